"""The forms of labels, seal and answers: what a file of others must be before it is used.

Names of cases and of experiments become names of folders: they are `case_<digits>`, and those of the
set-ups that are known.
"""

import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec

from fvcollapse.blind.run_forms import Form, Positive, Run, Share, Whole
from fvcollapse.blind.set_ups import CONTROL, SET_UPS, STATEMENTS
from fvcollapse.case.grammar import Section, closest_name, show
from fvcollapse.diagnosis.names import NAMED, NONE, UNKNOWN
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import NUISANCE
from fvcollapse.errors import InputError
from fvcollapse.output.forms import form_problems
from fvcollapse.output.json_files import read_object

VERDICTS = (*NAMED, NONE, UNKNOWN)
NAMES = 'effects of the catalogue, two of them joined by "+" in alphabetical order, none, unknown'
CASE_NAME = re.compile(r"case_[0-9]{1,12}")
SUM_TOLERANCE = 1.0e-3

Digest = Annotated[str, msgspec.Meta(pattern=r"^[0-9a-f]{64}\Z")]
Salt = Annotated[str, msgspec.Meta(pattern=r"^[0-9a-f]{32}\Z")]


# -- labels ------------------------------------------------------------------------------------------------


class Drawn(msgspec.Struct):
    """One effect of a label."""

    closure: Whole
    section: dict[str, bool | float | str]
    quantiles: dict[str, Share]


class World(msgspec.Struct):
    """What all experiments of a laboratory have in common, see `generator.drawn_world`."""

    name: Annotated[str, msgspec.Meta(pattern=r"^world_[0-9]{1,12}\Z")]
    strength: Literal["slight", "strong"]
    statement: str
    quality: Positive
    common: dict[str, float]
    controls: dict[str, Run]


class Label(msgspec.Struct):
    """What is hidden in a case, see `generator.draw_label`."""

    world: World
    cause: str
    unknown_kind: str | None
    effects: dict[str, Drawn]
    form: Form | None
    experiments: dict[str, Run]


class Entry(msgspec.Struct):
    """A label with its salt and the seed of its draw."""

    salt: Salt
    seed: Whole
    world_seed: Whole
    attempt: Whole
    label: Label


def label_problems(entry: Any) -> Iterator[tuple[str, str, str]]:
    """(key, found, allowed) of what is wrong in an entry of the labels."""
    wrong = list(form_problems(entry, Entry))
    if wrong:
        yield from wrong
        return
    label = entry["label"]
    if not is_name(label["cause"]):
        yield "label.cause", show(label["cause"]), NAMES
    elif (label["unknown_kind"] is not None) != (label["cause"] == UNKNOWN):
        yield (
            "label.unknown_kind",
            str(label["unknown_kind"]),
            f"a kind where the cause is {UNKNOWN}",
        )
    for name, drawn in label["effects"].items():
        yield from drawn_problems(name, drawn)
    world = label["world"]
    if world["statement"] not in STATEMENTS:
        yield "label.world.statement", show(world["statement"]), " or ".join(STATEMENTS)
    places = {"label.experiments": (label["experiments"], "")}
    places["label.world.controls"] = (world["controls"], CONTROL)
    for key, (runs, prefix) in places.items():
        for name in runs:
            if not name.startswith(prefix) or name.removeprefix(prefix) not in SET_UPS:
                nearest = closest_name(name, [prefix + each for each in SET_UPS])
                yield key, show(name), f"set-ups; the closest is {nearest}"


def drawn_problems(name: str, drawn: Any) -> Iterator[tuple[str, str, str]]:
    """The same for one effect."""
    key = f"label.effects.{name}"
    if name not in CATALOGUE:
        yield "label.effects", show(name), "effects of the catalogue"
        return
    section: type[Section] = CATALOGUE[name].section
    variants, keys = CATALOGUE[name].variants, section.__struct_fields__
    if drawn["closure"] >= len(variants):
        yield f"{key}.closure", f"{drawn['closure']}", f"0 to {len(variants) - 1}"
    for parameter in drawn["quantiles"]:
        value = drawn["section"].get(parameter)
        if parameter not in keys or isinstance(value, bool | str | None):
            yield f"{key}.quantiles", show(parameter), "parameters of the effect, with a value"


# -- the seal ----------------------------------------------------------------------------------------------


class Sealed(msgspec.Struct):
    """Hashes of one case."""

    label: Digest
    data: Digest


class Seal(msgspec.Struct):
    """What `SEAL.json` holds."""

    seal: Digest
    cases: dict[str, Sealed]


# -- answers -----------------------------------------------------------------------------------------------


class Interval(msgspec.Struct):
    """A parameter with its interval of 90 %."""

    value: float
    low: float
    high: float


class Reduction(msgspec.Struct):
    """Parts of the gap that are closed; `winner` where an experiment was held out, and what both leave of its gap."""

    predicted: float | None
    actual: float | None
    runner_up: float | None
    winner: float | None = None
    winner_left: float | None = None
    runner_up_left: float | None = None


class Answer(msgspec.Struct):
    """The answer to one case, see `score.score`."""

    verdict: str
    probability: Annotated[dict[str, Share], msgspec.Meta(min_length=1)]
    set: list[str] = []
    parameters: dict[str, dict[str, Interval]] = {}
    reduction: Reduction | msgspec.UnsetType = msgspec.UNSET


def answer_problems(answer: Any) -> Iterator[tuple[str, str, str]]:
    """(key, found, allowed) of what is wrong in an answer."""
    wrong = list(form_problems(answer, Answer))
    if wrong:
        yield from wrong
        return
    if answer["verdict"] not in VERDICTS:
        yield "verdict", show(answer["verdict"]), " or ".join(VERDICTS)
    for name in answer["probability"]:
        if not is_name(name):
            yield f"probability.{name}", "no such name", NAMES
    total = sum(answer["probability"].values())
    if abs(total - 1.0) > SUM_TOLERANCE:
        yield "probability", f"a sum of {total:.6g}", "1"
    if not all(is_name(name) for name in answer.get("set", [])):
        yield "set", show(answer["set"]), f"a list of {NAMES}"
    for effect, table in answer.get("parameters", {}).items():
        for name, row in table.items():
            if row["low"] > row["high"]:
                found = f"low = {row['low']:g}, high = {row['high']:g}"
                yield f"parameters.{effect}.{name}", found, "low <= high"


# -- files -------------------------------------------------------------------------------------------------


def is_name(name: str) -> bool:
    """Whether a name can be a cause."""
    if name in (NONE, UNKNOWN):
        return True
    parts = name.split("+")
    known = {effect for effect, about in CATALOGUE.items() if about.kind != NUISANCE}
    return 1 <= len(parts) <= 2 and set(parts) <= known and parts == sorted(set(parts))


def read_form(path: str | Path, kind: str, part: str = "cases") -> Any:
    """A JSON object of a format with a table `part`; a defect is one InputError."""
    table = read_object(path, f"a {kind} file")
    if table.get("format") != kind or not isinstance(table.get(part), dict):
        raise InputError(path, "format", show(table.get("format", "none")), f"{kind!r} with {part}")
    return table


def refuse_names(path: str | Path, cases: Iterable[str]) -> None:
    """Refuse names of cases that are anything but `case_<digits>`."""
    for name in cases:
        if not CASE_NAME.fullmatch(name):
            raise InputError(path, "cases", show(name), "names of cases: case_<digits>")
