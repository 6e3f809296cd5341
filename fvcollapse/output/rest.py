"""Where a run ends before its time since its pile rests (`time.stop_at_rest`).

A run ends so at a landing only: the schedule stays a pure function of the case, and the record says where it was left.
A run that is resumed therefore ends where an uninterrupted one does.
"""

from bisect import bisect_left
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from fvcollapse.measure.series_readings import SPEED_REST
from fvcollapse.output.recorder import SAME_TIME
from fvcollapse.step.gate import gate_height, gate_lift

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


SPELL = 0.1  # s that nothing may be faster than `SPEED_REST`


def rests(case: "Case", series: Mapping[str, Any]) -> bool:
    """Whether the pile has rested at the end of its series for `SPELL`, the gate above the column all the while.

    Parameters
    ----------
    case : Case
    series : dict of (n,) sequences
        "time" [s], "max_speed" [m/s] and "max_thickness" [m], as recorded.
    """
    time = series["time"]
    begin = time[-1] - SPELL
    if begin < 0.0:
        return False
    lift = gate_lift(case.resolved)
    if gate_height(begin, lift) < lift.foot + series["max_thickness"][0]:
        return False
    first = (
        bisect_left(time, begin + SAME_TIME) - 1
    )  # the row at the beginning of the spell, or the last before it
    return max(series["max_speed"][max(first, 0) :]) < SPEED_REST


def stops(case: "Case", series: Mapping[str, Any]) -> bool:
    """Whether a run of this case that has landed at the end of its series goes no further, before its time."""
    early = series["time"][-1] < case.time.end - SAME_TIME
    return early and case.time.stop_at_rest and rests(case, series)


def reached_end(case: "Case", series: Mapping[str, Any]) -> float:
    """Time [s] at which a run of this case ends, as far as its series shows."""
    return series["time"][-1] if stops(case, series) else case.time.end
