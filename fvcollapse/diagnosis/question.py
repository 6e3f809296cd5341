"""The question of a diagnosis: which experiments, held against which model."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from fvcollapse.case.case import Case
from fvcollapse.diagnosis.baseline import baseline_cases, usual_cell_size
from fvcollapse.diagnosis.point_choice import choose_points

if TYPE_CHECKING:
    from fvcollapse.diagnosis.points import Points
    from fvcollapse.measure.experiment import Experiment

ROUND_OFF = 1.0e-9  # relative


@dataclass(frozen=True)
class Question:
    """What is compared with what; everything that follows from it is computed once.

    Attributes
    ----------
    experiments, held_out, controls : tuple of Experiment
        Those to fit; those that only test the answer; those in which nothing is hidden, which teach
        the discrepancy of the model.
    believed : Case, optional
        The model as it is believed; without it the defaults with the set-up of each experiment, no effects.
    cell_size : float, optional
        Of the coarser of the two grids [m]; default height / 12 (length / 6 if that is less).
    seed : int
        Of all random draws.
    """

    experiments: "tuple[Experiment, ...]"
    held_out: "tuple[Experiment, ...]" = ()
    controls: "tuple[Experiment, ...]" = ()
    believed: Case | None = None
    cell_size: float | None = None
    seed: int = 0

    def check(self) -> None:
        """Refuse an experiment that is given twice, and cells too large for a column.

        Raises
        ------
        InputError
        """
        choose_points((*self.experiments, *self.held_out, *self.controls))
        _ = self.cases, self.held_out_cases

    @property
    def simulated(self) -> "tuple[Experiment, ...]":
        """Experiments whose effects and parameters are varied: those to fit, then the controls."""
        return (*self.experiments, *self.controls)

    @cached_property
    def points(self) -> "Points":
        """`Points` of the experiments to fit."""
        return choose_points(self.experiments)

    @cached_property
    def all_points(self) -> "Points":
        """`Points` of the experiments to fit and of the controls, in this order."""
        return choose_points(self.simulated)

    @cached_property
    def held_out_points(self) -> "Points":
        """`Points` of the experiments held out; there must be one."""
        return choose_points(self.held_out)

    @cached_property
    def cases(self) -> dict[str, Case]:
        """{name: `Case` on the coarser grid} of the experiments to fit and of the controls."""
        return baseline_cases(self.simulated, self.believed, self.cell_size)

    @cached_property
    def held_out_cases(self) -> dict[str, Case]:
        """{name: `Case` on the coarser grid} of the experiments held out."""
        return baseline_cases(self.held_out, self.believed, self.cell_size)

    @cached_property
    def coarse_cells(self) -> dict[str, float]:
        """{experiment: largest cell size [m] of the fitted verdict layer} of those whose cells are larger."""
        usual = {
            one.name: usual_cell_size(self.cases[one.name].geometry) for one in self.experiments
        }
        return {
            name: size
            for name, size in usual.items()
            if self.cases[name].grid.cell_size > size * (1.0 + ROUND_OFF)
        }

    @property
    def baseline(self) -> Case:
        """`Case` of the first experiment: the model as given."""
        return self.cases[self.experiments[0].name]
