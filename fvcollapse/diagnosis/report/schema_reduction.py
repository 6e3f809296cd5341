"""Parts of a report: how far the gap shrinks with the effect."""

from typing import Literal

from fvcollapse.diagnosis.names import BASELINE, WINNER
from fvcollapse.diagnosis.report.parts import Part, Range
from fvcollapse.diagnosis.report.schema_cause import Parameter


class Closed(Part):
    """A gap before and after, as far as it is beyond the noise, and the fraction that closed."""

    before: float
    after: float
    fraction_closed: float
    interval: Range | None
    units: str


class Reduction(Part):
    """The reduction over one group of experiments, overall and by observable."""

    overall: Closed
    by_observable: dict[str, Closed]


class Reductions(Part):
    """From true solver runs with the effect added; `held_out` None: there was none.

    `before_model` and `after_model` are keys of `RUNGS`.
    """

    fitted: Reduction
    held_out: Reduction | None
    before_model: str = BASELINE
    after_model: str = WINNER


class Misfit(Part):
    """Gap of one model over one group of experiments.

    Attributes
    ----------
    rms : float
        Root mean square gap in combined standard uncertainties.
    fraction_closed : float or None
        Of the gap of the baseline as given that is beyond the noise; negative: the gap grew.
    interval : (float, float) or None
        Its range over the leave-one-experiment-out values.
    predicted : float or None
        The same fraction as the emulator had predicted it.
    by_experiment : dict
        Experiment -> rms.
    """

    rms: float
    fraction_closed: float | None
    interval: Range | None = None
    predicted: float | None = None
    by_experiment: dict[str, float] = {}


class Rung(Part):
    """A model of the ladder: `model` is a key of `RUNGS`; `calibrated` are its re-fitted keys."""

    model: str
    effects: list[str]
    fitted: Misfit
    held_out: Misfit | None
    parameters: dict[str, Parameter] = {}
    calibrated: dict[str, Parameter] = {}


class Fold(Part):
    """Fractions closed in one experiment that was left out (or held out) of the calibration, and what is left.

    What is left is the root mean square of the gap, noise included, in standard deviations.
    """

    experiment: str
    winner: float
    runner_up: float | None
    held_out: bool = False
    winner_left: float | None = None
    runner_up_left: float | None = None


class Confirmation(Part):
    """How strong the wording may be, and why."""

    wording: Literal["confirmed", "consistent with", "not confirmed"]
    reasons: list[str]
    folds: list[Fold] = []
