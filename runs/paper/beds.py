"""The beds under which the statements are read, and what is run on each.

The paper writes that grains slide on the bed with mu_b = mu_1. The experiments have a bed of glued beads, which holds
the lowest grains: no slip, with and without the friction of thin layers.
"""

import math
from typing import NamedTuple

from fvcollapse.case.case import Case
from fvcollapse.errors import CaseError
from runs.paper.cases import GROUPS

FINER = "finer"  # group of the grids that statements ask for
SLIDES, ROUGH, ROUGH_THIN = "", "rough", "rough_thin_layer"
NO_SLIP = {"boundary.mu_bed": math.inf}
BEDS = {  # folder below that of the tables: settings that a bed adds
    SLIDES: {},
    ROUGH: NO_SLIP,
    ROUGH_THIN: NO_SLIP | {"effects.thin_layer": {"length": 1.65}},
}
WORDS = {
    SLIDES: "grains slide",
    ROUGH: "rough bed",
    ROUGH_THIN: "rough bed, thin_layer",
}
ON_A_ROUGH_BED = {  # group: names of its cases start with; the rest is about the bed, or the grid
    "lateral_friction": "muI",
    "viscosity": "eta",
    "older_closure": "older",
    "double_counting": "mu38_a",
    "back_wall": "back",
}
KEPT_ON_A_ROUGH_BED = ("fronts", "peak", "velocity")  # what statements read


class Run(NamedTuple):
    """One case on one bed and one grid."""

    bed: str
    group: str
    name: str
    member: object
    refinement: float
    case: Case


def groups_on(bed):
    """{group: {name: Member}} of what is run on a bed."""
    if bed == SLIDES:
        return GROUPS
    return {
        group: {
            name: on_bed(member, bed)
            for name, member in GROUPS[group].items()
            if name.startswith(start)
        }
        for group, start in ON_A_ROUGH_BED.items()
        if group in GROUPS
    }


def on_bed(member, bed):
    """A member on a rough bed, on two grids, with what statements read of it."""
    return member._replace(
        settings=member.settings | BEDS[bed],
        refinements=member.refinements[:2],
        keep=tuple(name for name in member.keep if name in KEPT_ON_A_ROUGH_BED),
    )


def parts():
    """Names of all groups on all beds, as folders of tables: `<group>` or `<bed>/<group>`."""
    return [part_name(bed, group) for bed in BEDS for group in groups_on(bed)]


def part_name(bed, group):
    """Folder of the tables of a group on a bed."""
    return f"{bed}/{group}".removeprefix("/")


def runs(wanted, cell_size):
    """All runs of some parts: {folder below --out: Run}.

    Parameters
    ----------
    wanted : sequence of str
        Parts; others than `parts()` are passed over.
    cell_size : float
        [m]

    Raises
    ------
    CaseError
        The cell size is out of range.
    """
    found = {}
    for bed in BEDS:
        for group, members in groups_on(bed).items():
            if part_name(bed, group) in wanted:
                for name, member in members.items():
                    for refinement in member.refinements:
                        add(found, Run(bed, group, name, member, refinement, None), cell_size)
    return found


def finer_runs(keys, cell_size):
    """Runs of further grids, {folder below --out: Run} of the group `finer`, from (bed, name, refinement)."""
    found = {}
    for bed, name, refinement in keys:
        members = {of: member for group in groups_on(bed).values() for of, member in group.items()}
        add(found, Run(bed, FINER, name, members[name], refinement, None), cell_size)
    return found


def add(found, run, cell_size):
    """Add a run, with its case, under its folder."""
    at = part_name(run.bed, run_name(run.name, cell_size, run.refinement))
    assert at not in found, f"{at} is listed twice"
    found[at] = run._replace(case=member_case(run.name, run.member, cell_size, run.refinement))


def member_case(name, member, cell_size, refinement):
    """The `Case` of a member at one refinement.

    Raises
    ------
    CaseError
        The cell size is out of range.
    """
    try:
        return Case().replace(**member.settings, **{"grid.cell_size": cell_size / refinement})
    except CaseError as error:
        raise CaseError(f"{name} at --cell-size {cell_size:g}", *error.args[1:]) from None


def run_name(name, cell_size, refinement):
    """Name of the folder of one run: the case and its cells."""
    return f"{name}_{1e3 * cell_size / refinement:.4g}mm"
