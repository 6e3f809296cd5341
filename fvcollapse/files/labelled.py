"""Arrays with names, units and coordinates for xarray, which is an extra."""

from collections.abc import Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    import xarray

EXTRA = "xarray is not installed: pip install 'fvcollapse[notebook]'"


class Labelled(NamedTuple):
    """An array with the names of its dimensions, its unit and its meaning; coordinates are named as a dimension."""

    dimensions: tuple[str, ...]
    values: Any
    units: str
    description: str


def xarray_module() -> Any:
    """The module xarray.

    Raises
    ------
    ImportError
        It is not installed; the message says what installs it.
    """
    try:
        return import_module("xarray")
    except ImportError:
        raise ImportError(EXTRA) from None


def tree(
    groups: Mapping[str, Mapping[str, Labelled]], attributes: Mapping[str, Any]
) -> "xarray.DataTree":
    """Groups of arrays as a tree of datasets.

    Parameters
    ----------
    groups : mapping
        Group -> name -> `Labelled`. A name that is one of the dimensions is a coordinate.
    attributes : mapping
        Of the tree as a whole: texts and numbers.

    Raises
    ------
    ImportError
        xarray is not installed.
    """
    xarray = xarray_module()
    datasets = {name: dataset(arrays) for name, arrays in groups.items()}
    made = xarray.DataTree.from_dict(datasets)
    made.attrs.update(attributes)
    return made


def dataset(arrays: Mapping[str, Labelled]) -> "xarray.Dataset":
    """Arrays as a dataset; see `tree`."""
    xarray = xarray_module()
    dimensions = {name for array in arrays.values() for name in array.dimensions}
    variables = {
        name: (
            array.dimensions,
            np.asarray(array.values),
            {"units": array.units, "long_name": array.description},
        )
        for name, array in arrays.items()
    }
    data = {name: of for name, of in variables.items() if name not in dimensions}
    return xarray.Dataset(data, {name: variables[name] for name in dimensions & set(variables)})
