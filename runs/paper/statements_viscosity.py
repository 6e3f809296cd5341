"""What the paper's section VIII says of viscosity, as measures of the tables."""

import numpy as np

from runs.paper.cases import SLOPES
from runs.paper.measures import PLATEAU_LEAST
from runs.paper.statement_terms import (
    BENDS,
    LENGTHS,
    SAME,
    bend,
    clause_in,
    deposit_gap,
    front_gap,
    muI,
    peak_gap,
    peak_less,
    shape_distance,
)
from runs.paper.verdicts import Clause, claims

CLAIMS, claim = claims()


@claim(
    "9, 10",
    "η_I and η_c = 0.4 Pa s give nearly the same fronts",
    f"fronts at all times within {SAME:g} % of the way from the gate, peaks within {SAME:g} %",
    front=True,
)
def same_fronts(t):
    clauses = []
    for w in ("winf", "w10"):
        for a in SLOPES:
            ours, other = f"eta0.4_a{a}_{w}", muI(a, w)
            gap = t.measure(lambda r, ours=ours, other=other: front_gap(t, ours, other, r))
            clauses.append(Clause(f"front {a}°, {w[1:]}", gap, "below", SAME, "%"))
            change = t.measure(lambda r, ours=ours, other=other: peak_gap(t, ours, other, r))
            clauses.append(Clause(f"peak {a}°, {w[1:]}", change, "below", SAME, "%"))
    return clauses


@claim(
    "9, 10",
    "the fronts of η_I and 0.4 Pa s differ more with lateral friction",
    "mean over the slopes of the difference of the fronts: w = 10 cm less w = ∞",
    front=True,
)
def larger_with_walls(t):
    def mean(w, r):
        return np.mean([front_gap(t, f"eta0.4_a{a}_{w}", muI(a, w), r) for a in SLOPES])

    more = t.measure(lambda r: mean("w10", r) - mean("winf", r))
    return [Clause("", more, "above", 0.0, "%")]


@claim(
    "11",
    "the shapes of η_I and 0.4 Pa s at peak velocity are very similar",
    f"L1 distance below {SAME:g} %, of the shapes as they are and of each in units of its length, up to where it is "
    "1, 5 or 10 mm thick",
)
def same_shapes(t):
    return [
        clause_in(
            t,
            LENGTHS,
            lambda r, mm, a=a: shape_distance(t, f"eta0.4_a{a}_w10", muI(a, "w10"), r, mm),
            f"{a}°",
            "below",
            SAME,
            "%",
        )
        for a in (0, 10, 16, 22)
    ]


@claim(
    "11",
    "the mean of η_I in the flowing part is near 0.4 Pa s",
    "volume mean over the flowing part at peak velocity, w = 10 cm, between 0.3 and 0.5",
)
def mean_viscosity(t):
    return [
        Clause(f"{a}°", t.value(muI(a, "w10"), "eta_mean_Pa_s"), "within", (0.3, 0.5), "Pa s")
        for a in (0, 10, 16, 22)
    ]


@claim(
    "VIII.A",
    "0.4 Pa s is slightly above the mean of η_I",
    "mean over the flowing part, w = 10 cm, below 0.4: over all times, and at peak velocity (as in figure 11)",
)
def mean_below(t):
    return [
        Clause(
            f"{a}°",
            t.value(muI(a, "w10"), "eta_mean_all_Pa_s"),
            "below",
            0.4,
            "Pa s",
            of_paper=True,
            windows=(("at peak velocity", t.value(muI(a, "w10"), "eta_mean_Pa_s")),),
        )
        for a in SLOPES
    ]


@claim(
    "11",
    "η_I ranges over about 0.1–1 Pa s",
    "5 and 95 % of the flowing volume at peak velocity, within a factor of 2 of 0.1 and 1",
)
def range_of_viscosity(t):
    return [
        Clause(f"{a}° {label}", t.value(muI(a, "w10"), column), "within", limits, "Pa s")
        for a in (0, 10, 16, 22)
        for label, column, limits in (
            ("low", "eta_p05_Pa_s", (0.05, 0.2)),
            ("high", "eta_p95_Pa_s", (0.5, 2.0)),
        )
    ]


@claim(
    "VIII.A",
    "I goes from 1e-3 at the interface to about 1 at surface and front",
    "at peak velocity, w = 10 cm: medians of the lowest and of the uppermost full cell that flows of each column, "
    "and over the last 5 cm; within a factor of 3 of 1e-3, 1 and 1",
)
def range_of_inertial_number(t):
    return [
        Clause(f"{a}° {label}", t.value(muI(a, "w10"), column), "within", limits)
        for a in (0, 10, 16, 22)
        for label, column, limits in (
            ("interface", "I_interface", (1e-3 / 3.0, 3e-3)),
            ("surface", "I_surface", (1.0 / 3.0, 3.0)),
            ("front", "I_front", (1.0 / 3.0, 3.0)),
        )
    ]


@claim(
    "12–15", "a higher viscosity lowers the peak velocity", "peak at the lower less the higher η_c"
)
def higher_is_slower(t):
    pairs = [(0.1, 1, a, w) for a in (10, 16, 22) for w in ("w10", "w20")]
    pairs += [(1, 2, 22, w) for w in ("w10", "w20")]
    return [
        peak_less(
            t,
            f"eta{low:g}_a{a}_{w}",
            f"eta{high:g}_a{a}_{w}",
            f"{low:g}–{high:g} Pa s, {a}°, {w[1:]} cm",
            "above",
        )
        for low, high, a, w in pairs
    ]


@claim(
    "12, 13",
    "a higher viscosity does not change the early slope of the velocity",
    "acceleration from 0.3 to 0.6 m/s with η_c = 1 Pa s within 10 % of that with 0.1 Pa s",
)
def same_acceleration(t):
    def change(a, w, r):
        thin, thick = (t.row(f"eta{eta}_a{a}_{w}", r)["acceleration_m_s2"] for eta in ("0.1", "1"))
        return 100.0 * abs(thick / thin - 1.0)

    return [
        Clause(
            f"{a}°, w = {w[1:]} cm",
            t.measure(lambda r, a=a, w=w: change(a, w, r)),
            "below",
            10.0,
            "%",
        )
        for a in (10, 16, 22)
        for w in ("w10", "w20")
    ]


def plateau_clauses(t, eta, sense, widths=("w10", "w20")):
    """Length of the slow phase at 22 deg against the least that counts."""
    return [
        Clause(
            f"w = {w[1:]} cm",
            t.value(f"eta{eta:g}_a22_{w}", "plateau_duration_s"),
            sense,
            PLATEAU_LEAST,
            "s",
        )
        for w in widths
    ]


@claim(
    "12–15",
    "η_c = 1 Pa s gives a slow propagation phase at 22°",
    f"a plateau of the front velocity of at least {PLATEAU_LEAST} s",
)
def slow_phase(t):
    ratio = ", ".join(f"{t.row(f'eta1_a22_{w}')['tail_ratio']:.2f}" for w in ("w10", "w20"))
    return plateau_clauses(t, 1, "above"), f"time below over time above half the peak {ratio}"


@claim("14, 15", "the slow phase lasts longer with 2 Pa s", "plateau with 2 less that with 1 Pa s")
def longer_phase(t):
    return [
        Clause(
            f"w = {w[1:]} cm",
            t.difference(f"eta2_a22_{w}", f"eta1_a22_{w}", "plateau_duration_s"),
            "above",
            0.0,
            "s",
        )
        for w in ("w10", "w20")
    ]


@claim("10, 12", "0.4 and 0.1 Pa s give no slow phase", f"no plateau as long as {PLATEAU_LEAST} s")
def no_phase(t):
    return plateau_clauses(t, 0.4, "below", ("w10",)) + plateau_clauses(t, 0.1, "below")


@claim(
    "12, 13",
    "a higher η_c bends the deceleration (fast, then slow)",
    "change of the deceleration over its mean, from 0.9 (0.85, 0.95) to 0.2 (0.15, 0.25) of the peak, grows with η_c "
    "at 22°, w = 10 cm",
)
def bends(t):
    def more(low, high, r, window):
        return bend(t, f"eta{high:g}_a22_w10", r, window) - bend(
            t, f"eta{low:g}_a22_w10", r, window
        )

    steps = ((0.1, 0.4), (0.4, 1), (1, 2))
    found = ", ".join(
        f"{t.measure(lambda r, eta=eta: bend(t, f'eta{eta:g}_a22_w10', r)).value:.2f}"
        for eta in (0.1, 0.4, 1, 2)
    )
    return [
        clause_in(
            t,
            BENDS,
            lambda r, window, low=low, high=high: more(low, high, r, window),
            f"{low:g}→{high:g} Pa s",
            "above",
            0.0,
        )
        for low, high in steps
    ], f"it is {found} of 0.1, 0.4, 1, 2 Pa s"


@claim(
    "16",
    "the deposits at 22° are nearly equal for η_I and 0.4–1 Pa s",
    f"L1 distance at 1.76 s, w = 10 cm, below {SAME:g} %",
)
def same_deposits(t):
    named = {"η_I": muI(22, "w10"), "0.4": "eta0.4_a22_w10", "1": "eta1_a22_w10"}
    return [
        Clause(f"{a}, {b}", deposit_gap(t, named[a], named[b]), "below", SAME, "%")
        for a, b in (("0.4", "η_I"), ("1", "η_I"), ("1", "0.4"))
    ]


@claim(
    "16",
    "the deposit of 2 Pa s at 22° is another one",
    f"L1 distance of 2 Pa s to the others above {SAME:g} %",
)
def other_deposit(t):
    named = {"η_I": muI(22, "w10"), "0.4": "eta0.4_a22_w10", "1": "eta1_a22_w10"}
    return [
        Clause(f"to {label}", deposit_gap(t, "eta2_a22_w10", other), "above", SAME, "%")
        for label, other in named.items()
    ]
