"""What can be refined, and how fine a result is; `refinement` says what each size means."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from fvcollapse.step.grid import spacing

if TYPE_CHECKING:
    from fvcollapse.output.result import Result


def cell_root(result: "Result") -> float:
    """Root of the area of a cell [m], with the sizes that the grid really has."""
    return math.sqrt(math.prod(spacing(result.case)))


def mean_step(result: "Result") -> float:
    """Mean time step that was taken [s]."""
    return float(result.series["time"][-1] / max(1, len(result.steps["dt"])))


def shear_rate_min(result: "Result") -> float:
    """Shear rate of the regularisation [1/s]."""
    return result.case.numerics.shear_rate_min


class Axis(NamedTuple):
    """What is refined: key of the case, unit, and refinement size of a result (None: no order)."""

    key: str
    unit: str
    size: Callable[["Result"], float] | None


AXES = {
    "cell_size": Axis("grid.cell_size", "m", cell_root),
    "time_step": Axis("time.step_max", "s", mean_step),
    "shear_rate_min": Axis("numerics.shear_rate_min", "1/s", shear_rate_min),
    "tolerance": Axis("numerics.tolerance", "1", None),
}
