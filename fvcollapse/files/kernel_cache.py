"""Where compiled kernels are kept on the disk, for any number of processes that compile at the same time.

Beside the file of a kernel, in `__pycache__`, stand an index (`.nbi`) and a file for each tuple of argument types
(`.nbc`), as those of Numba. Four things differ:

- a kernel is made again when any file with kernels has changed, since Numba looks at its own file only, not at those
  of the kernels that it calls;
- no other argument types and no other sources have the name of a data file, which is written before the index names
  it. Numba numbers the files and writes the index first. A process that reads in between then finds the kernel of an
  earlier source, and of two processes that save at once one may be given the kernel of the other's argument types;
- processes write an index one after the other, so that none overwrites the entry of another;
- kernels are read without the tables of the compiler, which take half a second to import.

None of this changes a number. So the digest of the solver does not depend on this file (`output/fingerprint.py`).
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from filelock import FileLock
from numba import __version__ as numba_version
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.runtime import rtsys

FILES_OF_KERNELS = ("step/*.py", "measure/pile.py", "measure/series_row.py", "march.py")
LOCK = "kernels.lock"  # of the indices of a folder; it is empty
PATIENCE = 60.0  # s to wait for a lock; an entry that is lost without it is compiled again
NOT_KEPT: set[str] = set()  # names of kernels that the disk did not take


@cache
def source_digest() -> str:
    """Digest of all files with kernels: what is compiled into one may stand in any of them."""
    digest, package = sha256(), Path(__file__).parents[1]
    for path in sorted(file for pattern in FILES_OF_KERNELS for file in package.glob(pattern)):
        digest.update(path.read_bytes())
    return digest.hexdigest()


class KernelFiles(IndexDataCacheFile):
    """Index and data files of a kernel, which several processes may read and write at once."""

    def save(self, key: tuple, data: Any) -> None:
        """Write a data file, then its entry in the index; see the module."""
        name = self._data_name_of(key)
        with self._alone():
            entries = self._load_index()
            if not entries:  # none yet, or of other sources
                self._remove_data()
            self._save_data(name, data)
            before = entries.get(key)  # another process may have named it otherwise
            if before != name:
                self._save_index(entries | {key: name})
                self._remove(before)

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """Hold the lock of all indices of the folder; where the file system has no locks, go on without."""
        lock = FileLock(Path(self._cache_path) / LOCK, timeout=PATIENCE)
        try:
            lock.acquire(poll_interval=0.01)
        except (OSError, NotImplementedError):  # a Timeout is an OSError
            yield
            return
        try:
            yield
        finally:
            lock.release()

    def _data_name_of(self, key: tuple) -> str:
        """Name of the data file of a key, which no other key nor version has; two processes may differ on it."""
        content = f"{self._version} {self._source_stamp} {self._dump(key)}"
        return self._data_name_pattern.format(
            number=int(sha256(content.encode()).hexdigest()[:15], 16)
        )

    def _remove_data(self) -> None:
        """Remove all data files, those of other sources."""
        before, after = self._data_name_pattern.split("{number:d}")
        for path in Path(self._cache_path).glob(f"{before}*{after}"):
            self._remove(path.name)

    def _remove(self, name: str | None) -> None:
        """Remove a data file, if there is one and the system lets it go."""
        if name is not None:
            with suppress(OSError):
                Path(self._data_path(name)).unlink()


class KernelCache(FunctionCache):
    """Compiled kernels of one function on the disk, for all types of its arguments.

    Parameters
    ----------
    function : function
    kind : str
        Tells kernels apart that are made of one function.

    Raises
    ------
    RuntimeError
        Numba has no place for them.
    """

    def __init__(self, function: Callable, kind: str = "") -> None:
        super().__init__(function)
        self._kind = kind
        numbas = self._cache_file
        self._cache_file = KernelFiles(
            self._cache_path, self._impl.filename_base, numbas._source_stamp
        )
        # the index of another version is not even read: it may name classes that are gone
        self._cache_file._version = f"{numba_version}+{source_digest()}"

    def _index_key(self, sig: Any, codegen: Any) -> tuple:
        """Numba's own key pickles the kernels in a closure, anew in each process; the digest covers their files."""
        return (sig, codegen.magic_tuple(), self._kind)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a kernel; one that the disk does not take is compiled again next time."""
        try:
            super().save_overload(sig, data)
        except OSError:
            NOT_KEPT.add(self._name)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The kernel for these argument types, or None."""
        rtsys.initialize(target_context)  # what the kernels allocate memory with
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)


def kept_types(kernel: Any) -> list[tuple] | None:
    """Types of the arguments for which a kernel is on the disk; None where none is kept.

    Raises
    ------
    OSError
        Another process replaces the index (Windows).
    """
    files = getattr(getattr(kernel, "_cache", None), "_cache_file", None)
    return None if files is None else [types for types, *_ in files._load_index()]


def not_kept() -> int:
    """Number of kernels that could not be kept on the disk."""
    return len(NOT_KEPT)


def keep_on_disk(kernel: Any, function: Callable, kind: str = "") -> None:
    """Let a kernel be kept on the disk, as does `cache=True`, where a folder can be written; see `KernelCache`."""
    try:
        kernel._cache = KernelCache(function, kind)
    except RuntimeError:  # Numba has no place for it
        NOT_KEPT.add(function.__name__)
