"""The terms that the effects add to a step: the stage functions of their modules, in the order of the catalogue.

The effect names its module (`Effect.term`). A module defines the stages that it needs and no others:

- `start(state, case)`: the state has the fields of the effect, unless it had them;
- `extend(state, case, nx, nz)`: cells beyond the first nx columns and nz rows hold what grains at rest hold;
- `limit(state)`: the longest step that the term allows, s; inf if any;
- `carry(state, aperture, phi_old, dt, dx, dz)`: the fields have moved with the grains for dt (s), from the surface
  `phi_old` to that of the state;
- `before_solve(simulation, u_star, w_star, balance)`: returns the `Impulse` that acts between advection and the
  implicit solve, or None, and the `Balance` that is left for the solve;
- `finish(simulation, dt)`: the fields have taken what the solve left, and evolved for dt (s).

Terms that answer the nonlinear sweeps are compiled into one kernel, `grain_response.respond`.
"""

from importlib import import_module
from typing import NamedTuple

import numpy as np

from fvcollapse.effects.catalogue import effects_on


class Impulse(NamedTuple):
    """Change of the velocity (nx + 1, nz), (nx, nz + 1) by a force before the solve, m/s.

    Its work is booked as that of the lateral walls (`lateral`), or as dissipated in the bulk.
    """

    u: np.ndarray
    w: np.ndarray
    lateral: bool = False


class Terms(NamedTuple):
    """Pairs (name of the effect, function) of each stage."""

    start: tuple
    extend: tuple
    limit: tuple
    carry: tuple
    before_solve: tuple
    finish: tuple


def terms_of(case):
    """The `Terms` of the effects of a case that are on."""
    modules = [
        (effect.name, import_module(f"fvcollapse.step.{effect.term}"))
        for effect, _ in effects_on(case)
        if effect.term
    ]
    return Terms(
        *(
            tuple(
                (name, getattr(module, stage)) for name, module in modules if hasattr(module, stage)
            )
            for stage in Terms._fields
        )
    )
