"""Names of hypotheses and models, and numbers with units, in plain words."""

import re
import textwrap
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, get_args, get_type_hints

from fvcollapse.case.case import Effects
from fvcollapse.diagnosis.names import BASELINE, NONE, RECALIBRATED, RUNNER_UP, UNKNOWN, WINNER
from fvcollapse.measure.quantities import observable_words, plain_unit

if TYPE_CHECKING:
    from fvcollapse.diagnosis.next_candidates import Candidate
    from fvcollapse.diagnosis.report.schema import Comparison, Report, Verdict

LEAST_PAIR = 0.02  # probability from which further pairs are shown
MINUS, NO_BREAK = "\N{MINUS SIGN}", "\N{NO-BREAK SPACE}"
CENTIMETRES = 100.0  # in a metre: lengths of a page are in cm
# a change of the set-up in words: value in SI units, and the same in cm
CHANGES = {
    "geometry.slope_angle_deg": "at {0:g}\N{DEGREE SIGN}",
    "geometry.channel_width": "in a channel {1:g} cm wide",
    "gate.speed": "with the gate removed as fast as possible",
    "geometry.height_0": "from a column {1:g} cm high",
}
# spaces at which no line may end
UNITS = r"(?:%|sd|s|m|cm|mm|m/s|bit|Pa|kg/m\^?3)(?![\w/])"
BROKEN = re.compile(
    rf"(?<=\d) (?={UNITS})|(?<=\d) (?=±)|(?<=±) (?=\d)|(?<=\bX) (?==)|(?<==) (?=\d)"
)
REST = {NONE: "no missing effect", UNKNOWN: "a cause outside the catalogue"}


def hypothesis_name(name: str) -> str:
    """An effect, a pair, "none" or "unknown" in words."""
    return REST.get(name) or " + ".join(part.replace("_", " ") for part in name.split("+"))


def effect_meaning(name: str) -> str:
    """First line of what the case file says of an effect; of a pair both; empty for the others."""
    sections = get_type_hints(Effects)
    lines = []
    for part in name.split("+"):
        for section in get_args(sections.get(part)):
            if section is not type(None):
                lines.append(section.__doc__.splitlines()[0].rstrip("."))
    return "; ".join(lines)


def model_name(model: str, report: "Report") -> str:
    """A model of the ladder in words."""
    effects = {rung.model: "+".join(sorted(rung.effects)) for rung in report.details.ladder}
    if model == BASELINE:
        return "model as given"
    if model == RECALIBRATED:
        return "model re-calibrated"
    added = effects.get(model) or ("+".join(report.verdict.effects) if model == WINNER else "")
    added = hypothesis_name(added) if added else {RUNNER_UP: "second effect"}.get(model, "effect")
    return f"with {added}, re-calibrated"


def after_model(report: "Report") -> str:
    """The model that the page calls "after": with the effect, else re-calibrated, else as given."""
    simulated = {model for one in report.details.comparisons for model in one.simulated}
    return next((model for model in (WINNER, RECALIBRATED) if model in simulated), BASELINE)


def ranking(report: "Report") -> list[tuple[str, float]]:
    """(hypothesis, probability), the most probable first, of equal ones that with more evidence.

    Of two effects together only the best pair is shown, and others of some probability.
    """

    def rank(item: tuple[str, float]) -> tuple[float, float]:
        stated = report.details.hypotheses.get(item[0])
        known = None if stated is None else stated.log_evidence
        return -item[1], 0.0 if known is None else -known

    ranked = sorted(report.verdict.probability.items(), key=rank)
    first = next((name for name, _ in ranked if "+" in name), None)
    return [
        (name, chance)
        for name, chance in ranked
        if "+" not in name or name == first or chance >= LEAST_PAIR
    ]


def number(value: float | None, digits: int = 3) -> str:
    """A number in `digits` significant digits without an exponent where that is short."""
    if value is None:
        return "\N{EN DASH}"
    text = f"{value:.{digits}g}"
    if "e" in text and 1.0e-4 <= abs(value) < 1.0e6:
        text = f"{value:.0f}" if abs(value) >= 1.0 else f"{value:.6f}".rstrip("0")
    return text.replace("-", MINUS)


def tenths(value: float | None) -> str:
    """A number with one decimal; a dash without one."""
    return "\N{EN DASH}" if value is None else f"{value:.1f}".replace("-", MINUS)


def percent(share: float | None) -> str:
    """A fraction in per cent, without decimals; near 0 and 1 only a bound."""
    if share is None:
        return "\N{EN DASH}"
    if 0.0 < share < 0.005:
        return "<1 %"
    if 0.995 <= share < 1.0:
        return ">99 %"
    whole = round(100.0 * share) + 0  # no minus before a zero
    return f"{whole} %".replace("-", MINUS)


def span(interval: tuple[float, float] | None, show: Callable[[float], str] = number) -> str:
    """An interval in words, or an empty text; a unit that both ends have is written once."""
    if interval is None:
        return ""
    low, high = (show(end) for end in interval)
    return f"{low.removesuffix(' %') if high.endswith(' %') else low} to {high}"


def with_unit(value: float, units: str, digits: int = 3) -> str:
    """A number with its unit; "1" and "-" are none."""
    return f"{number(value, digits)} {plain_unit(units)}".rstrip()


def unbroken(text: str) -> str:
    """Text in which no line break parts a number from its unit or its uncertainty."""
    return BROKEN.sub(NO_BREAK, text)


def wrapped(text: str, width: int) -> str:
    """A line of the answer in lines of a terminal, the further ones indented."""
    filled = textwrap.fill(unbroken(text), width, subsequent_indent="  ")
    return filled.replace(NO_BREAK, " ")


def in_cm(metres: float) -> str:
    """A length in cm with its unit."""
    return f"{number(CENTIMETRES * metres)} cm"


def listed(words: Iterable[str], last: str = "and") -> str:
    """`a, b and c`."""
    words = list(words)
    return f"{', '.join(words[:-1])} {last} {words[-1]}" if len(words) > 1 else "".join(words)


def hypotheses_listed(names: Iterable[str]) -> str:
    """Some hypotheses in words."""
    return listed(hypothesis_name(name) for name in names)


def first_causes(verdict: "Verdict", count: int = 3) -> str:
    """The most probable hypotheses of a verdict, with their probabilities."""
    first = list(verdict.probability.items())[:count]
    return ", ".join(f"{hypothesis_name(name)} {percent(share)}" for name, share in first)


def thinned_words(one: "Comparison") -> str:
    """How many of the measured points are compared; empty where all are, or where it is not recorded."""
    compared = len(one.measured)
    return f"{compared} of {one.of} measured points are compared" if one.of > compared else ""


def candidate_words(candidate: "Candidate") -> str:
    """A `next_candidates.Candidate` in words: what differs from the experiment of reference."""
    if candidate.added:
        added = listed(observable_words(name) for name in candidate.added)
        return f"the same set-up as {candidate.reference}, with {added} measured too"
    sizes = {key: value for key, value in candidate.changes.items() if key in CHANGES}
    changes = [CHANGES[key].format(value, 100.0 * value) for key, value in sizes.items()]
    return f"as {candidate.reference}, {listed(changes)}"
