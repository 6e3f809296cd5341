"""Closed boxes and channels full of fluid, set up on the `Simulation` that runs a collapse.

The solver has walls at x = 0 and at the bed; a collapse never reaches the other two sides. Here
they are walls too: beyond them stand two layers of cells that are no unknowns and mirror the flow,
as the halo of a periodic stretch repeats it.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from fvcollapse.case.case import Case
from fvcollapse.simulation import Simulation
from fvcollapse.step.advance import STAGES
from fvcollapse.step.domain import NO_CHANGE
from fvcollapse.step.extrapolation import TRUSTED_U
from fvcollapse.step.flow import TIME
from fvcollapse.step.geometry import repeat_columns
from fvcollapse.step.initial import HALO
from fvcollapse.step.state import State
from fvcollapse.step.surface import Moved
from fvcollapse.step.unknowns import number_unknowns
from fvcollapse.verification.flows import TIGHT, with_step

GHOSTS = 2  # layers beyond a wall: the reach of the stencil of the momentum advection


def box_case(cells: int, side: float = 1.0, **changes: Any) -> Case:
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


def channel_case(cells: int, depth: float = 1.0, **changes: Any) -> Case:
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
        self.no_slip, self.bed_speed = no_slip, bed_speed
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
            level_set_of(surface, h, nx, nz),
            velocity(self.x_u, self.z_u)[0] + 0.0 * self.x_u,
            velocity(self.x_w, self.z_w)[1] + 0.0 * self.x_w,
            pressure(self.x_p, self.z_p) + 0.0 * self.x_p,
            np.zeros(nx + 1),
        )
        state.volume_0, state.dt = nx * nz * h * h, dt
        super().__init__(case, state, with_step(stages_of(self), dt))
        continue_in_box(self, self.flow())

    def inside(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
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


# -- the stages of a step that differ from those of a collapse ------------------------------------


def stages_of(box: Any) -> Any:
    """The stages of a step in this box."""
    names = ("move_surface", "place", "carry_momentum", "continue_velocity")
    stages: tuple[Any, ...] = (hold_surface, place_in_box, carry_and_push, continue_in_box)
    bound = {name: partial(stage, box) for name, stage in zip(names, stages, strict=True)}
    return STAGES._replace(room_needed=stay, **bound)


def stay(flow: Any) -> Any:
    """Walls all around: the grid stays."""
    return NO_CHANGE


def hold_surface(box: Any, flow: Any, dt: float) -> Any:
    """A surface inside the box is where it was; return `Moved`."""
    return STAGES.move_surface(flow, dt) if box.surface is None else Moved(0.0, 0.0, 0.0)


def place_in_box(box: Any, flow: Any, time: float, closed: Any = False) -> Any:
    """The geometry is that of the fluid inside the walls, and the cells beyond are no unknowns; return its envelope."""
    STAGES.place(flow, time, closed)
    geometry, right, top = flow.geometry, box.right, box.cells_z
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
        last=geometry.last if box.halo else right,
    )
    return number_unknowns(inside, open_end=False)


def carry_and_push(box: Any, flow: Any, packing: np.ndarray, dt: float) -> Any:
    """Return the velocity after advection, the force on the fluid and the friction of the further walls, m/s."""
    u_star, w_star = STAGES.carry_momentum(flow, packing, dt)
    if box.force is not None:
        end = flow.fields.numbers[TIME] + dt
        u_star += dt * box.force(box.x_u, box.z_u, end)[0]
        w_star += dt * box.force(box.x_w, box.z_w, end)[1]
    add_walls(box, flow.fields, u_star, w_star, dt)
    return u_star, w_star


def add_walls(box: Any, fields: Any, u_star: np.ndarray, w_star: np.ndarray, dt: float) -> Any:
    """Friction of the walls that the solver does not know; dt < h^2/(2 nu) keeps it stable.

    The bed's own friction is implicit, but as if the bed stood still.
    """
    law = box.case.rheology
    rate = 2.0 * law.viscosity / law.density_bulk * dt / box.spacing[1] ** 2
    if math.isinf(box.case.boundary.mu_bed):
        u_star[:, 0] += rate * box.bed_speed
    if box.no_slip:
        u_star[:, box.cells_z - 1] -= rate * fields.u[:, box.cells_z - 1]
        if not box.halo:
            w_star[box.right - 1] -= rate * fields.w[box.right - 1]


def continue_in_box(box: Any, flow: Any) -> Any:
    """The layers beyond the walls mirror the flow."""
    if box.surface is not None:
        STAGES.continue_velocity(flow)
    state, right, top = flow.fields, box.right, box.cells_z
    tangential = -1.0 if box.no_slip else 1.0
    mirror(state.w.T, top, -1.0, on_face=True)
    mirror(state.u.T, top, tangential, on_face=False)
    mirror(state.pressure_filled.T, top, 1.0, on_face=False)
    if box.halo:
        for field in (state.u, state.w):
            repeat_columns(field, flow.geometry.first, flow.geometry.last)
    else:
        mirror(state.u, right, -1.0, on_face=True)
        mirror(state.w, right, tangential, on_face=False)
        mirror(state.pressure_filled, right, 1.0, on_face=False)
    if box.bed_speed:
        state.bed_slip[:] = box.bed_speed


def level_set_of(surface: Callable | None, h: float, nx: int, nz: int) -> np.ndarray:
    """Level set (nx + 1, nz + 1) of a surface (x, z) -> m, or of a full box, m."""
    if surface is None:
        return np.full((nx + 1, nz + 1), -20.0 * max(nx, nz) * h)
    return surface(*points(h, nx + 1, nz + 1, 0.0, 0.0))


def points(h: float, nx: int, nz: int, offset_x: float, offset_z: float) -> Any:
    """Abscissae and heights of nx by nz points, h apart, the first `offset` cells from the corner, m."""
    x, z = h * (np.arange(nx) + offset_x), h * (np.arange(nz) + offset_z)
    return np.meshgrid(x, z, indexing="ij")


def mirror(field: np.ndarray, wall: Any, sign: float, on_face: bool) -> Any:
    """Fill the layers beyond `wall` with what stands before it, times `sign`, in place."""
    if on_face:
        field[wall] = 0.0
        field[wall + 1 : wall + 1 + GHOSTS] = sign * field[wall - GHOSTS : wall][::-1]
    else:
        field[wall : wall + GHOSTS] = sign * field[wall - GHOSTS : wall][::-1]
