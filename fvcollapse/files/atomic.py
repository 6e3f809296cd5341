"""Files that appear whole or not at all, whatever ends the process that writes them.

A file is written beside its destination, forced to the disk and then put in place in one atomic move:
at any instant the destination is the last complete version. The temporary file has a random name
that nobody can guess, is made exclusively and for its owner alone, and is locked by its writer as long
as it exists. A temporary file whose lock is free was left by a process that was killed: the next write
into the folder removes it.
"""

import os
import tempfile
from contextlib import suppress
from pathlib import Path

from fvcollapse.errors import OutputError
from fvcollapse.files.locks import fcntl, try_lock

PREFIX, SUFFIX = ".fvcollapse-", ".tmp"  # of temporary files
USUAL = 0o666  # permissions of a file that is not private, before the mask of the process


def write_atomic(
    path: str | Path, data: bytes, running: bool = True, private: bool = False
) -> None:
    """Put `data` (bytes) at `path`: on the disk on return, previous file untouched on failure.

    Parameters
    ----------
    path : str or Path
    data : bytes
    running : bool
        Whether a computation is lost by a failure.
    private : bool
        Readable for the owner only.

    Raises
    ------
    OutputError
        Folder not writable, disk full.
    """
    path = Path(path)
    try:
        remove_stale(path.parent)
        handle, name = locked_temporary(path.parent)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(data)
                file.flush()
                if not private and hasattr(os, "fchmod"):
                    os.fchmod(file.fileno(), USUAL & ~mask_of_process())
                os.fsync(file.fileno())
                if fcntl is not None:
                    os.replace(name, path)  # while it is locked
            if fcntl is None:
                os.replace(name, path)
        finally:  # gone already, unless something stopped us
            with suppress(OSError):
                os.unlink(name)
        sync_folder(path.parent)
    except (OSError, ValueError) as error:
        raise OutputError(path, error, running) from None


def locked_temporary(folder: Path) -> tuple[int, str]:
    """(handle, path) of a new temporary file in a folder that this process has locked, if it can."""
    while True:
        handle, name = tempfile.mkstemp(SUFFIX, PREFIX, folder)
        try:
            taken = not try_lock(handle)
        except OSError:  # a file system without locks, where nobody removes it either
            taken = False
        if not taken and still_there(handle, name):
            return handle, name
        os.close(handle)  # another process took it for one that was left, and removed it


def remove_stale(folder: str | Path) -> None:
    """Remove the temporary files in a folder whose writer is dead; those of living ones are locked."""
    if fcntl is None:  # on Windows, where nobody can tell whether a writer lives
        return
    for path in Path(folder).glob(f"{PREFIX}*{SUFFIX}"):
        with suppress(OSError):
            handle = os.open(path, os.O_RDWR | os.O_NOFOLLOW)
            try:
                if try_lock(handle):
                    path.unlink()
            finally:
                os.close(handle)


def still_there(handle: int, name: str) -> bool:
    """Whether a name is still that of the open file."""
    try:
        return os.path.samestat(os.fstat(handle), os.stat(name, follow_symlinks=False))
    except FileNotFoundError:
        return False


def mask_of_process() -> int:
    """Permissions that new files of this process do not get; read without changing it where possible."""
    with suppress(OSError, ValueError), open("/proc/self/status", encoding="ascii") as file:
        for line in file:
            if line.startswith("Umask:"):
                return int(line.split()[1], 8)
    mask = os.umask(0o077)
    os.umask(mask)
    return mask


def sync_folder(folder: str | Path) -> None:
    """Force the names in a folder to the disk, where the system can."""
    if os.name == "posix":
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
