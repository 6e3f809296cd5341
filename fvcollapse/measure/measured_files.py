"""The files of an experiment folder: which are read, and those that only look as if they were.

A file that holds a measurement under a name that is not read would be passed over in silence.
"""

import stat
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from fvcollapse.errors import InputError
from fvcollapse.files.regular import SPECIAL
from fvcollapse.measure.curves import CSV_FILES

TABLES = (".csv", ".txt", ".tsv", ".dat", ".xls", ".xlsx", ".ods", ".gz", ".zip", ".xz")
COPIES = ("~", ".bak", ".orig", ".old", ".tmp", ".swp")  # what editors leave beside a file
ALIKE = 0.8  # of the letters: profile and profiles, but not pixels


def measured_files(folder: Path) -> dict[str, Path]:
    """Paths of the CSV files of a folder that are read, {name: path}.

    Parameters
    ----------
    folder : Path

    Raises
    ------
    InputError
        The folder cannot be listed; a file that is read is a folder, a pipe, a device or a link to
        nothing; a file is named almost as one that is read.
    """
    try:
        names = sorted(path.name for path in folder.iterdir())
    except OSError as error:
        problem = (error.strerror or str(error)).lower()
        raise InputError(folder, "folder", problem, "a readable folder") from None
    read = {name: folder / f"{name}.csv" for name in CSV_FILES if f"{name}.csv" in names}
    for path in read.values():
        if other := no_file(path):
            raise InputError(path, "file", other, "a CSV file")
    for name in names:
        if nearest := meant(name, read):
            raise InputError(folder / name, "file", "a name that is not read", f"{nearest}.csv")
    return read


def no_file(path: Path) -> str | None:
    """What stands at a path, in words, if that is no regular file; None if it is one."""
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        return "a link to nothing"
    except OSError as error:  # a ring of links, a folder that may not be entered
        return (error.strerror or str(error)).lower()
    if stat.S_ISREG(mode):
        return None
    return "a folder" if stat.S_ISDIR(mode) else SPECIAL.get(stat.S_IFMT(mode), "no file")


def meant(name: str, read: Any) -> str | None:
    """Name of the measurement that a file name is like but for its spelling or its ending; None if it is none.

    Where the measurement itself is there, a file with another ending is a copy or a source of it.
    """
    stem, *endings = name.casefold().split(".")
    endings = [f".{ending}" for ending in endings]
    if (
        name in {f"{known}.csv" for known in CSV_FILES}
        or not stem
        or not set(endings) & set(TABLES)
    ):
        return None
    if endings == [".csv"]:
        nearest = get_close_matches(stem, CSV_FILES, n=1, cutoff=ALIKE)
        return nearest[0] if nearest else None
    copy = name.endswith(COPIES) or ".csv" not in endings
    return stem if stem in CSV_FILES and not (copy and stem in read) else None
