"""The grains of each stored time as a mesh of quadrilaterals, which XDMF 3 can describe.

A program that reads meshes (ParaView, meshio) so gets the grains only: no values of the air, where the
stored velocity is a continuation that the scheme needs. ParaView's y is z here (normal to the bed), so that its
first view shows the pile upright.
"""

import h5py
import numpy as np

from fvcollapse.files.hdf5 import write_dataset
from fvcollapse.output.stored_names import about_field
from fvcollapse.step.geometry import cell_fractions

GROUP = "paraview"
POINTS, CELLS, VELOCITY, SURFACE = "points", "cells", "velocity", "level_set"
CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))  # of a cell, counted round it


def write_meshes(file: h5py.File) -> None:
    """Replace the arrays that the record keeps for viewers by a mesh for each time, `/paraview/<index>`.

    Parameters
    ----------
    file : h5py.File
        An open result.
    """
    recorded = {index: group[VELOCITY][:] for index, group in file[GROUP].items()}
    del file[GROUP]
    meshes = file.create_group(GROUP)
    for index, velocity in recorded.items():
        write_mesh(meshes.create_group(index), file[f"fields/{index}"], velocity)


def write_mesh(group: h5py.Group, fields: h5py.Group, velocity: np.ndarray) -> None:
    """Write the cells that hold grains, and what is stored of them.

    Parameters
    ----------
    group : h5py.Group
        Gets `points` (n, 3) [m], `cells` (m, 4), the level set of the points, and of the cells the velocity (m, 3)
        and every field at the cell centres (m,); single precision.
    fields : h5py.Group
        `/fields/<index>`.
    velocity : (nx, nz, 3) array
        At the cell centres, m/s.
    """
    level_set = fields[SURFACE][:]
    grains = cell_fractions(level_set) > 0.0
    i, k = np.nonzero(grains)
    corners = np.stack([(i + a) * level_set.shape[1] + k + b for a, b in CORNERS], axis=1)
    used, cells = np.unique(corners, return_inverse=True)
    column, row = np.divmod(used, level_set.shape[1])
    points = np.zeros((len(used), 3))
    points[:, 0], points[:, 1] = column * fields.attrs["dx"], row * fields.attrs["dz"]
    write(group, POINTS, points, "m", "x, z and 0 of the corners of the cells that hold grains")
    numbers = cells.reshape(corners.shape).astype(np.int32)
    write_dataset(group, CELLS, numbers, "1", "the four corners of each cell, as rows of points")
    write(group, SURFACE, level_set.ravel()[used], *about_field(SURFACE))
    write(group, VELOCITY, velocity[grains], "m/s", "u, w and 0 at the cell centres")
    for name, values in fields.items():
        if values.shape == grains.shape:
            write(group, name, values[:][grains], *about_field(name))


def write(group: h5py.Group, name: str, values: np.ndarray, units: str, description: str) -> None:
    """Write numbers in single precision."""
    write_dataset(group, name, values.astype(np.float32), units, description)
