"""How answers and recommendations did in the sealed checks, in words; the numbers are those of `sealed_scores.json`.

`python -m runs.sealed_scores` writes the file from the tables of the checks.
"""

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from fvcollapse.diagnosis.report.words import number, percent

if TYPE_CHECKING:
    from fvcollapse.diagnosis.report.schema import Report

PATH = Path(__file__).parent / "sealed_scores.json"


class WayScores(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Number of sealed cases; shares whose most probable cause was right, and that were wrong with more than 90 %."""

    cases: int
    first_right: float
    confident_errors: float


class NextScores(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Number of cases in which a next experiment was made, and drops of the entropy [bit].

    `ahead` is the 95 % interval of what the recommended experiment gained more than one drawn at random.
    """

    cases: int
    expected: float
    gained: float
    ahead: tuple[float, float]

    @property
    def margin(self) -> float:
        """What the expected gain missed the real one by [bit]: expected gains closer than this are equal."""
        return abs(self.expected - self.gained)


class SealedScores(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The content of `sealed_scores.json`."""

    alone: WayScores
    controls: WayScores
    next: NextScores


@cache
def sealed_scores() -> SealedScores:
    """The scores that the package ships."""
    return msgspec.json.decode(PATH.read_bytes(), type=SealedScores)


def right_words(report: "Report") -> str:
    """How often answers of the verdict layer were right, alone or with controls as here, one sentence."""
    scores = sealed_scores()
    has_controls = bool(report.details.expected)
    own = scores.controls if has_controls else scores.alone
    kind = "with" if has_controls else "without"
    text = (
        f"In {own.cases} sealed cases {kind} controls the most probable cause was right in {percent(own.first_right)}; "
        f"{percent(own.confident_errors)} of all answers were wrong and claimed more than 90 %"
    )
    if has_controls:
        return f"{text}."
    right, wrong = scores.controls.first_right, scores.controls.confident_errors
    return f"{text} (with controls in {percent(right)} and {percent(wrong)}: bring controls)."


def gain_words() -> str:
    """What became of expected gains, as the end of a sentence."""
    scores = sealed_scores().next
    return (
        f"in {scores.cases} sealed cases the plan expected {number(scores.expected, 2)} bit and "
        f"{number(scores.gained, 1)} bit came, {more_than_chance()} of an experiment drawn at random"
    )


def worth_words() -> str:
    """What recommended experiments told, beside others, one sentence."""
    return (
        f"In {sealed_scores().next.cases} sealed cases a recommended experiment told {more_than_chance()} one drawn "
        "at random."
    )


def more_than_chance() -> str:
    """Whether recommended experiments told more than others."""
    return "more than" if sealed_scores().next.ahead[0] > 0.0 else "not measurably more than"
