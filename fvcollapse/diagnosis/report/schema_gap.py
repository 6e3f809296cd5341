"""Parts of a report: where simulation and measurement differ."""

from typing import Literal

from fvcollapse.diagnosis.report.parts import Numbers, Part, Range


class Region(Part):
    """A significant region of the gap map.

    Attributes
    ----------
    experiment, observable, units : str
    t_range, x_range : (float, float) or None
        [s], [m]; None where the observable has no time or place.
    gap, gap_sd : float
        Mean of simulated - measured in the region and its combined standard uncertainty.
    significance : float
        Largest |gap| in combined standard uncertainties.
    p_value : float or None
        Probability of a cluster as massive anywhere in the maps without a gap (family-wise).
    words : str
        One plain sentence.
    """

    experiment: str
    observable: str
    t_range: Range | None
    x_range: Range | None
    gap: float
    units: str
    significance: float
    gap_sd: float | None = None
    p_value: float | None = None
    words: str = ""


class ObservableGap(Part):
    """Size of the gap of one observable over all fitted experiments, in its units."""

    rms_gap: float
    combined_uncertainty: float
    ratio: float
    units: str
    points: int


class SetUp(Part):
    """An experiment in words and numbers; `channel_width` None: no side walls."""

    title: str
    source: str
    slope_angle_deg: float
    height_0: float
    length_0: float
    channel_width: float | None


class Comparison(Part):
    """One observable of one experiment on its n chosen points: overlays and gap maps.

    Attributes
    ----------
    kind : str
        "value", "upper" or "lower" (then `measured` is a bound).
    time, x : (n,) or None
        [s], [m]; None where the observable has none.
    measured, sigma : (n,)
        `sigma` is the standard deviation of the measurement alone.
    combined : (n,)
        Combined standard uncertainty of the gap.
    simulated, z : dict
        Key of `RUNGS` -> (n,) values, and gaps in combined standard uncertainties.
    region : (n,)
        Index into `where` of the region that a point belongs to; None: in none.
    phase : (n,)
        One of `points.PHASES`; empty: not stated.
    of : int
        Number of points that were measured, n of which are compared; 0: not recorded.
    """

    experiment: str
    observable: str
    units: str
    time: Numbers | None
    x: Numbers | None
    measured: Numbers
    sigma: Numbers
    combined: Numbers
    simulated: dict[str, Numbers]
    z: dict[str, Numbers]
    kind: Literal["value", "upper", "lower"] = "value"
    region: list[int | None] = []
    phase: list[str] = []
    of: int = 0


class Share(Part):
    """Part of the squared gap that one observable has in one phase of one experiment.

    `sign` +1: the simulation is above the measurement there on average, -1: below.
    """

    experiment: str
    observable: str
    phase: str
    share: float
    sign: int
