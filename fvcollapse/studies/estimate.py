"""How long runs will take, roughly: by the number of cells and of time steps, as the benchmark measured them.

One step costs `STEP`, and `CELL` for each cell that holds grains (benchmark of `runs/bench`, collapse at 22 deg on
cells of 12 and 6 mm, one core). Another machine, a stiff law or a long thin deposit may take twice as long or half.
"""

from collections.abc import Sequence
from math import ceil, inf, sqrt
from typing import TYPE_CHECKING, NamedTuple

from fvcollapse.case.case import GRAVITY

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


STEP, CELL = 0.4e-3, 4.0e-6  # s
SPREAD = 1.2  # cells that hold grains, over those of the column
COURANT = 0.5  # of the fastest grains, over one cell


class Plan(NamedTuple):
    """Runs that a command needs: all, those that are there already, seconds on one core of the others."""

    runs: int
    present: int
    seconds: float

    def line(self, workers: int = 1) -> str:
        """One line for the user."""
        runs = "1 run" if self.runs == 1 else f"{self.runs} runs"
        there = f" ({self.present} of them there already)" if self.present else ""
        cores = "1 core" if workers == 1 else f"{workers} cores"
        return (
            f"{runs}{there}, about {duration(self.seconds / workers)} on {cores}, compilation aside"
        )


def run_seconds(case: "Case") -> float:
    """Time that a run takes on one core, roughly [s]."""
    geometry, grid = case.geometry, case.grid
    area = grid.cell_size * (grid.cell_size_z or grid.cell_size)
    cells = SPREAD * geometry.height_0 * geometry.length_0 / area
    speed = sqrt(2.0 * GRAVITY * geometry.height_0)
    step = min(case.longest_step, COURANT * grid.cell_size / speed)
    return (STEP + CELL * cells) * case.time.end / step


def plan_of(missing: "Sequence[Case]", present: int = 0) -> Plan:
    """The `Plan` of cases that are to be run, beside a number of runs that are there already."""
    return Plan(present + len(missing), present, sum(map(run_seconds, missing)))


def duration(seconds: float) -> str:
    """A time in words, rounded up to one unit."""
    for unit, size, most in (("s", 1.0, 90.0), ("min", 60.0, 90.0), ("h", 3600.0, inf)):
        if seconds < most * size:
            return f"{ceil(seconds / size)} {unit}"
    raise ValueError(f"{seconds} s is no time")
