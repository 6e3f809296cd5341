"""How far a result is to be trusted, judged by its own record: "fine", "look at it" or "do not use".

The table of the limits, with what is not judged, stands in `README.md` beside this file.

The volume is corrected after every step to that of the start, so a drift means that the correction had
nothing to act on; 1 % of the volume is as large as what a usual experiment resolves. With dilatancy the
volume changes as the grains expand, as it does with cohesion that loosens them: only what lies beyond the
solid fractions that the law allows counts.

The sum of the corrections says how much volume the motion of the surface made or lost on the way, and
the correction moved elsewhere. Ordinary collapses stay below 0.1. Grains that fly apart (a tall column
that leaves the back wall of a steep slope, where no gap can open) pass 0.3, and their shape is wrong.

A capped step is one whose nonlinear sweeps stopped above the tolerance. Ordinary collapses have less
than 4 % of them; materials of pure yield stress that come to rest have up to half, without harm. Many
capped steps are therefore a reason to look at a result, not to discard it.
"""

from math import floor
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fvcollapse.step.grid import spacing

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


FINE, LOOK, DO_NOT_USE = "fine", "look at it", "do not use"
VOLUME_LOOK, VOLUME_USELESS = 0.002, 0.01  # of the volume at the start
CORRECTED_LOOK, CORRECTED_USELESS = 0.15, 0.5  # sum of the corrections, of the volume at the start
CAPPED_LOOK = 0.2  # of the steps
HEIGHT_LOOK, LENGTH_LOOK = 12, 6  # cells in the column, as a diagnosis takes them by itself
ROUND_OFF = 1.0 + 1.0e-9  # 0.14 and 12 times 0.14/12 are the same height
NOT_JUDGED = "what finer cells would change is not judged"
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

    def __str__(self) -> str:
        return ": ".join(part for part in (self.verdict, "; ".join(self.reasons)) if part)

    @property
    def words(self) -> str:
        """The same, and what it does not say."""
        return f"{self} ({NOT_JUDGED})"


def trust_of(
    status: str,
    relative_volume: np.ndarray,
    corrected: float,
    capped: int,
    steps: int,
    case: "Case",
) -> Trust:
    """The `Trust` that a run deserves.

    Parameters
    ----------
    status : str
        Of the run: complete, running, interrupted, "stopped: why" or "failed: why".
    relative_volume : (n,) array
        V(t)/V(0) - 1.
    corrected : float
        Sum of the absolute corrections of the volume, over V(0).
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
        judged_corrections(corrected),
        judged_capped(capped, steps),
        judged_cells(case),
    ]
    found = [(verdict, reason) for verdict, reason in found if verdict != FINE]
    order = (FINE, LOOK, DO_NOT_USE)
    worst = max((verdict for verdict, _ in found), key=order.index, default=FINE)
    return Trust(worst, tuple(reason for _, reason in found))


def judged_status(status: str) -> tuple[str, str]:
    """(verdict, reason) of how a run ended."""
    if status == COMPLETE:
        return FINE, ""
    if status.startswith(FAILED):
        return DO_NOT_USE, status
    return LOOK, status if status.startswith(STOPPED) else f"not at its end ({status})"


def judged_volume(drift: float) -> tuple[str, str]:
    """(verdict, reason) of the largest drift of the volume."""
    if drift <= VOLUME_LOOK:
        return FINE, ""
    verdict = LOOK if drift <= VOLUME_USELESS else DO_NOT_USE
    return verdict, f"volume drifts {100.0 * drift:.3g} %"


def judged_corrections(corrected: float) -> tuple[str, str]:
    """(verdict, reason) of the sum of the corrections of the volume."""
    if corrected <= CORRECTED_LOOK:
        return FINE, ""
    verdict = LOOK if corrected <= CORRECTED_USELESS else DO_NOT_USE
    return verdict, f"corrections of the volume sum to {100.0 * corrected:.3g} % of it"


def judged_capped(capped: int, steps: int) -> tuple[str, str]:
    """(verdict, reason) of the number of capped steps."""
    share = capped / max(steps, 1)
    if share <= CAPPED_LOOK:
        return FINE, ""
    return LOOK, f"{100.0 * share:.0f} % of the steps are capped"


def judged_cells(case: "Case") -> tuple[str, str]:
    """(verdict, reason) of the cells in the column."""
    high, long = cells_in_column(case)
    found = []
    if high * ROUND_OFF < HEIGHT_LOOK:
        found.append(
            f"{floor(10.0 * high) / 10.0:g} cells in the height of the column, fewer than {HEIGHT_LOOK}"
        )
    if long * ROUND_OFF < LENGTH_LOOK:
        found.append(f"{floor(10.0 * long) / 10.0:g} cells in its length, fewer than {LENGTH_LOOK}")
    return (LOOK, "; ".join(found)) if found else (FINE, "")


def cells_in_column(case: "Case") -> tuple[float, float]:
    """Cells in the height and in the length of the column at the start."""
    column = case.resolved
    dx, dz = spacing(column)
    return column.geometry.height_max / dz, column.geometry.length_0 / dx


def largest_drift(relative_volume: np.ndarray, case: "Case") -> float:
    """Largest drift of the volume, as a fraction; beyond what dilatancy allows, if it acts."""
    values, (low, high) = np.asarray(relative_volume, float), allowed_volumes(case)
    return float(np.max(np.maximum(values - high, low - values), initial=0.0))


def allowed_volumes(case: "Case") -> tuple[float, float]:
    """Least and largest relative volume to which the grains may contract and expand."""
    effect = case.resolved.effects.dilatancy  # cohesion may loosen the grains, too
    if effect is None or effect.dilatancy_factor == 0.0:
        return 0.0, 0.0
    start = effect.solid_fraction_0 or case.rheology.density_bulk / case.rheology.density_grain
    densest = max(start, effect.solid_fraction_critical)
    loosest = min(start, effect.solid_fraction_critical - effect.solid_fraction_slope)
    return start / densest - 1.0, start / loosest - 1.0
