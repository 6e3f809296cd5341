"""HDF5 files: built in memory, and read without trust. Nothing is ever unpickled."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import ArrayLike

from fvcollapse.errors import InputError, UnreadableError
from fvcollapse.files.hdf5_digest import is_damaged, with_digest
from fvcollapse.files.hdf5_safety import unsafe_items
from fvcollapse.files.regular import refuse_unreadable
from fvcollapse.files.trees import is_text

# the oldest format whose attributes may exceed 64 KB (a case with many output times)
LIBVER = ("v108", "v110")
MEMORY_FILES = count()
# made once: `attrs[...] = text` makes this type anew each time, a quarter of the time of writing a value
TEXT = h5py.string_dtype()
TEXT_ID, ONE_ID = h5py.h5t.py_create(TEXT, logical=True), h5py.h5s.create(h5py.h5s.SCALAR)
BROKEN = (
    OSError,
    KeyError,
    RuntimeError,
    ValueError,
    TypeError,
    AttributeError,
    IndexError,
    MemoryError,
)


def memory_file(libver: tuple[str, str] = LIBVER) -> h5py.File:
    """A new HDF5 file that lives in memory only."""
    name = f"fvcollapse-memory-{next(MEMORY_FILES)}"  # HDF5 tells open files apart by name
    return h5py.File(name, "w", driver="core", backing_store=False, libver=libver)


def build_image(fill: Callable[[h5py.File], object], libver: tuple[str, str] = LIBVER) -> bytes:
    """Bytes of the HDF5 file that `fill(file)` writes, with their digest (see `hdf5_digest`)."""
    with memory_file(libver) as file:
        fill(file)
        file.flush()
        return with_digest(file.id.get_file_image())


def write_dataset(
    group: h5py.Group, name: str, values: ArrayLike, units: str, description: str
) -> None:
    """Store an array, compressed if it has more than one value, with its units and meaning."""
    values = np.asarray(values)
    options = (
        {"compression": "gzip", "compression_opts": 4, "shuffle": True} if values.size > 1 else {}
    )
    dataset = group.create_dataset(name, data=values, **options)
    for about, text in (("units", units), ("description", description)):
        attribute = h5py.h5a.create(dataset.id, about.encode(), TEXT_ID, ONE_ID)
        attribute.write(np.array(text, dtype=TEXT))


@contextmanager
def reading(source: Any, kind: str, part: str = "/") -> Iterator[h5py.File]:
    """Open an HDF5 `source` (path, or image in memory) of format `kind`; any defect is one InputError.

    Whatever leads out of the file is refused (see `hdf5_safety`) in the group `part` that will be read.
    A file that cannot be read now (not permitted, locked) is an UnreadableError.
    """
    in_memory = not isinstance(source, str | Path)
    name = kind if in_memory else source
    allowed = f"a complete {kind} file written by fvcollapse"
    if not in_memory:
        refuse_unreadable(source, allowed)
    try:
        if not in_memory and is_damaged(source):
            raise InputError(
                name, "file", "a damaged file: its digest is not that of its content", allowed
            )
        with h5py.File(source, "r") as file:
            found = text_attribute(file, "format")
            if found != kind:
                raise InputError(name, "format", repr(found), repr(kind))
            for refusal in unsafe_items(file, part):
                raise InputError(name, *refusal)
            yield file
    except BlockingIOError:
        held = "a file that another program holds open and has locked"
        free = "a file that is free; or set HDF5_USE_FILE_LOCKING=FALSE to read it all the same"
        raise UnreadableError(name, "file", held, free) from None
    except BROKEN:
        raise InputError(name, "file", "a broken or truncated file", allowed) from None


def text_attribute(file: h5py.File, name: str) -> str:
    """A root attribute that must be text."""
    value = file.attrs[name]
    if not isinstance(value, str) or not is_text(value):
        raise InputError(
            name_of(file), name, "no text in UTF-8", "what fvcollapse has written there"
        )
    return value


def name_of(file: h5py.File) -> str:
    """Path of an open HDF5 file, as errors give it."""
    return "a file in memory" if file.driver == "fileobj" else file.filename
