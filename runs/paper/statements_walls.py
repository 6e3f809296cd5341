"""What the paper's section VII says of lateral friction, as measures of the tables."""

import numpy as np

from runs.paper.cases import SLOPES
from runs.paper.statement_terms import LENGTH_0, SALTATION, muI, shortening
from runs.paper.verdicts import Clause, claims

AT_REST = (0.01, 0.10)  # share of the volume
CLAIMS, claim = claims()


@claim(
    "3–8, VII",
    "lateral friction matters for slopes ≥ 16°",
    "it shortens the runout, w = 10 cm, by more than 2 cm",
    front=True,
)
def walls_matter(t):
    return [Clause(f"{a}°", shortening(t, a, "w10"), "above", SALTATION, "m") for a in (16, 19, 22)]


@claim(
    "abstract",
    "lateral friction is crucial on slopes from about 10°",
    "shortens the runout at 10° by more than 2 cm",
    front=True,
)
def walls_at_10(t):
    return [
        Clause(f"w = {w[1:]} cm", shortening(t, 10, w), "above", SALTATION, "m")
        for w in ("w10", "w20")
    ]


@claim(
    "VII",
    "lateral friction has little effect on the horizontal",
    "shortens the runout at 0° by less than 2 cm",
    front=True,
)
def walls_at_0(t):
    relative = shortening(t, 0, "w10").value / (t.row(muI(0, "winf"))[t.runout] - LENGTH_0)
    clauses = [
        Clause(f"w = {w[1:]} cm", shortening(t, 0, w), "below", SALTATION, "m")
        for w in ("w10", "w20")
    ]
    return clauses, f"w = 10 cm: {100 * relative:.0f} % of the runout from the gate"


@claim(
    "VII",
    "the effect of lateral friction grows with the slope",
    "each slope is shortened more than the one below",
    front=True,
)
def walls_grow(t):
    def more(width, low, high):
        def gap(r):
            rows = {a: (t.row(muI(a, "winf"), r), t.row(muI(a, width), r)) for a in (low, high)}
            short = {a: free[t.runout] - rubbed[t.runout] for a, (free, rubbed) in rows.items()}
            return short[high] - short[low]

        return t.measure(gap)

    steps = list(zip(SLOPES[:-1], SLOPES[1:], strict=True))
    return [
        Clause(f"w = {w[1:]} cm, {a}→{b}°", more(w, a, b), "above", 0.0, "m")
        for w in ("w10", "w20")
        for a, b in steps
    ]


@claim(
    "VII.A",
    "w = 20 cm is affected less than 10 cm",
    "runout longer, at every slope",
    front=True,
)
def wide_less(t):
    return [
        Clause(f"{a}°", t.difference(muI(a, "w20"), muI(a, "w10"), t.runout), "above", 0.0, "m")
        for a in SLOPES
    ]


@claim(
    "VII.A",
    "w = 20 cm is clearly affected at 22°",
    "w = 20 cm shortens the runout by more than 2 cm",
    front=True,
)
def wide_clearly(t):
    return [Clause("", shortening(t, 22, "w20"), "above", SALTATION, "m")]


@claim(
    "4e",
    "without lateral friction a large part still flows at 1.76 s, 22°",
    "more than 10 % of the volume, and more than with it",
)
def still_flowing(t):
    free = t.value(muI(22, "winf"), "flowing_share_1.76")
    more = t.difference(muI(22, "winf"), muI(22, "w10"), "flowing_share_1.76")
    return [
        Clause("share", free, "above", 0.10),
        Clause("less that at w = 10 cm", more, "above", 0.0),
    ]


@claim(
    "4e",
    "without lateral friction the mass ends at about 1.6 m, 22°",
    "final runout between 1.5 and 1.7 m",
    front=True,
)
def runout_1_6(t):
    value = t.value(muI(22, "winf"), t.runout)
    also = f"x₉₉ {t.row(muI(22, 'winf'))['x_99_m']:.2f} m"
    return [Clause("", value, "within", (1.5, 1.7), "m")], also


@claim(
    "4e, f",
    "with lateral friction what still moves at 22° adds < 0.5 % of the runout",
    "the runout grows by less than 0.5 % after 1.76 s (w = 10 cm), 1.8 s (20 cm)",
    front=True,
)
def residual_motion(t):
    def growth(case, time):
        def percent(r):
            front = t.line(case, t.front, refinement=r)
            return 100.0 * (front.values[-1] / float(np.interp(time, front.at, front.values)) - 1.0)

        return t.measure(percent)

    return (
        [
            Clause(f"{w[1:]} cm", growth(muI(22, w), time), "below", 0.5, "%", of_paper=True)
            for w, time in (("w10", 1.76), ("w20", 1.8))
        ],
        "where the tongue thins below 5 mm the farthest 5 mm point no longer moves, also without walls",
    )


@claim(
    "3e, f",
    "at 10° nearly everything is at rest at 1.0 s",
    "the share of the volume that flows is below every limit from 1 % (nothing flows) to 10 % (only small areas do)",
)
def rest_at_10(t):
    return [
        Clause(f"w = {w[1:]} cm", t.value(muI(10, w), "flowing_share_1"), "below", AT_REST)
        for w in ("w10", "w20")
    ]


@claim("3e, f", "the deposit at 10° lies within 0.7 m", "runout at 1 mm thickness below 0.7 m")
def deposit_at_10(t):
    return [
        Clause(f"w = {w[1:]} cm", t.value(muI(10, w), "runout_1mm_m"), "below", 0.7, "m", True)
        for w in ("w10", "w20")
    ]


def against_none(t, slopes, column, sense, unit=""):
    """A number with lateral friction less that without, at some slopes and both widths."""
    return [
        Clause(
            f"{a}°, w = {w[1:]} cm",
            t.difference(muI(a, w), muI(a, "winf"), column),
            sense,
            0.0,
            unit,
        )
        for a in slopes
        for w in ("w10", "w20")
    ]


@claim(
    "3, 4",
    "with lateral friction the mass near the back wall is thicker",
    "largest thickness within 10 cm of it, at 1.76 s, above that without",
)
def rear_thicker(t):
    return against_none(t, (10, 22), "rear_height_m", "above", "m")


@claim(
    "VII.A",
    "with lateral friction the deposit is steeper",
    "mean slope of its surface above that without",
)
def deposit_steeper(t):
    return against_none(t, (10, 22), "surface_slope_deg", "above", "°")


def interface_clauses(t, quantity, unit, sense):
    """With less without lateral friction, at 10 and 22 deg, both widths, while it flows."""
    return [
        Clause(
            f"{a}°, {w[1:]} cm, {time:g} s",
            t.difference(muI(a, w), muI(a, "winf"), f"interface_{quantity}_{time:g}_{unit}"),
            sense,
            0.0,
            {"deg": "°", "per_m": "1/m"}[unit],
        )
        for a, times in ((10, (0.3, 0.48)), (22, (0.3, 0.48, 0.96)))
        for time in times
        for w in ("w10", "w20")
    ]


@claim(
    "3, 4, VII.B",
    "with lateral friction the static–flowing interface is less curved",
    "curvature of the parabola through its falling part below that without",
)
def interface_curvature(t):
    return interface_clauses(t, "curvature", "per_m", "below")


@claim(
    "3, 4, VII.B",
    "with lateral friction the interface is steeper to the bed",
    "its mean angle to the bed above that without",
)
def interface_angle(t):
    return interface_clauses(t, "angle", "deg", "above")


@claim(
    "VII.B",
    "with lateral friction less of the mass flows",
    "flowing share of the volume at 0.48 s below that without",
)
def flows_less(t):
    return against_none(t, (10, 16, 22), "flowing_share_0.48", "below")
