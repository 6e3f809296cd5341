"""What the paper's sections VIII and IX say of viscosity, pressure and mesh, as measures of the tables."""

import math

import numpy as np

from fvcollapse.studies.convergence import profile_distance
from runs.paper.cases import SLOPES
from runs.paper.measures import PLATEAU_LEAST
from runs.paper.statements_walls import LENGTH_0, muI
from runs.paper.verdicts import Clause, claims

SAME = 5.0  # %; curves and profiles that differ by less are "nearly the same"
ROUGH = 0.5  # mm; a surface that deviates more from a smooth one oscillates
CLAIMS, claim = claims()


def front_gap(t, case, other, refinement):
    """Largest difference of two fronts over the second one's way from the gate, %."""
    ours, theirs = (t.line(name, "front_m", refinement=refinement) for name in (case, other))
    time = max((ours.at, theirs.at), key=len)
    a, b = (np.interp(time, line.at, line.values) for line in (ours, theirs))
    return 100.0 * float(np.abs(a - b).max() / (b[-1] - LENGTH_0))


def profile_gap(t, case, other, quantity, time, refinement):
    """L1 distance of two profiles over the area of the second, %."""
    ours, theirs = (t.line(name, quantity, time, refinement=refinement) for name in (case, other))
    return 100.0 * profile_distance(*ours, *theirs)


@claim(
    "9, 10",
    "η_I and η_c = 0.4 Pa s give nearly the same fronts",
    f"fronts at all times within {SAME:g} % of the way from the gate, peaks within {SAME:g} %",
)
def same_fronts(t):
    clauses = []
    for w in ("winf", "w10"):
        for a in SLOPES:
            ours, other = f"eta0.4_a{a}_{w}", muI(a, w)
            gap = t.measure(lambda r, ours=ours, other=other: front_gap(t, ours, other, r))
            clauses.append(Clause(f"front {a}°, {w[1:]}", *gap, "below", SAME, "%"))
            change = t.measure(lambda r, ours=ours, other=other: peak_gap(t, ours, other, r))
            clauses.append(Clause(f"peak {a}°, {w[1:]}", *change, "below", SAME, "%"))
    return clauses


def peak_gap(t, case, other, refinement):
    """Difference of two peaks of the front velocity over the second, %."""
    ours, theirs = (t.row(name, refinement)["peak_velocity_m_s"] for name in (case, other))
    return 100.0 * abs(ours / theirs - 1.0)


@claim(
    "9, 10",
    "the differences are larger with lateral friction",
    "mean over the slopes of the difference of the fronts: w = 10 cm less w = ∞",
)
def larger_with_walls(t):
    def mean(w, r):
        return np.mean([front_gap(t, f"eta0.4_a{a}_{w}", muI(a, w), r) for a in SLOPES])

    more = t.measure(lambda r: mean("w10", r) - mean("winf", r))
    return [Clause("", *more, "above", 0.0, "%")]


@claim("11", "the shapes at peak velocity are very similar", f"L1 distance below {SAME:g} %")
def same_shapes(t):
    return [
        Clause(
            f"{a}°",
            *t.measure(
                lambda r, a=a: profile_gap(
                    t, f"eta0.4_a{a}_w10", muI(a, "w10"), "peak_thickness_mm", None, r
                )
            ),
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
        Clause(f"{a}°", *t.value(muI(a, "w10"), "eta_mean_Pa_s"), "within", (0.3, 0.5), "Pa s")
        for a in (0, 10, 16, 22)
    ]


@claim(
    "VIII.A",
    "0.4 Pa s is slightly above the mean of η_I",
    "mean over the flowing part and all times, w = 10 cm, below 0.4",
)
def mean_below(t):
    return [
        Clause(f"{a}°", *t.value(muI(a, "w10"), "eta_mean_all_Pa_s"), "below", 0.4, "Pa s")
        for a in SLOPES
    ]


@claim(
    "11",
    "η_I ranges over about 0.1–1 Pa s",
    "5 and 95 % of the flowing volume at peak velocity, within a factor of 2 of 0.1 and 1",
)
def range_of_viscosity(t):
    return [
        Clause(f"{a}° {label}", *t.value(muI(a, "w10"), column), "within", limits, "Pa s")
        for a in (0, 10, 16, 22)
        for label, column, limits in (
            ("low", "eta_p05_Pa_s", (0.05, 0.2)),
            ("high", "eta_p95_Pa_s", (0.5, 2.0)),
        )
    ]


@claim(
    "VIII.A",
    "I goes from 1e-3 at the interface to about 1 at surface and front",
    "quantiles of the flowing volume do not tell the values at interface, surface and front",
)
def range_of_inertial_number(t):
    rows = [t.row(muI(a, "w10"), 1.5) for a in (0, 10, 16, 22)]
    low, high = ([row[name] for row in rows] for name in ("I_p01", "I_p99"))
    return [], (
        f"1 and 99 % of the flowing volume at peak velocity: {min(low):.2g} to {max(low):.2g} and "
        f"{min(high):.2g} to {max(high):.2g}"
    )


@claim(
    "12–15", "a higher viscosity lowers the peak velocity", "peak at the lower less the higher η_c"
)
def higher_is_slower(t):
    pairs = [(0.1, 1, a, w) for a in (10, 16, 22) for w in ("w10", "w20")]
    pairs += [(1, 2, 22, w) for w in ("w10", "w20")]
    return [
        Clause(
            f"{low:g}–{high:g} Pa s, {a}°, {w[1:]} cm",
            *t.difference(f"eta{low:g}_a{a}_{w}", f"eta{high:g}_a{a}_{w}", "peak_velocity_m_s"),
            "above",
            0.0,
            "m/s",
        )
        for low, high, a, w in pairs
    ]


@claim(
    "12, 13",
    "without changing the early slope",
    "acceleration from 0.3 to 0.6 m/s with η_c = 1 Pa s within 10 % of that with 0.1 Pa s",
)
def same_acceleration(t):
    def change(a, w, r):
        thin, thick = (t.row(f"eta{eta}_a{a}_{w}", r)["acceleration_m_s2"] for eta in ("0.1", "1"))
        return 100.0 * abs(thick / thin - 1.0)

    return [
        Clause(
            f"{a}°, w = {w[1:]} cm",
            *t.measure(lambda r, a=a, w=w: change(a, w, r)),
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
            *t.value(f"eta{eta:g}_a22_{w}", "plateau_duration_s"),
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


@claim("14, 15", "it lasts longer with 2 Pa s", "plateau with 2 less that with 1 Pa s")
def longer_phase(t):
    return [
        Clause(
            f"w = {w[1:]} cm",
            *t.difference(f"eta2_a22_{w}", f"eta1_a22_{w}", "plateau_duration_s"),
            "above",
            0.0,
            "s",
        )
        for w in ("w10", "w20")
    ]


@claim("10, 12", "there is none with 0.4 nor 0.1 Pa s", f"no plateau as long as {PLATEAU_LEAST} s")
def no_phase(t):
    return plateau_clauses(t, 0.4, "below", ("w10",)) + plateau_clauses(t, 0.1, "below")


@claim(
    "12, 13",
    "a higher η_c bends the deceleration (fast, then slow)",
    "time below over time above half the peak, after it, grows with η_c at 22°, w = 10 cm",
)
def bends(t):
    steps = ((0.1, 0.4), (0.4, 1), (1, 2))
    return [
        Clause(
            f"{low:g}→{high:g} Pa s",
            *t.difference(f"eta{high:g}_a22_w10", f"eta{low:g}_a22_w10", "tail_ratio"),
            "above",
            0.0,
        )
        for low, high in steps
    ]


def deposit_gap(t, case, other):
    """L1 distance of two profiles at 1.76 s, `Measured`, %."""
    return t.measure(lambda r: profile_gap(t, case, other, "thickness_mm", 1.76, r))


@claim(
    "16",
    "the deposits at 22° are nearly equal for η_I and 0.4–1 Pa s",
    f"L1 distance at 1.76 s, w = 10 cm, below {SAME:g} %",
)
def same_deposits(t):
    named = {"η_I": muI(22, "w10"), "0.4": "eta0.4_a22_w10", "1": "eta1_a22_w10"}
    return [
        Clause(f"{a}, {b}", *deposit_gap(t, named[a], named[b]), "below", SAME, "%")
        for a, b in (("0.4", "η_I"), ("1", "η_I"), ("1", "0.4"))
    ]


@claim("16", "but not for 2 Pa s", f"L1 distance of 2 Pa s to the others above {SAME:g} %")
def other_deposit(t):
    named = {"η_I": muI(22, "w10"), "0.4": "eta0.4_a22_w10", "1": "eta1_a22_w10"}
    return [
        Clause(f"to {label}", *deposit_gap(t, "eta2_a22_w10", other), "above", SAME, "%")
        for label, other in named.items()
    ]


@claim(
    "4c, d, 17",
    "the surface at 22° oscillates with η_I",
    f"rms deviation from a smooth surface (15 cm) above {ROUGH:g} mm",
)
def rough_surface(t):
    return rough_clauses(t, "muI", "above")


@claim("17", "and not with constant viscosity", f"rms deviation below {ROUGH:g} mm, η_c = 0.4 Pa s")
def smooth_surface(t):
    return rough_clauses(t, "eta0.4", "below")


def rough_clauses(t, law, sense):
    """Roughness at 22 deg against what counts as an oscillation."""
    return [
        Clause(
            f"w = {w[1:]}, {time:g} s",
            *t.value(f"{law}_a22_{w}", f"roughness_{time:g}_mm"),
            sense,
            ROUGH,
            "mm",
        )
        for w in ("w10", "winf")
        for time in (0.96, 1.5)
    ]


PRESSURE_CASES = [
    (f"{label}, w = {w[1:]}", f"{law}_a22_{w}")
    for w in ("w10", "winf")
    for label, law in (("η_I", "muI"), ("0.4 Pa s", "eta0.4"))
]


@claim(
    "18",
    "the pressure deviates little from the hydrostatic one",
    "rms over the flowing part at 1.5 s, 22°, below 10 % of the pressure",
)
def near_hydrostatic(t):
    clauses = []
    for label, case in PRESSURE_CASES:
        value, error = t.value(case, "misfit_hydrostatic_1.5")
        clauses.append(Clause(label, 100.0 * value, 100.0 * error, "below", 10.0, "%"))
    return clauses


@claim(
    "18",
    "equation 22 is clearly closer, for both viscosities",
    "its rms misfit over the flowing part at 1.5 s less than half of the hydrostatic one",
)
def equation_22_closer(t):
    def ratio(case, r):
        row = t.row(case, r)
        return row["misfit_22_1.5"] / row["misfit_hydrostatic_1.5"]

    early = ", ".join(
        f"{t.row(case)['misfit_22_0.96'] / t.row(case)['misfit_hydrostatic_0.96']:.2f}"
        for _, case in PRESSURE_CASES
    )
    return [
        Clause(label, *t.measure(lambda r, case=case: ratio(case, r)), "below", 0.5)
        for label, case in PRESSURE_CASES
    ], f"at 0.96 s {early}"


@claim(
    "18",
    "with the same precision for both",
    "misfits of (22) differ by less than 2 % of the pressure",
)
def same_precision(t):
    clauses = []
    for w in ("w10", "winf"):
        value, error = t.difference(f"eta0.4_a22_{w}", muI(22, w), "misfit_22_1.5")
        clauses.append(Clause(f"w = {w[1:]}", 100.0 * abs(value), 100.0 * error, "below", 2.0, "%"))
    return clauses


# -- section IX ----------------------------------------------------------------------------------

FINEST = 3.0


@claim(
    "IX",
    "refinement brings small-scale shear bands",
    "shear bands per column at 0.48 s: a third as large cells give at least 0.5 more",
)
def shear_bands(t):
    sizes = (1.0, 1.5, 2.0, FINEST)
    numbers = [t.row(muI(22, "w10"), r)["bands_0.48"] for r in sizes]
    uneven = [t.row(muI(22, "w10"), r)["unevenness_0.48"] for r in sizes]
    change = Clause("", numbers[-1] - numbers[0], abs(numbers[-1] - numbers[-2]), "above", 0.5)
    return [change], (
        f"bands {', '.join(f'{n:.2f}' for n in numbers)}; shear unevenness on 12 mm "
        f"{', '.join(f'{u:.3f}' for u in uneven)} from coarse to fine"
    )


@claim(
    "IX",
    "profiles, interface and velocity range barely change",
    "between the coarsest and cells a third as large: thickness and interface at 0.48 s by less "
    f"than {SAME:g} % of the pile, largest speed by less than {SAME:g} %",
)
def barely_change(t):
    case = muI(22, "w10")
    fine, coarse = (t.line(case, "thickness_mm", 0.48, refinement=r) for r in (FINEST, 1.0))
    static_fine, static = (t.line(case, "static_mm", 0.48, refinement=r) for r in (FINEST, 1.0))
    area = np.trapezoid(fine.values, fine.at)
    gap = np.abs(
        np.interp(fine.at, *static, right=0.0) - np.interp(fine.at, *static_fine, right=0.0)
    )
    speeds = [t.row(case, r)["max_speed_m_s"] for r in (1.0, FINEST)]
    values = {
        "thickness": 100.0 * profile_distance(*coarse, *fine),
        "interface": 100.0 * np.trapezoid(gap, fine.at) / area,
        "speed": 100.0 * abs(speeds[0] / speeds[1] - 1.0),
    }
    return [Clause(name, value, math.nan, "below", SAME, "%") for name, value in values.items()]
