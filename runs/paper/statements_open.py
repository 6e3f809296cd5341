"""What the paper leaves open, or says of other closures, as measures of the tables."""

import numpy as np

from runs.paper.cases import SENSITIVITIES, SLOPES, WIDTHS
from runs.paper.statement_terms import LENGTH_0, SALTATION, muI, shape_gap
from runs.paper.verdicts import Clause, claims, rounded

MEASURED_RUNOUT, READING = 0.275, 0.005  # m from the gate at 0 deg, Mangeney et al. (2010)
DEPOSIT_LIMIT = 1.6  # m; the measured deposit at 22 deg, w = 10 cm, is shorter
AT_REST = 0.02  # share of the volume; less counts as a mass that has stopped
CLAIMS, claim = claims()


# -- the older closure -----------------------------------------------------------------------------


@claim(
    "V, (21)",
    "the older closure slows the flow",
    "h = 5 cm: shortens the runout at 16–22°, w = 10 cm, by more than 2 cm",
    front=True,
)
def older_slows(t):
    return [
        Clause(
            f"{a}°",
            t.difference(muI(a, "winf"), f"older_a{a}_w10", t.runout),
            "above",
            SALTATION,
            "m",
        )
        for a in (16, 19, 22)
    ]


@claim(
    "V, (21)",
    "the older closure does not change the velocity field, unlike the sink",
    "rms change of u over its surface value against w = ∞ (0.48 s, three columns): "
    "less than half of that by the sink",
)
def older_keeps_velocity(t):
    clauses = []
    for a in (10, 16, 22):

        def ratio(r, a=a):
            older, sink = (
                shape_gap(t, case, muI(a, "winf"), r) for case in (f"older_a{a}_w10", muI(a, "w10"))
            )
            return older / sink

        clauses.append(Clause(f"{a}°", t.measure(ratio), "below", 0.5))
    return clauses


def closure_clauses(t, column, limit, sense, unit, slopes=SLOPES):
    """Older closure less sink, at every slope and both widths, as moduli."""
    clauses = []
    for w in ("w10", "w20"):
        for a in slopes:
            gap = abs(t.difference(f"older_a{a}_{w}", muI(a, w), column))
            clauses.append(Clause(f"{a}°, {w[1:]} cm", gap, sense, limit, unit))
    return clauses


@claim(
    "VII (question)",
    "older closure (h = 5 cm) and sink give the same runout",
    "older (h = 5 cm) and sink within 2 cm",
    front=True,
)
def closures_same_runout(t):
    layers = ", ".join(f"{t.row(muI(a, 'w10'))['flowing_thickness_m']:.3f}" for a in SLOPES)
    return (
        closure_clauses(t, t.runout, SALTATION, "below", "m"),
        f"the flowing layer is {layers} m thick at {', '.join(map(str, SLOPES))}°",
    )


@claim(
    "VII (question)",
    "older closure (h = 2.5 cm, about what flows at 22°) and sink give the same runout",
    "older (h = 2.5 cm) and sink within 2 cm, w = 10 cm",
    front=True,
)
def closures_same_runout_25mm(t):
    clauses = []
    for a in SLOPES:
        gap = abs(t.difference(f"older25mm_a{a}_w10", muI(a, "w10"), t.runout))
        clauses.append(Clause(f"{a}°", gap, "below", SALTATION, "m"))
    return clauses


@claim(
    "V",
    "only the sink changes the shape of the interface",
    "angle of the interface to the bed at 0.48 s, w = 10 cm: the sink steepens it more than (21)",
)
def interface_of_closures(t):
    return [
        Clause(
            f"{a}°",
            t.difference(muI(a, "w10"), f"older_a{a}_w10", "interface_angle_0.48_deg"),
            "above",
            0.0,
            "°",
        )
        for a in (10, 16, 22)
    ]


# -- back wall -----------------------------------------------------------------------------------


@claim(
    "(14), VI",
    "µ_w or µ_b on the back wall does not matter (question)",
    "runouts within 2 cm, w = 10 cm",
    front=True,
)
def back_wall(t):
    clauses = []
    for a in SLOPES:
        gap = abs(t.difference(f"back0.18_a{a}_w10", muI(a, "w10"), t.runout))
        clauses.append(Clause(f"{a}°", gap, "below", SALTATION, "m"))
    change = t.difference("back0.18_a22_w10", muI(22, "w10"), "rear_height_m")
    return clauses, f"thickness near the back wall at 22° {1e3 * change.value:+.1f} mm with µ_w"


# -- are the walls counted twice? ------------------------------------------------------------------

VARIANTS = {  # words: (name of the case, width of the case)
    "0.48, 0.73 with the sink": ("muI", "w10"),
    "0.48, 0.73 without": ("muI", "winf"),
    "0.38, 0.64 with the sink": ("mu38", "w10"),
    "0.38, 0.64 without": ("mu38", "winf"),
    "0.38, 0.64, µ_b = 0.38 with the sink": ("mu38_bed38", "w10"),
    "0.38, 0.64, µ_b = 0.38 without": ("mu38_bed38", "winf"),
}


def count_twice(words, name, width):
    """Add the claim that one set of parameters agrees with what is known of w = 10 cm."""

    @claim(
        "Table I (question)",
        f"µ1, µ2 = {words.removesuffix(' the sink')} the sink agrees with the experiment, w = 10 cm",
        "runout at 0° within 2.5 cm of 0.475 m and at 22° below 1.6 m, less than 2 % of the "
        "volume flowing at 1.76 s and 22°",
        front=True,
        on_beds="µ_b" not in words,
    )
    def agrees(t):
        flat, steep = f"{name}_a0_{width}", f"{name}_a22_{width}"
        middle, slack = LENGTH_0 + MEASURED_RUNOUT, SALTATION + READING
        clauses = [
            Clause(
                "0°",
                t.value(flat, t.runout),
                "within",
                (middle - slack, middle + slack),
                "m",
                of_paper=True,
            ),
            Clause("22°", t.value(steep, t.runout), "below", DEPOSIT_LIMIT, "m", of_paper=True),
            Clause("flowing", t.value(steep, "flowing_share_1.76"), "below", AT_REST),
        ]
        row, thick = t.row(flat), t.row(steep)
        return clauses, (
            f"0°: 1 mm {row['runout_1mm_m']:.3f}, 10 mm {row['runout_10mm_m']:.3f}, height "
            f"{row['final_height_m']:.3f} m (measured 0.14); 22°: 1 mm {thick['runout_1mm_m']:.2f}, "
            f"10 mm {thick['runout_10mm_m']:.2f} m"
        )


for _words, (_name, _width) in VARIANTS.items():
    count_twice(_words, _name, _width)


# -- tables beside the statements ------------------------------------------------------------------


def sensitivity_rows(t):
    """Rows (change, runouts at 10, 5, 1 mm less those of the reference, what moves beyond the grid)."""
    reference = muI(22, "winf")
    columns = ("runout_10mm_m", "runout_5mm_m", "runout_1mm_m")
    rows = [("reference", *(f"{t.row(reference)[name]:.3f}" for name in columns), "")]
    errors = [t.value(reference, name).uncertainty for name in columns]
    rows.append(("its grid uncertainty", *(f"± {error:.3f}" for error in errors), ""))
    for name, (words, _) in SENSITIVITIES.items():
        row = t.row(f"{name}_a22_winf")
        changes = [row[column] - t.row(reference)[column] for column in columns]
        moved = [
            label
            for label, change, error in zip(("10", "5", "1"), changes, errors, strict=True)
            if abs(change) > error
        ]
        verdict = f"beyond the grid at {', '.join(moved)} mm" if moved else "within the grid"
        rows.append((words, *(f"{change:+.3f}" for change in changes), verdict))
    return rows


def front_moves(t, case):
    """Whether the front still advances when the run ends."""
    front = t.line(case, "front_m")  # ends where the front comes to rest
    if front.at[-1] < t.row(case)["end_s"] - 0.05:
        return False
    last = np.interp([front.at[-1] - 0.1, front.at[-1]], front.at, front.values)
    return last[1] - last[0] > 1.0e-3  # m


def parameter_rows(t):
    """Rows (set, width, runout (5 mm) at each slope, flowing share at 1.76 s and 22 deg).

    Of a run whose front still moves at its end the runout is a lower bound.
    """
    sets = dict.fromkeys(
        (words.removesuffix(" with the sink"), name)
        for words, (name, width) in VARIANTS.items()
        if width == "w10"
    )
    rows = []
    for words, name in sets:
        for width in WIDTHS:
            found = [t.value(f"{name}_a{a}_{width}", "runout_5mm_m") for a in SLOPES]
            flowing = t.row(f"{name}_a22_{width}")["flowing_share_1.76"]
            label = "w = ∞, no sink" if width == "winf" else f"w = {width[1:]} cm, sink"
            values = [
                f"> {of.value:.3f}"
                if front_moves(t, f"{name}_a{a}_{width}")
                else f"{of.value:.3f} ± {rounded(of.uncertainty)}"
                for a, of in zip(SLOPES, found, strict=True)
            ]
            rows.append((words, label, *values, f"{flowing:.3f}"))
    return rows


TABLES = (  # title, head, rows
    (
        "Runout at 22° without lateral friction: what each change moves (m)",
        ("change", "at 10 mm", "at 5 mm", "at 1 mm", "against the grid uncertainty"),
        sensitivity_rows,
    ),
    (
        "Parameter sets with and without the sink: runout (5 mm) from the back wall (m); >: ended in motion",
        ("µ1, µ2", "walls", *(f"{a}°" for a in SLOPES), "flowing share at 1.76 s, 22°"),
        parameter_rows,
    ),
)
