"""The options of the blind check, and what its steps share."""

from pathlib import Path

from fvcollapse.blind.seal import SEAL, read_seal
from fvcollapse.blind.set_ups import BLIND_DESIGNS
from fvcollapse.diagnosis.analysis import REFINEMENTS
from fvcollapse.diagnosis.verdict_model import SHIPPED, SHIPPED_CONTROLS
from fvcollapse.errors import InputError
from runs.study import one_of

FIRST = sorted({min(design) for design in BLIND_DESIGNS})  # experiments by which a case can begin


def add_options(parser):
    """Options of this study."""
    parser.add_argument("--per-class", type=int, default=18, help="cases of an effect; default 18")
    parser.add_argument(
        "--taught", type=int, default=240, help="cases of a suite that teach; default 240"
    )
    parser.add_argument(
        "--used-up",
        metavar="FOLDER",
        type=Path,
        nargs="*",
        default=[],
        help="--out of blind suites that have been scored: more cases to fit",
    )
    parser.add_argument("--cases", type=int, default=240, help="blind cases; default 240")
    parser.add_argument(
        "--first",
        type=one_of("--first", FIRST),
        metavar="SET_UP",
        nargs="*",
        default=FIRST,
        help=f"blind cases that begin by one of these experiments; default {', '.join(FIRST)}",
    )
    parser.add_argument("--per-world", type=int, default=3, help="cases of a world; default 3")
    parser.add_argument("--ladders", type=int, default=40, help="whole diagnoses; default 40")
    parser.add_argument(
        "--asked",
        type=int,
        help="cases whose next experiment is answered, the first by number; default all",
    )
    parser.add_argument("--refinements", type=int, default=REFINEMENTS, help="see analyse")
    parser.add_argument(
        "--layer",
        type=Path,
        nargs="*",
        default=[SHIPPED, SHIPPED_CONTROLS],
        help="verdict layers to restamp",
    )
    parser.add_argument("--note", help="why a restamp is right; required by it")


def options_of(arguments):
    """What the diagnosis of every case shares."""
    return {
        "cache": arguments.cache,
        "cell_size": arguments.cell_size,
        "workers": arguments.workers,
        "refinements": arguments.refinements,
        "quiet": False,
    }


def refuse_again(path):
    """Refuse to answer a suite that has been answered.

    Raises
    ------
    InputError
    """
    if path.exists():
        allowed = "no answers: a suite is answered once"
        raise InputError(path, "file", "answers that are already there", allowed)


def refuse_other_seal(arguments):
    """Refuse a suite whose seal is not the published one.

    Raises
    ------
    InputError
    """
    folder = arguments.out / "blind"
    published, present = (read_seal(place / SEAL) for place in (arguments.tables, folder))
    if published != present:
        raise InputError(folder / SEAL, "file", "another seal", f"that of {arguments.tables}")
