"""The deposit of a run as the column of another one: a second collapse starts where the first has come to rest.

The final profile becomes `geometry.polygon`, so that the new case holds all that its run depends on. Grains are at
rest at its start, and the gate is gone. What an effect has carried along with the grains (their packing, the history
of their friction) is not taken over: it starts as the new case has it.
"""

import numpy as np

from fvcollapse.case.case import Case
from fvcollapse.case.rules import VERTICES_MAX
from fvcollapse.errors import InputError
from fvcollapse.output.result import Result

LEAST = 1.0e-6  # m of thickness that still counts as grains
GONE = {"gate.speed": float("inf"), "gate.time_constant": 0.0}


def deposit(result: Result) -> tuple[tuple[float, float], ...]:
    """The final profile as vertices (x, z) [m] of a polygon, from the foot of the back wall round.

    Parameters
    ----------
    result : Result
        Complete, and at rest at its end.

    Raises
    ------
    InputError
        It is not complete, still moves, or has an erodible bed.
    """
    refuse_no_deposit(result)
    x, h = result.profiles.x, result.profiles.thickness[-1]
    filled = np.flatnonzero(h > LEAST)
    end = min(filled[-1] + 2, len(x))  # the first node without grains closes the polygon
    surface = thinned(x[:end], np.where(h[:end] > LEAST, h[:end], 0.0))
    tip = [] if surface[-1][1] == 0.0 else [(surface[-1][0], 0.0)]
    return ((0.0, 0.0), *tip, *surface[::-1])


def thinned(x: np.ndarray, h: np.ndarray) -> list[tuple[float, float]]:
    """Points of a profile, so few that a polygon may have them; those that are left out lie evenly."""
    most = VERTICES_MAX - 2
    rows = np.unique(np.linspace(0, len(x) - 1, min(len(x), most)).round().astype(int))
    return [(float(x[row]), float(h[row])) for row in rows]


def refuse_no_deposit(result: Result) -> None:
    """Refuse a run whose end is no deposit.

    Raises
    ------
    InputError
    """
    source, summary = result.path or "result", result.summary()
    if not result.complete:
        raise InputError(source, "status", result.status, "a complete run")
    if summary["arrest_time"] is None:
        found = f"grains as fast as {summary['final_max_speed']:.2g} m/s at its end"
        raise InputError(source, "time.end", found, "a run at rest: a later time.end")
    if result.case.effects.erodible_bed is not None:
        allowed = "a run without it: the eroded layer is no polygon"
        raise InputError(source, "effects.erodible_bed", "a table", allowed)


def from_deposit(result: Result, case: Case | None = None) -> Case:
    """A case that starts from the deposit of a run, without a gate.

    Parameters
    ----------
    result : Result
        See `deposit`.
    case : Case, optional
        All but the column and the gate: slope, material, effects, grid. Default: that of the run.

    Raises
    ------
    InputError
        The run left no deposit, or the case cannot start from it.
    """
    base = result.case if case is None else case
    own = {
        f"geometry.{name}": getattr(result.case.geometry, name) for name in ("height_0", "length_0")
    }
    shape = {"geometry.polygon": deposit(result), "geometry.surface": "parallel"}
    return base.replace(**own, **shape, **GONE)
