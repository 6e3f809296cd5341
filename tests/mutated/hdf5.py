"""Mutations of HDF5 files: bytes, and types, shapes, values, links and storage inside a valid file."""

import io
import os

import h5py
import numpy as np

from mutated.text import cut, flip, remove, repeat
from mutated.values import WORDS, pick


def datasets(file):
    """Paths of all data sets."""
    found = []
    file.visititems(lambda name, item: found.append(name) if hasattr(item, "shape") else None)
    return found


def groups(file):
    """Paths of all groups."""
    found = []
    file.visititems(lambda name, item: None if hasattr(item, "shape") else found.append(name))
    return found


def put(file, name, values, **options):
    """Another data set in the place of one; its attributes are kept."""
    kept = dict(file[name].attrs)
    del file[name]
    dataset = file.create_dataset(name, data=values, **options)
    dataset.attrs.update(kept)


# -- data sets -----------------------------------------------------------------------------------


def other_type(file, rng):
    """A data set of another type, of the same shape."""
    name = pick(rng, datasets(file))
    values = np.asarray(file[name][()])
    text = values.astype("S12")
    compound = np.zeros(values.shape, [("a", "f8"), ("b", "i4")])
    kinds = [
        lambda: put(file, name, text),
        lambda: put(file, name, text.astype(object), dtype=h5py.string_dtype()),
        lambda: put(file, name, values.astype(complex)),
        lambda: put(file, name, values.astype(bool)),
        lambda: put(file, name, np.nan_to_num(values).astype("u8")),
        lambda: put(file, name, values.astype("f2")),
        lambda: put(file, name, values.astype(">f8")),
        lambda: put(file, name, values.astype("f4")),
        lambda: put(file, name, compound),
        lambda: put(file, name, h5py.Empty("f8")),
        lambda: put(file, name, np.full(values.shape, file.ref, dtype=h5py.ref_dtype)),
        lambda: put(file, name, values.view("V8") if values.itemsize == 8 else text),
    ]
    pick(rng, kinds)()


def other_shape(file, rng):
    """A data set of another shape."""
    name = pick(rng, datasets(file))
    values = np.asarray(file[name][()])
    flat = values.ravel()
    shapes = [
        flat[:0],
        flat[:1],
        flat[: len(flat) // 2],
        np.concatenate([flat, flat]),
        values[None],
        values[..., None],
        values.T,
        np.float64(flat[0]) if flat.size else np.float64(0),
        np.zeros((3, 0)),
        values[:-1] if values.ndim else values,
    ]
    put(file, name, pick(rng, shapes))


def other_numbers(file, rng):
    """Values that are not finite, huge, of the other sign, or in another order."""
    name = pick(rng, datasets(file))
    values = np.array(file[name][()])
    if values.size and values.dtype.kind == "f":
        flat = values.reshape(-1)
        at = int(rng.integers(flat.size))
        changes = [np.nan, np.inf, -np.inf, 1e300, -1e300, -1.0, -0.3, 0.0, 1e12]
        choice = int(rng.integers(len(changes) + 4))
        if choice < len(changes):
            with np.errstate(over="ignore"):  # in single precision
                flat[at] = changes[choice]
        else:
            orders = [flat[::-1], rng.permutation(flat), -flat, np.full(flat.size, flat[at])]
            flat[:] = orders[choice - len(changes)]
    elif values.size:
        values.reshape(-1)[int(rng.integers(values.size))] = 1
        values = values - 5 if values.dtype.kind == "i" and rng.random() < 0.5 else values
    put(file, name, values)


def lost_item(file, rng):
    """A data set or a group is missing."""
    del file[pick(rng, [*datasets(file), *groups(file)])]


def renamed_item(file, rng):
    """A data set or a group has another name."""
    name = pick(rng, [*datasets(file), *groups(file)])
    words = [word for word in WORDS if word.strip("./\x00") and "\x00" not in word]
    words = [word for word in words if word.isprintable()] + ["01", "-1", "7"]
    file.move(name, f"{name.rpartition('/')[0]}/{pick(rng, words).replace('/', '_')}")


def group_for_dataset(file, rng):
    """A group where a data set should be, or the other way round."""
    name = pick(rng, [*datasets(file), *groups(file)])
    is_group = isinstance(file[name], h5py.Group)
    del file[name]
    if is_group:
        file[name] = 1.0
    else:
        file.create_group(name)


# -- attributes ----------------------------------------------------------------------------------


def other_attribute(file, rng):
    """An attribute of another type or value."""
    name = pick(rng, ["/", "/", *groups(file)])
    item = file[name]
    if not item.attrs:
        item = file
    key = pick(rng, sorted(item.attrs))
    values = [np.nan, np.inf, -1.0, 1e300, 0, "", "x", b"\xff\xfe", True, np.arange(3), np.zeros(0)]
    values += [h5py.Empty("f8"), np.array([["a", "b"]], "S1"), 2**62, -5, 0.5, 3j]
    choice = int(rng.integers(len(values) + 1))
    del item.attrs[key]
    if choice < len(values):
        item.attrs[key] = values[choice]


def flipped_text(file, rng):
    """Flipped bytes in the stored case, or in another text."""
    key = pick(rng, ["case", "case", "case", "code_version", "format"])
    data = flip(file.attrs[key].encode(), rng)
    del file.attrs[key]
    try:
        file.attrs.create(key, data, dtype=h5py.string_dtype("utf-8"))
    except ValueError:  # a zero byte, which this type cannot hold
        file.attrs[key] = np.bytes_(data)


# -- links and storage ---------------------------------------------------------------------------


def other_link(file, rng, outside):
    """A link into another file, to nowhere, or in a circle."""
    name = pick(rng, [*datasets(file), *groups(file)])
    parent = file[name].parent
    shape = getattr(file[name], "shape", None)
    del file[name]
    links = [
        lambda: file.__setitem__(name, h5py.ExternalLink(outside, "/secret")),
        lambda: file.__setitem__(name, h5py.ExternalLink("nowhere.h5", "/secret")),
        lambda: file.__setitem__(name, h5py.SoftLink("/profiles/x")),
        lambda: file.__setitem__(name, h5py.SoftLink("/nowhere")),
        lambda: file.__setitem__(name, parent),
        lambda: file.__setitem__(name, file["/"]),
    ]
    if shape is not None:
        links += [lambda: virtual(file, name, shape, outside)]
        links += [lambda: external(file, name, shape, outside)]
    pick(rng, links)()


def virtual(file, name, shape, outside):
    """A data set whose values are those of another file."""
    layout = h5py.VirtualLayout(shape=shape, dtype="f8")
    if 0 not in shape and shape:
        layout[...] = h5py.VirtualSource(outside, "secret", shape=shape)
    file.create_virtual_dataset(name, layout)


def external(file, name, shape, outside):
    """A data set whose bytes are those of another file."""
    file.create_dataset(name, shape=shape, dtype="f8", external=[(outside, 0, h5py.h5f.UNLIMITED)])


def huge(file, rng):
    """A data set that says to be larger than any memory."""
    name = pick(rng, datasets(file))
    rank = max(len(file[name].shape), 1)
    del file[name]
    shape = (10**7,) * min(rank, 2) + (3,) * (rank - 2) if rank > 1 else (10**12,)
    chunks = (100,) * min(rank, 2) + (3,) * (rank - 2)
    file.create_dataset(name, shape=shape, dtype="f8", chunks=chunks, compression="gzip")


INSIDE = (
    *(other_type, other_type, other_shape, other_shape, other_numbers, other_numbers),
    *(other_numbers, lost_item, renamed_item, group_for_dataset, other_attribute),
    *(other_attribute, flipped_text, flipped_text, other_link, other_link, huge),
)


def mutated(data, rng, outside):
    """Bytes of a mutated file; `outside` is a file that nothing in it may lead to."""
    if rng.random() < 0.3:
        return pick(rng, [flip, flip, flip, cut, remove, repeat])(data, rng)
    stream = io.BytesIO(data)
    with h5py.File(stream, "r+") as file:
        change = pick(rng, INSIDE)
        change(file, rng, os.fspath(outside)) if change is other_link else change(file, rng)
    return stream.getvalue()
