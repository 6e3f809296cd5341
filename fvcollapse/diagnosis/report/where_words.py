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
UNCERTAINTY = "the combined standard uncertainty"


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
    taught = " (the model error learned from the controls is taken off)"
    return [
        f"in the simulation {listed(directions(regions))}, by more than measurement, grid and calibrated parameters "
        f"explain{taught if report.details.expected else ''}.",
        largest_words(regions, report),
    ]


def directions(regions: "list[Region]") -> list[str]:
    """In which direction each observable is off; in both where regions of both signs are significant."""
    found: dict[str, dict[str, None]] = {}
    for region in regions:
        ways = found.setdefault(region.observable, {})
        ways[direction_words(region.observable, region.gap)] = None
    return [
        f"the {observable_words(name)} is {' in one place and '.join(ways)}"
        + (" in another" if len(ways) > 1 else "")
        for name, ways in found.items()
    ]


def largest_words(regions: "list[Region]", report: "form.Report") -> str:
    """The largest regions, with size, place and time."""
    largest = regions[:LARGEST_REGIONS]
    words = "; ".join(
        f"{region_words(region, report).partition(';')[0]} ({region.experiment})"
        for region in largest
    )
    others = len(regions) - len(largest)
    more = f"; and {others} smaller region{'s' if others > 1 else ''}" if others else ""
    return f"{'Largest' if others else 'There'}: {words}{more}."


def practical_words(report: "form.Report") -> list[str]:
    """Whether what is left in practice is larger than an honest error of the model; [] where nothing is."""
    parts = {name: part for name, part in report.details.practical.items() if part.beyond > 0.0}
    if not parts:
        return []
    groups: dict[str, dict[bool, list[str]]] = {}
    for name, part in parts.items():
        yardstick, honest = yardstick_of(part)
        sizes = f"{length(name, part, part.beyond)} beside {length(name, part, honest)}"
        sides = groups.setdefault(yardstick, {True: [], False: []})
        sides[part.is_larger].append(f"{observable_words(name)} ({sizes})")
    clauses = [
        clause for yardstick, sides in groups.items() for clause in clauses_of(yardstick, sides)
    ]
    text = f"What noise and calibration do not explain is, as a root mean square, {'; '.join(clauses)}."
    if set(groups) == {CODES} and not any(part.is_larger for part in parts.values()):
        return [text, "So the gap is no larger than the choice of a code makes it."]
    return [text]


def clauses_of(yardstick: str, sides: "dict[bool, list[str]]") -> list[str]:
    """The observables that are larger than a yardstick, and those that are not."""
    words = {True: "larger", False: "not larger"}
    named = [side for side in words if sides[side]]
    return [
        f"{words[side]}{f' than {yardstick}' if side == named[0] else ''} for {listed(sides[side])}"
        for side in named
    ]


def yardstick_of(part: "form.Practical") -> tuple[str, float]:
    """(what an observable is compared with, its size): controls, else two codes, else the uncertainty."""
    if part.controls is not None:
        return CONTROLS, part.controls
    return (UNCERTAINTY, part.uncertainty) if part.codes is None else (CODES, part.codes)


def length(name: str, part: "form.Practical", value: float) -> str:
    """A size of an observable as it is shown."""
    factor, unit = shown_gap(name, part.units)
    return f"{number(factor * value, 2)} {unit}".rstrip()
