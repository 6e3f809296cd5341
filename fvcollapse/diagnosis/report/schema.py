"""The result of a diagnosis as one tree of plain values: the content of `report.json`.

The keys of `Report` up to `cost` are a stable interface; `details` holds what the page and the
figures need beyond it. Numbers are SI. A list may hold gaps (NaN or infinite: null in the file); a
single number may be absent (None) where its type says so, and is never NaN or infinite.
"""

from typing import TYPE_CHECKING, Final, Literal

from fvcollapse.diagnosis.oddities import Oddity
from fvcollapse.diagnosis.report.parts import Part
from fvcollapse.diagnosis.report.schema_cause import (
    Candidate,
    HypothesisSummary,
    Parameter,
    PriorRange,
    Separability,
    Verdict,
)
from fvcollapse.diagnosis.report.schema_gap import Comparison, ObservableGap, Region, SetUp, Share
from fvcollapse.diagnosis.report.schema_origin import Assumption, Made, RunGroup
from fvcollapse.diagnosis.report.schema_reduction import (
    Closed,
    Confirmation,
    Fold,
    Misfit,
    Reduction,
    Reductions,
    Rung,
)
from fvcollapse.diagnosis.report.schema_unexplained import (
    Likeness,
    PlaceShare,
    Practical,
    RemainderSize,
    Unexplained,
)
from fvcollapse.diagnosis.report.shown import answer_table, arrays_of, draw_probabilities

if TYPE_CHECKING:
    import xarray

    from fvcollapse.draw.drawing import Picture

__all__ = [
    "Assumption",
    "Candidate",
    "Closed",
    "Comparison",
    "Confirmation",
    "Cost",
    "Details",
    "Fold",
    "HypothesisSummary",
    "Likeness",
    "Made",
    "Misfit",
    "NextExperiment",
    "PartialAnswer",
    "ObservableGap",
    "Parameter",
    "PlaceShare",
    "Practical",
    "PriorRange",
    "Reduction",
    "Reductions",
    "Region",
    "RemainderSize",
    "Report",
    "RunGroup",
    "Rung",
    "Separability",
    "SetUp",
    "Share",
    "Unexplained",
    "Verdict",
]
FORMAT: Final = "fvcollapse-report"
FORMAT_VERSION: Final = 1


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
        Number of such experiments for a log Bayes factor of 5, as the plan expects it; the page does not show it.
    case : str
        Of the best one only, else empty: case file (TOML) of the first set-up that was not measured yet.
    """

    description: str
    separates: list[str]
    expected_gain: float
    units: str = "bit"
    set_up: dict[str, float] = {}
    repeats: int | None = None
    case: str = ""


class Cost(Part):
    """What it took; `cached_runs` of the `solver_runs` were reused from the cache."""

    solver_runs: int
    wall_time_s: float
    cell_size: float
    cached_runs: int = 0


class PartialAnswer(Part):
    """The answer after some of the experiments, in the order in which they were given."""

    experiments: list[str]
    verdict: Verdict


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
    practical : dict
        Observable -> `Practical`: how large the gap is beside the errors that a model may honestly have.
    unexplained : Unexplained or None
        What no hypothesis explains; None where one cause is named, or where the open ones leave nothing significant.
    grains : list of str
        What is wrong with the mass balance of the measured profiles, one sentence each.
    sequence : list of PartialAnswer
        After the first experiment, the first two, …; the answer to all is not among them.
    shared_physics : dict
        Effect that the controls show in all experiments alike -> its share; see `diagnosis.shared_physics`.
    hypotheses : dict
        Name -> `HypothesisSummary`, "none" and "unknown" among them.
    temperature : float or None
        What logarithms of evidences are divided by; None where the verdict layer judges, or where it is not recorded.
    separability : Separability or None
    ladder : list of Rung
    confirmation : Confirmation or None
        None where no effect is named.
    alternatives : list of NextExperiment
        What else was considered, the best first.
    coarse_cells : dict
        Experiment -> largest cell size [m] that the verdict layer was fitted with, where the cells are coarser.
    assumed : list of Assumption
        What the experiments do not state.
    runs : list of RunGroup
    made : Made or None
    limits : list of str
        What this diagnosis cannot say; one sentence each.
    """

    set_ups: dict[str, SetUp] = {}
    expected: dict[str, float] = {}
    comparisons: list[Comparison] = []
    shares: list[Share] = []
    budget: dict[str, dict[str, float]] = {}
    practical: dict[str, Practical] = {}
    unexplained: Unexplained | None = None
    grains: list[str] = []
    sequence: list[PartialAnswer] = []
    shared_physics: dict[str, float] = {}
    hypotheses: dict[str, HypothesisSummary] = {}
    temperature: float | None = None
    separability: Separability | None = None
    ladder: list[Rung] = []
    confirmation: Confirmation | None = None
    alternatives: list[NextExperiment] = []
    coarse_cells: dict[str, float] = {}
    assumed: list[Assumption] = []
    runs: list[RunGroup] = []
    made: Made | None = None
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

    def plot(self) -> "Picture":
        """Probabilities of the first causes as a figure, which a notebook shows."""
        return draw_probabilities(self)

    def to_xarray(self) -> "xarray.DataTree":
        """Measured and simulated values as labelled arrays with units, one group for each curve.

        Raises
        ------
        ImportError
            xarray is not installed.
        """
        return arrays_of(self)

    def _repr_html_(self) -> str:
        return answer_table(self)
