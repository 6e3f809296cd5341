"""How far a result is to be trusted, judged by its own record: "fine", "look at it" or "do not use".

| reason | look at it | do not use |
|---|---|---|
| the run did not reach its end | interrupted, or a stated limit was reached | it failed |
| largest drift of the volume | above 0.2 % | above 1 % |
| share of capped steps | above 20 % | |

The volume is conserved by the equations and corrected after every step, so a drift is an error of the
scheme. Ordinary collapses with six cells in the height or more keep it to 0.2 %; 1 % of the volume is
as large as what a usual experiment resolves. With dilatancy the volume changes as the grains expand:
only what lies beyond the solid fractions that the law allows counts.

A capped step is one whose nonlinear sweeps stopped above the tolerance. Ordinary collapses have less
than 4 % of them; materials of pure yield stress that come to rest have up to half, without harm. Many
capped steps are therefore a reason to look at a result, not to discard it.
"""

from typing import NamedTuple

import numpy as np

FINE, LOOK, DO_NOT_USE = "fine", "look at it", "do not use"
VOLUME_LOOK, VOLUME_USELESS = 0.002, 0.01  # of the volume at the start
CAPPED_LOOK = 0.2  # of the steps
COMPLETE, RUNNING, INTERRUPTED, STOPPED, FAILED = (
    "complete",
    "running",
    "interrupted",
    "stopped",
    "failed",
)


class Trust(NamedTuple):
    """`verdict` ("fine", "look at it" or "do not use") and the reasons, a tuple of phrases."""

    verdict: str
    reasons: tuple

    def __str__(self):
        return ": ".join(part for part in (self.verdict, "; ".join(self.reasons)) if part)


def trust_of(status, relative_volume, capped, steps, case):
    """The `Trust` that a run deserves.

    Parameters
    ----------
    status : str
        Of the run: complete, running, interrupted, "stopped: why" or "failed: why".
    relative_volume : (n,) array
        V(t)/V(0) - 1.
    capped, steps : int
        Number of capped steps, and of all.
    case : Case

    Returns
    -------
    Trust
    """
    found = [
        judged_status(status),
        judged_volume(largest_drift(relative_volume, case)),
        judged_capped(capped, steps),
    ]
    found = [(verdict, reason) for verdict, reason in found if verdict != FINE]
    order = (FINE, LOOK, DO_NOT_USE)
    worst = max((verdict for verdict, _ in found), key=order.index, default=FINE)
    return Trust(worst, tuple(reason for _, reason in found))


def judged_status(status):
    """(verdict, reason) of how a run ended."""
    if status == COMPLETE:
        return FINE, ""
    if status.startswith(FAILED):
        return DO_NOT_USE, status
    return LOOK, status if status.startswith(STOPPED) else f"not at its end ({status})"


def judged_volume(drift):
    """(verdict, reason) of the largest drift of the volume."""
    if drift <= VOLUME_LOOK:
        return FINE, ""
    verdict = LOOK if drift <= VOLUME_USELESS else DO_NOT_USE
    return verdict, f"volume drifts {100.0 * drift:.3g} %"


def judged_capped(capped, steps):
    """(verdict, reason) of the number of capped steps."""
    share = capped / max(steps, 1)
    if share <= CAPPED_LOOK:
        return FINE, ""
    return LOOK, f"{100.0 * share:.0f} % of the steps are capped"


def largest_drift(relative_volume, case):
    """Largest drift of the volume, as a fraction; beyond what dilatancy allows, if it acts."""
    values, (low, high) = np.asarray(relative_volume, float), allowed_volumes(case)
    return float(np.max(np.maximum(values - high, low - values), initial=0.0))


def allowed_volumes(case):
    """Least and largest relative volume to which the grains may contract and expand."""
    effect = case.effects.dilatancy
    if effect is None or effect.dilatancy_factor == 0.0:
        return 0.0, 0.0
    start = effect.solid_fraction_0 or case.rheology.density_bulk / case.rheology.density_grain
    densest = max(start, effect.solid_fraction_critical)
    loosest = min(start, effect.solid_fraction_critical - effect.solid_fraction_slope)
    return start / densest - 1.0, start / loosest - 1.0
