"""Stages of a step in plain Python: terms of effects that are not compiled, and the reference method of the solve.

The functions of such a term (`terms`) take the resolved case before the arguments that stand there, but for

- `before_solve(case, flow, u_star, w_star, balance)`, which returns the change of the velocity on the x-faces and on
  the z-faces, m/s; its work is dissipated in the bulk.
"""

from functools import partial

import numpy as np


def stages_with(stages, case, terms):
    """The stages of a step in which the terms in plain Python act, and the method of solution of the case.

    Parameters
    ----------
    stages : Stages
        To be called from Python.
    case : Case
        Resolved.
    terms : Terms

    Returns
    -------
    Stages
        `stages` itself if nothing is added.
    """
    changed = {}
    if case.numerics.method != "coupled":
        changed["solve"] = project
    pairs = (
        ("choose_step", terms.limit, limited),
        ("move_surface", terms.carry, carried),
        ("act_before_solve", terms.before_solve, pushed),
        ("finish_terms", terms.finish, finished),
    )
    for name, functions, wrap in pairs:
        if functions:
            bound = [partial(function, case) for _, function in functions]
            changed[name] = partial(wrap, bound, getattr(stages, name))
    return stages._replace(**changed) if changed else stages


def limited(functions, choose_step, flow, time_limit):
    """The step that all limits allow, s."""
    limits = [limit(flow.fields) for limit in functions]
    return min(choose_step(flow, time_limit), *limits)


def carried(functions, move_surface, flow, dt):
    """The surface has moved, and the fields of the terms with it."""
    moved = move_surface(flow, dt)
    for carry in functions:
        carry(flow, dt)
    return moved


def pushed(functions, act_before_solve, flow, u_star, w_star, balance):
    """The impulse of all terms, and the balance that is left for the solve."""
    impulse, left = act_before_solve(flow, u_star, w_star, balance)
    u, w = np.zeros_like(u_star), np.zeros_like(w_star)
    for before_solve in functions:
        change_u, change_w = before_solve(flow, u_star, w_star, balance)
        u += change_u
        w += change_w
    return impulse._replace(bulk_u=u, bulk_w=w), left


def finished(functions, finish_terms, flow, dt):
    """The fields of all terms are those at the end of the step."""
    finish_terms(flow, dt)
    for finish in functions:
        finish(flow, dt)


def project(flow, ends, u_star, w_star, impulse, balance, memory):
    """Velocity and pressure by the incremental projection; see `projection`."""
    from . import projection  # sparse matrices of scipy, for the reference method only

    changes = (impulse.bulk_u, impulse.bulk_w), (impulse.lateral_u, impulse.lateral_w)
    for change_u, change_w in changes:
        if change_u.size > 0:
            u_star, w_star = u_star + change_u, w_star + change_w
    constants = flow.constants
    outcome = projection.solve(
        flow.fields,
        flow.work,
        ends,
        u_star,
        w_star,
        flow.geometry,
        constants.material,
        balance,
        constants.dx,
        constants.dz,
    )
    return outcome, memory
