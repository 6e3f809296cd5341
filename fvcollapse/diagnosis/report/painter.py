"""Figures drawn in two processes at once: they take a third of a diagnosis whose runs are at hand."""

from concurrent.futures import BrokenExecutor
from typing import TYPE_CHECKING

from fvcollapse.diagnosis.report.figures import drawn

if TYPE_CHECKING:
    from fvcollapse.diagnosis.report.drawing import Picture
    from fvcollapse.diagnosis.report.schema import Report
    from fvcollapse.studies.standing import StandingWorkers

EVEN, ODD = slice(0, None, 2), slice(1, None, 2)


class Painter:
    """Draws the figures of a report, half of them in another process where there are any.

    That process is started now, to be ready when the report is.

    Parameters
    ----------
    standing : StandingWorkers
    """

    def __init__(self, standing: "StandingWorkers") -> None:
        self.standing = standing
        standing.submit(ready)

    def draw(self, report: "Report", count: int) -> "list[Picture]":
        """The `Picture`s of a report, in order; `count` is their number."""
        future = self.standing.submit(drawn, report, ODD)
        if future is None:
            return drawn(report)
        made: list[Picture] = [None] * count  # type: ignore[list-item]
        made[EVEN] = drawn(report, EVEN)
        try:
            made[ODD] = future.result()
        except BrokenExecutor:  # the process was killed
            made[ODD] = drawn(report, ODD)
        return made


def ready() -> None:
    """Nothing; a process that was asked for it has loaded what it takes to draw."""
