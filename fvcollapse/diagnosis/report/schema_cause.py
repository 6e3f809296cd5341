"""Parts of a report: which effect explains the gap."""

from typing import Literal

from fvcollapse.diagnosis.report.parts import Numbers, Part


class Verdict(Part):
    """The answer.

    Attributes
    ----------
    kind : str
    effects : list of str
        Names; empty for "none" and "unknown"; all members for "several" and for a pair.
    indistinguishable : list of list of str
        Groups of effects that these data cannot tell apart.
    probability : dict
        Hypothesis (effects, pairs "a+b", "none", "unknown") -> probability; sums to 1.
    set : list of str
        Hypotheses that the conformal test keeps, the most probable first.
    """

    kind: Literal["effect", "several", "none", "unknown"]
    effects: list[str]
    indistinguishable: list[list[str]]
    probability: dict[str, float]
    set: list[str] = []


class PriorRange(Part):
    """Prior of a parameter, as `fvcollapse.effects.effect.Prior`."""

    kind: str
    first: float
    second: float
    grade: str = ""
    source: str = ""
    strong_end: str = "high"


class Parameter(Part):
    """Best value of a parameter, its 90 % interval, and what was known before."""

    value: float
    low: float | None
    high: float | None
    units: str
    prior: PriorRange | None


class Candidate(Part):
    """One effect of the catalogue; `plausible`: its parameters lie inside the 98 % prior range."""

    probability: float
    log_evidence: float | None
    parameters: dict[str, Parameter]
    plausible: bool


class HypothesisSummary(Part):
    """One bar of the evidence figure: an effect, a pair, "none" or "unknown".

    Attributes
    ----------
    log_evidence, log_evidence_wide : float or None
        ln Z, and the same with priors twice as wide.
    conformal_p, predictive_p : float or None
        p-value among simulated cases with this cause; of the remaining gap at the best value.
    like_miscalibration : bool
        It also wins on simulated data without any effect but with parameters off by 1-2 sd.
    absorbed_in : list of str
        Keys of the case whose calibration could have absorbed the effect.
    """

    log_evidence: float | None
    log_evidence_wide: float | None = None
    conformal_p: float | None = None
    predictive_p: float | None = None
    like_miscalibration: bool = False
    absorbed_in: list[str] = []


class Separability(Part):
    """How alike the effects' signatures are after whitening with all uncertainties.

    Attributes
    ----------
    names : list of str
        k effects.
    cosine, distance_squared : (k, k)
        Cosine of the angle between two signatures; 2 x the expected log Bayes factor.
    unique_snr : (k,)
        Norm of what the others cannot imitate.
    threshold : float
        Effects with a distance squared below it are one class.
    classes : list of list of str
        Every effect in exactly one class.
    split_by : dict
        Members joined by ", " -> the measurement that would split the class, in words.
    """

    names: list[str]
    cosine: list[Numbers]
    distance_squared: list[Numbers]
    unique_snr: Numbers
    threshold: float
    classes: list[list[str]]
    split_by: dict[str, str] = {}
