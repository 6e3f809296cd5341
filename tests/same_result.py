"""Comparison of two result files to the last bit, wall-clock times excepted."""

import h5py
import numpy as np


def differences(first, second, ignore=("steps/wall_time",)):
    """Names of everything in which two HDF5 files differ."""
    with h5py.File(first) as a, h5py.File(second) as b:
        names = set()
        for file in (a, b):
            file.visit(names.add)
        return sorted(n for n in names if n not in ignore and not same(a, b, n)) + (
            [] if same_attributes(a, b) else ["root attributes"]
        )


def same(a, b, name):
    """Whether one group or dataset is the same in both files."""
    if name not in a or name not in b:
        return False
    first, second = a[name], b[name]
    if type(first) is not type(second) or not same_attributes(first, second):
        return False
    if isinstance(first, h5py.Group):
        return True
    x, y = first[()], second[()]
    return x.dtype == y.dtype and x.shape == y.shape and x.tobytes() == y.tobytes()


def same_attributes(a, b):
    """Whether two objects have the same attributes."""
    names = set(a.attrs)
    return names == set(b.attrs) and all(
        np.array_equal(a.attrs[name], b.attrs[name]) for name in names
    )
