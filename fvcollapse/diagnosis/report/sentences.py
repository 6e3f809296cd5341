"""The answer of a report as one paragraph, and its headline."""

from fvcollapse.diagnosis.names import NONE, SEVERAL, UNKNOWN
from fvcollapse.diagnosis.report.regions import region_words
from fvcollapse.diagnosis.report.words import (
    effect_meaning,
    hypothesis_name,
    listed,
    number,
    percent,
    ranking,
    span,
    with_unit,
)
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import NUISANCE
from fvcollapse.measure.quantities import observable_words, shown_gap

LARGEST_REGIONS = 2  # named in the answer
COUNTS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
CLOSE_SECOND = 0.05  # probability from which another hypothesis is named after the first


def answer(report):
    """The sentences of the answer, the most important first."""
    kind = report.verdict.kind
    sentences = [where_sentence(report), *report.details.grains]
    if kind == NONE:
        sentences += none_sentences(report)
    elif kind == UNKNOWN:
        sentences += unknown_sentences(report)
    else:
        sentences += [cause_sentence(report), *confusion_sentences(report)]
        sentences += addition_sentences(report)
        sentences += reduction_sentences(report)
    if report.next_experiment is not None:
        sentences.append(next_sentence(report.next_experiment))
    return sentences


def where_sentence(report):
    """Where the gap lies."""
    regions = report.where
    if not regions:
        text = "No single region of the data shows a significant difference"
        if report.verdict.kind != NONE:
            text += "; all points taken together do"
        return f"{text}."
    largest = sorted(regions, key=lambda region: -region.significance)[:LARGEST_REGIONS]
    words = "; ".join(
        f"{region_words(region).partition(';')[0]} ({region.experiment})" for region in largest
    )
    others = len(regions) - len(largest)
    more = f"; and {others} smaller region{'s' if others > 1 else ''}" if others else ""
    corrected = (
        ", after subtraction of the model error learned from the controls"
        if report.details.expected
        else ""
    )
    return (
        "Simulation and experiment differ by more than the uncertainties of measurement, grid and "
        f"calibrated parameters explain{corrected}: {words}{more}."
    )


def none_sentences(report):
    """The meaning of "none"."""
    verdict = report.verdict
    chance = percent(verdict.probability[NONE])
    sentences = [f"No missing effect is needed to explain these data (probability {chance})."]
    first, most = ranking(report)[0]
    if first != NONE:
        sentences.append(
            f"A higher probability falls to {hypothesis_name(first)} ({percent(most)}), but the model "
            "without it is not rejected."
        )
    others = [hypothesis_name(name) for name in verdict.set if name != NONE]
    if others:
        sentences.append(f"The data do not exclude {listed(others, 'or')}.")
    if report.where:
        sentences.append(
            "The differences above are of a size that a model without any missing effect shows as well."
        )
    return sentences


def unknown_sentences(report):
    """The meaning of "unknown"."""
    likely = "Most probably" if leads(report, UNKNOWN) else "Possibly"
    chance = percent(report.verdict.probability[UNKNOWN])
    return [
        f"None of the effects that were tried ({len(report.candidates)}) explains this with plausible "
        f"values. {likely} ({chance}) the cause lies outside {tried(report)}: in the model, or in "
        "a measurement error larger than its stated uncertainty."
    ]


def tried(report):
    """The effects that an unknown cause is not among."""
    known = {name for name, effect in CATALOGUE.items() if effect.kind != NUISANCE}
    return "the catalogue" if known <= set(report.candidates) else "the effects that were tried"


def cause_sentence(report):
    """The effect, its meaning and probability, and who comes next."""
    verdict = report.verdict
    first, share = named(report)
    chance = percent(share)
    if verdict.kind == SEVERAL and "+" not in first:
        names = listed((hypothesis_name(name) for name in verdict.effects), "or")
        chances = listed(percent(verdict.probability[name]) for name in verdict.effects)
        return f"These data leave more than one cause open: {names} (probabilities {chances})."
    meaning = effect_meaning(first)
    meaning = f" ({meaning[0].lower()}{meaning[1:]})" if meaning else ""
    rank = "" if leads(report, first) else " that is not rejected"
    text = f"The most probable cause{rank} is {hypothesis_name(first)}{meaning}, with probability {chance}"
    close = [(name, p) for name, p in ranking(report) if name != first and p >= CLOSE_SECOND]
    if close:
        text += "; " + listed(f"{hypothesis_name(name)} has {percent(p)}" for name, p in close)
    return f"{text}."


def confusion_sentences(report):
    """Groups that cannot be told apart and hold a named effect."""
    named = set(report.verdict.effects)
    groups = [group for group in report.verdict.indistinguishable if named & set(group)]
    return [
        f"These data cannot tell apart {listed(hypothesis_name(name) for name in group)}."
        for group in groups
        if len(group) > 1
    ]


def addition_sentences(report):
    """Second effects that the data leave open in addition to the one that is named."""
    first = set(report.verdict.effects)
    pairs = [set(name.split("+")) for name in report.verdict.set if "+" in name]
    others = [hypothesis_name(name) for pair in pairs if first < pair for name in pair - first]
    if not others:
        return []
    cause = hypothesis_name(named(report)[0])
    return [f"The data do not exclude that {listed(others, 'or')} acts in addition to {cause}."]


def reduction_sentences(report):
    """How far the gap closes, and how strong the wording is."""
    reduction, confirmation = report.reduction, report.details.confirmation
    sentences = []
    if reduction is not None:
        text = (
            "With the effect really added to the solver and the model re-calibrated, "
            f"{closed(reduction.fitted.overall)} of the gap closes in the experiments that were fitted"
        )
        if reduction.held_out is not None:
            text += f" and {closed(reduction.held_out.overall)} in those that were held out"
        sentences.append(f"{text}.")
    if confirmation is not None:
        sentences.append(f"{wording(confirmation)}: {listed(confirmation.reasons)}.")
    return sentences


def closed(part):
    """Fraction of a gap that closed, with its range."""
    return percent(part.fraction_closed) + (
        f" ({span(part.interval, percent)})" if part.interval else ""
    )


def expected_gaps(report):
    """Root mean square of the model error learned from the controls, in words; empty without controls."""
    parts = []
    for name, size in report.details.expected.items():
        factor, shown = shown_gap(name, report.by_observable[name].units)
        parts.append(f"{observable_words(name)} {number(factor * size, 2)} {shown}".rstrip())
    return ", ".join(parts)


def named(report):
    """(hypothesis, probability) that the verdict states."""
    verdict = report.verdict
    pair = "+".join(sorted(verdict.effects)) or verdict.kind
    name = pair if pair in verdict.probability else verdict.effects[0]
    return name, verdict.probability[name]


def wording(confirmation):
    """The strongest statement that the runs allow."""
    return {
        "confirmed": "The cause is confirmed",
        "consistent with": "The data are consistent with this cause, which is less than a confirmation",
        "not confirmed": "The cause is not confirmed",
    }[confirmation.wording]


def next_sentence(measurement):
    """The most informative next measurement."""
    gain = with_unit(measurement.expected_gain, measurement.units, 2)
    return f"Most informative next experiment: {measurement.description} (expected gain {gain})."


def headline(report):
    """The verdict in a few words, with its probability: never firmer than its number."""
    verdict = report.verdict
    if verdict.kind == NONE:
        text = f"No missing effect is needed ({percent(verdict.probability[NONE])})"
        return text + not_excluded(report, {NONE})
    if verdict.kind == UNKNOWN:
        chance = percent(verdict.probability[UNKNOWN])
        likely = "Most likely" if leads(report, UNKNOWN) else "Possibly"
        text = f"{likely} a cause outside {tried(report)} ({chance})"
        return text + not_excluded(report, {UNKNOWN})
    name, chance = named(report)
    if verdict.kind == SEVERAL and "+" not in name:
        causes = (
            f"{hypothesis_name(effect)} ({percent(verdict.probability[effect])})"
            for effect in verdict.effects
        )
        return f"Several causes possible: {listed(causes, 'or')}"
    likely = "Most likely" if leads(report, name) else "Possible"
    text = f"{likely} cause: {hypothesis_name(name)} ({percent(chance)})"
    return text + not_excluded(report, {name})


def leads(report, name):
    """Whether no hypothesis has a larger probability."""
    probability = report.verdict.probability
    return probability[name] >= max(probability.values())


def not_excluded(report, stated):
    """How many hypotheses the data leave open in addition to those that are stated; empty for none."""
    count = len(set(report.verdict.set) - stated)
    if count == 0:
        return ""
    number = COUNTS[count] if count < len(COUNTS) else str(count)
    return f"; {number} other{' is' if count == 1 else 's are'} not excluded"
