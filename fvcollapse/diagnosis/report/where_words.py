"""Where the gap lies and how large it is in practice, in words: the first sentence without coordinates."""

from typing import TYPE_CHECKING

from fvcollapse.diagnosis.report.regions import region_words
from fvcollapse.diagnosis.report.standing import NOTHING, OPEN, standing
from fvcollapse.diagnosis.report.words import listed, number
from fvcollapse.measure.quantities import direction_words, observable_words, shown_gap

if TYPE_CHECKING:
    from fvcollapse.diagnosis.report import schema as form
    from fvcollapse.diagnosis.report.schema_gap import Region

LARGEST_REGIONS = 2  # named in the answer
CONTROLS = "the model error that the controls leave open"
CODES = "the difference of two codes for the same equations"
UNCERTAINTY = "the uncertainty"


def where_words(report: "form.Report") -> list[str]:
    """What is off in the simulation; where and when; how large it is in practice; what the grains in view say."""
    return [*gap_words(report), *practical_words(report), *report.details.grains]


def gap_words(report: "form.Report") -> list[str]:
    """What is off, without coordinates, and the largest regions with them."""
    if not report.where:
        text = "no single region of the data shows a significant difference"
        if standing(report).state not in (NOTHING, OPEN):
            text += "; the answer rests on all points taken together"
        return [f"{text}."]
    regions = sorted(report.where, key=lambda region: -region.significance)
    taught = " (the model error that the controls show is subtracted)"
    return [
        f"without any effect added, the simulated {listed(directions(regions))}, beyond what measurement, grid and "
        f"calibration explain{taught if report.details.expected else ''}.",
        largest_words(regions, report),
    ]


def directions(regions: "list[Region]") -> list[str]:
    """In which direction each observable is off; both where regions of both signs are significant."""
    found: dict[str, dict[str, None]] = {}
    for region in regions:
        ways = found.setdefault(region.observable, {})
        ways[direction_words(region.observable, region.gap)] = None
    return [
        f"{observable_words(name)} is {' here, '.join(ways)}{' there' if len(ways) > 1 else ''}"
        for name, ways in found.items()
    ]


def largest_words(regions: "list[Region]", report: "form.Report") -> str:
    """The largest regions, with size, place and time."""
    largest = regions[:LARGEST_REGIONS]
    names = list(dict.fromkeys(region.experiment for region in largest))
    texts = [region_words(region, report).partition(";")[0] for region in largest]
    if len(names) == 1:
        words = f"{'; '.join(texts)} ({'both in ' if len(texts) > 1 else ''}{names[0]})"
    else:
        pairs = zip(texts, largest, strict=True)
        words = "; ".join(f"{text} ({region.experiment})" for text, region in pairs)
    others = len(regions) - len(largest)
    more = f"; {others} smaller" if others else ""
    return f"{'Largest' if others else 'There'}: {words}{more}."


def practical_words(report: "form.Report") -> list[str]:
    """Whether what is left in practice is larger than an honest error of the model; [] where nothing is."""
    parts = {name: part for name, part in report.details.practical.items() if part.beyond > 0.0}
    if not parts:
        return []
    groups: dict[tuple[str, bool], list[str]] = {}
    for name, part in parts.items():
        groups.setdefault((yardstick_of(part)[0], part.is_larger), []).append(name)
    clauses = []
    for (yardstick, is_larger), names in groups.items():
        sizes = listed(
            f"{observable_words(n)} {length(n, parts[n], parts[n].beyond)}" for n in names
        )
        honest = listed(length(n, parts[n], yardstick_of(parts[n])[1]) for n in names)
        clauses.append(f"{sizes}, {'' if is_larger else 'not '}above {yardstick} ({honest})")
    text = f"Beyond noise and calibration (rms): {'; '.join(clauses)}."
    if set(groups) == {(CODES, False)}:
        return [text, "So the gap is no larger than the choice of a code makes it."]
    return [text]


def yardstick_of(part: "form.Practical") -> tuple[str, float]:
    """(what an observable is compared with, its size): controls, else two codes, else the uncertainty."""
    if part.controls is not None:
        return CONTROLS, part.controls
    return (UNCERTAINTY, part.uncertainty) if part.codes is None else (CODES, part.codes)


def length(name: str, part: "form.Practical", value: float) -> str:
    """A size of an observable as it is shown."""
    factor, unit = shown_gap(name, part.units)
    return f"{number(factor * value, 2)} {unit}".rstrip()
