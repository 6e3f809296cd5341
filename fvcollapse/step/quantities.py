"""What the solver knows at the cell centres; computed for output, never fed back."""

import math

import numpy as np

from .adhesion import adhesion_of
from .compiled import inner_jit, kernel_jit
from .flow import DT
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


@inner_jit()
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
    adhesion,
):
    """Cell-centre fields in the wet cells; elsewhere they stay as they are, zero."""
    for i in range(filled.shape[0]):
        for k in range(reach[i]):
            if filled[i, k] <= WET:
                continue
            rate = shear_rate_centre(e_centre, g_node, i, k)
            p = pressure_filled[i, k] / filled[i, k]
            pressure[i, k] = p - adhesion
            shear_rate[i, k] = rate
            grains = with_extra_friction(material, extra_friction[i, k])
            viscosity[i, k] = effective_viscosity(rate, p, grains)
            if p > 0.0:
                inertial[i, k] = inertial_number(rate, p, material.grain_scale)
                if rate > 0.0:
                    exponent, slope = local_slopes(rate, p, grains)
                    ill_posed[i, k] = is_ill_posed(exponent, slope)


@kernel_jit()
def fill_from_flow(
    pressure, shear_rate, viscosity, inertial, ill_posed, e_centre, g_node, response_work, flow
):
    """`fill_quantities` of a flow; the effects answer in `response_work`, so that nothing is fed back."""
    fields, geometry, constants = flow.fields, flow.geometry, flow.constants
    dx, dz = constants.dx, constants.dz
    strain_rates(e_centre, g_node, fields.u, fields.w, fields.bed_slip, geometry, dx, dz)
    answer_once(constants.balance.response, response_work, e_centre, g_node, flow)
    fill_quantities(
        pressure,
        shear_rate,
        viscosity,
        inertial,
        ill_posed,
        e_centre,
        g_node,
        fields.pressure_filled,
        geometry.filled,
        geometry.reach,
        response_work.extra_friction,
        constants.material,
        adhesion_of(constants.balance.response),
    )


@inner_jit()
def answer_once(response, work, e_centre, g_node, flow):
    """The extra friction of the effects in the present state; none where `response` is None."""
    if response is None:
        return
    fields, constants = flow.fields, flow.constants
    prepare_response(work, fields, response)
    dt = fields.numbers[DT] if fields.numbers[DT] > 0.0 else 1.0  # at rest nothing dilates
    respond(
        work,
        e_centre,
        g_node,
        fields.pressure_filled,
        flow.geometry,
        constants.material,
        response,
        1.0,
        dt,
        constants.dx,
        constants.dz,
    )


def cell_quantities(flow):
    """Fields at the cell centres of a `Flow`, zero outside the grains.

    Returns
    -------
    dict of (nx, nz) arrays
        filled_fraction (-), pressure (Pa), shear_rate (1/s), viscosity (Pa s), inertial_number (-,
        0 without pressure), ill_posed (bool).
    """
    nx, nz = flow.geometry.filled.shape
    pressure, shear_rate, viscosity, inertial = (np.zeros((nx, nz)) for _ in range(4))
    ill_posed = np.zeros((nx, nz), np.bool_)
    e_centre, g_node = np.zeros((nx, nz)), np.zeros((nx + 1, nz + 1))
    computed = pressure, shear_rate, viscosity, inertial, ill_posed
    fill_from_flow(*computed, e_centre, g_node, allocate_response(nx, nz), flow)
    return {
        "filled_fraction": flow.geometry.filled.copy(),
        "pressure": pressure,
        "shear_rate": shear_rate,
        "viscosity": viscosity,
        "inertial_number": inertial,
        "ill_posed": ill_posed,
    }
