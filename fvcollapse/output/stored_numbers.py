"""Numbers in an HDF5 file that is not trusted: of the right type and shape, finite, in range.

Every defect is one `InputError` that names file and data set. Nothing that is read here is judged: that is
the matter of `record_layout` and `field_layout`, which know what the numbers mean.
"""

from typing import Any, NoReturn

import numpy as np

from fvcollapse.errors import InputError
from fvcollapse.files.hdf5 import name_of

LARGEST = 1e30  # an extract stores single precision, which ends at 3e38; no quantity in SI units comes near
ANY = (-LARGEST, LARGEST)
POSITIVE = (0.0, LARGEST)
SIZES = (4, 8)  # bytes of a floating-point number that kernels can read
NUMBERS = "fiu"  # kinds of numpy types


def refuse(file: Any, key: str, found: str, allowed: str) -> NoReturn:
    """Raise the InputError of something in an open file."""
    raise InputError(name_of(file), key, found, allowed)


def group_of(file: Any, path: str) -> Any:
    """A group; InputError if there is none."""
    if path not in file or not hasattr(file[path], "keys"):
        refuse(file, path, "no such group", "a group of data sets")
    return file[path]


def numbers_of(
    file: Any,
    path: str,
    shape: tuple[int | None, ...],
    limits: tuple[float, float] = ANY,
    kinds: str = NUMBERS,
) -> np.ndarray:
    """The numbers in a data set of this shape, where None stands for any length.

    Raises
    ------
    InputError
        It is missing or unreadable, of another type or shape, or has values that are not finite or out
        of range.
    """
    wanted = " x ".join("n" if size is None else str(size) for size in shape) or "1"
    allowed = f"{wanted} finite numbers"
    dataset = file.get(path)
    if dataset is None:
        refuse(file, path, "no such data set", allowed)
    if not hasattr(dataset, "dtype") or dataset.shape is None:
        refuse(file, path, "no array of values", allowed)
    if dataset.dtype.kind not in kinds or not is_readable(dataset.dtype):
        refuse(file, path, f"values of the type {dataset.dtype}", allowed)
    found = dataset.shape
    if len(found) != len(shape) or any(
        want not in (None, size) for want, size in zip(shape, found, strict=True)
    ):
        refuse(file, path, f"an array of the shape {found}", allowed)
    try:
        values = dataset[()]
    except (OSError, RuntimeError, ValueError, TypeError):  # compressed data that were changed
        refuse(file, path, "damaged data", "data as they were written")
    return check_values(file, path, values, limits)


def is_readable(dtype: np.dtype) -> bool:
    """Whether kernels read numbers of this type; half and extended precision they do not."""
    return dtype.kind != "f" or dtype.itemsize in SIZES


def check_values(
    file: Any, path: str, values: np.ndarray, limits: tuple[float, float] = ANY
) -> np.ndarray:
    """The values if all are finite and within the limits; else InputError."""
    low, high = limits
    if not np.isfinite(values).all():
        refuse(file, path, "a value that is not finite", "finite numbers")
    least, most = (float(values.min()), float(values.max())) if values.size else (low, high)
    if least < low or most > high:
        worst = least if least < low else most
        refuse(file, path, f"the value {worst:g}", f"numbers from {low:g} to {high:g}")
    return values


def refuse_fall(file: Any, path: str, values: np.ndarray, strictly: bool = False) -> None:
    """InputError if values fall (or, strictly, do not rise)."""
    steps = np.diff(values)
    if (steps <= 0.0).any() if strictly else (steps < 0.0).any():
        row = int(np.argmin(steps))
        found = f"{values[row + 1]:g} after {values[row]:g}"
        allowed = "increasing values" if strictly else "values that never fall"
        refuse(file, path, found, allowed)


def number_of(
    file: Any, group: str, name: str, limits: tuple[float, float] = ANY, kinds: str = NUMBERS
) -> Any:
    """The number in an attribute of a group, of Python's types.

    Raises
    ------
    InputError
    """
    path = f"{group}.{name}"
    value = np.asarray(file[group].attrs[name]) if name in file[group].attrs else np.empty(0, "S1")
    if value.shape != () or value.dtype.kind not in kinds:
        refuse(file, path, "no such number", "a whole number" if kinds == "iu" else "a number")
    return check_values(file, path, value, limits).item()
