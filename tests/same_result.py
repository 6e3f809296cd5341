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
    if name not in a or name not in b or not same_attributes(a[name], b[name]):
        return False
    if isinstance(a[name], h5py.Group):
        return True
    x, y = a[name][()], b[name][()]
    return x.dtype == y.dtype and x.shape == y.shape and x.tobytes() == y.tobytes()


def same_attributes(a, b):
    """Whether two objects have the same attributes."""
    return dict(a.attrs).keys() == dict(b.attrs).keys() and all(
        np.array_equal(a.attrs[key], b.attrs[key]) for key in a.attrs
    )
