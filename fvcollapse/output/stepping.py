"""The steps of a run to a landing with their record, and the status of a run that fails."""

import time
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.errors import LimitReached, named_failure
from fvcollapse.output.recorder import SAME_TIME
from fvcollapse.output.rest import stops
from fvcollapse.output.trust import FAILED, STOPPED, trust_of
from fvcollapse.step.guards import steps_left

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.errors import FvcollapseError
    from fvcollapse.output.recorder import Landing, Recorder
    from fvcollapse.output.trust import Trust
    from fvcollapse.simulation import Marched, Simulation


CALL = 0.2  # s of wall time that the steps between two looks at the signals should take
MOST = 256  # steps between two looks


class Pace:
    """How many steps are taken between two looks at the signals; their number does not change the steps."""

    def __init__(self) -> None:
        self.steps = 1

    def note(self, steps: int, seconds: float) -> None:
        """Note that so many steps took so many seconds."""
        if steps > 0:
            self.steps = int(min(max(CALL * steps / max(seconds, 1e-9), 1), MOST, 4 * self.steps))


def steps_towards(
    simulation: "Simulation", recorder: "Recorder", landing: "Landing", pace: Pace, last: "Landing"
) -> "Marched":
    """Take some steps towards a landing and record them; a step that fails leaves no trace in the record.

    Parameters
    ----------
    simulation : Simulation
        Left at the state that failed, if a guard refuses it.
    recorder : Recorder
    landing : Landing
    pace : Pace
    last : Landing
        At the end of the run. What is due there is due where the run stops before; see `rest`.

    Returns
    -------
    Marched
    """
    state = simulation.state
    left = steps_left(state.step, state.time)
    start, mark = time.perf_counter(), recorded(recorder)
    marched = simulation.march(landing.time, min(pace.steps, left))
    seconds = time.perf_counter() - start
    pace.note(len(marched.records), seconds)
    try:
        recorder.add_steps(marched, seconds)
        if marched.problem is None and simulation.state.time >= landing.time - SAME_TIME:
            stopping = stops(simulation.case, recorder.series)
            recorder.add_landing(simulation, last if stopping else landing)
    except BaseException:
        rewind(recorder, mark)
        raise
    return marched


def recorded(recorder: "Recorder") -> Any:
    """Numbers of rows and of profiles recorded so far."""
    return len(recorder.series["time"]), len(recorder.profile_times)


def rewind(recorder: "Recorder", mark: Any) -> None:
    """Drop what was recorded since `recorded(recorder)` was `mark`."""
    rows, profiles = mark
    for values in recorder.series.values():
        del values[rows:]
    for values in recorder.steps.values():
        del values[rows - 1 :]
    for values in (recorder.profile_times, *recorder.profiles.values()):
        del values[profiles:]
    reached = recorder.series["time"][-1]
    fields = recorder.store["fields"]
    for index in [index for index in fields if not fields[index].attrs.get("time", inf) <= reached]:
        for name in ("fields", "paraview"):
            if index in recorder.store[name]:
                del recorder.store[name][index]


def trust_of_record(recorder: "Recorder", status: str, case: "Case") -> "Trust":
    """The `Trust` that a record deserves; `status` as in `trust_of`."""
    capped = recorder.steps.get("capped", [])
    volume = np.array(recorder.series["relative_volume"])
    corrected = recorder.series["volume_correction"][-1]
    return trust_of(status, volume, corrected, sum(capped), len(capped), case)


def ending(error: BaseException, moment: float) -> "tuple[FvcollapseError, str]":
    """(named error, status of the result) of a run that an exception has ended at `moment` (s)."""
    failure = named_failure(error, moment)
    word = STOPPED if isinstance(failure, LimitReached) else FAILED
    return failure, f"{word}: {failure}"
