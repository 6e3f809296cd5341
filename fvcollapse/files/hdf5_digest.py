"""A digest at the end of an HDF5 file, by which damage is seen before the file is opened.

HDF5 itself does not always notice damage: one wrong byte in a table of texts may let it search for ever, where no
signal reaches it. The digest stands beyond the end of what HDF5 reads. A program that changes the file, be it in one
attribute, cuts it off; such a file is read without it, as is one that an earlier version wrote.
"""

import hashlib
import os
from functools import lru_cache
from pathlib import Path

MARK = b"fvcollapse sha256"
LENGTH = len(MARK) + hashlib.sha256().digest_size
BLOCK = 1 << 20  # bytes that are read at once
REMEMBERED = 64  # files whose digest is not computed again as long as they are the same


def with_digest(image: bytes) -> bytes:
    """The bytes of a file, and their digest."""
    return image + MARK + hashlib.sha256(image).digest()


def is_damaged(path: str | Path) -> bool:
    """Whether a file has a digest, and it is not that of its content.

    Raises
    ------
    OSError
        The file cannot be read.
    """
    stat = os.stat(path)
    return _is_damaged(os.path.abspath(path), stat.st_ino, stat.st_size, stat.st_mtime_ns)


@lru_cache(REMEMBERED)
def _is_damaged(path: str, inode: int, size: int, changed: int) -> bool:
    with open(path, "rb") as file:
        file.seek(max(size - LENGTH, 0))
        end = file.read()
        if not end.startswith(MARK):
            return MARK in end  # what follows was cut off
        digest, left = hashlib.sha256(), size - LENGTH
        file.seek(0)
        while left > 0:
            block = file.read(min(BLOCK, left))
            if not block:
                return True
            digest.update(block)
            left -= len(block)
    return end[len(MARK) :] != digest.digest()
