"""Constants of the momentum balance of one step, for the kernels."""

import math
from typing import NamedTuple

from fvcollapse.case.case import GRAVITY

from .compiled import inner_jit
from .grain_response import Response
from .lateral_friction import sink_constants

PENALTY = 4.0e5  # of the incompressibility, in units of rho h0 sqrt(g h0): 1e8 Pa s for the paper's column
SPEED_SCALE = 0.01  # of sqrt(g h0): the sweeps of slower grains need not converge any closer
SOFT_STEPS = 10  # first steps, whose sweeps begin with a larger regularisation


class Balance(NamedTuple):
    """Constants of the momentum balance of one step, SI. `wall_strength` = 2 mu_w K_w / w, 0 without lateral walls.

    `response` is None where no effect answers the sweeps: the compiler then leaves out what they call.
    """

    dt: float
    density: float
    gx: float
    gz: float
    mu_bed: float
    mu_back_wall: float
    wall_strength: float
    slip_min: float
    penalty: float
    unilateral: bool
    tolerance: float
    speed_scale: float
    max_sweeps: int
    rate_start: float
    wall_deep_ratio: float
    wall_weakening_depth: float
    gate_column: int
    gate_speed: float
    mu_gate: float
    response: Response | None


def balance_at_rest(case, gravity, gate_column, response):
    """`Balance` of a resolved case for a step of no length, with the gate at rest; see `balance_of`.

    Parameters
    ----------
    case : Case
    gravity : (float, float)
        Along the bed and normal to it, m/s2.
    gate_column : int
        Negative without a gate.
    response : Response or None
    """
    numerics, height, density = case.numerics, case.geometry.height_0, case.rheology.density_bulk
    walls, gate = case.effects.lateral_friction, case.effects.gate
    strength, deep_ratio, weakening_depth = sink_constants(walls, case.geometry.channel_width)
    scale = math.sqrt(GRAVITY * height)
    periodic = case.boundary.ends == "periodic"
    return Balance(
        dt=0.0,
        density=density,
        gx=gravity[0],
        gz=gravity[1],
        mu_bed=float(case.boundary.mu_bed),
        mu_back_wall=0.0 if periodic else float(case.boundary.mu_back_wall),
        wall_strength=strength,
        slip_min=0.1 * numerics.shear_rate_min * height,
        penalty=PENALTY * density * height * scale,
        unilateral=numerics.unilateral,
        tolerance=numerics.tolerance,
        speed_scale=SPEED_SCALE * scale,
        max_sweeps=numerics.max_sweeps,
        rate_start=0.0,
        wall_deep_ratio=deep_ratio,
        wall_weakening_depth=weakening_depth,
        gate_column=gate_column,
        gate_speed=0.0,
        mu_gate=gate.mu_gate if gate is not None else 0.0,
        response=response,
    )


def soft_rate(case):
    """Shear rate, 1/s, by which the first sweeps of the first steps are regularised."""
    return 0.1 * math.sqrt(GRAVITY / case.geometry.height_0)


@inner_jit()
def balance_with(balance, dt, rate_start, gate_speed, wall_strength):
    """The same `Balance` with what changes from step to step."""
    return Balance(
        dt,
        balance.density,
        balance.gx,
        balance.gz,
        balance.mu_bed,
        balance.mu_back_wall,
        wall_strength,
        balance.slip_min,
        balance.penalty,
        balance.unilateral,
        balance.tolerance,
        balance.speed_scale,
        balance.max_sweeps,
        rate_start,
        balance.wall_deep_ratio,
        balance.wall_weakening_depth,
        balance.gate_column,
        gate_speed,
        balance.mu_gate,
        balance.response,
    )
