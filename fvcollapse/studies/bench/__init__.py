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
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fvcollapse.case.case import Case
from fvcollapse.console.bars import tqdm
from fvcollapse.errors import InputError, NumericalError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.studies.bench.case_list import (
    cases,
    effect_cases,
    shortened,
    until,
    without_effect,
)
from fvcollapse.studies.bench.report import growth, table
from fvcollapse.studies.estimate import duration, run_seconds
from fvcollapse.studies.sweep import sweep
from fvcollapse.studies.workers import Resources
from fvcollapse.version import __version__

COMPILATION = 92.0  # s; of all kernels, as `runs/bench` has measured it

__all__ = ["run_bench", "run_member", "table"]


def run_member(case: Case) -> dict:
    """Figures of one case from a new process, with the wall time of that process but for its second, timed run."""
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    code = (
        "import sys, json; from fvcollapse.studies.bench.measured import member; "
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
    figures = json.loads(done.stdout)
    elapsed = time.perf_counter() - start
    return figures | {"command_s": elapsed - figures.pop("timed_again_s")}


def compile_times() -> dict:
    """Wall time of the command on a short coarse case: with nothing compiled, and with all on the disk, s."""
    case = shortened(Case().replace(**{"effects.lateral_friction": {}}))
    with tempfile.TemporaryDirectory() as folder:
        cold, *warm = (time_command(case, Path(folder), number) for number in range(4))
    run_member(case)  # the cases that follow find everything compiled
    return {"cold_s": cold, "warm_s": min(warm)}


def time_command(case: Case, folder: Path, number: int) -> float:
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


def refuse_failure(done: Any) -> None:
    """Raise what made a process of the benchmark fail."""
    if done.returncode != 0:
        reason = done.stderr.strip().splitlines()[-1:] or [f"exit status {done.returncode}"]
        raise NumericalError(f"a case of the benchmark failed: {reason[0]}")


def sweep_case() -> Case:
    """The case of the sweep of 8 runs, but for its slope."""
    return Case().replace(**{"grid.cell_size": 0.006, "time.end": 2.0, "time.field_interval": 2.0})


def sweep_times() -> dict:
    """Wall time of a sweep of 8 runs on 6 mm cells with one and with two processes, s, and their ratio."""
    case = sweep_case()
    slopes = {"geometry.slope_angle_deg": [15.0 + number for number in range(8)]}
    seconds = {}
    for workers in (1, 2):
        with tempfile.TemporaryDirectory() as folder:
            start = time.perf_counter()
            sweep(case, slopes, Path(folder) / "sweep", Resources(workers))
            seconds[workers] = time.perf_counter() - start
    return {
        "one_core_s": seconds[1],
        "two_cores_s": seconds[2],
        "ratio": seconds[1] / seconds[2],
    }


def cost(chosen: Mapping[str, Case], effects: bool = False, all_of_them: bool = False) -> str:
    """How many cases are run, and how long that takes with all that is measured beside them."""
    seconds = sum(2.0 * run_seconds(case) for case in chosen.values())  # a second, timed run each
    seconds += 0.0 if effects else COMPILATION
    seconds += 12.0 * run_seconds(sweep_case()) if all_of_them else 0.0  # 8 on one core, 4 on two
    cases = "1 case" if len(chosen) == 1 else f"{len(chosen)} cases"
    return f"{cases}, about {duration(seconds)}; where nothing is compiled yet, a minute more"


def machine() -> dict:
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


def run_bench(
    names: Sequence[str] = (),
    path: str | Path | None = None,
    quiet: bool = False,
    effects: bool = False,
    end: float | None = None,
    finest: bool = False,
) -> dict:
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
            raise InputError("command line", "NAME", name, "one of " + ", ".join(known))
    if effects:
        pairs = [(without_effect(name), name) for name in names or known]
        chosen = {name: known[name] for pair in pairs for name in pair}
    else:
        chosen = {name: known[name] for name in names or cases(finest)}
    if not quiet:
        print(cost(chosen, effects, not (effects or names)), file=sys.stderr, flush=True)
    if effects:
        return run_effects(chosen, path, quiet)
    report: dict[str, Any] = {"machine": machine(), "compilation": compile_times(), "cases": []}
    for name, case in tqdm(chosen.items(), disable=quiet or None, unit="case"):
        report["cases"].append({"name": name} | run_member(case))
        report["growth"] = growth(report["cases"])
        save(report, path)
    if not names:
        report["sweep_of_8"] = sweep_times()
        save(report, path)
    return report


def run_effects(chosen: dict, path: str | Path | None, quiet: bool) -> dict:
    """The report of the effects."""
    report: dict[str, Any] = {"machine": machine(), "cases": []}
    for name, case in tqdm(chosen.items(), disable=quiet or None, unit="case"):
        run_member(shortened(case))  # its kernels are compiled
        row = {"name": name} | run_member(case)
        loops = {each["name"]: each["wall_s"] for each in [*report["cases"], row]}
        report["cases"].append(row | {"cost_factor": row["wall_s"] / loops[without_effect(name)]})
        save(report, path)
    return report


def save(report: dict, path: str | Path | None) -> None:
    """Write the report as JSON, if a path is given."""
    if path is not None:
        write_atomic(path, json.dumps(report, indent=1).encode() + b"\n")
