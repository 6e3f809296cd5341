"""What a diagnosis found, as one tree of plain values: the content of `report.json`.

The keys of `Report` up to `cost` are a stable interface; `details` holds what the page and the
figures need beyond it. Numbers are SI. A list may hold gaps (NaN or infinite: null in the file); a
single number may be absent (None) where its type says so, and is never NaN or infinite.
"""

import json
import math
import os
from pathlib import Path
from typing import Literal

import msgspec
import numpy as np

from fvcollapse.case.grammar import read_text
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.diagnosis.oddities import Oddity
from fvcollapse.errors import FvcollapseError, InputError
from fvcollapse.files.atomic import write_atomic

FORMAT = "fvcollapse-report"
FORMAT_VERSION = 1
FILE_NAME = "report.json"
SUM_TOLERANCE = 1.0e-6
DIGITS = 6  # significant digits of an array in the file

# The models that are compared: as given, re-calibrated, with the first and with the second effect.
BASELINE, RECALIBRATED, WINNER, RUNNER_UP = "baseline", "recalibrated", "winner", "runner_up"
RUNGS = {BASELINE: "G0", RECALIBRATED: "G1", WINNER: "G2", RUNNER_UP: "G2'"}

Numbers = list[float | None]
Range = tuple[float, float]


class ReportError(FvcollapseError):
    """A report that contradicts itself; nothing is written."""


class Part(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Base of all parts of a report."""


# -- where ---------------------------------------------------------------------------------------


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


# -- which ---------------------------------------------------------------------------------------


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
    """Prior of a parameter, as `fvcollapse.effects.catalogue.Prior`."""

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


class Hypothesis(Part):
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


# -- how far -------------------------------------------------------------------------------------


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
    """Fractions closed in one experiment that was left out (or held out) of the calibration."""

    experiment: str
    winner: float
    runner_up: float | None
    held_out: bool = False


class Confirmation(Part):
    """How strong the wording may be, and why."""

    wording: Literal["confirmed", "consistent with", "not confirmed"]
    reasons: list[str]
    folds: list[Fold] = []


class NextExperiment(Part):
    """The measurement or set-up that would best separate what is left.

    Attributes
    ----------
    description : str
        In words, with numbers and units.
    separates : list of str
    expected_gain : float
        Expected drop of the entropy of the probabilities [bit].
    set_up : dict
        Key -> value of the case.
    repeats : int or None
        Number of such experiments for a log Bayes factor of 5.
    """

    description: str
    separates: list[str]
    expected_gain: float
    units: str = "bit"
    set_up: dict[str, float] = {}
    repeats: int | None = None


class Cost(Part):
    """What it took; `cached_runs` of the `solver_runs` were found done."""

    solver_runs: int
    wall_time_s: float
    cell_size: float
    cached_runs: int = 0


# -- what the page shows beyond the stable keys ----------------------------------------------------


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


class Share(Part):
    """Part of the squared gap that one observable has in one phase of one experiment.

    `sign` +1: the simulation is above the measurement there on average, -1: below.
    """

    experiment: str
    observable: str
    phase: str
    share: float
    sign: int


class Details(Part):
    """Everything that the page shows and that is no stable key.

    Attributes
    ----------
    set_ups : dict
        Experiment -> `SetUp`, fitted and held out.
    expected : dict
        Observable -> root mean square of the gap that the controls let expect, which is taken off, in its
        units; empty without controls.
    comparisons : list of Comparison
    shares : list of Share
    budget : dict
        Observable -> source of uncertainty -> root mean square standard deviation in its units.
    grains : list of str
        What is wrong with the mass balance of the measured profiles, one sentence each.
    hypotheses : dict
        Name -> `Hypothesis`, "none" and "unknown" among them.
    separability : Separability or None
    ladder : list of Rung
    confirmation : Confirmation or None
        None where no effect is named.
    alternatives : list of NextExperiment
        What else was considered, the best first.
    limits : list of str
        What this diagnosis cannot say; one sentence each.
    """

    set_ups: dict[str, SetUp] = {}
    expected: dict[str, float] = {}
    comparisons: list[Comparison] = []
    shares: list[Share] = []
    budget: dict[str, dict[str, float]] = {}
    grains: list[str] = []
    hypotheses: dict[str, Hypothesis] = {}
    separability: Separability | None = None
    ladder: list[Rung] = []
    confirmation: Confirmation | None = None
    alternatives: list[NextExperiment] = []
    limits: list[str] = []


class Report(Part, kw_only=True):
    """The result of a diagnosis.

    Attributes
    ----------
    experiments, held_out : list of str
        Names of the experiments that were fitted, and of those that were not.
    baseline_case : str
        Resolved case of the baseline (TOML).
    where : list of Region
        The significant ones.
    by_observable : dict
        Observable -> `ObservableGap`.
    verdict : Verdict
    candidates : dict
        Effect -> `Candidate`.
    reduction : Reductions or None
        None where no effect is named.
    next_experiment : NextExperiment or None
        None where nothing is left to separate.
    cost : Cost
    warnings : list of Oddity
        What is odd about the experiments themselves, controls and held-out ones included.
    details : Details
    """

    format: Literal["fvcollapse-report"] = FORMAT
    format_version: Literal[1] = FORMAT_VERSION
    experiments: list[str]
    held_out: list[str]
    baseline_case: str
    where: list[Region]
    by_observable: dict[str, ObservableGap]
    verdict: Verdict
    candidates: dict[str, Candidate]
    reduction: Reductions | None
    next_experiment: NextExperiment | None
    cost: Cost
    warnings: list[Oddity] = []
    details: Details = Details()


# -- writing and reading -------------------------------------------------------------------------


def to_json(report):
    """The report as the text of `report.json`.

    Raises
    ------
    ReportError
        It contradicts itself, or holds a value that JSON has not.
    """
    tree = msgspec.to_builtins(report, enc_hook=plain)
    tree = without_nan(tree, "")
    try:
        checked = msgspec.convert(tree, Report)
    except msgspec.ValidationError as error:
        raise ReportError(f"report: {error}") from None
    for key, problem in contradictions(checked):
        raise ReportError(f"report: {key}: {problem}")
    return json.dumps(tree, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def write_report(report, folder):
    """Put `report.json` into a folder; its path.

    Raises
    ------
    ReportError, OutputError
    """
    path = Path(folder) / FILE_NAME
    write_atomic(path, to_json(report).encode())
    return path


def read_report(path):
    """The report in a file (or in `report.json` of a folder).

    Raises
    ------
    InputError
        No report, or one that contradicts itself.
    """
    path = Path(path)
    path = path / FILE_NAME if os.path.isdir(path) else path
    text = read_text(path, "JSON")
    try:
        report = msgspec.json.decode(text, type=Report)
    except (msgspec.MsgspecError, RecursionError) as error:
        allowed = f"a {FORMAT} of version {FORMAT_VERSION}"
        raise InputError(path, "file", str(error), allowed) from None
    for key, problem in contradictions(report):
        raise InputError(path, key, problem, "a report that agrees with itself")
    return report


def plain(value):
    """Arrays and numpy numbers as lists and numbers of Python; arrays to `DIGITS` digits."""
    if isinstance(value, np.ndarray):
        return rounded(value.tolist())
    if isinstance(value, np.generic):
        return value.item()
    raise ReportError(f"report: a {type(value).__name__} is no value of a report")


def rounded(value):
    """Nested lists with their floats rounded to `DIGITS` significant digits."""
    if isinstance(value, list):
        return [rounded(item) for item in value]
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value


def without_nan(value, key):
    """The tree with None for what is not finite in a list; elsewhere that is an error."""
    if isinstance(value, dict):
        return {name: without_nan(item, f"{key}.{name}".strip(".")) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [
            None if missing(item) else without_nan(item, f"{key}[{n}]")
            for n, item in enumerate(value)
        ]
    if missing(value):
        raise ReportError(f"report: {key}: {value} is no finite number")
    return value


def missing(value):
    """Whether a value is NaN or infinite."""
    return isinstance(value, float) and not math.isfinite(value)


# -- agreement -----------------------------------------------------------------------------------


def contradictions(report):
    """(key, problem) of everything in a report that does not agree with the rest."""
    yield from verdict_contradictions(report)
    yield from candidate_contradictions(report)
    yield from where_contradictions(report)
    yield from comparison_contradictions(report)
    yield from separability_contradictions(report.details.separability)
    yield from ladder_contradictions(report)


def verdict_contradictions(report):
    """Probabilities that are none, and effects that the kind does not allow."""
    verdict = report.verdict
    values = verdict.probability.values()
    if any(not 0.0 <= value <= 1.0 for value in values):
        yield "verdict.probability", "a number outside 0..1"
    if abs(math.fsum(values) - 1.0) > SUM_TOLERANCE:
        yield "verdict.probability", f"a sum of {math.fsum(values):.8g} instead of 1"
    for name in (NONE, UNKNOWN):
        if name not in verdict.probability:
            yield "verdict.probability", f"no {name!r}"
    if (verdict.kind in (NONE, UNKNOWN)) != (not verdict.effects):
        yield "verdict.effects", f"{verdict.effects} for the verdict {verdict.kind!r}"
    for name in verdict.set:
        if name not in verdict.probability:
            yield "verdict.set", f"{name!r}, which has no probability"
    known = {part for name in verdict.probability for part in name.split("+")}
    for name in [*verdict.effects, *(one for group in verdict.indistinguishable for one in group)]:
        if name not in known:
            yield "verdict.effects", f"{name!r}, which has no probability"


def candidate_contradictions(report):
    """Candidates whose probability is not that of the verdict."""
    for name, candidate in report.candidates.items():
        stated = report.verdict.probability.get(name)
        if stated is None or abs(stated - candidate.probability) > SUM_TOLERANCE:
            yield f"candidates.{name}.probability", f"{candidate.probability:g} beside {stated}"
    for name in report.verdict.probability:
        if name not in report.candidates and name not in (NONE, UNKNOWN) and "+" not in name:
            yield "candidates", f"no {name!r}, which has a probability"


def where_contradictions(report):
    """Regions of an experiment that is not compared, and ranges that run backwards."""
    compared = {*report.experiments, *report.held_out}
    for n, region in enumerate(report.where):
        if region.experiment not in compared:
            yield f"where[{n}]", f"the experiment {region.experiment!r}, not compared"
        for span in (region.t_range, region.x_range):
            if span is not None and span[0] > span[1]:
                yield f"where[{n}]", f"the range {span}"
    for name in set(report.experiments) & set(report.held_out):
        yield "held_out", f"{name!r}, which was fitted as well"


def comparison_contradictions(report):
    """Columns of unequal length, models without a name, regions that do not exist."""
    compared = {*report.experiments, *report.held_out}
    for n, one in enumerate(report.details.comparisons):
        key, size = f"details.comparisons[{n}]", len(one.measured)
        columns = [one.sigma, one.combined, *one.simulated.values(), *one.z.values()]
        columns += [column for column in (one.time, one.x) if column is not None]
        columns += [column for column in (one.region, one.phase) if column]
        if any(len(column) != size for column in columns):
            yield key, "columns of unequal length"
        if one.experiment not in compared:
            yield key, f"the experiment {one.experiment!r}, not compared"
        for model in {*one.simulated, *one.z} - set(RUNGS):
            yield key, f"the model {model!r}"
        if any(index is not None and index >= len(report.where) for index in one.region):
            yield key, "a region that does not exist"


def separability_contradictions(separability):
    """Matrices that are not k x k, classes that are no partition."""
    if separability is None:
        return
    k = len(separability.names)
    for name in ("cosine", "distance_squared"):
        matrix = getattr(separability, name)
        if len(matrix) != k or any(len(row) != k for row in matrix):
            yield f"details.separability.{name}", f"no {k} x {k} matrix"
    if len(separability.unique_snr) != k:
        yield "details.separability.unique_snr", f"{len(separability.unique_snr)} values for {k}"
    members = sorted(name for one in separability.classes for name in one)
    if members != sorted(separability.names):
        yield "details.separability.classes", "classes that do not hold every effect once"


def ladder_contradictions(report):
    """Models without a name, and held-out values where nothing was held out."""
    for n, rung in enumerate(report.details.ladder):
        if rung.model not in RUNGS:
            yield f"details.ladder[{n}].model", repr(rung.model)
        if rung.held_out is not None and not report.held_out:
            yield f"details.ladder[{n}].held_out", "values although no experiment was held out"
    reduction = report.reduction
    if reduction is not None and reduction.held_out is not None and not report.held_out:
        yield "reduction.held_out", "values although no experiment was held out"
    confirmation = report.details.confirmation
    if confirmation is not None and confirmation.wording == "confirmed" and not report.held_out:
        yield "details.confirmation", "'confirmed' although no experiment was held out"
