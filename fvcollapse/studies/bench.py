"""What a run costs: fixed cases, each in a process of its own, against the bound set by memory traffic.

The bound of a run: in every nonlinear sweep each unknown and each coefficient of the assembled
operator is read once and each unknown written once, at the bandwidth of a triad on arrays of the
same total size (in the cache where those fit). No sweep can be faster; how many sweeps a step takes
is not in the bound.
"""

import json
import math
import os
import platform
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from tqdm import tqdm

from fvcollapse.case.case import Case, case_from_text
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import PHYSICAL
from fvcollapse.errors import InputError, NumericalError
from fvcollapse.files.storage import write_atomic
from fvcollapse.output.run import run_case
from fvcollapse.simulation import Simulation
from fvcollapse.step import coupled
from fvcollapse.step.advance import STAGES, balance_of_step
from fvcollapse.step.banded import allocate_system, factorise, solve_factorised
from fvcollapse.step.compiled import kernel_jit
from fvcollapse.studies.sweep import sweep
from fvcollapse.version import __version__

SLOPES = {22: 2.0, 0: 1.0}  # deg: time simulated, s
WIDTHS = {"w10cm": 0.10, "winf": float("inf")}
SIZES = (0.012, 0.006, 0.003)  # m
FINEST = 0.0015  # m; minutes each, on demand
TERMS = {
    "move_surface": "surface",
    "carry_momentum": "momentum advection",
    "place": "geometry",
    "solve": "implicit solve",
    "book_energy": "energy budget",
    "continue_velocity": "continuation of the velocity",
}
NO_EFFECT = "no_effect"
SAMPLES = 20  # instants at which the parts of a sweep are timed
REPEATS = 3
GROWTH_FROM = 0.006  # m; the growth of the cost with refinement begins here


def cases(finest=False):
    """The cases by name; the mass is released at once, as in the code that they are compared with."""
    return {
        f"{slope}deg_{width}_{1e3 * size:g}mm": Case().replace(
            **{
                "geometry.slope_angle_deg": float(slope),
                "geometry.channel_width": value,
                "effects.lateral_friction": {},
                "gate.speed": math.inf,
                "grid.cell_size": size,
                "time.end": end,
                "time.field_interval": end,
            }
        )
        for slope, end in SLOPES.items()
        for width, value in WIDTHS.items()
        for size in (*SIZES, *([FINEST] if finest else []))
    }


def effect_cases():
    """The collapse at 22 deg, 10 cm and 6 mm without any effect, then with each that changes the flow.

    Every parameter has the median of its prior; of several variants the default one is taken.
    """
    base = cases()["22deg_w10cm_6mm"].replace(
        **{"effects.lateral_friction": None, "gate.speed": Case().gate.speed}
    )
    with_each = {
        name: base.replace(**{f"effects.{name}": effect.keys(0.5)})
        for name, effect in CATALOGUE.items()
        if effect.kind == PHYSICAL
    }
    return {NO_EFFECT: base} | with_each


# ---------------------------------------------------------------- within the process of one case


class Clock:
    """Wall time of the stages of a step, in `seconds`; `read` returns the present time, s."""

    def __init__(self, read=time.perf_counter):
        self.read, self.seconds = read, dict.fromkeys(TERMS, 0.0)

    def stages(self):
        """The stages of a step, which add their wall time to `seconds`."""
        return STAGES._replace(**{name: self.timed(name) for name in TERMS})

    def timed(self, name):
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

    def __init__(self, case, state=None):
        clock = Clock()
        super().__init__(case, state, clock.stages())
        self.seconds = clock.seconds = dict.fromkeys(TERMS, 0.0)  # of the steps, without the start
        self.sweeps = self.unknowns = self.cells = self.steps = 0
        self.began = self.ended = self.probing = 0.0
        self.sweep_parts = []

    def advance(self, time_limit):
        """One step, counted."""
        self.began = self.began or time.perf_counter()
        record = super().advance(time_limit)
        cells = np.count_nonzero(self.geometry.filled)
        self.sweeps += record.sweeps
        self.unknowns += record.sweeps * (self.ends.size + cells)
        self.cells += cells
        self.steps += 1
        if self.state.time >= self.case.time.end * (len(self.sweep_parts) + 0.5) / SAMPLES:
            start = time.perf_counter()
            self.sweep_parts.append(time_sweep(self) | {"sweeps": self.sweeps})
            self.probing += time.perf_counter() - start
        self.ended = time.perf_counter()
        return record


def time_sweep(simulation):
    """Time of the parts of one sweep of the present state, s, and its size; the state stays as it is."""
    state, geometry, work = simulation.state.copy(), simulation.geometry, simulation.work
    band, rhs = allocate_system(simulation.ends)
    balance, spacing = balance_of_step(simulation, state.dt), simulation.spacing
    fields = state.u, state.w, state.pressure_filled

    def coefficients():
        coupled.coefficients(
            work, *fields, state.bed_slip, geometry, simulation.material, balance, *spacing
        )

    def assemble():
        coupled.assemble(
            band,
            rhs,
            simulation.ends,
            work,
            state.pressure_filled,
            state.u,
            state.w,
            geometry,
            balance,
            *spacing,
        )

    parts = {"coefficients": best(coefficients), "assembly": best(assemble)}
    coefficients_read = np.count_nonzero(band)
    both = best(lambda: (assemble(), factorise(band, simulation.ends)))
    parts["factorisation"] = both - parts["assembly"]
    parts["substitution"] = best(lambda: solve_factorised(rhs, band, simulation.ends))
    unknowns = simulation.ends.size + np.count_nonzero(geometry.filled)
    return parts | {"unknowns": unknowns, "coefficients_read": coefficients_read}


def best(work, repeats=REPEATS):
    """Shortest of a few wall times, s."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


@kernel_jit()
def triad(a, b, c):
    """Set a = b + 2 c."""
    for i in range(a.size):
        a[i] = b[i] + 2.0 * c[i]


def bandwidth(total_bytes):
    """Bytes per second of a triad whose three arrays have this size together."""
    a, b, c = np.zeros((3, max(int(total_bytes) // 24, 1)))
    loops = max(1, int(2e7 // (24 * a.size)))

    def work():
        for _ in range(loops):
            triad(a, b, c)

    triad(a, b, c)
    return loops * 24 * a.size / best(work)


def member(case_text):
    """Run one case as the command line does and return its figures; for a process of its own."""
    case, made = case_from_text(case_text), []

    def simulate(*arguments):
        made.append(TimedSimulation(*arguments))
        return made[-1]

    with tempfile.TemporaryDirectory() as folder:
        run_case(case, Path(folder) / "run", quiet=True, simulate=simulate)
    (timed,) = made
    return figures(timed)


def figures(timed):
    """The row of one case; the loop begins with the first step and ends with the last."""
    sizes = {name: mean_over_sweeps(timed, name) for name in ("unknowns", "coefficients_read")}
    sweep_bytes = 8.0 * (2.0 * sizes["unknowns"] + sizes["coefficients_read"])
    bound_of_sweep = sweep_bytes / bandwidth(sweep_bytes)
    parts = {name: mean_over_sweeps(timed, name) for name in PARTS}
    traffic = sweep_bytes * timed.unknowns / sizes["unknowns"]
    wall = timed.ended - timed.began - timed.probing
    share = {TERMS[name]: seconds / wall for name, seconds in timed.seconds.items()}
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
        "memory_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
    }


def mean_over_sweeps(timed, name):
    """Mean of what was found at each instant, each for the sweeps that are nearest to it."""
    made = np.array([part["sweeps"] for part in timed.sweep_parts])
    between = 0.5 * (made[1:] + made[:-1])
    weights = np.diff([0.0, *between, timed.sweeps])
    return np.average([part[name] for part in timed.sweep_parts], weights=weights)


PARTS = ("coefficients", "assembly", "factorisation", "substitution")


# ---------------------------------------------------------------- from outside


def run_member(case):
    """Figures of one case from a new process, with the wall time of that process."""
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    code = (
        "import sys, json; from fvcollapse.studies.bench import member; "
        "json.dump(member(sys.stdin.read()), sys.stdout)"
    )
    start = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", code],
        input=case.to_toml(),
        capture_output=True,
        text=True,
        env=environment,
    )
    refuse_failure(done)
    return json.loads(done.stdout) | {"command_s": time.perf_counter() - start}


def compile_times():
    """Wall time of the command on a short coarse case: with nothing compiled, and with all on the disk, s."""
    case = shortened(Case().replace(**{"effects.lateral_friction": {}}))
    with tempfile.TemporaryDirectory() as folder:
        cold, *warm = (time_command(case, Path(folder), number) for number in range(4))
    run_member(case)  # the cases that follow find everything compiled
    return {"cold_s": cold, "warm_s": min(warm)}


def time_command(case, folder, number):
    """Wall time of `fvcollapse run` with the compiled kernels kept in a folder, s; `number` names its result."""
    write_atomic(folder / "case.toml", case.to_toml().encode())
    command = [sys.executable, "-m", "fvcollapse", "run", str(folder / "case.toml"), "--quiet"]
    start = time.perf_counter()
    done = subprocess.run(
        [*command, "--out", str(folder / f"run{number}")],
        capture_output=True,
        text=True,
        env=os.environ | {"NUMBA_CACHE_DIR": str(folder / "compiled")},
    )
    refuse_failure(done)
    return time.perf_counter() - start


def refuse_failure(done):
    """Raise what made a process of the benchmark fail."""
    if done.returncode != 0:
        reason = done.stderr.strip().splitlines()[-1:] or [f"exit status {done.returncode}"]
        raise NumericalError(f"a case of the benchmark failed: {reason[0]}")


def shortened(case):
    """A short coarse run that calls the kernels of a case."""
    return until(case.replace(**{"grid.cell_size": 0.03}), 0.05)


def sweep_times():
    """Wall time of a sweep of 8 runs on 6 mm cells with one and with two processes, s, and their ratio."""
    case = Case().replace(**{"grid.cell_size": 0.006, "time.end": 2.0, "time.field_interval": 2.0})
    slopes = {"geometry.slope_angle_deg": [15.0 + number for number in range(8)]}
    seconds = {}
    for workers in (1, 2):
        with tempfile.TemporaryDirectory() as folder:
            start = time.perf_counter()
            sweep(case, slopes, Path(folder) / "sweep", workers=workers, quiet=True)
            seconds[workers] = time.perf_counter() - start
    return {
        "one_core_s": seconds[1],
        "two_cores_s": seconds[2],
        "ratio": seconds[1] / seconds[2],
    }


def machine():
    """What the figures were measured on."""
    model = platform.processor()
    info = Path("/proc/cpuinfo")
    if info.exists():
        lines = info.read_text().splitlines()
        model = next((line.split(":")[1].strip() for line in lines if "model name" in line), model)
    return {
        "processor": model,
        "cores": os.cpu_count(),
        "system": platform.platform(),
        "python": platform.python_version(),
        "fvcollapse": __version__,
    }


def run_bench(names=(), path=None, quiet=False, effects=False, end=None, finest=False):
    """Measure cases and compilation; rewrite the report at `path` (JSON) after every case.

    With `effects` the cases are those of `effect_cases` and nothing else is measured; each has a
    `cost_factor`, its time loop over that without any effect.

    Parameters
    ----------
    names : list of str
        Of `cases(finest=True)` or of the effects; without any, all but the finest grid.
    path : Path, optional
    quiet : bool
        No progress bar.
    end : float, optional
        The collapses are cut short at this time, s: what a step costs on the finest grid needs no whole one.
    finest : bool
        Without names, the cases on the finest grid too.

    Returns
    -------
    dict
        machine, compilation (s), cases and, with all of them, the sweep of 8 runs on two cores.

    Raises
    ------
    InputError
        A name that is none of the cases, or an end that is no time.
    """
    if end is not None and not 0.0 < end < math.inf:
        raise InputError("command line", "--end", f"{end:g}", "a time > 0 s")
    known = effect_cases() if effects else cases(finest=True)
    if end is not None:
        known = {name: until(case, end) for name, case in known.items()}
    for name in names:
        if name not in known:
            raise InputError("command line", "case", name, "one of " + ", ".join(known))
    if effects:
        chosen = dict.fromkeys([NO_EFFECT, *(names or known)])
        return run_effects({name: known[name] for name in chosen}, path, quiet)
    chosen = {name: known[name] for name in names or cases(finest)}
    report = {"machine": machine(), "compilation": compile_times(), "cases": []}
    for name, case in tqdm(chosen.items(), disable=quiet or None, unit="case"):
        report["cases"].append({"name": name} | run_member(case))
        report["growth"] = growth(report["cases"])
        save(report, path)
    if not names:
        report["sweep_of_8"] = sweep_times()
        save(report, path)
    return report


def until(case, end):
    """The case cut short at a time, s."""
    end = min(end, case.time.end)
    return case.replace(**{"time.end": end, "time.field_interval": end})


def run_effects(chosen, path, quiet):
    """The report of the effects."""
    report = {"machine": machine(), "cases": []}
    for name, case in tqdm(chosen.items(), disable=quiet or None, unit="case"):
        run_member(shortened(case))  # its kernels are compiled
        row = {"name": name} | run_member(case)
        first = report["cases"][0] if report["cases"] else row
        report["cases"].append(row | {"cost_factor": row["wall_s"] / first["wall_s"]})
        save(report, path)
    return report


def growth(rows):
    """How the cost of a cell and step grows from 6 mm cells on, per slope and width: fitted exponent, total ratio.

    The exponent n is that of cost ~ (1/cell size)^n, by least squares over all sizes that were run.
    """
    families = {}
    for row in rows:
        if row["cell_size"] <= GROWTH_FROM:
            families.setdefault(row["name"].rpartition("_")[0], []).append(row)
    found = {}
    for name, members in families.items():
        if len(members) > 1:
            size = np.log([row["cell_size"] for row in members])
            cost = np.log([row["us_per_cell_and_step"] for row in members])
            finest, coarsest = np.argmin(size), np.argmax(size)
            found[name] = {
                "exponent": -float(np.polyfit(size, cost, 1)[0]),
                "ratio": float(np.exp(cost[finest] - cost[coarsest])),
                "cell_size": [float(np.exp(size[coarsest])), float(np.exp(size[finest]))],
            }
    return found


def save(report, path):
    """Write the report as JSON, if a path is given."""
    if path is not None:
        write_atomic(path, json.dumps(report, indent=1).encode() + b"\n")


def table(report):
    """The report as aligned plain text."""
    names = [
        "case",
        "to s",
        "loop s",
        "command s",
        "steps",
        "sweeps",
        "solves",
        "us/cell/step",
        "bound s",
        "MB",
    ]
    factors = all("cost_factor" in row for row in report["cases"])
    rows = [[*names, "cost factor"] if factors else names]
    for row in report["cases"]:
        rows.append(
            [
                row["name"],
                f"{row['end_s']:g}",
                f"{row['wall_s']:.2f}",
                f"{row['command_s']:.2f}",
                str(row["steps"]),
                str(row["sweeps"]),
                str(row["linear_iterations"]),
                f"{row['us_per_cell_and_step']:.2f}",
                f"{row['bound_s']:.3f}",
                f"{row['memory_mb']:.0f}",
                *([f"{row['cost_factor']:.2f}"] if factors else []),
            ]
        )
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = ["  ".join(f"{word:>{w}}" for word, w in zip(row, widths, strict=True)) for row in rows]
    if "compilation" in report:
        cold, warm = (report["compilation"][name] for name in ("cold_s", "warm_s"))
        lines.append(f"\nfirst start {cold:.1f} s, later {warm:.2f} s")
    if "sweep_of_8" in report:
        lines.append(
            f"two cores on a sweep of 8 runs: {report['sweep_of_8']['ratio']:.2f} times one core"
        )
    for name, found in report.get("growth", {}).items():
        coarse, fine = (1e3 * size for size in found["cell_size"])
        lines.append(
            f"{name}: a cell and step cost {found['ratio']:.2f} times as much at {fine:.2g} as at {coarse:.2g} mm; "
            f"exponent {found['exponent']:.2f}"
        )
    for row in report["cases"]:
        parts = ", ".join(f"{part} {ratio:.0f}" for part, ratio in row["over_bound"].items())
        lines.append(f"{row['name']}: parts of a sweep over its bound: {parts}")
        share = sorted(row["share"].items(), key=lambda item: -item[1])
        lines.append(f"{row['name']}: " + ", ".join(f"{term} {100 * s:.0f} %" for term, s in share))
    return "\n".join(lines)
