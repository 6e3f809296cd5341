"""The same case at several values of one numerical parameter: runs, observables, their convergence.

Each axis has its own meaning of "refinement size":

- `cell_size`: the root of the cell area, as the grid really has it (the gate is a grid line). A
  `cell_size_z` in the case is scaled along. The time step is left to its own limits, so where they
  follow the cells, space and time are refined together.
- `time_step`: the mean step that was taken, because shorter limits (motion of the surface, gate)
  may hold for part of a run; "not refined" where the longest step was not what limited. The index
  is then one of the time step at a fixed grid.
- `shear_rate_min`: the value itself. Order and extrapolation belong to the limit of vanishing
  regularisation, at a fixed grid.
- `tolerance`: none. The error left by an iteration is bounded by the tolerance but is no power of
  it: only differences are given.

The formal order of every other axis is 1: of the cell size, because the surface is of first order
and the longest time step does not shrink with the cell; of the time step, because the implicit
solve is; of the regularisation, because a layer at rest creeps in proportion to it. Four values or
more are also fitted all together (`fvcollapse.studies.least_squares`).
"""

import csv
import io
import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from fvcollapse.errors import CaseError, InputError, NumericalError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.files.targets import make_folder
from fvcollapse.output.question import Latitude, case_question, claim_folder
from fvcollapse.output.result import open_result
from fvcollapse.studies.convergence import (
    convergence,
    convergence_of_profiles,
    oscillating_share,
    profile_distance,
    spread,
    successive,
)
from fvcollapse.studies.least_squares import fit
from fvcollapse.studies.members import run_member, run_members
from fvcollapse.studies.refinement_axes import AXES
from fvcollapse.studies.workers import HERE, refuse_workers

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.output.result import Result
    from fvcollapse.studies.workers import Resources


NAME = "converge"  # of the files of the report
OBSERVABLES = {  # keys of the summary, and their units
    "runout_10mm": "m",
    "runout": "m",
    "runout_1mm": "m",
    "x_99": "m",
    "final_thickness": "m",
    "peak_front_velocity": "m/s",
    "arrest_time": "s",
}
FORMAL_ORDER = 1.0
PROFILE = "profile_l1"
UNITS = OBSERVABLES | {PROFILE: "1"}
MEMBERS = "members.csv"
SAME_VALUE = 1.0e-9  # relative


# -- the members ---------------------------------------------------------------------------------


def checked_values(axis: str, values: Sequence[float]) -> list[float]:
    """The values from coarse to fine; at least three, positive, all different.

    Raises
    ------
    InputError
    """
    option = f"--{axis.replace('_', '-')}"

    def refuse(found, allowed):
        raise InputError("command line", option, found, allowed)

    for value in values:
        if not (math.isfinite(value) and value > 0.0):
            refuse(f"{value:g}", "positive numbers")
    if len(values) < 3:
        refuse(f"{len(values)} of them", "at least three values")
    ordered = sorted(values, reverse=True)
    for coarse, fine in zip(ordered, ordered[1:], strict=False):
        if coarse <= fine * (1.0 + SAME_VALUE):
            refuse(f"{fine:g} twice", "different values")
    return ordered


def member_case(case: "Case", axis: str, value: float, source: str | Path = "case") -> "Case":
    """The case at one value of an axis; `source` is the file that errors name.

    Raises
    ------
    CaseError
        The value is out of the range of the key.
    """
    changes = {AXES[axis].key: value}
    if axis == "cell_size" and case.grid.cell_size_z is not None:
        changes["grid.cell_size_z"] = case.grid.cell_size_z * value / case.grid.cell_size
    try:
        return case.replace(**changes)
    except CaseError as error:
        origin = f"{source} with --{axis.replace('_', '-')} {value:g}"
        raise CaseError(origin, error.key, error.found, error.allowed) from None


def member_keys(axis: str) -> tuple[str, ...]:
    """Keys of the case that differ between the members."""
    return (AXES[axis].key, "grid.cell_size_z") if axis == "cell_size" else (AXES[axis].key,)


# -- the study -----------------------------------------------------------------------------------


class Series(NamedTuple):
    """The members of a study: a case at the values (three or more) of an axis (one of `AXES`).

    `source` is the name of the case in errors.
    """

    case: "Case"
    axis: str
    values: tuple
    source: str = "case"


def refine(
    series: Series,
    folder: str | Path,
    resources: "Resources" = HERE,
    tell: Callable[[str], object] = print,
    force: bool = False,
) -> dict[str, dict]:
    """Run a case at several values of one numerical parameter and measure its convergence.

    Parameters
    ----------
    series : Series
    folder : str or Path
        Each member is run into `<axis>_<value>` inside; finished members are read, not run.
    resources : Resources
        Processes of this machine.
    tell : function
        Called with a line of text after each member.
    force : bool
        Take the folder over from another study; see `question`.

    Returns
    -------
    dict of dict
        {observable: record}, see `record`, of the members that finished. `members.csv` in the folder
        says how each ended.

    Raises
    ------
    InputError, OutputError
        Before anything runs.
    NumericalError
        Fewer than three members finish.
    """
    refuse_workers(resources.workers)
    case, axis, values, source = series
    folder, ordered = Path(folder), checked_values(axis, values)
    cases = {
        folder / f"{axis}_{value:.12g}": member_case(case, axis, value, source) for value in ordered
    }
    asked = case_question(case, without=member_keys(axis)) | {"axis": axis, "values": ordered}
    claim_folder(folder, "converge", asked, force, Latitude(growing=("values",)))
    make_folder(folder, *(f"{NAME}.{suffix}" for suffix in ("json", "csv", "png")))
    run = partial(run_member, force=True) if force else run_member
    failures: dict[Path, Exception] = {}
    width = min(resources.workers, len(cases))
    run_members(cases, width, resources.quiet, run, tell, failed=failures.__setitem__)
    write_members(folder / MEMBERS, axis, dict(zip(ordered, cases, strict=True)), failures)
    for member, error in failures.items():
        tell(f"{member}: failed: {error}")
    done = {
        value: member
        for value, member in zip(ordered, cases, strict=True)
        if member not in failures
    }
    if len(done) < 3:
        what = f"{len(failures)} of {len(cases)} members failed, three must finish"
        raise NumericalError(f"{what}; the last: {list(failures.values())[-1]}")
    return study(axis, list(done), [open_result(member) for member in done.values()])


def write_members(
    path: Path, axis: str, members: Mapping[float, Path], failures: Mapping[Path, Exception]
) -> None:
    """Write how each member ended: its value, status (complete, failed) and the problem, as CSV.

    Parameters
    ----------
    path : Path
    axis : str
    members : dict
        {value: folder}.
    failures : dict
        {folder: NumericalError}.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([axis, "status", "problem"])
    for value, folder in members.items():
        problem = failures.get(folder, "")
        writer.writerow([value, "failed" if problem else "complete", problem])
    write_atomic(path, text.getvalue().encode())


def study(axis: str, values: list[float], results: "list[Result]") -> dict[str, dict]:
    """{observable: record} of finished runs, from coarse to fine."""
    size = AXES[axis].size
    sizes = None if size is None else [size(result) for result in results]
    summaries = [result.summary() for result in results]
    measured = {name: [summary[name] for summary in summaries] for name in OBSERVABLES}
    records = {name: record(axis, values, sizes, of) for name, of in measured.items()}
    records[PROFILE] = record_of_profiles(axis, values, sizes, results)
    return {name: {"unit": UNITS[name]} | of for name, of in records.items()}


def record(axis: str, values: list[float], sizes: list[float] | None, measured: list) -> dict:
    """All numbers of one observable, ready for JSON.

    Lists run from coarse to fine. `order`, `extrapolated`, `gci` and the further numbers at the top
    belong to the finest three; `triplets` holds the same of every three neighbours, each with its
    values of the axis; `least_squares` is the fit to all values, null for fewer than four.
    """
    triplets = successive(convergence, sizes, measured, FORMAL_ORDER)
    fitted = fit(sizes, measured)
    return {
        axis: values,
        "value": measured,
        "refinement_size": sizes,
        "spread": spread(measured),
        "least_squares": None if fitted is None else fitted._asdict(),
    } | of_triplets(axis, values, [outcome._asdict() for outcome in triplets])


def record_of_profiles(
    axis: str, values: list[float], sizes: list[float] | None, results: "list[Result]"
) -> dict:
    """The same for the final profiles, whose differences are L1 distances over the area.

    `value` is the distance of each profile to the next finer one, null for the finest; `spread` the
    largest distance to the finest; `oscillating` the share of the points of the profile that
    oscillate among the three.
    """
    profiles = [(result.profiles.x, result.profiles.thickness[-1]) for result in results]
    triplets = successive(convergence_of_profiles, sizes, profiles, FORMAL_ORDER)
    outcomes = [
        outcome._asdict() | {"oscillating": oscillating_share(profiles[n : n + 3])}
        for n, outcome in enumerate(triplets)
    ]
    pairs = zip(profiles, profiles[1:], strict=False)
    return {
        axis: values,
        "value": [*(profile_distance(*coarse, *fine) for coarse, fine in pairs), None],
        "refinement_size": sizes,
        "spread": max(profile_distance(*profile, *profiles[-1]) for profile in profiles),
        "least_squares": None,
    } | of_triplets(axis, values, outcomes)


def of_triplets(axis: str, values: list[float], outcomes: list[dict]) -> dict:
    """The outcome of the finest three, and those of every three with their values of the axis."""
    triplets = [{axis: values[n : n + 3]} | of for n, of in enumerate(outcomes)]
    return outcomes[-1] | {"triplets": triplets}
