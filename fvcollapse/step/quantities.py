"""What the solver knows at the cell centres, and the energies; computed for output, never fed back."""

import math

import numpy as np

from .compiled import kernel_jit
from .geometry import WET
from .grain_response import allocate_response, prepare_response, respond
from .ill_posedness import is_ill_posed
from .rheology import effective_viscosity, inertial_number, with_extra_friction
from .strain import shear_rate_centre, strain_rates


@kernel_jit()
def local_slopes(shear_rate, pressure, material):
    """N = d ln tau / d ln shear_rate and t = d tau / d p of the law, by central differences of 0.1 %."""
    step = 1.0e-3
    up, down = shear_rate * (1.0 + step), shear_rate * (1.0 - step)
    tau_up = up * effective_viscosity(up, pressure, material)
    tau_down = down * effective_viscosity(down, pressure, material)
    exponent = math.log(tau_up / tau_down) / math.log(up / down)
    rise = shear_rate * (
        effective_viscosity(shear_rate, pressure * (1.0 + step), material)
        - effective_viscosity(shear_rate, pressure * (1.0 - step), material)
    )
    return exponent, rise / (2.0 * step * pressure)


@kernel_jit()
def fill_quantities(
    pressure,
    shear_rate,
    viscosity,
    inertial,
    ill_posed,
    e_centre,
    g_node,
    pressure_filled,
    filled,
    reach,
    extra_friction,
    material,
):
    """Cell-centre fields in the wet cells; elsewhere they stay as they are, zero."""
    for i in range(filled.shape[0]):
        for k in range(reach[i]):
            if filled[i, k] <= WET:
                continue
            rate = shear_rate_centre(e_centre, g_node, i, k)
            p = pressure_filled[i, k] / filled[i, k]
            pressure[i, k] = p
            shear_rate[i, k] = rate
            grains = with_extra_friction(material, extra_friction[i, k])
            viscosity[i, k] = effective_viscosity(rate, p, grains)
            if p > 0.0:
                inertial[i, k] = inertial_number(rate, p, material.grain_scale)
                if rate > 0.0:
                    exponent, slope = local_slopes(rate, p, grains)
                    ill_posed[i, k] = is_ill_posed(exponent, slope)


def cell_quantities(state, geometry, material, response, dx, dz):
    """Fields at the cell centres, zero outside the grains.

    Parameters
    ----------
    state : State
    geometry : Geometry
    material : Material
    response : Response
    dx, dz : float
        m.

    Returns
    -------
    dict of (nx, nz) arrays
        filled_fraction (-), pressure (Pa), shear_rate (1/s), viscosity (Pa s), inertial_number (-,
        0 without pressure), ill_posed (bool).
    """
    shape = state.pressure_filled.shape
    e_centre, g_node = np.zeros(shape), np.zeros((shape[0] + 1, shape[1] + 1))
    strain_rates(e_centre, g_node, state.u, state.w, state.bed_slip, geometry, dx, dz)
    pressure, shear_rate, viscosity, inertial = (np.zeros(shape) for _ in range(4))
    ill_posed = np.zeros(shape, np.bool_)
    rates, spacing = (e_centre, g_node), (dx, dz)
    extra_friction = extra_friction_of(state, rates, geometry, material, response, spacing)
    fill_quantities(
        pressure,
        shear_rate,
        viscosity,
        inertial,
        ill_posed,
        e_centre,
        g_node,
        state.pressure_filled,
        geometry.filled,
        geometry.reach,
        extra_friction,
        material,
    )
    return {
        "filled_fraction": geometry.filled.copy(),
        "pressure": pressure,
        "shear_rate": shear_rate,
        "viscosity": viscosity,
        "inertial_number": inertial,
        "ill_posed": ill_posed,
    }


def extra_friction_of(state, rates, geometry, material, response, spacing):
    """What the effects add to the friction coefficient of the cells, (nx, nz); `rates` are those of cells and nodes."""
    work = allocate_response(*state.pressure_filled.shape)
    if response.active:
        prepare_response(work, state, response)
        respond(
            work,
            *rates,
            state.pressure_filled,
            geometry,
            material,
            response,
            1.0,
            state.dt or 1.0,  # at rest nothing dilates
            *spacing,
        )
    return work.extra_friction


def energies(state, geometry, density, gravity, dx, dz):
    """Kinetic and potential energy per unit width, J/m, with the face masses of the solver.

    The potential is zero at the origin (back wall, bed).
    """
    x_moment, z_moment = first_moments(
        geometry.filled, geometry.lever_x, geometry.lever_z, geometry.packing
    )
    return {
        "kinetic": kinetic_energy(state, geometry, density, dx, dz),
        "potential": -(density * dx * dz)
        * (gravity[0] * dx * x_moment + gravity[1] * dz * z_moment),
    }


def kinetic_energy(state, geometry, density, dx, dz):
    """Kinetic energy per unit width, J/m; see `energies`."""
    squares = weighted_square(geometry.mass_x, state.u) + weighted_square(geometry.mass_z, state.w)
    return 0.5 * (density * dx * dz) * squares


@kernel_jit()
def weighted_square(weight, values):
    """Sum of weight * values^2 over two arrays of one shape."""
    total = 0.0
    for i in range(values.shape[0]):
        for k in range(values.shape[1]):
            if weight[i, k] != 0.0:  # most cells are air
                total += weight[i, k] * values[i, k] * values[i, k]
    return total


@kernel_jit()
def first_moments(filled, lever_x, lever_z, packing):
    """Moments of the filled area, weighted by the packing, about the origin, in cells^2 dx and cells^2 dz."""
    x_moment = z_moment = 0.0
    for i in range(filled.shape[0]):
        for k in range(filled.shape[1]):
            if filled[i, k] > 0.0:
                x_moment += packing[i, k] * (i * filled[i, k] + lever_x[i, k])
                z_moment += packing[i, k] * (k * filled[i, k] + lever_z[i, k])
    return x_moment, z_moment
