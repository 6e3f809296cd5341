"""What effects make the grains do beyond the local law at fixed density: the one hook of the solve.

Dilatancy, friction hysteresis, thin layers and nonlocal fluidity change the coefficients of a nonlinear sweep:

* the friction coefficient of every cell, by `extra_friction` (all four), and of the bed (thin layers);
* the condition on the divergence, div u = s instead of 0, and the penalty that imposes it (dilatancy);
* the force that holds adhesive grains together (`adhesion`).

They act in this order: friction of settled contacts, frozen during a step; dilatancy, which adds
tan(psi); thin layers, whose friction is that of mu_stop at least; nonlocal fluidity, which makes the law with these
nonlocal. `Response.active` is false without them, and then nothing here is called.
"""

from typing import NamedTuple

import numpy as np

from .adhesion import adhesion_law, opening_power
from .arrays import copy
from .compiled import inner_jit, kernel_jit
from .dilatancy import FULL_SWEEPS, Dilatancy, dilatancy_law, dilate, dilation_power
from .fluidity_relaxation import Cooperation, cooperate, cooperation_law
from .friction_hysteresis import FrictionHysteresis, hysteresis_law
from .geometry import WET
from .rheology import ETA_FLOOR
from .shear_planes import sum_of_cells
from .strain import mean_square, shear_rate_centre, shear_rate_from
from .thin_layer import ThinLayer, strengthen, thin_layer_law
from .viscous import friction_at_node


class Response(NamedTuple):
    """Laws of the effects; `active` says whether any of them has a strength; `adhesion` is p_c, Pa."""

    active: bool
    dilatancy: Dilatancy
    hysteresis: FrictionHysteresis
    thin: ThinLayer
    cooperation: Cooperation
    adhesion: float


class ResponseWork(NamedTuple):
    """Scratch arrays (nx, nz) of the effects; all zero while they are off.

    bed_excess (nx,) is what thin layers add to the friction of a bed on which grains slide. solid_fraction
    and settled_friction are set before the solve; share (1,) is how far a sweep moves source and friction
    towards their new values. `local_friction` is `extra_friction` before thin layers and the nonlocal law.
    """

    source: np.ndarray
    penalty: np.ndarray
    extra_friction: np.ndarray
    local_friction: np.ndarray
    settled_friction: np.ndarray
    solid_fraction: np.ndarray
    fluidity: np.ndarray
    bed_excess: np.ndarray
    share: np.ndarray


def response_of(case):
    """`Response` of a case."""
    dilatancy, hysteresis, thin = dilatancy_law(case), hysteresis_law(case), thin_layer_law(case)
    cooperation, adhesion = cooperation_law(case, thin), adhesion_law(case)
    strengths = dilatancy.factor, hysteresis.delta_mu, thin.length, cooperation.length, adhesion
    return Response(max(strengths) > 0.0, dilatancy, hysteresis, thin, cooperation, adhesion)


def allocate_response(nx, nz):
    """Scratch arrays for an nx by nz grid."""
    return ResponseWork(*(np.zeros((nx, nz)) for _ in range(7)), np.zeros(nx), np.ones(1))


# -- once a step ---------------------------------------------------------------------------------


@inner_jit()
def prepare_response(work, fields, response):
    """Hand the fields of the state to the solve; nothing of the last step is left to relax from."""
    if response is None:
        return
    work.local_friction[:] = 0.0
    work.fluidity[:] = 0.0
    if fields.solid_fraction.size > 0:
        copy(work.solid_fraction, fields.solid_fraction)
    share, friction = fields.settled_share, work.settled_friction
    for i in range(share.shape[0]):
        for k in range(share.shape[1]):
            friction[i, k] = response.hysteresis.delta_mu * share[i, k]


# -- once a sweep --------------------------------------------------------------------------------


@inner_jit()
def relax_late(work, sweep):
    """Set the relaxation factor: 1 in the first `FULL_SWEEPS` sweeps, 0.5 afterwards."""
    work.share[0] = 1.0 if sweep < FULL_SWEEPS else 0.5


@kernel_jit()
def respond(
    work, e_centre, g_node, pressure_filled, geometry, material, response, hardest, dt, dx, dz
):
    """Extra friction, source and penalty of the present strain rates and pressure, into `work`.

    Parameters
    ----------
    work : ResponseWork
    e_centre, g_node : arrays
        From `strain_rates`, 1/s.
    pressure_filled : (nx, nz) array
        Pa.
    geometry : Geometry
    material : Material
    response : Response
    hardest : float
        Penalty of an incompressible cell, Pa s.
    dt, dx, dz : float
        s, m.
    """
    if response.dilatancy.factor > 0.0:
        dilate(
            work.source,
            work.penalty,
            work.local_friction,
            work.settled_friction,
            work.solid_fraction,
            e_centre,
            g_node,
            pressure_filled,
            geometry,
            material,
            response.dilatancy,
            hardest,
            dt,
            work.share[0],
        )
    else:
        copy(work.local_friction, work.settled_friction)
    copy(work.extra_friction, work.local_friction)
    if response.thin.length > 0.0:
        strengthen(
            work.extra_friction,
            work.bed_excess,
            e_centre,
            g_node,
            pressure_filled,
            geometry,
            material,
            response.thin,
            dz,
        )
    if response.cooperation.length > 0.0:
        cooperate(
            work.extra_friction,
            work.fluidity,
            e_centre,
            g_node,
            pressure_filled,
            geometry,
            material,
            response.cooperation,
            dx,
            dz,
        )


@inner_jit()
def add_dilating_friction(
    weight_centre,
    weight_node,
    friction,
    e_centre,
    g_node,
    pressure_filled,
    geometry,
    material,
):
    """Add the extra friction of dilating grains to the viscosity of cells and nodes; at nodes the mean of the cells.

    At a node the mean pressure of its cells acts, not that of its plane (`viscous.viscosity_weights`): their source
    takes from every cell what friction pays there.

    Parameters
    ----------
    weight_centre, weight_node : (nx, nz), (nx + 1, nz + 1) arrays
        Filled fraction times viscosity, from `viscosity_weights`; changed in place, Pa s.
    friction : (nx, nz) array
    """
    filled = geometry.filled
    for i in range(filled.shape[0]):
        for k in range(geometry.reach[i]):
            v = filled[i, k]
            if v > WET:
                rate = shear_rate_centre(e_centre, g_node, i, k)
                extra = max(pressure_filled[i, k], 0.0) * friction[i, k]
                extra /= (rate**2 + material.shear_rate_min**2) ** 0.5
                weight_centre[i, k] = max(weight_centre[i, k] + extra, v * ETA_FLOOR)
    for i in range(1, filled.shape[0]):
        for k in range(1, geometry.reach[i]):
            if geometry.interior[i, k]:
                v, extra = friction_at_node(friction, geometry, i, k)
                p = 0.25 * sum_of_cells(pressure_filled, i, k)
                e2 = mean_square(
                    e_centre[i - 1, k - 1], e_centre[i, k - 1], e_centre[i - 1, k], e_centre[i, k]
                )
                rate = shear_rate_from(4.0 * e2, g_node[i, k] ** 2)
                extra *= max(p, 0.0) / v / (rate**2 + material.shear_rate_min**2) ** 0.5
                weight_node[i, k] = max(weight_node[i, k] + extra, geometry.plane[i, k] * ETA_FLOOR)


@inner_jit()
def add_source(response, rhs, work, constrained, geometry, dx, dz):
    """Change the constraint of the assembled system from penalty div u = 0 to penalty (div u - s) = 0."""
    if response is None:
        return
    if response.dilatancy.factor <= 0.0:
        return
    iu, iw, aperture = geometry.index_u, geometry.index_w, geometry.aperture
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            if not constrained[i, k]:
                continue
            left, right = aperture[i, k] / dx, aperture[i + 1, k] / dx
            a, b, c, d = iu[i, k], iu[i + 1, k], iw[i, k], iw[i, k + 1]
            push = work.penalty[i, k] * work.source[i, k]
            for n, weight in ((a, -left), (b, right), (c, -1.0 / dz), (d, 1.0 / dz)):
                if n >= 0:
                    rhs[n] += push * weight


@inner_jit()
def work_of_grains(response, work, fields, geometry, dx, dz):
    """Power of the pressure in expanding the grains less what they pay for opening, summed over cells, Pa/s."""
    if response is None:
        return 0.0
    power = 0.0
    if response.dilatancy.factor > 0.0:
        power += dilation_power(work.source, fields.pressure_filled, geometry)
    if response.adhesion > 0.0:
        power -= opening_power(response.adhesion, fields.u, fields.w, geometry, dx, dz)
    return power
