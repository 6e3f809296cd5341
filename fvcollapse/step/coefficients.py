"""Coefficients of a nonlinear sweep: viscosity and every friction of the present velocity and pressure."""

from typing import NamedTuple

import numpy as np

from .adhesion import adhesion_of
from .compiled import inner_jit, kernel_jit
from .coulomb_walls import back_wall_friction, bed_friction
from .gate import gate_friction
from .grain_response import (
    ResponseWork,
    add_dilating_friction,
    allocate_response,
    relax_late,
    respond,
)
from .lateral_friction import face_pressures, sink_coefficients
from .side_shear import side_shear
from .strain import strain_rates
from .viscous import viscosity_weights


class Work(NamedTuple):
    """Scratch arrays of the sweeps on one grid shape.

    The traction of the bed is k_bed u + bed_drag, Pa: see `sliding_bed.linearise`. `side` is that of `side_shear`.
    """

    e_centre: np.ndarray
    g_node: np.ndarray
    weight_centre: np.ndarray
    weight_node: np.ndarray
    k_bed: np.ndarray
    bed_drag: np.ndarray
    k_wall: np.ndarray
    wall_slip: np.ndarray
    k_gate: np.ndarray
    gate_slip: np.ndarray
    pressure_x: np.ndarray
    pressure_z: np.ndarray
    sink_x: np.ndarray
    sink_z: np.ndarray
    side: np.ndarray
    constrained: np.ndarray
    multiplier: np.ndarray
    response: ResponseWork


def allocate_work(nx, nz):
    """Scratch arrays for an nx by nz grid."""
    return Work(
        np.zeros((nx, nz)),
        np.zeros((nx + 1, nz + 1)),
        np.zeros((nx, nz)),
        np.zeros((nx + 1, nz + 1)),
        np.zeros(nx + 1),
        np.zeros(nx + 1),
        np.zeros(nz + 1),
        np.zeros(nz + 1),
        np.zeros(nz + 1),
        np.zeros(nz + 1),
        np.zeros((nx + 1, nz)),
        np.zeros((nx, nz + 1)),
        np.zeros((nx + 1, nz)),
        np.zeros((nx, nz + 1)),
        np.zeros((nx, nz + 1)),
        np.zeros((nx, nz), np.bool_),
        np.zeros((nx, nz)),
        allocate_response(nx, nz),
    )


@inner_jit()
def answer(response, work, pressure_filled, geometry, material, balance, dx, dz):
    """What the effects make of the strain rates in `work`; nothing is compiled where `response` is None."""
    if response is not None:
        respond(
            work.response,
            work.e_centre,
            work.g_node,
            pressure_filled,
            geometry,
            material,
            response,
            balance.penalty,
            balance.dt,
            dx,
            dz,
        )


@inner_jit()
def answer_beforehand(
    response, work, u, w, pressure_filled, bed_slip, geometry, material, balance, dx, dz
):
    """The source of dilating grains before the first sweep: it says which cells are being compressed."""
    if response is None:
        return
    if response.dilatancy.factor > 0.0:
        strain_rates(work.e_centre, work.g_node, u, w, bed_slip, geometry, dx, dz)
        relax_late(work.response, 0)
        answer(response, work, pressure_filled, geometry, material, balance, dx, dz)


@inner_jit()
def stress_coefficients(work, pressure_filled, geometry, material, response):
    """Viscosity of cells and nodes, the extra friction of the effects included."""
    if response is None:
        set_viscosity(work, pressure_filled, geometry, material, 0.0, None)
    elif response.dilatancy.factor > 0.0:
        set_viscosity(work, pressure_filled, geometry, material, adhesion_of(response), None)
        add_dilating_friction(
            work.weight_centre,
            work.weight_node,
            work.response.extra_friction,
            work.e_centre,
            work.g_node,
            pressure_filled,
            geometry,
            material,
        )
    else:
        friction = work.response.extra_friction
        set_viscosity(work, pressure_filled, geometry, material, adhesion_of(response), friction)


@inner_jit()
def set_viscosity(work, pressure_filled, geometry, material, adhesion, friction):
    """Set the viscosity of cells and nodes to that of the present strain rates: see `viscosity_weights`."""
    viscosity_weights(
        work.weight_centre,
        work.weight_node,
        work.e_centre,
        work.g_node,
        pressure_filled,
        geometry,
        material,
        adhesion,
        friction,
    )


@inner_jit()
def wall_coefficients(work, u, w, pressure_filled, bed_slip, geometry, material, balance, dx, dz):
    """Friction coefficients of bed and back wall."""
    work.bed_drag[:] = 0.0
    bed_friction(
        work.k_bed,
        bed_slip,
        u,
        pressure_filled,
        work.weight_centre,
        work.e_centre,
        work.response.extra_friction,
        work.response.bed_excess,
        geometry,
        material,
        balance.gz,
        balance.density,
        balance.mu_bed,
        adhesion_of(balance.response),
        dz,
    )
    back_wall_friction(
        work.k_wall,
        work.wall_slip,
        w,
        pressure_filled,
        work.weight_centre,
        work.e_centre,
        work.response.extra_friction,
        geometry,
        material,
        balance.gx,
        balance.density,
        balance.mu_back_wall,
        dx,
    )


@inner_jit()
def lateral_coefficients(work, u, w, pressure_filled, geometry, balance, dz):
    """Friction coefficients of the lateral walls."""
    if balance.wall_strength > 0.0:
        face_pressures(
            work.pressure_x,
            work.pressure_z,
            pressure_filled,
            geometry,
            balance.wall_deep_ratio,
            balance.wall_weakening_depth,
            dz,
        )
        sink_coefficients(
            work.sink_x,
            work.sink_z,
            u,
            w,
            work.pressure_x,
            work.pressure_z,
            geometry,
            balance.wall_strength,
            balance.slip_min,
        )
    else:
        work.sink_x[:] = 0.0
        work.sink_z[:] = 0.0


@inner_jit()
def gate_coefficients(work, w, pressure_filled, geometry, material, balance, dx):
    """Friction coefficients of the gate."""
    if balance.mu_gate > 0.0:
        gate_friction(
            work.k_gate,
            work.gate_slip,
            w,
            pressure_filled,
            work.weight_centre,
            work.e_centre,
            work.response.extra_friction,
            geometry,
            material,
            balance,
            dx,
        )


@kernel_jit()
def coefficients(
    work, u, w, pressure_filled, bed_slip, geometry, material, balance, dx, dz, solved
):
    """Viscosity and friction coefficients of the current velocity and pressure, into `work` and `bed_slip`.

    `solved`: velocity and pressure come from a solve with the viscosity that is in `work`. The reaction of a
    wall is then taken with that viscosity, for only so is it what carries the grains in that solve. With the
    new one the reaction under a plug, whose viscosity jumps tenfold from sweep to sweep, would be wrong by 3 % in
    turns, and the sweeps would not settle in a tip of one cell.
    """
    strain_rates(work.e_centre, work.g_node, u, w, bed_slip, geometry, dx, dz)
    answer(balance.response, work, pressure_filled, geometry, material, balance, dx, dz)
    if not solved:
        stress_coefficients(work, pressure_filled, geometry, material, balance.response)
    wall_coefficients(work, u, w, pressure_filled, bed_slip, geometry, material, balance, dx, dz)
    gate_coefficients(work, w, pressure_filled, geometry, material, balance, dx)
    if solved:
        stress_coefficients(work, pressure_filled, geometry, material, balance.response)
    side_shear(work.side, work.weight_node, work.g_node, geometry, dx)
    lateral_coefficients(work, u, w, pressure_filled, geometry, balance, dz)
