"""What a check of plausibility says, and the scales of a collapse that it judges by."""

from math import radians, sqrt
from typing import TYPE_CHECKING, NamedTuple

from fvcollapse.case.case import GRAVITY

if TYPE_CHECKING:
    from fvcollapse.measure.experiment import Experiment


ERROR, WARNING = "error", "warning"
UNITS = {"mm": 1000.0, "cm": 100.0, "dm": 10.0}  # in a metre
NEAR_UNIT = 2.0  # a ratio within this factor of a unit is taken for it; between two units it is not
BACK_WALL = "X counted from the gate instead of from the back wall?"
CLOCK = 0.01  # s; standard deviation of the clock of a camera, as the effect `time_origin` has it


class Finding(NamedTuple):
    """A measured or stated value that is impossible (`ERROR`) or merely odd (`WARNING`).

    Attributes
    ----------
    severity : str
    file : str
        Name in the folder of the experiment.
    key : str
        Key of `experiment.toml`, or column of a CSV file.
    found, allowed : str
        With units.
    likely : str
        The convention that would explain it, as a question; "" if none does.
    """

    severity: str
    file: str
    key: str
    found: str
    allowed: str
    likely: str = ""

    @property
    def expected(self) -> str:
        """What is allowed, and the likely convention."""
        return f"{self.allowed}; {self.likely}" if self.likely else self.allowed


class Scales(NamedTuple):
    """Scales of a collapse: height, length [m], slope [rad], fall time sqrt(height / g) [s], speed [m/s]."""

    height: float
    length: float
    slope: float
    time: float
    speed: float


def scales_of(experiment: "Experiment") -> Scales:
    """The `Scales` of an experiment."""
    geometry = experiment.settings.geometry
    height = geometry.height_0
    slope = radians(geometry.slope_angle_deg)
    return Scales(height, geometry.length_0, slope, sqrt(height / GRAVITY), sqrt(GRAVITY * height))


def unit_words(ratio: float) -> str:
    """The unit that a ratio of found to expected length suggests, as a question; "" if none."""
    for unit, factor in UNITS.items():
        if factor / NEAR_UNIT < ratio < factor * NEAR_UNIT:
            return f"in {unit} instead of m?"
        if factor / NEAR_UNIT < 1.0 / max(ratio, 1.0e-300) < factor * NEAR_UNIT:
            return f"the column of experiment.toml in {unit} instead of m?"
    return ""
