"""Whose results a place holds: the one rule by which every command writes, which `--help` prints.

A *question* is all that an answer depends on (the case, the experiments, the values), but not how it is
computed (number of workers, scheduler, cache) nor what is printed.

- A folder of results (`sweep`, `converge`, `diagnose`, `plot`) holds its question in `question.json`. A
  folder with other contents and without that file is foreign.
- A folder of one run holds it as the case in `result.h5` and `checkpoint.h5`; see `output.run.run_case`.
- A single file (`--json`, `--markdown`, a curve of `import-curves`) holds no question: one that is
  there is refused, unless its contents are to be the same.
- `blind make` has its own record, the sealed labels, and no `--force`: labels are never replaced.
"""

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fvcollapse.case.grammar import as_table
from fvcollapse.errors import InputError, OutputError
from fvcollapse.files.atomic import PREFIX, write_atomic
from fvcollapse.files.locks import LOCK, exclusive
from fvcollapse.files.targets import (
    ELSEWHERE,
    has_contents,
    is_there,
    read_or_none,
    refuse_bad_target,
)

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


RECORD = "question.json"
FORMAT = "fvcollapse-question"
OUTPUTS = ("time.output_interval", "time.field_interval", "time.output_times")


def case_question(case: "Case", without: Sequence[str] = ()) -> dict[str, Any]:
    """The keys of a case as {"case.section.key": value}, those that only concern outputs left out.

    Parameters
    ----------
    case : Case
    without : sequence of str
        Further keys, or whole sections, to leave out.
    """
    return {
        f"case.{name}": value
        for name, value in flat(as_table(case)).items()
        if not any(covers(key, name) for key in (*OUTPUTS, *without))
    }


def flat(table: dict, prefix: str = "") -> dict[str, Any]:
    """{dotted name: value} of a nested table; an empty section counts as a key."""
    found: dict[str, Any] = {}
    for name, value in table.items():
        if isinstance(value, dict) and value:
            found |= flat(value, f"{prefix}{name}.")
        else:
            found[prefix + name] = value
    return found


def covers(key: str, name: str) -> bool:
    """Whether a dotted name is a key, or in the section of that name."""
    return name == key or name.startswith(f"{key}.")


class Latitude(NamedTuple):
    """What may differ between two askings of the same question.

    Attributes
    ----------
    free : tuple of str
        Names, or whole sections of names, that may have any value: they are in the names of the
        results. Only what was free before stays free.
    growing : tuple of str
        Names of lists to which further values may be added.
    """

    free: tuple = ()
    growing: tuple = ()


def claim_folder(
    folder: str | Path,
    command: str,
    question: dict,
    force: bool = False,
    latitude: Latitude = Latitude(),  # noqa: B008 (immutable)
) -> bool:
    """Make a folder the place of a question, or find that it already is.

    Parameters
    ----------
    folder : str or Path
        Made if need be.
    command : str
        Name of the command that asks.
    question : dict
        {name: number, text, list, …}: all that the answer depends on.
    force : bool
        Take the folder over from another question.
    latitude : Latitude

    Returns
    -------
    bool
        Whether the results that are there, if any, belong to this question.

    Raises
    ------
    InputError
        The folder holds something else, and `force` is False.
    OutputError
        It cannot be written.
    """
    folder, question = Path(folder), as_stored(question)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        others = sorted(entry.name for entry in os.scandir(folder) if not is_own(entry.name))
    except OSError as error:
        raise OutputError(folder, error, running=False) from None
    if others and not force and not (folder / RECORD).exists():
        found = f"contents of another origin, such as {others[0]}"
        raise InputError(folder, "folder", found, f"an empty or new folder, {ELSEWHERE}")
    with exclusive(folder / LOCK):
        stored = stored_question(folder / RECORD, force) if others else None
        same, free = False, list(latitude.free)
        if stored is not None:
            shared = [name for name in free if name in stored["free"]]
            other = differences(stored, command, question, latitude._replace(free=tuple(shared)))
            same, free = not other, shared if not other else free
            if other and not force:
                raise other_question(folder / RECORD, other[0], stored, command, question)
        content = {"format": FORMAT, "command": command, "question": question, "free": free}
        if content != stored:
            text = json.dumps(content, indent=1, sort_keys=True) + "\n"
            write_atomic(folder / RECORD, text.encode(), running=False)
    return same


def as_stored(question: dict) -> dict:
    """The question as it is read back from JSON."""
    return json.loads(json.dumps(question))


def is_own(name: str) -> bool:
    """Whether a file is one that this module, or a file that is being written, leaves in a folder."""
    return name in (LOCK, RECORD) or name.startswith(PREFIX)


def stored_question(path: Path, force: bool) -> dict | None:
    """What `question.json` holds; None if there is none, or if it is broken and may be replaced."""
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
        whole = stored["format"] == FORMAT and isinstance(stored["command"], str)
        whole = whole and isinstance(stored["question"], dict) and isinstance(stored["free"], list)
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        whole = False
    if not whole and not force:
        raise InputError(path, "file", "no question of fvcollapse", ELSEWHERE)
    return stored if whole else None


def differences(stored: dict, command: str, question: dict, latitude: Latitude) -> list[str]:
    """Names in which a question differs from the one stored, beyond the latitude."""
    if stored["command"] != command:
        return ["command"]
    before = stored["question"]

    def same(name):
        old, new = before.get(name), question.get(name)
        if name in latitude.growing and isinstance(old, list) and isinstance(new, list):
            return all(value in new for value in old)
        return old == new or any(covers(key, name) for key in latitude.free)

    return [name for name in sorted(before.keys() | question.keys()) if not same(name)]


def other_question(path: Path, name: str, stored: dict, command: str, question: dict) -> InputError:
    """The InputError that names a difference to the question that was stored."""
    before, now = stored["question"].get(name), question.get(name)
    if name == "command":
        before, now = stored["command"], command
    allowed = f"{shown(before)}, as the results there have it, {ELSEWHERE}"
    return InputError(path, name.removeprefix("case."), shown(now), allowed)


def shown(value: Any) -> str:
    """A value of a question in a few words."""
    text = "absent" if value is None else json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else text[:57] + "..."


def claim_file(path: str | Path | None, force: bool = False, copy_of: Path | None = None) -> None:
    """Refuse a file that is to be written last (None: none) if it is there, or cannot be written.

    Parameters
    ----------
    path : str or Path, optional
    force : bool
        Replace it.
    copy_of : Path, optional
        A file of a folder that was claimed: a copy of it may be renewed.

    Raises
    ------
    InputError
        It exists, and `force` is False.
    OutputError
        It cannot be written.
    """
    refuse_bad_target(path)
    if path is None or force or not is_there(path):
        return
    if copy_of is None or not has_contents(path, read_or_none(copy_of)):
        raise InputError(path, "file", "one that is already there", ELSEWHERE)
