"""HDF5 files that are built in memory, and reading that trusts nothing: nothing is ever unpickled."""

from contextlib import contextmanager
from itertools import count
from pathlib import Path

import h5py
import numpy as np

from fvcollapse.errors import InputError, UnreadableError
from fvcollapse.files.regular import refuse_special

LIBVER = (
    "v108",
    "v110",
)  # oldest format that takes attributes beyond 64 KB (a case with many output times)
MEMORY_FILES = count()
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


def memory_file(libver=LIBVER):
    """A new HDF5 file that lives in memory only."""
    name = f"fvcollapse-memory-{next(MEMORY_FILES)}"  # HDF5 tells open files apart by name
    return h5py.File(name, "w", driver="core", backing_store=False, libver=libver)


def build_image(fill, libver=LIBVER):
    """Bytes of the HDF5 file that `fill(file)` writes."""
    with memory_file(libver) as file:
        fill(file)
        file.flush()
        return file.id.get_file_image()


def write_dataset(group, name, values, units, description):
    """Store an array, compressed if it has more than one value, with its units and meaning."""
    values = np.asarray(values)
    options = (
        {"compression": "gzip", "compression_opts": 4, "shuffle": True} if values.size > 1 else {}
    )
    dataset = group.create_dataset(name, data=values, **options)
    dataset.attrs["units"] = units
    dataset.attrs["description"] = description


@contextmanager
def reading(source, kind):
    """Open an HDF5 `source` (path or bytes) of format `kind`; any defect is one InputError."""
    name = source if isinstance(source, str | Path) else kind
    allowed = f"a complete {kind} file written by fvcollapse"
    try:
        refuse_special(source)
        with open(source, "rb"):
            pass
    except TypeError:
        pass  # an image in memory
    except (OSError, ValueError) as error:
        problem = (getattr(error, "strerror", None) or str(error)).lower()
        refusal = UnreadableError if isinstance(error, PermissionError) else InputError
        raise refusal(name, "file", problem, allowed) from None
    try:
        with h5py.File(source, "r") as file:
            if file.attrs["format"] != kind:
                raise InputError(name, "format", repr(file.attrs["format"]), repr(kind))
            yield file
    except BlockingIOError:
        held = "a file that another program holds open and has locked"
        free = "a file that is free; or set HDF5_USE_FILE_LOCKING=FALSE to read it all the same"
        raise UnreadableError(name, "file", held, free) from None
    except BROKEN:
        raise InputError(name, "file", "a broken or truncated file", allowed) from None


def text_attribute(file, name):
    """A root attribute that must be text."""
    value = file.attrs[name]
    if not isinstance(value, str):
        raise TypeError(f"{name} is no text")
    return value
