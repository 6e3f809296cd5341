"""Where the unknowns live: a uniform Cartesian staggered (MAC) grid in the channel frame.

x runs along the bed (index i, downslope), z normal to it (index k). Pressure and solid quantities
sit at the cell centres [i, k], u on the x-faces, w on the z-faces, the level set on the nodes (cell
corners). x = 0 is the back wall and z = 0 the bed; both coincide with grid lines, and so does the
gate.
"""

from typing import NamedTuple

import numpy as np


class Grid(NamedTuple):
    """Shape and spacing of the grid; `dx` and `dz` in m."""

    nx: int
    nz: int
    dx: float
    dz: float

    @property
    def x_nodes(self):
        """Abscissae of the nodes and x-faces, (nx + 1,), m."""
        return self.dx * np.arange(self.nx + 1)

    @property
    def z_nodes(self):
        """Ordinates of the nodes and z-faces, (nz + 1,), m."""
        return self.dz * np.arange(self.nz + 1)

    @property
    def x_centres(self):
        """Abscissae of the cell centres, (nx,), m."""
        return self.dx * (np.arange(self.nx) + 0.5)

    @property
    def z_centres(self):
        """Ordinates of the cell centres, (nz,), m."""
        return self.dz * (np.arange(self.nz) + 0.5)


def spacing(case):
    """Cell sizes (dx, dz) in m: `cell_size` rounded so that the gate x = length_0 is a grid line."""
    cell_size_z = case.grid.cell_size_z or case.grid.cell_size
    columns = max(1, round(case.geometry.length_0 / case.grid.cell_size))
    return case.geometry.length_0 / columns, cell_size_z


def gate_column(case):
    """Index of the x-face that is the gate."""
    return max(1, round(case.geometry.length_0 / case.grid.cell_size))
