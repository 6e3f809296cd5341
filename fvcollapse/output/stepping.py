"""One step of a run with its guards and its record, and the status of a run that fails."""

import time
from math import inf

from fvcollapse.errors import LimitReached, named_failure
from fvcollapse.output.recorder import SAME_TIME
from fvcollapse.output.trust import FAILED, STOPPED, trust_of
from fvcollapse.step.guards import WATCHED, Guards, refuse_step


def guards_of(simulation, recorder):
    """The `Guards` of a run whose record begins at t = 0."""
    start = {name: recorder.series[name][0] for name in ("kinetic_energy", "potential_energy")}
    return Guards(simulation.case, sum(start.values()))


def guarded_step(simulation, recorder, guards, landing):
    """Make one step towards a landing and record it; a step that fails leaves no trace in the record.

    Parameters
    ----------
    simulation : Simulation
        Left at the state that failed, if the step fails.
    recorder : Recorder
    guards : Guards
    landing : Landing

    Returns
    -------
    (StepRecord, State)
        Copy of the state after the step.

    Raises
    ------
    NumericalError
        The solve fails, a guard is broken, or a limit is reached.
    """
    refuse_step(simulation.state.step, simulation.state.time)
    start, mark = time.perf_counter(), recorded(recorder)
    try:
        record = simulation.advance(landing.time)
        recorder.add_step(record, time.perf_counter() - start)
        recorder.add_series(simulation)
        guards.check(simulation, {name: recorder.series[name][-1] for name in WATCHED})
        if simulation.state.time >= landing.time - SAME_TIME:
            recorder.add_snapshot(simulation, landing)
        return record, simulation.state.copy()
    except Exception:
        rewind(recorder, mark)
        raise


def recorded(recorder):
    """Numbers of rows and of profiles recorded so far."""
    return len(recorder.series["time"]), len(recorder.profile_times)


def rewind(recorder, mark):
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


def trust_of_record(recorder, status, case):
    """The `Trust` that a record deserves; `status` as in `trust_of`."""
    capped = recorder.steps.get("capped", [])
    return trust_of(status, recorder.series["relative_volume"], sum(capped), len(capped), case)


def ending(error, moment):
    """(named error, status of the result) of a run that an exception has ended at `moment` (s)."""
    failure = named_failure(error, moment)
    word = STOPPED if isinstance(failure, LimitReached) else FAILED
    return failure, f"{word}: {failure}"
