"""Closed boxes and channels full of fluid, set up on the `Simulation` that runs a collapse.

The solver has walls at x = 0 and at the bed; a collapse never reaches the other two sides. Here
they are walls too: beyond them stand two layers of cells that are no unknowns and mirror the flow,
as the halo of a periodic stretch repeats it.
"""

import math

import numpy as np

from fvcollapse.case.case import Case
from fvcollapse.simulation import Simulation
from fvcollapse.step.extrapolation import TRUSTED_U
from fvcollapse.step.geometry import number_unknowns
from fvcollapse.step.initial import HALO
from fvcollapse.step.state import State
from fvcollapse.verification.flows import TIGHT

GHOSTS = 2  # layers beyond a wall: the reach of the stencil of the momentum advection


def box_case(cells, side=1.0, **changes):
    """Case of a full box of `side` (m) with `cells` per side; free slip and level, unless changed.

    Keys are those of the case file with a double underscore for the dot.
    """
    keys = {
        "grid.cell_size": side / cells,
        "geometry.height_0": side,
        "geometry.length_0": side,
        "geometry.slope_angle_deg": 0.0,
        "geometry.channel_width": math.inf,
        "boundary.mu_bed": 0.0,
        "boundary.mu_back_wall": 0.0,
        "gate.speed": math.inf,
        "rheology.law": "newtonian",
        "rheology.density_bulk": 1000.0,
        "numerics.unilateral": False,
        **TIGHT,
    }
    keys.update({name.replace("__", "."): value for name, value in changes.items()})
    return Case().replace(**keys)


def channel_case(cells, depth=1.0, **changes):
    """Case of a full channel of `depth` (m) below a lid: one column of a periodic stretch."""
    column = {"geometry__length_0": depth / cells, "boundary__ends": "periodic"}
    return box_case(cells, depth, **{**column, **changes})


class Box(Simulation):
    """A closed box, or a periodic channel below a lid, full of fluid.

    Parameters
    ----------
    case : Case
        As from `box_case` or `channel_case`.
    dt : float
        Time step, s.
    velocity : callable
        (x, z) -> (u, w) at the start, m/s.
    pressure : callable
        (x, z) -> p at the start, Pa. Its mean stays, since the box is closed.
    force : callable, optional
        (x, z, time) -> (f_x, f_z), acceleration beside gravity at the end of a step, m/s2.
    no_slip : bool
        Right wall and lid hold the fluid; else it slips. Bed and back wall follow the case.
    bed_speed : float
        The bed moves along itself; with boundary.mu_bed = inf it carries the fluid with it, m/s.
    surface : callable, optional
        Level set (x, z) -> m of a free surface inside the box, which is held fixed; else it is full.
    """

    def __init__(
        self, case, dt, velocity, pressure, force=None, no_slip=False, bed_speed=0.0, surface=None
    ):
        self.chosen_dt, self.no_slip, self.bed_speed = dt, no_slip, bed_speed
        h, geometry = case.grid.cell_size, case.geometry
        self.cells_z, columns = round(geometry.height_0 / h), round(geometry.length_0 / h)
        periodic = case.boundary.ends == "periodic"
        nx, nz = columns + (2 * HALO if periodic else GHOSTS), self.cells_z + GHOSTS
        self.right = nx if periodic else columns  # end of the fluid; a periodic one has none
        self.x_u, self.z_u = points(h, nx + 1, nz, 0.0, 0.5)
        self.x_w, self.z_w = points(h, nx, nz + 1, 0.5, 0.0)
        self.x_p, self.z_p = points(h, nx, nz, 0.5, 0.5)
        self.force = force
        self.surface = surface
        state = State(
            self._level_set(h, nx, nz),
            velocity(self.x_u, self.z_u)[0] + 0.0 * self.x_u,
            velocity(self.x_w, self.z_w)[1] + 0.0 * self.x_w,
            pressure(self.x_p, self.z_p) + 0.0 * self.x_p,
            np.zeros(nx + 1),
        )
        state.volume_0, state.dt = nx * nz * h * h, dt
        super().__init__(case, state)
        self._continue_velocity()

    def _level_set(self, h, nx, nz):
        if self.surface is None:
            return np.full((nx + 1, nz + 1), -20.0 * max(nx, nz) * h)
        return self.surface(*points(h, nx + 1, nz + 1, 0.0, 0.0))

    def _time_step(self, time_limit):
        return self.chosen_dt

    def _make_room(self):
        """Walls all around: the grid stays."""

    def _move_surface(self, dt):
        return super()._move_surface(dt) if self.surface is None else 0.0

    def _place(self, time, closed=False):
        super()._place(time, closed)
        geometry, right, top = self.geometry, self.right, self.cells_z
        geometry.index_u[:] = -1
        geometry.index_w[:] = -1
        geometry.interior[:] = False
        inside = geometry._replace(
            index_u=geometry.index_u[: right + 1, :top],
            index_w=geometry.index_w[:right, : top + 1],
            interior=geometry.interior[: right + 1, : top + 1],
            filled=geometry.filled[:right, :top],
            aperture=geometry.aperture[: right + 1, :top],
            reach=np.minimum(geometry.reach[: right + 1], top),
            last=geometry.last if self.halo else right,
        )
        self.ends = number_unknowns(inside, open_end=False)

    def _solve(self, u_star, w_star, impulse, balance):
        if self.force is not None:
            end = self.state.time + balance.dt
            u_star += balance.dt * self.force(self.x_u, self.z_u, end)[0]
            w_star += balance.dt * self.force(self.x_w, self.z_w, end)[1]
        self._add_walls(u_star, w_star, balance.dt)
        return super()._solve(u_star, w_star, impulse, balance)

    def _add_walls(self, u_star, w_star, dt):
        """Friction of the walls that the solver does not know; dt < h^2/(2 nu) keeps it stable.

        The bed's own friction is implicit, but as if the bed stood still.
        """
        law = self.case.rheology
        rate = 2.0 * law.viscosity / law.density_bulk * dt / self.spacing[1] ** 2
        if math.isinf(self.case.boundary.mu_bed):
            u_star[:, 0] += rate * self.bed_speed
        if self.no_slip:
            u_star[:, self.cells_z - 1] -= rate * self.state.u[:, self.cells_z - 1]
            if not self.halo:
                w_star[self.right - 1] -= rate * self.state.w[self.right - 1]

    def _continue_velocity(self):
        if self.surface is not None:
            super()._continue_velocity()
        state, right, top = self.state, self.right, self.cells_z
        tangential = -1.0 if self.no_slip else 1.0
        mirror(state.w.T, top, -1.0, on_face=True)
        mirror(state.u.T, top, tangential, on_face=False)
        mirror(state.pressure_filled.T, top, 1.0, on_face=False)
        if self.halo:
            self._repeat(state.u, state.w)
        else:
            mirror(state.u, right, -1.0, on_face=True)
            mirror(state.w, right, tangential, on_face=False)
            mirror(state.pressure_filled, right, 1.0, on_face=False)
        if self.bed_speed:
            state.bed_slip[:] = self.bed_speed

    def inside(self):
        """Where u, w and pressure are those of the fluid: masks without walls and mirrors.

        Without the all but empty faces beside a free surface, whose velocity the solver itself does
        not trust, and without the cells that are not full.
        """
        geometry = self.geometry
        of_u = (geometry.index_u >= 0) & (geometry.mass_x >= TRUSTED_U)
        of_w = (geometry.index_w >= 0) & (geometry.mass_z >= TRUSTED_U)
        of_p = geometry.filled >= 1.0
        of_p[self.right :], of_p[:, self.cells_z :] = False, False
        for mask in (of_u, of_w, of_p) if self.halo else ():
            mask[:HALO], mask[HALO + 1 :] = False, False
        return of_u, of_w, of_p


def points(h, nx, nz, offset_x, offset_z):
    """Abscissae and heights of nx by nz points, h apart, the first `offset` cells from the corner, m."""
    x, z = h * (np.arange(nx) + offset_x), h * (np.arange(nz) + offset_z)
    return np.meshgrid(x, z, indexing="ij")


def mirror(field, wall, sign, on_face):
    """Fill the layers beyond `wall` with what stands before it, times `sign`, in place."""
    if on_face:
        field[wall] = 0.0
        field[wall + 1 : wall + 1 + GHOSTS] = sign * field[wall - GHOSTS : wall][::-1]
    else:
        field[wall : wall + GHOSTS] = sign * field[wall - GHOSTS : wall][::-1]
