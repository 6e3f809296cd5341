"""Steps to the next landing in one compiled call: each is taken, read into the series, and held to the guards.

`march` returns to Python where Python must act: at a landing, where the grid must grow, and where a step fails. Its
steps are those of `fvcollapse.step.advance`.
"""

from typing import NamedTuple

from fvcollapse.measure.series_row import ROW, Reading, fill_row
from fvcollapse.step.advance import COMPILED, DONE, stepper
from fvcollapse.step.compiled import from_python, kernel_jit
from fvcollapse.step.coupled import Outcome
from fvcollapse.step.domain import Room
from fvcollapse.step.flow import TIME
from fvcollapse.step.guards import NO_LAW, Watch, broken_law
from fvcollapse.step.settling import settle

# Why a march has ended, beside how a step ends
NEEDS_ROOM, BREAKS_LAW = 3, 4
SAME_TIME = 1.0e-9  # s
LOG = ("time", "dt", "sweeps", "residual", "divergence", "capped", "volume_correction")
SPEED, VOLUME = ROW.index("max_speed"), ROW.index("relative_volume")


class Plan(NamedTuple):
    """What a march is to do: until when (s), how the rows are read, what the guards watch, whether they do.

    `settles`: no step is taken; the column comes to rest behind the closed gate, with the balance of the flow.
    """

    time_limit: float
    reading: Reading
    watch: Watch
    guarded: bool
    settles: bool


class Ended(NamedTuple):
    """How a march has ended: its code, the number of steps taken, the `Room` it needs, and the last solve."""

    code: int
    steps: int
    room: Room
    outcome: Outcome


def marcher(stages):
    """The function `march` with these stages of a step: see its docstring."""
    room_needed = stages.room_needed
    jit = kernel_jit() if stages is COMPILED else _as_it_is
    fill, law_of, come_to_rest = HELPERS if stages is COMPILED else HELPERS_FROM_PYTHON
    _, take_step = stepper(stages)

    @jit
    def march(flow, plan, log, rows, memory):
        """Take steps until the time limit, as many as `log` has room for.

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
        if plan.settles:
            come_to_rest(flow, memory)
            return Ended(DONE, 0, Room(0, 0, 0, False), outcome), memory
        numbers = flow.fields.numbers
        n = 0
        while n < len(log) and numbers[TIME] < plan.time_limit - SAME_TIME:
            room = room_needed(flow)
            if room.columns > 0 or room.rows > 0 or room.keep > 0 or room.at_end:
                return Ended(NEEDS_ROOM, n, room, outcome), memory
            step, memory = take_step(flow, plan.time_limit, memory)
            outcome = step.outcome
            if step.code != DONE:
                return Ended(step.code, n, room, outcome), memory
            log[n, 0], log[n, 1], log[n, 2] = numbers[TIME], step.dt, outcome.sweeps
            log[n, 3], log[n, 4] = outcome.change, outcome.divergence
            log[n, 5], log[n, 6] = not outcome.settled, step.added
            fill(rows[n], flow, plan.reading)
            if plan.guarded:
                law, _, _ = law_of(flow, plan.watch, rows[n, VOLUME], rows[n, SPEED])
                if law != NO_LAW:
                    return Ended(BREAKS_LAW, n, room, outcome), memory
            n += 1
        return Ended(DONE, n, Room(0, 0, 0, False), outcome), memory

    return march


def _as_it_is(function):
    return function


HELPERS = fill_row, broken_law, settle
HELPERS_FROM_PYTHON = tuple(from_python(helper) for helper in HELPERS)
march = marcher(COMPILED)
