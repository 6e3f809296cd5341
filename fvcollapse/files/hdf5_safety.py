"""What an HDF5 file may be made of: hard links and data of its own, no larger than the file can hold.

HDF5 follows links into other files, and reads raw bytes of any file as external storage. A file from
elsewhere could so show what its reader may read. Nothing that fvcollapse writes has any of this.
"""

import math
from collections.abc import Iterator

import h5py
from h5py import h5d, h5g, h5l, h5o

DEFLATE_MOST = 1100  # bytes that one byte of compressed data can stand for, at most 1032
FREE = 65536  # bytes that a data set without data may claim: values that were never written


def unsafe_items(file: h5py.File, part: str = "/") -> Iterator[tuple[str, str, str]]:
    """(path, what was found, what is allowed) of everything that leads out of a file or cannot be in it.

    Parameters
    ----------
    file : h5py.File
        Open for reading.
    part : str
        Path of the group that will be read; default: all.

    Yields
    ------
    tuple of str
    """
    # of the low-level interface, which takes a fifth of the time
    group, names = file["/"].id, [name for name in part.encode().split(b"/") if name]
    for depth, name in enumerate(names, start=1):
        if not is_inside(group, name):
            yield text_of(b"/".join(names[:depth])), "a link", "data in the file itself"
            return
        group = h5o.open(group, name)
    visited, todo = {h5o.get_info(group).addr}, [(b"/".join(names), group)]
    while todo:
        start, group = todo.pop()
        for name in group:
            path = start + b"/" + name if start else name
            if not is_inside(group, name):
                yield text_of(path), "a link", "data in the file itself"
                return
            item = h5o.open(group, name)
            place = h5o.get_info(item).addr
            if place in visited:
                yield text_of(path), "a second link to the same object", "each object once"
                return
            visited.add(place)
            if isinstance(item, h5g.GroupID):
                todo.append((path, item))
            elif isinstance(item, h5d.DatasetID):
                yield from unsafe_storage(text_of(path), item)


def is_inside(group: h5g.GroupID, name: bytes) -> bool:
    """Whether an item is stored there, not linked to from there."""
    return group.links.exists(name) and group.links.get_info(name).type == h5l.TYPE_HARD


def text_of(path: bytes) -> str:
    """A path in a file as it is printed."""
    return path.decode("utf-8", "surrogateescape")


def unsafe_storage(path: str, dataset: h5d.DatasetID) -> Iterator[tuple[str, str, str]]:
    """The same for one data set (a `DatasetID`)."""
    properties = dataset.get_create_plist()
    size = math.prod(dataset.shape or ()) * dataset.dtype.itemsize
    if properties.get_external_count() > 0:
        yield path, "values in another file (external storage)", "values in the file itself"
    elif properties.get_layout() == h5d.VIRTUAL:
        yield path, "values of other data sets (virtual)", "values in the file itself"
    elif size > DEFLATE_MOST * dataset.get_storage_size() + FREE:
        yield path, f"{size:.3g} bytes, more than are stored", "all values in the file"
