"""What labels, evidence, answers and scores are as the plain values that JSON holds, for hints.

What a file of others must hold is checked by the forms of the same names in `forms` and `evidence_file`.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NotRequired, TypedDict

Force = dict[str, Any]  # a `kind` of `outside.FORCES`, and its numbers
Reading = dict[str, Any]  # a `kind` of `outside.READINGS`, and its numbers
Keys = dict[str, float | str]  # of a table `[effects.<name>]`


# -- labels ------------------------------------------------------------------------------------------------


class Outside(TypedDict, total=False):
    """A cause outside the catalogue: what it adds to every run; see `outside.UNKNOWNS`."""

    forces: list[Force]
    readings: list[Reading]
    polygon: list[list[float]]
    channel_end: float


class Run(TypedDict):
    """One run: the TOML text of its truth, forces, wrong readings, and the seed of its noise.

    Where the hidden effects act by another closure: `without`, the truth without them, and the `form` of the response.
    """

    case: str
    forces: list[Force]
    readings: list[Reading]
    noise: int
    without: NotRequired[str]
    form: NotRequired["Form"]


class Form(TypedDict):
    """Form of the response to effects that act by another closure; see `other_closure.draw_form`."""

    share: float
    waves: list[list[float]]
    phases: list[float]


class Drawn(TypedDict):
    """One effect that is hidden: number of its closure, its keys, and {parameter: quantile of the prior}."""

    closure: int
    section: Keys
    quantiles: dict[str, float]


class World(TypedDict):
    """What all experiments of a laboratory have in common; see `worlds.draw_world`."""

    name: str
    strength: str
    kinds: list[str]
    effects: dict[str, Keys]
    forces: list[Force]
    readings: list[Reading]
    material: dict[str, float]
    numerics: dict[str, float]
    statement: str
    quality: float
    common: dict[str, float]
    set_ups: list[str]
    controls: NotRequired[dict[str, Run]]  # once they are drawn, see `generator.drawn_world`


class Label(TypedDict):
    """What is hidden in a case; see `generator.draw_label`."""

    cause: str
    unknown_kind: str | None
    effects: dict[str, Drawn]
    form: Form | None
    outside: Outside
    world: World
    experiments: dict[str, Run]


class Entry(TypedDict):
    """A label with its salt, the seeds of its draw, and how often it was drawn again."""

    salt: str
    seed: int
    world_seed: int
    attempt: int
    label: Label


class Plan(TypedDict):
    """A file of labels."""

    format: str
    format_version: int
    solver: str
    cases: dict[str, Entry]


# -- evidence ----------------------------------------------------------------------------------------------


class Simple(TypedDict):
    """Statistics of the simple rules: {hypothesis: (chi-square, p-value)}, and cosines of the signatures."""

    chi_square: Mapping[str, Sequence[float]]
    signature: dict[str, float]


class Levels(TypedDict):
    """Quantiles of the levels (m, d) of a closure, and their columns (m,); see `separation`."""

    levels: list[list[float]]
    columns: list[int]


class Separation(TypedDict):
    """See `separation.separation_of`."""

    closures: dict[str, list[Levels]]
    products: list[list[float]]


class Content(TypedDict):
    """A file of evidence; see `evidence_file.content_of`."""

    format: str
    solver: str
    experiments: list[str]
    hypotheses: dict[str, dict[str, Any]]
    mass_balance: list[Any] | None
    left: dict[str, Any] | None
    classes: list[list[str]]
    separation: Separation
    simple: Simple


# -- answers and scores ------------------------------------------------------------------------------------


class Interval(TypedDict):
    """A parameter with its interval of 90 %."""

    value: float
    low: float
    high: float


class Left(TypedDict, total=False):
    """What winner and runner-up leave of the gap of one experiment held out, in standard deviations."""

    winner_left: float | None
    runner_up_left: float | None


class Reduction(Left):
    """Parts of the gap that are closed; `winner` where an experiment was held out, and what both leave of its gap."""

    predicted: float | None
    actual: float | None
    runner_up: float | None
    winner: NotRequired[float | None]


class Answer(TypedDict):
    """The answer to one case; see `score.score`."""

    verdict: str
    probability: dict[str, float]
    set: NotRequired[list[str]]
    parameters: NotRequired[dict[str, dict[str, Interval]]]
    reduction: NotRequired[Reduction]


class Planned(TypedDict):
    """One set-up that could be measured next; see `next_plan.plan_of`."""

    changes: dict[str, float]
    words: str
    expected_gain: float
    separates: list[str]


class NextPlan(TypedDict):
    """What the diagnosis of the first experiment of a case recommends; see `next_plan.plan_of`."""

    first: Answer
    leading: list[str]
    candidates: dict[str, Planned]
    recommended: str | None
    random: str | None


class Added(TypedDict):
    """One next experiment, and the answer to it and the first; None: it could not be filmed or compared."""

    words: str
    expected_gain: float
    separates: list[str]
    answer: Answer | None


class NextAnswer(TypedDict):
    """The entry of a case in the answers to next experiments; see `next_answers.together`."""

    first: Answer
    leading: list[str]
    added: dict[str, Added]
    recommended: str | None
    random: str | None


class Average(TypedDict):
    """A mean over n cases with its interval of 95 %; None where there are no cases."""

    value: float | None
    low: float | None
    high: float | None
    n: int
