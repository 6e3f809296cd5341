"""The report in plain words: names, numbers with units, and the answer as one paragraph."""

from typing import get_args, get_type_hints

from fvcollapse.case.case import Effects
from fvcollapse.diagnosis.names import NONE, SEVERAL, UNKNOWN
from fvcollapse.diagnosis.report import BASELINE, RECALIBRATED, RUNNER_UP, WINNER
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import NUISANCE

LEAST_PAIR = 0.02  # probability from which further pairs are shown
MINUS = "\N{MINUS SIGN}"
OBSERVABLES = {
    "front": "front position",
    "profiles": "thickness",
    "interface": "static\N{EN DASH}flowing interface",
    "volume": "relative volume",
}
# what is shown: (factor from SI, unit) of the value and of a gap
SHOWN = {
    "front": ((1.0, "m"), (100.0, "cm")),
    "profiles": ((100.0, "cm"), (100.0, "cm")),
    "interface": ((100.0, "cm"), (100.0, "cm")),
    "volume": ((100.0, "%"), (100.0, "%")),
}
REST = {NONE: "no missing effect", UNKNOWN: "a cause outside the catalogue"}
LARGEST_REGIONS = 2  # named in the answer
CLOSE_SECOND = 0.05  # probability from which another hypothesis is named beside the first


# -- names ---------------------------------------------------------------------------------------


def observable_name(observable):
    """An observable in words."""
    return OBSERVABLES.get(observable, observable.replace("_", " "))


def hypothesis_name(name):
    """An effect, a pair, "none" or "unknown" in words."""
    return REST.get(name) or " + ".join(part.replace("_", " ") for part in name.split("+"))


def effect_meaning(name):
    """First line of what the case file says of an effect; of a pair both; empty for the others."""
    sections = get_type_hints(Effects)
    lines = []
    for part in name.split("+"):
        for section in get_args(sections.get(part)):
            if section is not type(None):
                lines.append(section.__doc__.splitlines()[0].rstrip("."))
    return "; ".join(lines)


def model_name(model, report):
    """A model of the ladder in words."""
    effects = {rung.model: "+".join(sorted(rung.effects)) for rung in report.details.ladder}
    if model == BASELINE:
        return "model as given"
    if model == RECALIBRATED:
        return "model re-calibrated"
    added = effects.get(model) or ("+".join(report.verdict.effects) if model == WINNER else "")
    added = hypothesis_name(added) if added else {RUNNER_UP: "second effect"}.get(model, "effect")
    return f"with {added}, re-calibrated"


def after_model(report):
    """The model that the page calls "after": with the effect, else re-calibrated, else as given."""
    simulated = {model for one in report.details.comparisons for model in one.simulated}
    return next((model for model in (WINNER, RECALIBRATED) if model in simulated), BASELINE)


def ranking(report):
    """(hypothesis, probability), the most probable first, of equal ones that with more evidence.

    Of two effects together only the best pair is shown, and others of some probability.
    """

    def rank(item):
        stated = report.details.hypotheses.get(item[0])
        known = stated is not None and stated.log_evidence is not None
        return -item[1], -stated.log_evidence if known else 0.0

    ranked = sorted(report.verdict.probability.items(), key=rank)
    first = next((name for name, _ in ranked if "+" in name), None)
    return [
        (name, chance)
        for name, chance in ranked
        if "+" not in name or name == first or chance >= LEAST_PAIR
    ]


# -- numbers -------------------------------------------------------------------------------------


def number(value, digits=3):
    """A number in `digits` significant digits without an exponent where that is short."""
    if value is None:
        return "\N{EN DASH}"
    text = f"{value:.{digits}g}"
    if "e" in text and 1.0e-4 <= abs(value) < 1.0e6:
        text = f"{value:.0f}" if abs(value) >= 1.0 else f"{value:.6f}".rstrip("0")
    return text.replace("-", MINUS)


def tenths(value):
    """A number with one decimal; a dash without one."""
    return "\N{EN DASH}" if value is None else f"{value:.1f}".replace("-", MINUS)


def hundredths(value):
    """A number with two decimals."""
    return f"{value:.2f}".replace("-", MINUS)


def percent(share):
    """A fraction in per cent, without decimals; near 0 and 1 only a bound."""
    if share is None:
        return "\N{EN DASH}"
    if 0.0 < share < 0.005:
        return "<1 %"
    if 0.995 <= share < 1.0:
        return ">99 %"
    return f"{100.0 * share:.0f} %".replace("-", MINUS)


def span(interval, show=number):
    """An interval in words, or an empty text; a unit that both ends have is written once."""
    if interval is None:
        return ""
    low, high = (show(end) for end in interval)
    return f"{low.removesuffix(' %') if high.endswith(' %') else low} to {high}"


def with_unit(value, units, digits=3):
    """A number with its unit; "1" and "-" are none."""
    return f"{number(value, digits)} {unit(units)}".rstrip()


def unit(units):
    """A unit as printed: empty where there is none."""
    return "" if units in ("1", "-") else units


def shown_gap(observable, units):
    """(factor from SI, unit) in which a gap of an observable is shown."""
    return SHOWN[observable][1] if observable in SHOWN else (1.0, unit(units))


def shown_value(observable, units):
    """(factor from SI, unit) in which an observable is shown."""
    return SHOWN[observable][0] if observable in SHOWN else (1.0, unit(units))


def listed(words, last="and"):
    """`a, b and c`."""
    words = list(words)
    return f"{', '.join(words[:-1])} {last} {words[-1]}" if len(words) > 1 else "".join(words)


# -- sentences -----------------------------------------------------------------------------------


def region_words(region):
    """One plain sentence for a region."""
    if region.words:
        return region.words
    factor, shown = shown_gap(region.observable, region.units)
    spread = f" \N{PLUS-MINUS SIGN} {number(factor * region.gap_sd, 2)}" if region.gap_sd else ""
    size = f"{number(factor * abs(region.gap), 2)}{spread} {shown}".rstrip()
    above = "too far" if region.observable == "front" else "too high"
    below = "too short" if region.observable == "front" else "too low"
    side = above if region.gap > 0.0 else below
    text = f"simulated {observable_name(region.observable)} {size} {side}"
    if region.t_range is not None:
        text += f" from {span(region.t_range, hundredths)} s"
    if region.x_range is not None:
        text += f", at x = {span(region.x_range, hundredths)} m"
    return text


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
        sentences += beside_sentences(report)
        sentences += reduction_sentences(report)
    if report.next_experiment is not None:
        sentences.append(next_sentence(report.next_experiment))
    return sentences


def where_sentence(report):
    """Where the gap lies."""
    regions = report.where
    if not regions:
        text = (
            "Nowhere do simulation and experiment differ by more than the uncertainties of "
            "measurement, grid and calibrated parameters explain"
        )
        if report.verdict.kind != NONE:
            text += ", but all points together do"
        return f"{text}."
    largest = sorted(regions, key=lambda region: -region.significance)[:LARGEST_REGIONS]
    words = "; ".join(
        f"{region_words(region).partition(';')[0]} ({region.experiment})" for region in largest
    )
    others = len(regions) - len(largest)
    more = f"; and {others} smaller region{'s' if others > 1 else ''}" if others else ""
    after = ", after what the controls show is taken off" if report.details.expected else ""
    return (
        "Simulation and experiment differ by more than the uncertainties of measurement, grid and "
        f"calibrated parameters explain{after}: {words}{more}."
    )


def none_sentences(report):
    """What "none" means."""
    verdict = report.verdict
    chance = percent(verdict.probability[NONE])
    text = f"No effect has to be added to the model to explain these data (probability {chance})"
    first, most = ranking(report)[0]
    if first != NONE:
        text += f", although {hypothesis_name(first)} is more probable ({percent(most)}): the model passes as it is"
    text += "."
    still = [hypothesis_name(name) for name in verdict.set if name != NONE]
    if still:
        text += f" The data do not exclude {listed(still, 'or')}."
    if report.where:
        text += " The differences above are of a size that a model without any missing effect shows as well."
    return [text]


def unknown_sentences(report):
    """What "unknown" means."""
    chance = percent(report.verdict.probability[UNKNOWN])
    return [
        f"None of the effects that were tried ({len(report.candidates)}) explains this with plausible "
        f"values: the cause lies outside {tried(report)} (probability {chance}), in the model or in "
        "an error of the measurement that its stated uncertainty does not hold."
    ]


def tried(report):
    """What a cause that is unknown lies outside of."""
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
    text = f"The cause that explains this best is {hypothesis_name(first)}{meaning}, with probability {chance}"
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


def beside_sentences(report):
    """Second effects that the data leave open beside the one that is named."""
    first = set(report.verdict.effects)
    pairs = [set(name.split("+")) for name in report.verdict.set if "+" in name]
    others = [hypothesis_name(name) for pair in pairs if first < pair for name in pair - first]
    if not others:
        return []
    return [
        f"That {listed(others, 'or')} acts beside {hypothesis_name(named(report)[0])} is not excluded."
    ]


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
    """What the controls let expect, in words; empty without controls."""
    parts = []
    for name, size in report.details.expected.items():
        factor, shown = shown_gap(name, report.by_observable[name].units)
        parts.append(f"{observable_name(name)} {number(factor * size, 2)} {shown}".rstrip())
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
    """What to measure next."""
    return (
        f"The next experiment that would tell most: {measurement.description} (expected gain "
        f"{with_unit(measurement.expected_gain, measurement.units, 2)})."
    )


def headline(report):
    """The verdict in a few words."""
    verdict = report.verdict
    if verdict.kind == NONE:
        return "Nothing has to be added to the model"
    if verdict.kind == UNKNOWN:
        return f"A cause outside {tried(report)}"
    pair = "+".join(sorted(verdict.effects))
    if verdict.kind == SEVERAL and pair not in verdict.probability:
        names = listed((hypothesis_name(name) for name in verdict.effects), "or")
        return f"Several causes possible: {names}"
    return f"Most likely cause: {hypothesis_name(pair)}"
