"""What one case costs, measured within a process: the stages of the steps, and the parts of a sweep."""

import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.case.case import case_from_text
from fvcollapse.console.bars import progress_bar
from fvcollapse.output.run import Job, run_case
from fvcollapse.simulation import Simulation
from fvcollapse.step import assembly, coefficients
from fvcollapse.step.advance import STAGES, balance_of
from fvcollapse.step.banded import allocate_system, clear, factorise, solve_factorised
from fvcollapse.step.compiled import from_python, kernel_jit

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.simulation import Marched

try:
    import resource
except ImportError:  # not on Windows
    resource = None  # type: ignore[assignment]

TERMS = {
    "move_surface": "surface",
    "carry_momentum": "momentum advection",
    "place": "geometry",
    "solve": "implicit solve",
    "book_energy": "energy budget",
    "continue_velocity": "continuation of the velocity",
}
SAMPLES = 20  # instants at which the parts of a sweep are timed
REPEATS = 3
BALANCE_OF = from_python(balance_of)
PARTS = ("coefficients", "assembly", "factorisation", "substitution")


class Clock:
    """Wall time of the stages of a step, in `seconds`; `read` returns the present time, s."""

    def __init__(self, read: Callable[[], float] = time.perf_counter) -> None:
        self.read, self.seconds = read, dict.fromkeys(TERMS, 0.0)

    def stages(self) -> Any:
        """The stages of a step, which add their wall time to `seconds`."""
        return STAGES._replace(**{name: self.timed(name) for name in TERMS})

    def timed(self, name: str) -> Callable:
        """A stage that adds its wall time to `seconds`."""
        stage = getattr(STAGES, name)

        def timed_stage(*arguments, **options):
            start = self.read()
            value = stage(*arguments, **options)
            self.seconds[name] += self.read() - start
            return value

        return timed_stage


class TimedSimulation(Simulation):
    """A simulation that keeps the wall time of its terms and the sizes of its systems."""

    def __init__(self, case: "Case", state: Any = None) -> None:
        clock = Clock()
        super().__init__(case, state, clock.stages())
        self.seconds = clock.seconds = dict.fromkeys(TERMS, 0.0)  # of the steps, without the start
        self.sweeps = self.unknowns = self.cells = self.steps = 0
        self.began = self.ended = self.probing = 0.0
        self.sweep_parts: list[dict] = []

    def march(self, time_limit: float, steps: int, guarded: bool = True) -> "Marched":
        """One step, counted."""
        self.began = self.began or time.perf_counter()
        marched = super().march(time_limit, min(steps, 1), guarded)
        cells = int(np.count_nonzero(self.geometry.filled))
        for record in marched.records:
            self.sweeps += record.sweeps
            self.unknowns += record.sweeps * (unknown_faces(self.geometry) + cells)
            self.cells += cells
            self.steps += 1
        if self.state.time >= self.case.time.end * (len(self.sweep_parts) + 0.5) / SAMPLES:
            start = time.perf_counter()
            self.sweep_parts.append(time_sweep(self) | {"sweeps": self.sweeps})
            self.probing += time.perf_counter() - start
        self.ended = time.perf_counter()
        return marched


def unknown_faces(geometry: Any) -> int:
    """Number of the faces whose velocity is unknown."""
    return 1 + max(int(geometry.index_u.max()), int(geometry.index_w.max()))


def time_sweep(simulation: Simulation) -> dict:
    """Time of the parts of one sweep of the present state, s, and its size; the state stays as it is."""
    state, geometry, work = simulation.state.copy(), simulation.geometry, simulation.work
    flow, spacing = simulation.flow(), simulation.spacing
    ends = STAGES.place(flow, state.time, False)
    band, rhs = allocate_system(ends)
    balance = BALANCE_OF(flow, state.dt)
    fields = state.u, state.w, state.pressure_filled

    def compute():
        coefficients.coefficients(
            work, *fields, state.bed_slip, geometry, simulation.material, balance, *spacing, True
        )

    def put_together():
        assembly.assemble(
            band,
            rhs,
            work,
            state.pressure_filled,
            state.u,
            state.w,
            geometry,
            balance,
            *spacing,
        )

    parts = {"coefficients": best(compute), "assembly": best(put_together)}
    coefficients_read = np.count_nonzero(band)
    emptied = best(lambda: clear(band, ends))
    both = best(
        lambda: (
            clear(band, ends),
            put_together(),
            factorise(band, ends),
        )
    )
    parts["factorisation"] = both - parts["assembly"] - emptied
    parts["substitution"] = best(lambda: solve_factorised(rhs, band, ends))
    unknowns = ends.size + np.count_nonzero(geometry.filled)
    return parts | {"unknowns": unknowns, "coefficients_read": coefficients_read}


def best(work: Callable[[], object], repeats: int = REPEATS) -> float:
    """Shortest of a few wall times, s."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


@kernel_jit()
def triad(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> None:
    """Set a = b + 2 c."""
    for i in range(a.size):
        a[i] = b[i] + 2.0 * c[i]


def bandwidth(total_bytes: float) -> float:
    """Bytes per second of a triad whose three arrays have this size together."""
    a, b, c = np.zeros((3, max(int(total_bytes) // 24, 1)))
    loops = max(1, int(2e7 // (24 * a.size)))

    def work():
        for _ in range(loops):
            triad(a, b, c)

    triad(a, b, c)
    return loops * 24 * a.size / best(work)


def member(case_text: str) -> dict:
    """Run one case twice and return its figures, for a process of its own.

    The first run is that of the command line, compiled as a whole: its loop is the wall time. The stages of the second
    are timed one by one, which costs about a millisecond a step more.
    """
    case, made = case_from_text(case_text), []

    def simulate(*arguments):
        made.append(TimedSimulation(*arguments))
        return made[-1]

    wall, memory = loop_time(case), largest_memory()
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        run_case(case, Path(folder) / "run", quiet=True, simulate=simulate)
    (timed,) = made
    again = time.perf_counter() - start
    return figures(timed, wall) | {"memory_mb": memory, "timed_again_s": again}


def largest_memory() -> float | None:
    """Largest memory of this process so far, MB; None where the system does not tell (Windows)."""
    if resource is None:
        return None
    unit = 1 if sys.platform == "darwin" else 1024  # bytes there, kB elsewhere
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 2**20


def loop_time(case: "Case") -> float:
    """Wall time of the steps of a run with their record, s."""
    job = Job(case)
    start = time.perf_counter()
    with progress_bar(case, 0.0, quiet=True) as bar:
        job.march(bar)
    return time.perf_counter() - start


def figures(timed: Any, wall: float) -> dict:
    """The row of one case; `wall` is the time of its loop compiled as a whole, s."""
    sizes = {name: mean_over_sweeps(timed, name) for name in ("unknowns", "coefficients_read")}
    sweep_bytes = 8.0 * (2.0 * sizes["unknowns"] + sizes["coefficients_read"])
    bound_of_sweep = sweep_bytes / bandwidth(sweep_bytes)
    parts = {name: mean_over_sweeps(timed, name) for name in PARTS}
    traffic = sweep_bytes * timed.unknowns / sizes["unknowns"]
    interpreted = timed.ended - timed.began - timed.probing
    share = {TERMS[name]: seconds / interpreted for name, seconds in timed.seconds.items()}
    share["recording and the rest"] = 1.0 - sum(share.values())
    return {
        "cell_size": timed.spacing[1],
        "end_s": timed.case.time.end,
        "wall_s": wall,
        "steps": timed.steps,
        "sweeps": timed.sweeps,
        "linear_iterations": timed.sweeps,  # one direct solve in each sweep
        "active_cells": timed.cells / timed.steps,
        "us_per_cell_and_step": 1e6 * wall / timed.cells,
        "share": share,
        "sweep_s": parts,
        "bound_sweep_s": bound_of_sweep,
        "over_bound": {name: seconds / bound_of_sweep for name, seconds in parts.items()},
        "bound_s": traffic / sweep_bytes * bound_of_sweep,
        "memory_mb": largest_memory(),
    }


def mean_over_sweeps(timed: Any, name: str) -> float:
    """Mean of what was found at each instant, each for the sweeps that are nearest to it."""
    made = np.array([part["sweeps"] for part in timed.sweep_parts])
    between = 0.5 * (made[1:] + made[:-1])
    weights = np.diff([0.0, *between, timed.sweeps])
    return np.average([part[name] for part in timed.sweep_parts], weights=weights)
