"""Reading of input from regular files only.

Reading from a named pipe without a writer, a terminal or a device would never end.
"""

import os
import stat
from errno import EINVAL
from pathlib import Path

from fvcollapse.errors import InputError

SPECIAL = {
    stat.S_IFIFO: "a named pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


def refuse_special(path):
    """Raise OSError unless there is a file or a folder at `path`."""
    kind = SPECIAL.get(stat.S_IFMT(os.stat(path).st_mode))
    if kind is not None:
        raise OSError(EINVAL, f"{kind}, not a regular file")


def refuse_unreadable(path, allowed):
    """Refuse what is no file that can be read.

    Parameters
    ----------
    path : str or Path
    allowed : str
        What is expected there, for the message.

    Raises
    ------
    InputError
    """
    try:
        refuse_special(path)
        with open(path, "rb"):
            pass
    except (OSError, ValueError) as error:
        problem = (getattr(error, "strerror", None) or str(error)).lower()
        raise InputError(path, "file", problem, allowed) from None


def read_regular(path):
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
