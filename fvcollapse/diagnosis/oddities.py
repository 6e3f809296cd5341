"""What is odd about the experiments themselves, said before anything is computed and again in the report."""

import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING

import msgspec

from fvcollapse.measure.plausibility import oddities

if TYPE_CHECKING:
    from fvcollapse.diagnosis.question import Question
    from fvcollapse.measure.experiment import Experiment


COMMAND_LINE = "command line"  # in place of a file


class Oddity(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A number of an experiment that no gap should be explained with before it is checked.

    Attributes
    ----------
    experiment, file, key : str
        Name of the experiment, name of the file in its folder, key or column.
    found, expected : str
        With units.
    likely : str
        The convention that would explain it, as a question; "" if none does.
    """

    experiment: str
    file: str
    key: str
    found: str
    expected: str
    likely: str = ""

    def line(self) -> str:
        """One line."""
        end = f"; {self.likely}" if self.likely else ""
        between = ": " if self.file == COMMAND_LINE else "/"
        place = f"{self.experiment}{between}{self.file}: {self.key}"
        return f"{place}: found {self.found}; expected: {self.expected}{end}"


def oddities_of(experiments: "Iterable[Experiment]") -> list[Oddity]:
    """The `Oddity` list of some experiments."""
    return [
        Oddity(one.name, each.file, each.key, each.found, each.allowed, each.likely)
        for one in experiments
        for each in oddities(one)
    ]


def coarse_grid(question: "Question") -> list[Oddity]:
    """The `Oddity` list of the cells of a `Question` that are too coarse for calibrated probabilities."""
    return [
        Oddity(
            name,
            COMMAND_LINE,
            "--cell-size",
            f"{question.cases[name].grid.cell_size:g} m",
            f"at most {size:.3g} m, with which the verdict layer was fitted; on coarser cells probabilities are not "
            "calibrated and the grid may hide the cause",
        )
        for name, size in question.coarse_cells.items()
    ]


def tell(warnings: Iterable[Oddity]) -> None:
    """Write each `Oddity` as one line to stderr."""
    for each in warnings:
        print(f"warning: {' '.join(each.line().split())}", file=sys.stderr)
