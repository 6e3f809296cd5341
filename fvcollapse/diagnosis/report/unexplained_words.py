"""What is left unexplained, in words: where, when, in which direction, and which quantity would have to change.

The reading follows from three tables, one for each of place, phase and direction: what sets a place apart is the stress
that counts there (in thin layers one that does not grow with the pressure, at the back wall one that grows with the
thickness), what sets a phase apart is what the grains do then. No combination is written out by itself.
"""

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

from fvcollapse.diagnosis.evidence import CHECK_PASSED
from fvcollapse.diagnosis.names import NONE
from fvcollapse.diagnosis.report.words import hypothesis_name, listed, number
from fvcollapse.diagnosis.unexplained import BACK, FRONT, MIDDLE, PILE, THIN
from fvcollapse.measure.quantities import observable_words, shown_gap

if TYPE_CHECKING:
    from fvcollapse.diagnosis.report import schema as form

MOST = 0.8  # share from which a place or a phase is the only one
MUCH = 0.25  # and from which it is named
ONE_SIDED = 0.5  # |direction| from which the motion is one-sided
FRONT_PART = {FRONT, THIN}
OBJECTS = {  # what moves there
    FRONT: "the grains at the tip of the flow",
    THIN: "thin layers",
    MIDDLE: "the thick flowing part",
    BACK: "the grains near the back wall",
    PILE: "the whole pile",
}
STRESSES = {  # what counts there more than elsewhere
    FRONT: "a resistance that thin layers feel as much as thick ones, or single grains ahead of the flow",
    THIN: "a resistance that thin layers feel as much as thick ones, or a least thickness that flows",
    MIDDLE: "friction in proportion to the pressure, in the grains, on the bed or on lateral walls",
    BACK: "friction that thick layers feel most, or a threshold of motion where shear is slow",
    PILE: "another volume of the grains with their voids, or another scale of the heights",
}
TIMES = {  # what counts then more than at other times
    "release": "the gate and the state of the column at the start",
    "spreading": "friction where shear is fast",
    "arrest": "friction near rest",
    "deposit": "friction near rest",
}
MOMENTS = {
    "release": "while the column is released",
    "spreading": "while it spreads",
    "arrest": "as it comes to rest",
    "deposit": "after it has come to rest",
}
VERBS = {
    1: "holds {0}",
    -1: "lets {0} move more easily",
    0: "changes the shape of {0} without holding or driving it",
}
ALL_POINTS = "only all points together are off by more than chance explains"
MOST_PHASES = 2  # that are named; more are the whole collapse
CHANGES = {1: "Grains move too easily in the simulation.", -1: "Grains do not move easily enough."}


def sentence(part: "form.Unexplained") -> str:
    """Where, when and in which direction the remainder lies, and what it reads like.

    Parameters
    ----------
    part : unexplained.Unexplained or schema_unexplained.Unexplained
    """
    if not part.shares:
        alike = (
            "chance explains all points together" if part.p_value >= CHECK_PASSED else ALL_POINTS
        )
        return f"no place or moment stands out; {alike}"
    places, phases = main_keys(part, "place"), main_keys(part, "phase")
    return f"{place_words(part, places)}, {time_words(part)}: {reading(part, places, phases)}"


def totals(part: "form.Unexplained", key: str) -> dict[str, float]:
    """{place or phase: its share}, the largest first."""
    sums: dict[str, float] = {}
    for one in part.shares:
        name = getattr(one, key)
        sums[name] = sums.get(name, 0.0) + one.share
    return dict(sorted(sums.items(), key=lambda item: -item[1]))


def main_keys(part: "form.Unexplained", key: str) -> list[str]:
    """Places or phases that hold much of the remainder, the largest first; at least one."""
    sums = totals(part, key)
    first = next(iter(sums))
    return [name for name, share in sums.items() if share >= MUCH or name == first]


def place_words(part: "form.Unexplained", places: Sequence[str]) -> str:
    """The places of the remainder."""
    sums = totals(part, "place")
    in_front = sum(share for name, share in sums.items() if name in FRONT_PART)
    if in_front >= MOST:
        thin = "" if THIN not in places else ", in the thin part"
        return f"tip of the flow only{thin}"
    names = [place_name(place) for place in places]
    if sums[places[0]] >= MOST:
        return f"{names[0]} only"
    mostly = "" if sum(sums[place] for place in places) >= MOST else "mostly "
    return f"{mostly}{listed(names)}"


def place_name(place: str) -> str:
    """A place in words: the front is an observable, its place the tip of the flow."""
    return "tip of the flow" if place == FRONT else place


def time_words(part: "form.Unexplained") -> str:
    """The times of the remainder, in the experiment that has most of it."""
    if part.t_range is None or part.span is None:
        return "over the whole collapse"
    (start, stop), (first, last) = part.t_range, part.span
    if start <= first and stop >= last:
        return "at all times"
    if start == stop:
        return f"at {start:.2f} s"
    if stop >= last:
        return f"from {start:.2f} s on"
    return f"until {stop:.2f} s" if start <= first else f"from {start:.2f} to {stop:.2f} s"


def reading(part: "form.Unexplained", places: Sequence[str], phases: Sequence[str]) -> str:
    """Which quantity would have to change."""
    if places[0] == PILE:
        return volume_reading(part)
    thing = listed(dict.fromkeys(OBJECTS[place] for place in shown_places(places)))
    clauses: list[str] = []
    for side, together in sides_of(part, places, phases):
        when = listed(MOMENTS[phase] for phase in together)
        clauses.append(f"{VERBS[side].format('them' if clauses else thing)} {when}")
    if len(clauses) == 1 and len(phases) > MOST_PHASES:
        clauses = [VERBS[side].format(thing)]
    return f"something that {' and '.join(clauses)}"


def volume_reading(part: "form.Unexplained") -> str:
    """What would have to change where the volume of the whole pile is off."""
    size = part.sizes.get("volume")
    if size is None or size.mean == 0.0:
        return "something that changes the whole pile"
    return f"something that makes the grains take {'less' if size.mean > 0.0 else 'more'} room"


def shown_places(places: Sequence[str]) -> list[str]:
    """Front and thin part together are thin layers."""
    return [place for place in places if place != FRONT or THIN not in places]


def in_order(phases: Collection[str]) -> list[str]:
    """Phases in the order of the collapse."""
    return [name for name in MOMENTS if name in phases]


def sides_of(
    part: "form.Unexplained", places: Collection[str], phases: Collection[str]
) -> list[tuple[int, list[str]]]:
    """[(side, its phases)] in the order of the collapse, neighbours of one side together."""
    groups: list[tuple[int, list[str]]] = []
    for phase in in_order(phases):
        own = [one for one in part.shares if one.phase == phase and one.place in places]
        side = side_of([(one.share, one.direction) for one in own])
        if groups and groups[-1][0] == side:
            groups[-1][1].append(phase)
        else:
            groups.append((side, [phase]))
    return groups


def side_of(weighted: Sequence[tuple[float, float]]) -> int:
    """+1: the simulated grains move too easily, -1: not easily enough, 0: neither; of (share, direction)."""
    told = sum(share for share, direction in weighted if direction)
    total = sum(share for share, _ in weighted)
    mean = sum(share * direction for share, direction in weighted) / told if told > 0.0 else 0.0
    if abs(mean) < ONE_SIDED or told < MUCH * total:
        return 0
    return 1 if mean > 0.0 else -1


def size_words(part: "form.Unexplained") -> str:
    """How large it is, by observable."""
    words = []
    for name, size in part.sizes.items():
        factor, unit = shown_gap(name, size.units)
        amount = f"{number(factor * size.rms, 2)} {unit}".rstrip()
        words.append(f"{observable_words(name)} {amount} ({number(size.deviations, 2)} sd)")
    return listed(words)


def stress_words(part: "form.Unexplained") -> str:
    """What counts at the place and, where that is no matter of the volume, at the time of the remainder."""
    place, phases = main_keys(part, "place")[0], main_keys(part, "phase")
    if place == PILE or len(phases) > MOST_PHASES:
        return STRESSES[place]
    times = dict.fromkeys(TIMES[phase] for phase in in_order(phases))
    return f"{STRESSES[place]}; at that time: {listed(times)}"


def likeness_words(one: "form.Likeness") -> str:
    """How an effect resembles the remainder, and what speaks against it."""
    name = hypothesis_name(one.effect)
    if one.cosine < 0.0:
        return f"{name} acting the other way ({number(abs(one.cosine), 2)})"
    against = []
    if one.strength > 1.0:
        against.append(f"{number(one.strength, 2)} times as strong as is plausible")
    if one.worse:
        against.append(f"{listed(observable_words(each) for each in one.worse)} would fit worse")
    reasons = "".join(f", {text}" for text in against)
    return f"{name} ({number(one.cosine, 2)}{reasons})"


def unexplained_words(part: "form.Unexplained | None") -> str:
    """The answer's sentences on what is left unexplained; empty where nothing is."""
    if part is None:
        return ""
    beside = "" if part.beside == NONE else f"beside {hypothesis_name(part.beside)}, "
    texts = [f"{beside}{part.words}."]
    if not part.shares:
        return texts[0]
    texts.append(f"Root mean square there: {size_words(part)}.")
    side = side_of([(one.share, one.direction) for one in part.shares])
    if side:
        texts.append(CHANGES[side])
    texts.append(f"Worth looking for: {stress_words(part)}.")
    if part.resembles:
        alike = listed(likeness_words(one) for one in part.resembles)
        texts.append(f"Its form is like that of (1 is the same form) {alike}.")
    else:
        texts.append("No effect of the catalogue has its form.")
    return " ".join(texts)
