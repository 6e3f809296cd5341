"""The cases of the model as given, on the coarser and on the finer grid."""

from collections.abc import Sequence
from math import ceil, sqrt
from typing import TYPE_CHECKING

from fvcollapse.case.case import GRAVITY
from fvcollapse.errors import InputError

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.case.sections import Geometry
    from fvcollapse.measure.experiment import Experiment

# cells of the coarser grid, in the height and in the length of the column at least
CELLS, CELLS_LENGTH = 12, 6
LEAST_CELLS = 5  # in both, of a cell size that is asked for
REFINEMENT = 0.75  # cell size of the finer grid over that of the coarser
LONGEST_STEP = 0.034  # of the coarser grid, in sqrt(height_0 / g): 4 ms for a column of 14 cm
END_MARGIN, END_STEP = 0.02, 0.5  # s; ends are rounded up, so that similar films share their runs
ARREST = 2.5  # s; least end of a run whose state of rest was measured


def baseline_cases(
    experiments: "Sequence[Experiment]", case: "Case | None" = None, cell_size: float | None = None
) -> "dict[str, Case]":
    """{name: Case} of the experiments on the coarser grid, without any effect but those of `case`.

    Raises
    ------
    InputError
        Cells too large for columns that are a little smaller than stated.
    """
    cases = {}
    for experiment in experiments:
        own = experiment.case(case)
        geometry = own.geometry
        largest = min(geometry.height_0, geometry.length_0) / LEAST_CELLS
        if cell_size is not None and not 0.0 < cell_size <= largest:
            allowed = f"> 0 and <= {largest:g}, a fifth of the column of {experiment.name}"
            raise InputError("command line", "--cell-size", f"{cell_size:g}", allowed)
        size = cell_size or usual_cell_size(geometry)
        changes = {"grid.cell_size": size, "time.end": run_end(experiment)}
        if own.time.step_max is None:
            changes["time.step_max"] = LONGEST_STEP * sqrt(geometry.height_0 / GRAVITY)
        cases[experiment.name] = own.replace(**changes)
    return cases


def usual_cell_size(geometry: "Geometry") -> float:
    """Cell size of the coarser grid where none is asked for, with which the verdict layer was fitted [m]."""
    return min(geometry.height_0 / CELLS, geometry.length_0 / CELLS_LENGTH)


def run_end(experiment: "Experiment") -> float:
    """End of the runs of an experiment [s]."""
    end = END_STEP * ceil((experiment.time_end + END_MARGIN) / END_STEP)
    return max(end, ARREST) if experiment.scalars else end


def refined(case: "Case") -> "Case":
    """The case on the finer grid, with steps half as long."""
    grid = case.grid
    changes = {
        "grid.cell_size": REFINEMENT * grid.cell_size,
        "time.step_max": 0.5 * case.time.step_max,  # type: ignore[operator]
    }
    if grid.cell_size_z is not None:
        changes["grid.cell_size_z"] = REFINEMENT * grid.cell_size_z
    return case.replace(**changes)
