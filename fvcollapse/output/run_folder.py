"""The folder of one run: names of its files, whose run it is, and what a kill left undone there."""

import tomllib
from contextlib import suppress
from logging import Logger
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fvcollapse.case.case import case_from_text
from fvcollapse.errors import InputError, OutputError, UnreadableError
from fvcollapse.files.atomic import remove_stale, write_atomic
from fvcollapse.files.hdf5 import reading, text_attribute
from fvcollapse.files.targets import is_there
from fvcollapse.output import checkpoint, result
from fvcollapse.output.checkpoint import read_checkpoint
from fvcollapse.output.recorder import SAME_TIME
from fvcollapse.output.result import open_result
from fvcollapse.output.run_log import tell
from fvcollapse.output.xdmf import has_meshes, xdmf_text

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.output.checkpoint import Checkpoint
    from fvcollapse.output.result import Result


RESULT, CHECKPOINT, XDMF = "result.h5", "checkpoint.h5", "result.xdmf"
# what may change when a run is continued: where it ends, and its outputs
OUTPUT_KEYS = (
    "time.end",
    "time.stop_at_rest",
    "time.output_interval",
    "time.field_interval",
    "time.output_times",
)
FORMATS = {RESULT: result.FORMAT, CHECKPOINT: checkpoint.FORMAT}


def key_values(case: "Case") -> dict[str, Any]:
    """All keys of a case that are present, as {dotted name: value}."""

    def flatten(table, prefix):
        for name, value in table.items():
            if isinstance(value, dict):
                yield from flatten(value, f"{prefix}{name}.")
            else:
                yield prefix + name, value

    return dict(flatten(tomllib.loads(case.to_toml()), ""))


def holds_run(case: "Case", folder: Path) -> bool:
    """Whether a folder holds a run of exactly this case, finished or not."""
    stored = [stored_case(folder / name) for name in FORMATS]
    found = [key_values(one) for one in stored if one is not None]
    return bool(found) and all(values == key_values(case) for values in found)


def stored_case(path: Path) -> "Case | None":
    """The case in a result or checkpoint; None if it is missing or cannot be read."""
    try:
        with reading(path, FORMATS[path.name]) as file:
            return case_from_text(text_attribute(file, "case"), path)
    except UnreadableError:  # it may be sound
        raise
    except InputError:
        return None


def ready(case: "Case", folder: Path, resume: bool, force: bool) -> bool:
    """Whether to continue what is in a folder that this run holds now; another run goes if `force`."""
    if force:
        resume = holds_run(case, folder)
        if not resume:
            remove_run(folder)
    elif not resume:
        refuse_existing(folder)  # another run may have ended here meanwhile
    return resume


def refuse_existing(folder: Path) -> None:
    """Refuse a folder that already holds a result (or the checkpoint of one)."""
    for name in (RESULT, CHECKPOINT):
        if is_there(folder / name):
            raise InputError(
                folder / name,
                "file",
                "a result that is already there",
                "another folder, --resume, or --force",
            )


def serves(finished: "Result", case: "Case") -> bool:
    """Whether a finished result goes to the end of a case that differs in end and outputs only."""
    if finished.ended_at_rest:
        return case.time.stop_at_rest or case.time.end <= finished.time[-1] + SAME_TIME
    return case.time.end <= finished.case.time.end + SAME_TIME


def refuse_other_case(case: "Case", stored: "Case", path: Path) -> None:
    """Refuse to continue a run with a case that differs in more than its end and outputs."""
    new, old = key_values(case), key_values(stored)
    for name in sorted(new.keys() | old.keys()):
        if name not in OUTPUT_KEYS and new.get(name) != old.get(name):
            began = old.get(name, "absent")
            allowed = f"{began}, as the run began (only [time] end and outputs may change)"
            raise InputError(path, name, str(new.get(name, "absent")), allowed)


def remove_run(folder: Path) -> None:
    """Remove result, checkpoint and XDMF file of a run that is to be replaced.

    Raises
    ------
    OutputError
    """
    for name in (RESULT, XDMF, CHECKPOINT):
        try:
            (folder / name).unlink(missing_ok=True)
        except OSError as error:
            raise OutputError(folder / name, error, running=False) from None


def tidy(folder: Path) -> None:
    """Remove what killed runs left half written; only for the run that holds the folder."""
    remove_stale(folder)
    for name in (RESULT, CHECKPOINT, XDMF):  # the names of earlier versions
        with suppress(OSError):
            (folder / f".{name}.tmp").unlink(missing_ok=True)


def renew_xdmf(folder: Path) -> None:
    """Write the XDMF file that belongs to the result, unless it is there: a kill may have come before it.

    A result of an earlier version, without meshes, keeps the one that it has.

    Raises
    ------
    OutputError
    """
    with reading(folder / RESULT, result.FORMAT) as file:
        if not has_meshes(file):
            return
        text = xdmf_text(file, RESULT)
    path = folder / XDMF
    if not path.is_file() or path.read_bytes() != text:
        write_atomic(path, text, running=False)


def usable_checkpoint(folder: Path, log: Logger) -> "Checkpoint | None":
    """The checkpoint in the folder; None, with a warning in the log, if it is missing or broken."""
    path = folder / CHECKPOINT
    if not path.exists():
        tell(log, f"{path}: no checkpoint; the run starts from t = 0")
        return None
    try:
        return read_checkpoint(path)
    except UnreadableError:  # it may be sound
        raise
    except InputError as error:
        tell(log, f"checkpoint not usable, the run starts from t = 0: {error}")
        return None


def finished_result(
    case: "Case", folder: Path, stored: "Checkpoint | None", log: Logger
) -> "Result | None":
    """The result in the folder if it is complete to the end of the case, else None.

    Raises
    ------
    InputError
        Result or checkpoint belong to another case, or the result may be of anything.
    """
    previous = None
    if (folder / RESULT).exists():
        try:
            previous = open_result(folder)
        except UnreadableError:
            raise
        except InputError as error:
            log.warning("previous result not usable: %s", error)
    if stored is not None:
        refuse_other_case(case, case_from_text(stored.case_text), folder / CHECKPOINT)
    if previous is None and stored is None and (folder / RESULT).exists():
        found = "a file of unknown origin: it cannot be read, and there is no checkpoint beside it"
        raise InputError(folder / RESULT, "file", found, "another folder, or --force")
    if previous is not None:
        refuse_other_case(case, previous.case, folder / RESULT)
        if previous.complete and serves(previous, case):
            return previous
    return None
