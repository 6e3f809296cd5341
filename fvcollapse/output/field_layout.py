"""The form of the fields in a file: one group per stored time, all data sets of the shapes of one grid."""

from typing import Any

import numpy as np

from fvcollapse.output.stored_names import FIELDS
from fvcollapse.output.stored_numbers import (
    ANY,
    POSITIVE,
    group_of,
    is_readable,
    number_of,
    numbers_of,
    refuse,
)
from fvcollapse.step.state import EFFECT_FIELDS, location_shape

SAME = 1.0e-6  # relative round-off
LONGEST = 1.0e6  # m and s; ten times the longest domain that a case can ask for
# location of the fields that are in every result; others are at the centres of the cells
LOCATIONS = {"level_set": "node", "u": "xface", "w": "zface"}
LOCATIONS |= dict.fromkeys(("pressure", "shear_rate", "viscosity", "inertial_number"), "centre")
LOCATIONS |= {name: about[1] for name, about in EFFECT_FIELDS.items()}
RANGES = dict.fromkeys(("shear_rate", "viscosity", "inertial_number"), POSITIVE)
CELL_ATTRIBUTES = ("time", "dx", "dz")


def check_field_forms(file: Any, end: float) -> None:
    """Check the groups of /fields: numbered from 0, times in order, data sets of the shapes of one grid."""
    before = -np.inf
    for index in range(len(file["fields"])):
        path = f"fields/{index}"
        group_of(file, path)
        time, _, _ = cell_attributes(file, path)
        if not before < time <= end * (1.0 + SAME):
            refuse(file, f"{path}.time", f"{time:g}", f"times in order, up to {end:g}")
        before = time
        field_forms(file, path)


def cell_attributes(file: Any, path: str) -> tuple[float, float, float]:
    """(time [s], dx [m], dz [m]) of a field."""
    time, dx, dz = (float(number_of(file, path, name, (0.0, LONGEST))) for name in CELL_ATTRIBUTES)
    if min(dx, dz) == 0.0:
        refuse(file, f"{path}.dx", "cells without size", "numbers > 0")
    return time, dx, dz


def field_forms(file: Any, path: str) -> dict[str, tuple[int, ...]]:
    """{name: shape} of the data sets of one field; InputError if they are not those of one grid."""
    for name in FIELDS:
        if name not in file[path]:
            refuse(file, f"{path}/{name}", "no such data set", "an array")
    nodes = getattr(file[path]["level_set"], "shape", None)
    if nodes is None or len(nodes) != 2 or min(nodes) < 2:
        refuse(file, f"{path}/level_set", "no field", "(nx + 1) x (nz + 1) numbers")
    grid = nodes[0] - 1, nodes[1] - 1
    shapes = {name: location_shape(LOCATIONS.get(name, "centre"), *grid) for name in file[path]}
    for name, shape in shapes.items():
        dataset = file[path][name]
        dtype = getattr(dataset, "dtype", None)
        if dtype is None or dtype.kind != "f" or not is_readable(dtype) or dataset.shape != shape:
            found = (
                f"{getattr(dataset, 'dtype', 'a group')} of shape {getattr(dataset, 'shape', '')}"
            )
            refuse(file, f"{path}/{name}", found, f"{shape[0]} x {shape[-1]} finite numbers")
    return shapes


def read_field(file: Any, index: int) -> dict[str, Any]:
    """Arrays of one field, and its time, dx and dz.

    Raises
    ------
    InputError
    """
    path = f"fields/{index}"
    group_of(file, path)
    values = dict(zip(CELL_ATTRIBUTES, cell_attributes(file, path), strict=True))
    arrays = {
        name: numbers_of(file, f"{path}/{name}", shape, RANGES.get(name, ANY))
        for name, shape in field_forms(file, path).items()
    }
    return arrays | values


def check_paraview(file: Any, index: int) -> None:
    """Check what ParaView needs beside a field."""
    nx, nz = (size - 1 for size in file[f"fields/{index}/level_set"].shape)
    group_of(file, f"paraview/{index}")
    numbers_of(file, f"paraview/{index}/coordinates", (nx + 1, nz + 1, 3), kinds="f")
    numbers_of(file, f"paraview/{index}/velocity", (nx, nz, 3), kinds="f")
