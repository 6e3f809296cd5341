"""Input is read from regular files only.

Reading from a named pipe without a writer, from a terminal or from a device might never end.
"""

import os
import stat
from errno import EINVAL
from pathlib import Path

from fvcollapse.errors import InputError, UnreadableError

SPECIAL = {
    stat.S_IFIFO: "a named pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


def refuse_special(path: str | Path) -> None:
    """Raise OSError if `path` is missing, or is neither a file nor a folder."""
    kind = SPECIAL.get(stat.S_IFMT(os.stat(path).st_mode))
    if kind is not None:
        raise OSError(EINVAL, f"{kind}, not a regular file")


def refuse_unreadable(path: str | Path, allowed: str) -> None:
    """Refuse a path at which no readable file is.

    Parameters
    ----------
    path : str or Path
    allowed : str
        What is expected there, for the message.

    Raises
    ------
    InputError
        An `UnreadableError` where permission is missing.
    """
    try:
        refuse_special(path)
        with open(path, "rb"):
            pass
    except (OSError, ValueError) as error:
        problem = problem_words(error)
        refusal = UnreadableError if isinstance(error, PermissionError) else InputError
        raise refusal(path, "file", problem, allowed) from None


def problem_words(error: Exception) -> str:
    """Why a file could not be read."""
    if isinstance(error, IsADirectoryError):
        return "a folder"
    return (getattr(error, "strerror", None) or str(error)).lower()


def read_regular(path: str | Path) -> bytes:
    """Bytes of a regular file; links are followed.

    Raises
    ------
    OSError
        There is no such file, it cannot be read, or it is a pipe, a socket, a device or a folder.
    ValueError
        The path holds a null character.
    """
    refuse_special(path)
    return Path(path).read_bytes()
