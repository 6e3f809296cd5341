"""How large a cache of runs is, and its pruning."""

import shutil
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from fvcollapse.errors import InputError, UnreadableError
from fvcollapse.files.locks import LOCK, exclusive
from fvcollapse.output.result import open_result
from fvcollapse.studies.cache import EXTRACT, WORK, cache_key
from fvcollapse.studies.cache_folder import default_folder

DIGITS = 64  # of a key


class CacheSize(NamedTuple):
    """Finished runs, runs that were begun, and their size in bytes."""

    folder: Path
    finished: int
    begun: int
    size: int

    def line(self, verb: str) -> str:
        """One line; `verb` says what is done with these runs."""
        return (
            f"{self.folder}: {verb} {self.finished} finished runs and {self.begun} that were begun, "
            f"{self.size / 1e6:.1f} MB"
        )


def cache_size(folder: str | Path | None = None) -> CacheSize:
    """The `CacheSize` of a cache; default that of this user. A folder that is not there holds nothing."""
    folder = Path(folder or default_folder()).absolute()
    return sized(folder, entries(folder))


def entries(folder: Path) -> list[Path]:
    """Folders of the runs of a cache, each named by its key; other files in it are none of its business."""
    return [
        place
        for place in sorted(folder.glob("??/*"))
        if len(place.name) == DIGITS and place.name[:2] == place.parent.name and place.is_dir()
    ]


def sized(folder: Path, places: Iterable[Path]) -> CacheSize:
    """The `CacheSize` of some entries."""
    finished = sum((place / EXTRACT).exists() for place in places)
    begun = sum((place / WORK).exists() for place in places)
    return CacheSize(folder, finished, begun, sum(map(size_of, places)))


def size_of(place: Path) -> int:
    """Bytes of all files of an entry; one that vanishes meanwhile counts nothing."""
    total = 0
    for path in place.rglob("*"):
        try:
            total += path.stat().st_size if path.is_file() else 0
        except FileNotFoundError:
            continue
    return total


def prune(folder: str | Path | None = None) -> CacheSize:
    """Remove the entries that no question to the present solver can find; the `CacheSize` of what went.

    Each entry is locked while it is looked at, so that a run of another process is waited for. One that cannot be
    read now stays.
    """
    folder = Path(folder or default_folder()).absolute()
    gone = CacheSize(folder, 0, 0, 0)
    for place in entries(folder):
        with exclusive(place / LOCK):
            if is_of_use(place):
                continue
            one = sized(folder, [place])
            shutil.rmtree(place / WORK, ignore_errors=True)
            (place / EXTRACT).unlink(missing_ok=True)
        shutil.rmtree(place, ignore_errors=True)
        gone = CacheSize(folder, *(a + b for a, b in zip(gone[1:], one[1:], strict=True)))
    return gone


def is_of_use(place: Path) -> bool:
    """Whether the present solver would find the run in an entry under its key."""
    path = place / EXTRACT if (place / EXTRACT).exists() else place / WORK
    try:
        return cache_key(open_result(path).case) == place.name
    except UnreadableError:
        return True
    except InputError:
        return False
