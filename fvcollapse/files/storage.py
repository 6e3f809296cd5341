"""Atomic writing and checked reading of files.

A file is built in memory, written beside its destination, forced to the disk and moved into place
atomically. After a kill, a crash or a full disk the destination is the last complete version.
Nothing is ever unpickled.
"""

import os
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path

import h5py
import numpy as np

try:
    import fcntl
except ImportError:  # not on Windows, where nothing is locked
    fcntl = None

from fvcollapse.errors import InputError, OutputError
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


def write_atomic(path, data, running=True):
    """Put `data` (bytes) at `path`: on the disk on return, previous file untouched on failure.

    Raises
    ------
    OutputError
        Folder not writable, disk full; `running` says whether a computation is lost by it.
    """
    path = Path(path)
    temporary = path.with_name(f".{path.name}.tmp")
    try:
        with open(temporary, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
        sync_folder(path.parent)
    except OSError as error:
        raise OutputError(path, error, running) from None
    finally:  # gone already, unless something stopped us
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def sync_folder(folder):
    """Force the names in a folder to the disk, if the system supports it."""
    if os.name == "posix":
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


@contextmanager
def exclusive(path):
    """Hold the lock file at `path`, and wait while another process holds it; make it if it is missing.

    The system releases the lock when the process dies.

    Raises
    ------
    OutputError
        The folder cannot be written.
    """
    path = Path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError as error:
        raise OutputError(path.parent, error, running=False) from None
    try:
        if fcntl is not None:
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


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
        raise InputError(name, "file", problem, allowed) from None
    try:
        with h5py.File(source, "r") as file:
            if file.attrs["format"] != kind:
                raise InputError(name, "format", repr(file.attrs["format"]), repr(kind))
            yield file
    except BROKEN:
        raise InputError(name, "file", "a broken or truncated file", allowed) from None


def text_attribute(file, name):
    """A root attribute that must be text."""
    value = file.attrs[name]
    if not isinstance(value, str):
        raise TypeError(f"{name} is no text")
    return value
