"""The rules of a case that tie several keys together; the range of one key stands in `sections.py`.

Each rule takes a case and yields (key, what was found, what is allowed) for what it refuses.
"""

from collections.abc import Iterator, Sequence
from math import inf, isfinite, radians, tan
from typing import TYPE_CHECKING, Any

from fvcollapse.case.grammar import key_metas, sections, show
from fvcollapse.case.limits import LIMIT_RULES, ROUND_OFF
from fvcollapse.case.well_posed import rule_regularised
from fvcollapse.effects.catalogue import refusals

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


VERTICES_MAX = 500  # the check that a polygon is simple compares all pairs of edges
POLYGON_WORDS = f"a list of 3 to {VERTICES_MAX} points [x, z], from 0 to 1000: a simple polygon"


def rule_finite(case: "Case") -> Iterator[tuple[str, str, str]]:
    """Numbers are finite, except where inf is named; those beside inf are not too large."""
    for section, model in sections(type(case)):
        values: Any = case
        for part in section.split("."):
            values = getattr(values, part, None)
        for name, meta in key_metas(model).items():
            value = getattr(values, name, None)
            numbers = value if isinstance(value, tuple) else (value,)
            infinite = any(isinstance(number, float) and not isfinite(number) for number in numbers)
            most = meta.extra["most"]
            if most is not None and value is not None and most < value < inf:
                yield f"{section}.{name}", show(value), f"a number {meta.extra['allowed']}"
            if infinite and not meta.extra["inf"]:
                yield f"{section}.{name}", show(value), f"a finite number: {meta.extra['allowed']}"


def rule_friction(case: "Case") -> Iterator[tuple[str, str, str]]:
    """mu(I) rises with I."""
    mu_1, mu_2 = case.rheology.mu_1, case.rheology.mu_2
    if mu_2 < mu_1:
        yield "rheology.mu_2", f"{mu_2:g}", f">= rheology.mu_1 = {mu_1:g}"


def rule_density(case: "Case") -> Iterator[tuple[str, str, str]]:
    """The packed grains are not denser than the grains."""
    grain, bulk = case.rheology.density_grain, case.rheology.density_bulk
    if bulk > grain:
        yield "rheology.density_bulk", f"{bulk:g}", f"<= rheology.density_grain = {grain:g}"


def rule_polygon(case: "Case") -> Iterator[tuple[str, str, str]]:
    """The polygon is simple, has an area, and the gate does not cut it."""
    vertices, length_0 = case.geometry.polygon, case.geometry.length_0
    if vertices is None:
        return
    problem = polygon_problem(vertices)
    if problem:
        yield "geometry.polygon", problem, POLYGON_WORDS
    if isfinite(case.gate.speed) and case.geometry.length_max > length_0 * ROUND_OFF:
        limit = f"x <= geometry.length_0 = {length_0:g} (the gate), or gate.speed = inf"
        yield "geometry.polygon", f"x up to {case.geometry.length_max:g}", limit
    if case.geometry.surface != "parallel":
        yield "geometry.surface", show(case.geometry.surface), '"parallel" beside geometry.polygon'


def rule_surface(case: "Case") -> Iterator[tuple[str, str, str]]:
    """A level surface meets both walls above the bed, so that its mean height is height_0."""
    geometry = case.geometry
    drop = 0.5 * geometry.length_0 * tan(radians(abs(geometry.slope_angle_deg)))
    if geometry.surface == "horizontal" and geometry.height_0 <= drop:
        limit = f"> length_0 tan(slope)/2 = {drop:.4g} with a horizontal surface"
        yield "geometry.height_0", f"{geometry.height_0:g}", limit


def rule_domain(case: "Case") -> Iterator[tuple[str, str, str]]:
    """The domain holds the column."""
    column = max(case.geometry.length_max, case.geometry.length_0)
    length = case.boundary.domain_length
    if length is not None and length <= column:
        yield "boundary.domain_length", f"{length:g}", f"> {column:g}, the length of the column"
    if case.boundary.right_end == "wall" and case.boundary.ends == "walls" and length is None:
        yield "boundary.domain_length", "absent", 'where the wall stands, with right_end = "wall"'
    least = max(column, length or 0.0)
    if case.domain_max < least:
        limit = f">= {least:g}, the length of the domain at the start"
        yield "boundary.domain_max", f"{case.domain_max:g}", limit


RULES = (
    rule_finite,
    rule_friction,
    rule_regularised,
    rule_density,
    rule_polygon,
    rule_surface,
    *LIMIT_RULES,
    rule_domain,
    refusals,
)


def polygon_problem(vertices: Sequence[tuple[float, float]]) -> str:
    """Why a list of vertices is no simple polygon of positive area; "" if it is one."""
    count = len(vertices)
    if not 3 <= count <= VERTICES_MAX:
        return f"{count} vertices"
    edges = [(vertices[n], vertices[(n + 1) % count]) for n in range(count)]
    for first in range(count):
        for second in range(first + 1, count):
            neighbours = second == first + 1 or (first == 0 and second == count - 1)
            if edges_clash(edges[first], edges[second], neighbours):
                return f"edges {first} and {second}, counted from 0, that touch or cross"
    return ""


def edges_clash(first: Sequence, second: Sequence, neighbours: bool) -> bool:
    """Whether two edges share more than they may: a neighbour's vertex, and otherwise nothing."""
    (a, b), (c, d) = first, second
    if neighbours:
        tip, base, other = (a, b, d) if b == c else (b, a, c)  # the edges meet in `base`
        if base in (tip, other):
            return True
        product_x = (tip[0] - base[0]) * (other[0] - base[0])
        product_z = (tip[1] - base[1]) * (other[1] - base[1])
        return side(tip, base, other) == 0 and product_x + product_z > 0
    if max(a[0], b[0]) < min(c[0], d[0]) or max(c[0], d[0]) < min(a[0], b[0]):
        return False
    if max(a[1], b[1]) < min(c[1], d[1]) or max(c[1], d[1]) < min(a[1], b[1]):
        return False
    return side(a, b, c) * side(a, b, d) <= 0 and side(c, d, a) * side(c, d, b) <= 0


def side(a: Sequence[float], b: Sequence[float], c: Sequence[float]) -> int:
    """+1, 0 or -1: c lies left of, on, or right of the line from a to b, to round-off."""
    left, right = (b[0] - a[0]) * (c[1] - a[1]), (b[1] - a[1]) * (c[0] - a[0])
    cross = left - right
    return 0 if abs(cross) <= 1e-12 * (abs(left) + abs(right)) else (1 if cross > 0 else -1)
