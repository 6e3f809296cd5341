"""What the paper's section IX says of pressure, surface and mesh, as measures of the tables."""

import numpy as np

from fvcollapse.studies.convergence import profile_distance
from runs.measured import Measured
from runs.paper.statement_terms import SAME, muI
from runs.paper.verdicts import Clause, claims

ROUGH = 0.5  # mm; a surface that deviates more from a smooth one oscillates
CLAIMS, claim = claims()


@claim(
    "4c, d, 17",
    "the surface at 22° oscillates with η_I",
    f"rms deviation from a smooth surface (15 cm) above {ROUGH:g} mm",
)
def rough_surface(t):
    return rough_clauses(t, "muI", "above")


@claim(
    "17",
    "the surface at 22° does not oscillate with constant viscosity",
    f"rms deviation below {ROUGH:g} mm, η_c = 0.4 Pa s",
)
def smooth_surface(t):
    return rough_clauses(t, "eta0.4", "below")


def rough_clauses(t, law, sense):
    """Roughness at 22 deg against what counts as an oscillation."""
    return [
        Clause(
            f"w = {w[1:]}, {time:g} s",
            t.value(f"{law}_a22_{w}", f"roughness_{time:g}_mm"),
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
        misfit = t.value(case, "misfit_hydrostatic_1.5").scaled(100.0)
        clauses.append(Clause(label, misfit, "below", 10.0, "%"))
    return clauses


@claim(
    "18",
    "equation 22 is clearly closer to the pressure than the hydrostatic one",
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
        Clause(label, t.measure(lambda r, case=case: ratio(case, r)), "below", 0.5)
        for label, case in PRESSURE_CASES
    ], f"at 0.96 s {early}"


@claim(
    "18",
    "equation 22 is as precise for η_I as for 0.4 Pa s",
    "misfits of (22) differ by less than 2 % of the pressure",
)
def same_precision(t):
    clauses = []
    for w in ("w10", "winf"):
        gap = abs(t.difference(f"eta0.4_a22_{w}", muI(22, w), "misfit_22_1.5")).scaled(100.0)
        clauses.append(Clause(f"w = {w[1:]}", gap, "below", 2.0, "%"))
    return clauses


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
    more = Measured(numbers[-1] - numbers[0], abs(numbers[-1] - numbers[-2]))
    return [Clause("", more, "above", 0.5)], (
        f"bands {', '.join(f'{n:.2f}' for n in numbers)}; shear unevenness on 12 mm "
        f"{', '.join(f'{u:.3f}' for u in uneven)} from coarse to fine"
    )


@claim(
    "IX",
    "refinement barely changes profiles, interface and velocity range",
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
    # what these two grids differ by has no grid uncertainty
    return [
        Clause(name, Measured(value, 0.0), "below", SAME, "%") for name, value in values.items()
    ]
