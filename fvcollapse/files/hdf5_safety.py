"""What an HDF5 file may be made of: hard links and data of its own, no larger than the file can hold.

HDF5 follows links into other files, and reads raw bytes of any file as external storage. A file from
elsewhere could so show what its reader may read. Nothing that fvcollapse writes has any of this.
"""

import h5py

DEFLATE_MOST = 1100  # bytes that one byte of compressed data can stand for, at most 1032
FREE = 65536  # bytes that a data set without data may claim: values that were never written


def unsafe_items(file, part="/"):
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
    group, names = file["/"], [name for name in part.split("/") if name]
    for depth, name in enumerate(names, start=1):
        if not is_inside(group, name):
            yield "/".join(names[:depth]), "a link", "data in the file itself"
            return
        group = group[name]
    visited, todo = {address(group)}, [group]
    while todo:
        group = todo.pop()
        for name in group:
            path = f"{group.name}/{name}".strip("/")
            if not is_inside(group, name):
                yield path, "a link", "data in the file itself"
                return
            item = group[name]
            place = address(item)
            if place in visited:
                yield path, "a second link to the same object", "each object once"
                return
            visited.add(place)
            if isinstance(item, h5py.Group):
                todo.append(item)
            elif isinstance(item, h5py.Dataset):
                yield from unsafe_storage(path, item)


def is_inside(group, name):
    """Whether an item is stored there, not linked to from there."""
    return isinstance(group.get(name, getlink=True), h5py.HardLink)


def address(item):
    """Where an object is in its file."""
    return h5py.h5o.get_info(item.id).addr


def unsafe_storage(path, dataset):
    """The same for one data set."""
    properties = dataset.id.get_create_plist()
    if properties.get_external_count() > 0:
        yield path, "values in another file (external storage)", "values in the file itself"
    elif properties.get_layout() == h5py.h5d.VIRTUAL:
        yield path, "values of other data sets (virtual)", "values in the file itself"
    elif dataset.size and dataset.nbytes > DEFLATE_MOST * dataset.id.get_storage_size() + FREE:
        yield path, f"{dataset.nbytes:.3g} bytes, more than are stored", "all values in the file"
