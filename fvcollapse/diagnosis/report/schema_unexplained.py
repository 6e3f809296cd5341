"""Parts of a report: what no hypothesis explains, and how large the gap is in practice."""

from fvcollapse.diagnosis.report.parts import Part, Range
from fvcollapse.diagnosis.report.schema_gap import Region


class Practical(Part):
    """Size of what no re-calibration explains of one observable, in its units, beside what it is compared with.

    Attributes
    ----------
    gap, beyond : float
        Root mean square, and the part of it beyond the noise of measurement and grid.
    share : float
        beyond^2 / gap^2.
    uncertainty : float
        Combined standard uncertainty, root mean square.
    controls : float or None
        Standard deviation of the error of the model that the controls leave open.
    codes : float or None
        What two codes for the same equations differ by; None where that was not measured.
    is_larger : bool
        Whether `beyond` is larger than an honest error of the model: `controls`, without controls `codes`.
    """

    gap: float
    beyond: float
    share: float
    uncertainty: float
    units: str
    controls: float | None
    codes: float | None
    is_larger: bool


class PlaceShare(Part):
    """Part of the remainder in one place of the pile and one phase.

    `direction` from -1 to 1: +1 where the simulated grains move too easily, -1 where not easily enough, 0 where the
    observable does not say it.
    """

    place: str
    phase: str
    share: float
    direction: float


class RemainderSize(Part):
    """Remainder of one observable in its significant regions: rms, mean of simulated - measured, and rms in sd."""

    rms: float
    mean: float
    deviations: float
    units: str


class Likeness(Part):
    """An effect that resembles the remainder, although it does not explain it.

    Attributes
    ----------
    cosine : float
        Between the whitened remainder, its sign turned, and the whitened response: -1 acts the other way.
    strength : float
        Strength that is needed over the largest that is plausible; 0 where the cosine is negative.
    worse : list of str
        Observables that the effect would make worse.
    """

    effect: str
    cosine: float
    strength: float
    worse: list[str]


class Unexplained(Part):
    """The part of the gap that no hypothesis explains.

    Attributes
    ----------
    beside : str
        Hypothesis whose response has been taken off; "none": the whole gap.
    p_value : float
        Predictive check of what is left.
    regions : list of Region
        Significant ones of what is left.
    shares : list of PlaceShare
        The largest first.
    sizes : dict
        Observable -> `RemainderSize`.
    direction : float
        As that of a `PlaceShare`, of everything.
    experiment : str
        That which has most of it.
    t_range, span : (float, float) or None
        Times of its regions there, and all that were compared [s].
    resembles : list of Likeness
    words : str
        Place, time, direction and what would have to change, in a sentence.
    """

    beside: str
    p_value: float
    regions: list[Region]
    shares: list[PlaceShare]
    sizes: dict[str, RemainderSize]
    direction: float
    experiment: str
    t_range: Range | None
    span: Range | None
    resembles: list[Likeness]
    words: str = ""
