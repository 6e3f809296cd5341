"""Steps to the next landing in one compiled call: each is taken, read into the series, and held to the guards.

`march` returns to Python where Python must act: at a landing, where the grid must grow, and where a step fails. Its
steps are those of `fvcollapse.step.advance`.
"""

from typing import NamedTuple

from fvcollapse.measure import series_row
from fvcollapse.measure.series_row import ROW, Reading
from fvcollapse.step import energy, guards, settling
from fvcollapse.step.advance import COMPILED, DONE, stepper
from fvcollapse.step.compiled import from_python, inner_jit, kernel_jit
from fvcollapse.step.coupled import Outcome
from fvcollapse.step.domain import Room
from fvcollapse.step.flow import KINETIC, POTENTIAL, TIME
from fvcollapse.step.guards import NO_LAW, Watch

# Why a march has ended, beside how a step ends
NEEDS_ROOM, BREAKS_LAW = 3, 4
GO_ON, SETTLE, PLACE = range(3)  # how a march begins
SAME_TIME = 1.0e-9  # s
LOG = ("time", "dt", "sweeps", "residual", "divergence", "capped", "volume_correction")
SPEED, VOLUME = ROW.index("max_speed"), ROW.index("relative_volume")


class Plan(NamedTuple):
    """What a march is to do: until when (s), how the rows are read, what the guards watch, whether they do.

    `begin`: how it begins, see `march`.
    """

    time_limit: float
    reading: Reading
    watch: Watch
    guarded: bool
    begin: int


class Ended(NamedTuple):
    """How a march has ended: its code, the number of steps taken, the `Room` it needs, and the last solve."""

    code: int
    steps: int
    room: Room
    outcome: Outcome


def marcher(stages):
    """The function `march` with these stages of a step: see its docstring."""
    room_needed, place = stages.room_needed, stages.place
    jit = kernel_jit() if stages is COMPILED else _as_it_is
    helpers = HELPERS if stages is COMPILED else HELPERS_FROM_PYTHON
    note_step, fill_row, broken_law, energies, settle = helpers
    _, take_step = stepper(stages)

    @jit
    def march(flow, plan, log, rows, memory):
        """Take steps until the time limit, as many as `log` has room for.

        Or, before the first of them, let the column settle behind the closed gate, with the balance of the flow
        (`SETTLE`), or place the geometry of the state (`PLACE`); the first row of `rows` is then that of the present.

        Parameters
        ----------
        flow : Flow
        plan : Plan
        log : (n, len(LOG)) array
            Result: the report of every step.
        rows : (n, len(ROW)) array
            Result: the series after every step.
        memory : (m,) array
            Of the matrix, all zero.

        Returns
        -------
        (Ended, (m,) array)
            The second is the memory of the next march.
        """
        outcome = Outcome(0, 0.0, 0.0, 0.0, 0.0, 0, True)
        numbers = flow.fields.numbers
        if plan.begin != GO_ON:
            if plan.begin == SETTLE:
                settle(flow, memory)
            else:
                place(flow, numbers[TIME], False)
            flow.energy[KINETIC], flow.energy[POTENTIAL] = energies(flow)
            fill_row(rows[0], flow, plan.reading)
            return Ended(DONE, 0, Room(0, 0, 0, False), outcome), memory
        n = 0
        while n < len(log) and numbers[TIME] < plan.time_limit - SAME_TIME:
            room = room_needed(flow)
            if room.columns > 0 or room.rows > 0 or room.keep > 0 or room.at_end:
                return Ended(NEEDS_ROOM, n, room, outcome), memory
            step, memory = take_step(flow, plan.time_limit, memory)
            outcome = step.outcome
            if step.code != DONE:
                return Ended(step.code, n, room, outcome), memory
            note_step(log[n], numbers[TIME], step)
            fill_row(rows[n], flow, plan.reading)
            if plan.guarded:
                law, _, _ = broken_law(flow, plan.watch, rows[n, VOLUME], rows[n, SPEED])
                if law != NO_LAW:
                    return Ended(BREAKS_LAW, n, room, outcome), memory
            n += 1
        return Ended(DONE, n, Room(0, 0, 0, False), outcome), memory

    return march


@inner_jit()
def note_step(line, time, step):
    """Fill a line of the log (len(LOG),) with the report of a step that ended at `time` (s)."""
    outcome = step.outcome
    line[0], line[1], line[2] = time, step.dt, outcome.sweeps
    line[3], line[4] = outcome.change, outcome.divergence
    line[5], line[6] = not outcome.settled, step.added


def _as_it_is(function):
    return function


HELPERS = note_step, series_row.fill_row, guards.broken_law, energy.energies, settling.settle
HELPERS_FROM_PYTHON = tuple(from_python(helper) for helper in HELPERS)
march = marcher(COMPILED)
