"""A result with names, units and coordinates, for xarray.

The file itself has no dimension scales: they are references, which differ between two files with the same
contents, and results of the same case are the same to the last bit.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.files.labelled import Labelled, tree
from fvcollapse.output.field_layout import LOCATIONS
from fvcollapse.output.stored_names import PROFILES, SERIES, STEPS, about_field

if TYPE_CHECKING:
    import xarray

TIME = ("s", "time since the gate starts to rise")
PLACES = {
    "x": ("m", "distance along the bed from the back wall, cell centres"),
    "z": ("m", "height above the bed, cell centres"),
    "x_node": ("m", "distance along the bed from the back wall, nodes"),
    "z_node": ("m", "height above the bed, nodes"),
}
AXES = {  # names of the dimensions of a field, by its location
    "node": ("x_node", "z_node"),
    "xface": ("x_node", "z"),
    "zface": ("x", "z_node"),
    "centre": ("x", "z"),
    "xnode": ("x_node",),
}


def axes_of(name: str) -> tuple[str, ...]:
    """Names of the dimensions of a field."""
    return AXES[LOCATIONS.get(name, "centre")]


def places(nodes: tuple[int, int], dx: float, dz: float) -> dict[str, np.ndarray]:
    """Coordinates [m] of the nodes and centres of a grid with so many nodes."""
    x, z = dx * np.arange(nodes[0]), dz * np.arange(nodes[1])
    return {"x": x[:-1] + 0.5 * dx, "z": z[:-1] + 0.5 * dz, "x_node": x, "z_node": z}


def tree_of(result: Any, fields: bool = True) -> "xarray.DataTree":
    """The tree of a result; see `Result.to_xarray`."""
    groups = {
        "series": columns(result.series, SERIES),
        "steps": columns(result.steps, STEPS),
        "profiles": profile_arrays(result.profiles),
    }
    if fields and len(result.field_times):
        groups["fields"] = field_arrays(result)
    about = {"status": result.status, "trust": result.trust.verdict, "case": result.case_text}
    return tree(groups, about | {"code_version": result.code_version})


def columns(arrays: Mapping[str, np.ndarray], about: Mapping) -> dict[str, Labelled]:
    """Arrays over time."""
    return {
        name: Labelled(("time",), values, *about.get(name, ("SI", name.replace("_", " "))))
        for name, values in arrays.items()
    }


def profile_arrays(profiles: Any) -> dict[str, Labelled]:
    """Profiles over time and x."""
    arrays = {
        "time": Labelled(("time",), profiles.time, "s", "times of the profiles"),
        "x": Labelled(("x",), profiles.x, *PLACES["x_node"]),
    }
    heights = {
        name: Labelled(("time", "x"), getattr(profiles, name), *about)
        for name, about in PROFILES.items()
    }
    return arrays | heights


def field_arrays(result: Any) -> dict[str, Labelled]:
    """All fields over time, on the largest of their grids; NaN beyond the grid of an earlier time."""
    fields = [result.field(index) for index in range(len(result.field_times))]
    nodes = [field["level_set"].shape for field in fields]
    largest = max(size[0] for size in nodes), max(size[1] for size in nodes)
    places_of = places(largest, fields[0]["dx"], fields[0]["dz"])
    arrays = {"time": Labelled(("time",), result.field_times, *TIME)}
    arrays |= {name: Labelled((name,), values, *PLACES[name]) for name, values in places_of.items()}
    for name in fields[0]:
        if name in ("time", "dx", "dz"):
            continue
        axes = axes_of(name)
        values = np.full([len(fields), *(len(places_of[axis]) for axis in axes)], np.nan)
        for row, field in zip(values, fields, strict=True):
            row[tuple(slice(size) for size in field[name].shape)] = field[name]
        arrays[name] = Labelled(("time", *axes), values, *about_field(name))
    return arrays
