"""A convergence study in one call: runs, report in a folder, table and figure."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from fvcollapse.case.case import Case
from fvcollapse.draw.html import html_table
from fvcollapse.studies.refinement import Series, refine
from fvcollapse.studies.refinement_report import label, table, write_report
from fvcollapse.studies.workers import HERE, Resources

if TYPE_CHECKING:
    from fvcollapse.draw.drawing import Picture


class Study(NamedTuple):
    """A convergence study.

    Attributes
    ----------
    case : Case
    axis : str
        What was refined, one of `refinement.AXES`.
    records : dict
        Observable -> record, as `converge.json` has it.
    """

    case: Case
    axis: str
    records: dict

    def table(self) -> str:
        """The study as aligned plain text."""
        return table(self.records, self.axis, self.case)

    def plot(self) -> "Picture":
        """Value against refinement size for each observable, which a notebook shows."""
        from fvcollapse.studies.refinement_figure import draw  # loads matplotlib

        return draw(
            self.records, self.axis, {name: label(name, self.case) for name in self.records}
        )

    def _repr_html_(self) -> str:
        header = ("", *(f"{value:g}" for value in next(iter(self.records.values()))[self.axis]))
        header += ("behaviour", "order", "extrapolated", "index")
        rows = [
            (
                f"{label(name, self.case)} ({record['unit']})",
                *map(digits, record["value"]),
                record["behaviour"],
                digits(record["order"]),
                digits(record["extrapolated"]),
                digits(record["gci"]),
            )
            for name, record in self.records.items()
        ]
        return html_table(f"convergence in {self.axis}", rows, header)


def digits(value: float | None) -> str:
    """A number in four digits; a dash for none."""
    return "-" if value is None else f"{value:.4g}"


def silent(line: str) -> None:
    """Say nothing."""


def converge(
    case: Case,
    values: Sequence[float],
    folder: str | Path,
    axis: str = "cell_size",
    resources: Resources = HERE,
    tell: Callable[[str], object] = silent,
) -> Study:
    """Run a case at several values of one numerical parameter and measure its convergence.

    Parameters
    ----------
    case : Case
    values : sequence of float
        Three or more, SI units.
    folder : str or Path
        Gets a folder for each run, `converge.json`, `.csv` and `.png`. Finished runs are read, not run.
    axis : str
        "cell_size", "time_step", "shear_rate_min" or "tolerance".
    resources : Resources
        Processes of this machine.
    tell : function
        Called with a line of text after each run.

    Returns
    -------
    Study

    Raises
    ------
    InputError, OutputError
        Before anything runs.
    NumericalError
        Fewer than three runs finish.
    """
    records = refine(Series(case, axis, tuple(values)), folder, resources, tell)
    write_report(records, axis, case, Path(folder))
    return Study(case, axis, records)
