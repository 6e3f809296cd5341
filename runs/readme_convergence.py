"""Tables of the convergence studies for their README, from the stored reports."""

from fvcollapse.studies.convergence import SAFETY, SAFETY_UNKNOWN
from runs.readme_stamps import solver_line
from runs.readme_tables import bullets, require, rounded, span, stored, table

FOLDER = "convergence"
CASES = {  # report: words
    f"collapse_{slope}deg_{width}": f"{slope}°, {wide}"
    for slope in (0, 16, 22)
    for width, wide in (("w10cm", "10 cm"), ("winf", "∞"))
}
AXES = {  # report: (words of the axis, unit of its values, the values)
    "time_step": ("time step", "ms", ("1.2", "0.6", "0.3")),
    "shear_rate_min": ("regularisation", "10⁻³ /s", ("4", "1", "0.25")),
    "tolerance": ("tolerance of the sweeps", "", ("10⁻²", "10⁻³", "10⁻⁴")),
}
PERCENT, MM = 100, 1000


def reports():
    """{name: report} of the cases."""
    return {name: stored(FOLDER, f"{name}.json") for name in CASES}


def told(report, name, digits, scale=1):
    """Values of an observable in the order of the grids; what the last has not is left out."""
    values = [value for value in report[name]["value"] if value is not None]
    return ", ".join(rounded(value, digits, scale) for value in values)


def made(names):
    """The line that names the solver of reports."""
    return solver_line(*(f"{FOLDER}/{name}.json" for name in names))


def convergence():
    """Values on the grids, index of the 10 mm runout, and differences of the final profile."""
    lines = []
    for name, report in reports().items():
        indices = (rounded(of["gci"], 2, PERCENT) for of in report["runout_10mm"]["triplets"])
        lines.append(
            (
                CASES[name],
                told(report, "runout_10mm", 3),
                ", ".join(indices),
                told(report, "runout", 3),
                told(report, "profile_l1", 2, PERCENT),
                told(report, "final_thickness", 1, MM),
                told(report, "peak_front_velocity", 2),
            )
        )
    heading = ("case", "10 mm runout (m)", "GCI at 3, 2 mm (%)", "5 mm runout (m)", "profile (%)")
    heading = (*heading, "final height (mm)", "peak front velocity (m/s)")
    return table(heading, lines) + made(CASES)


def convergence_says():
    """What the table says: how far the runouts still move, the order of the profile, the time of arrest."""
    found = reports()
    profiles = [of for of in orders(found, "profile_l1") if of is not None]
    runouts = [of for of in orders(found, "runout_10mm") if of is not None]
    walled = [
        found[name]["arrest_time"]["value"]
        for name in ("collapse_0deg_w10cm", "collapse_16deg_w10cm")
    ]
    require(all(of[-1] > of[-2] for of in walled), "the time of arrest grows from 3 to 2 mm")
    arrest = " and ".join(
        f"{rounded(of[-2], 2)} to {rounded(of[-1], 2)} s (+{rounded(of[-1] / of[-2] - 1.0, 0, PERCENT)} %)"
        for of in walled
    )
    return bullets(
        [
            f"From 3 to 2 mm the 10 mm runout moves by {moves(found, 'runout_10mm')} %, the 5 mm runout by "
            f"{moves(found, 'runout')} %, the 1 mm runout by {moves(found, 'runout_1mm')} %.",
            f"On the finest three grids the final profile falls into an order in {len(profiles)} of {len(found)} "
            f"cases, {span(profiles, lambda of: rounded(of, 1))}, the 10 mm runout in {len(runouts)}. Without an "
            f"order the index is {SAFETY_UNKNOWN:g} times the largest difference, or no less than {SAFETY:g} times it.",
            f"The time of arrest at 0 and 16° with walls still grows from 3 to 2 mm: {arrest}.",
        ]
    )


def orders(found, name):
    """Order of an observable on the finest three grids of every case; None where it falls into none."""
    finest = [report[name]["triplets"][-1] for report in found.values()]
    return [of["order"] if of["behaviour"] == "monotone" else None for of in finest]


def moves(found, name):
    """Range of the sizes of the change of an observable between the finest two grids, %."""
    pairs = [report[name]["value"][-2:] for report in found.values()]
    return span([abs(fine / coarse - 1.0) for coarse, fine in pairs], as_percent)


def as_percent(value):
    """A share in %, two decimals."""
    return rounded(value, 2, PERCENT)


def axes():
    """The same observables along the other axes."""
    lines = []
    for name, (words, unit, values) in AXES.items():
        report = stored(FOLDER, f"{name}.json")
        lines.append(
            (
                f"{words} {', '.join(values)} {unit}".strip(),
                told(report, "runout_10mm", 3),
                told(report, "runout", 3),
                told(report, "x_99", 3),
                told(report, "peak_front_velocity", 2),
                told(report, "profile_l1", 2, PERCENT),
            )
        )
    heading = ("axis", "10 mm runout (m)", "5 mm runout (m)", "x₉₉ (m)")
    return table((*heading, "peak front velocity (m/s)", "profile (%)"), lines) + made(AXES)
