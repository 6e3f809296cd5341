"""Places where a command will write: tried before anything is computed.

A computation takes minutes to hours. A trial file shows at its beginning whether the folder may be
entered, the name is short enough and the disk is writable.
"""

import errno
import os
import stat
from pathlib import Path

from fvcollapse.errors import OutputError
from fvcollapse.files.atomic import locked_temporary

NAME_MAX = 255  # bytes of a file name, of every usual file system
ELSEWHERE = "another place, or --force"  # allowed where other results are in the way


def make_folder(folder: str | Path, *names: str, mode: int = 0o777) -> Path:
    """Make a folder if need be, and prove that files can be written into it.

    Parameters
    ----------
    folder : str or Path
    *names : str
        Files that will be written there, each checked as by `refuse_bad_target`.
    mode : int
        Permissions of a new folder, less the umask.

    Returns
    -------
    Path
        The folder.

    Raises
    ------
    OutputError
        With exit status 2: nothing is computed yet.
    """
    folder = Path(folder)
    try:
        folder.mkdir(mode, parents=True, exist_ok=True)
        prove(folder / "file")
    except FileExistsError:
        raise OutputError(folder, "a file, where a folder is expected", running=False) from None
    except (OSError, ValueError) as error:
        raise OutputError(folder, error, running=False) from None
    for name in names:
        refuse_bad_target(folder / name)
    return folder


def refuse_file(folder: str | Path | None) -> None:
    """Refuse a file where a folder will be made (None: none); nothing is written.

    Raises
    ------
    OutputError
        With exit status 2.
    """
    if folder is None:
        return
    places = [Path(folder), *Path(folder).parents]
    there = next((place for place in places if is_there(place)), None)
    if there is not None and not there.is_dir():
        raise OutputError(there, "a file, where a folder is expected", running=False)


def refuse_bad_target(path: str | Path | None) -> None:
    """Refuse a file that cannot be written; None, which stands for no file, is accepted.

    An existing file or link may be replaced; a folder, a device or a pipe may not.

    Raises
    ------
    OutputError
        With exit status 2: nothing is computed yet.
    """
    if path is None:
        return
    path = Path(path)
    try:
        kind = kind_of(path)
        if kind is None or stat.S_ISREG(kind) or stat.S_ISLNK(kind):
            prove(path)
            return
    except FileNotFoundError:
        raise OutputError(path, "no such folder", running=False) from None
    except (OSError, ValueError) as error:
        raise OutputError(path, error, running=False) from None
    found = "a folder" if stat.S_ISDIR(kind) else "a device or a pipe"
    raise OutputError(path, found, running=False)


def is_there(path: str | Path) -> bool:
    """Whether a file or folder exists at a place where something is to be written.

    Raises
    ------
    OutputError
        The system does not tell: a folder that may not be entered, a name that is too long.
    """
    try:
        os.stat(path)
    except (FileNotFoundError, NotADirectoryError):
        return False
    except (OSError, ValueError) as error:
        raise OutputError(path, error, running=False) from None
    return True


def kind_of(path: str | Path) -> int | None:
    """Mode of what is at a path, of a link itself; None if there is nothing."""
    try:
        return os.lstat(path).st_mode
    except FileNotFoundError:
        return None


def prove(path: Path) -> None:
    """Make and remove a temporary file beside a path, as writing it will.

    Raises
    ------
    OSError, ValueError
    """
    if not path.name:
        raise OSError(errno.EISDIR, os.strerror(errno.EISDIR))
    if len(os.fsencode(path.name)) > NAME_MAX:
        raise OSError(errno.ENAMETOOLONG, os.strerror(errno.ENAMETOOLONG))
    handle, temporary = locked_temporary(path.parent)
    os.close(handle)
    os.unlink(temporary)


def has_contents(path: str | Path, data: bytes | None) -> bool:
    """Whether a file holds these bytes (None: never)."""
    return data is not None and read_or_none(path) == data


def read_or_none(path: str | Path) -> bytes | None:
    """The bytes of a file, None if it cannot be read."""
    try:
        return Path(path).read_bytes()
    except OSError:
        return None
