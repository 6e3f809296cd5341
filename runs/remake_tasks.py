"""What a change of the solver makes stale: tables and figures, how each is made, and what it costs.

In the order in which they are remade: the cheap and the important first. Costs are CPU seconds on one core as last
measured by hand; a stamp has the measured one.
"""

from typing import NamedTuple

WALLS, THIN = ("lateral_friction",), ("lateral_friction", "thin_layer")


class Task(NamedTuple):
    """One command and the files that it makes.

    Attributes
    ----------
    name : str
    command : tuple of str
        After `python -m`; {out}, {tables}, {data}, {workers} stand for folders and a number.
    makes : tuple of str
        Files below the repository, with wildcards. The command writes them below {tables} as it would below `runs`.
    effects : tuple of str or None
        Effects that are on in its runs, None: all. Others do not make it stale.
    cpu_s : float
        Last known cost.
    reads : tuple of str
        Files that it follows from, without runs of its own; then it writes to `makes` at once.
    after : tuple of str
        Names of tasks whose tables it reads below {tables}, beside making its own.
    """

    name: str
    command: tuple
    makes: tuple
    effects: tuple | None = None
    cpu_s: float = 0.0
    reads: tuple = ()
    after: tuple = ()

    @property
    def needs_data(self):
        """Sub-folder of the published data that it reads, "." for all of it; None without."""
        found = [part for part in self.command if part.startswith("{data}")]
        return found[0].removeprefix("{data}").strip("/") or "." if found else None


def study(name, part, makes, effects=None, cpu_s=0.0, data=None, options=()):
    """The task of one part of a study."""
    where = ("--out", "{out}/" + name, "--tables", "{tables}/" + name, "--workers", "{workers}")
    read = ("--data", "{data}/" + data if data else "{data}") if data is not None else ()
    files = tuple(f"runs/{name}/{file}" for file in makes)
    command = (f"runs.{name}.study", *part.split(), *where, *read, *options)
    return Task(f"{name} {part}".strip(), command, files, effects, cpu_s)


def converge(case, sizes, cpu_s):
    """The task of one stored convergence study."""
    out, report = "{out}/convergence/" + case, "{tables}/convergence/" + case + ".json"
    command = ("fvcollapse", "converge", f"runs/convergence/{case}.toml", "--cell-size", *sizes)
    command += ("--workers", "{workers}", "--out", out, "--json", report, "--force")
    return Task(f"convergence {case}", command, (f"runs/convergence/{case}.json",), WALLS, cpu_s)


def axis(name, option, values, cpu_s):
    """The task of a convergence study along another axis, 22 deg, w = 10 cm."""
    out, report = "{out}/convergence/" + name, "{tables}/convergence/" + name + ".json"
    command = ("fvcollapse", "converge", "runs/convergence/collapse_22deg_w10cm.toml", option)
    command += (*values, "--workers", "{workers}", "--out", out, "--json", report, "--force")
    return Task(f"convergence {name}", command, (f"runs/convergence/{name}.json",), WALLS, cpu_s)


def figures(name, module, pictures, reads, cpu_s=10.0):
    """The task of figures that follow from tables."""
    makes = tuple(f"plots/figures/{picture}" for picture in pictures)
    return Task(f"figures {name}", (f"plots.{module}",), makes, (), cpu_s, reads)


def report(name, arguments, file, cpu_s):
    """The task of a report of a command."""
    command = ("fvcollapse", *arguments, "--json", "{tables}/" + file)
    return Task(name, command, (f"runs/{file}",), None, cpu_s)


SIZES = ("0.006", "0.004", "0.003", "0.002")
CONVERGED = {  # case: CPU s
    f"collapse_{slope}deg_{width}": cpu_s
    for slope, cpu_s in ((0, 45.0), (16, 70.0), (22, 90.0))
    for width in ("w10cm", "winf")
}
PAPER = (
    "runs/paper/*/scalars.csv",
    "runs/paper/*/curves.csv",
    "runs/paper/*/labels.csv",
    "runs/paper/rough*/*/scalars.csv",
    "runs/paper/rough*/*/curves.csv",
)
SEARCHED = ("runs/paper/slow_phase/*.csv", "runs/paper/volume/*.csv")  # for figures, no statement
COMPARED = tuple(
    f"runs/comparison/{part}{kind}.csv"
    for part in ("columns", "volume_of_fluid", "channel", "plane")
    for kind in ("", "_profiles")
)
STATEMENTS = ("runs/paper/statements.csv", "runs/paper/statements.md")
LABORATORY = "particle_laboratory"
PAPER_PARTS = {  # part: CPU s
    "lateral_friction": 800.0,
    "rough/lateral_friction": 130.0,
    "viscosity": 200.0,
    "rough/viscosity": 200.0,
    "older_closure": 130.0,
    "double_counting": 130.0,
    "rough/double_counting": 90.0,
    "back_wall": 45.0,
    "rough_thin_layer/lateral_friction": 130.0,
    "rough/older_closure": 130.0,
    "rough/back_wall": 45.0,
    "refinement": 30.0,
    "sensitivity": 60.0,
    "rough_thin_layer/viscosity": 200.0,
    "rough_thin_layer/older_closure": 130.0,
    "rough_thin_layer/double_counting": 90.0,
    "rough_thin_layer/back_wall": 45.0,
    "finer": 2900.0,
}


def paper(part, cpu_s):
    """The task of one part of the study of the paper."""
    folders = [part] if part != "finer" else [part, f"rough/{part}", f"rough_thin_layer/{part}"]
    makes = [f"{folder}/{table}.csv" for folder in folders for table in ("scalars", "curves")]
    makes += [f"{part}/labels.csv"] if part == "sensitivity" else []
    effects = THIN if part.startswith(("rough_thin_layer", "finer")) else WALLS
    before = tuple(f"paper {of}" for of in PAPER_PARTS if of != part) if part == "finer" else ()
    return study("paper", part, makes, effects, cpu_s)._replace(after=before)


TASKS = (
    study("comparison", "bars", ("bars.csv", "bars_profiles.csv"), ("thin_layer",), 60.0, ""),
    figures(
        "aluminium_bars",
        "aluminium_bars",
        ("aluminium_bars.*",),
        ("runs/comparison/bars.csv", "runs/comparison/bars_profiles.csv"),
    ),
    study("paper_facts", "grid", ("grid.csv",), THIN, 300.0),
    study(LABORATORY, "thin_layers", ("thin_layers.csv",), ("thin_layer",), 350.0, "dem"),
    study(
        LABORATORY,
        "thin_layers_finer",
        ("thin_layers_finer.csv",),
        ("thin_layer",),
        300.0,
        "dem",
    ),
    study(LABORATORY, "walls", ("walls.csv",), None, 120.0, "dem"),
    study(LABORATORY, "mobilised", ("mobilised.csv",), ("lateral_friction", "gate"), 60.0, "dem"),
    study(LABORATORY, "shape", ("shape.csv",), None, 180.0, "dem"),
    study(LABORATORY, "closures", ("closures.csv",), None, 120.0, "dem"),
    study(LABORATORY, "validation", ("validation.csv", "curves.csv"), (), 60.0, "dem"),
    figures(
        LABORATORY,
        LABORATORY,
        ("particle_laboratory_*",),
        ("runs/particle_laboratory/validation.csv", "runs/particle_laboratory/curves.csv"),
    ),
    study("acceptance", "matrix", ("matrix.csv",), WALLS, 60.0),
    study("acceptance", "grid", ("grid.csv",), WALLS, 25.0),
    study("acceptance", "time_step", ("time_step.csv",), WALLS, 15.0),
    figures(
        "acceptance",
        "runout_against_slope",
        ("runout_against_slope.*",),
        ("runs/acceptance/matrix.csv", "runs/acceptance/grid.csv"),
    ),
    *(paper(part, cpu_s) for part, cpu_s in PAPER_PARTS.items()),
    study("paper", "slow_phase", ("slow_phase/phases.csv", "slow_phase/speeds.csv"), None, 1633.0),
    study(
        "paper",
        "volume",
        ("volume/runs.csv", "volume/seen.csv", "volume/changes.csv"),
        ("lateral_friction", "dilatancy", "transverse_profile"),
        1350.0,
    ),
    Task("paper statements", ("runs.paper.statements",), STATEMENTS, (), 5.0, PAPER),
    figures("paper", "paper", ("paper_*",), (*PAPER, *SEARCHED, *STATEMENTS), 60.0),
    study("paper_facts", "facts", ("facts.csv", "facts_sets.csv"), None, 840.0),
    study("paper_facts", "finer", ("finer.csv", "finer_sets.csv"), None, 120.0),
    study("paper_facts", "beds", ("beds.csv",), THIN, 300.0),
    study(
        "effects",
        "catalogue",
        ("effects.csv", "curves.csv"),
        None,
        900.0,
        options=("--cell-size", "0.006"),
    ),
    study(
        "effects",
        "dilatancy",
        ("dilatancy.csv",),
        ("lateral_friction", "dilatancy"),
        60.0,
        options=("--cell-size", "0.012"),
    ),
    figures("effects", "effects", ("effects_*",), ("runs/effects/*.csv",), 30.0),
    *(converge(case, SIZES, cpu_s) for case, cpu_s in CONVERGED.items()),
    axis("time_step", "--time-step", ("1.2e-3", "6e-4", "3e-4"), 30.0),
    axis("shear_rate_min", "--shear-rate-min", ("4e-3", "1e-3", "2.5e-4"), 15.0),
    axis("tolerance", "--tolerance", ("1e-2", "1e-3", "1e-4"), 20.0),
    figures("convergence", "convergence", ("convergence_*",), ("runs/convergence/*.json",)),
    study("comparison", "columns", ("columns.csv", "columns_profiles.csv"), (), 90.0),
    study(
        "comparison",
        "volume_of_fluid",
        ("volume_of_fluid.csv", "volume_of_fluid_profiles.csv"),
        (),
        75.0,
    ),
    study("comparison", "channel", ("channel.csv", "channel_profiles.csv"), WALLS, 180.0),
    study("comparison", "plane", ("plane.csv", "plane_profiles.csv"), (), 70.0),
    Task(
        "comparison differences",
        ("runs.comparison.study", "differences", "--data", "{data}"),
        ("runs/comparison/differences.csv", "runs/comparison/deposit_shapes.csv"),
        (),
        10.0,
        COMPARED,
    ),
    figures(
        "comparison",
        "comparison",
        ("comparison_*",),
        (*COMPARED, "runs/comparison/deposit_shapes.csv", "runs/comparison/reference/*.csv"),
    ),
    study("comparison", "steady_front", ("steady_front.csv",), ("thin_layer",), 240.0, ""),
    study("laboratories", "columns", ("columns.csv", "columns_fit.csv"), WALLS, 800.0),
    figures(
        "laboratory_columns",
        "laboratory_columns",
        ("laboratory_columns.*",),
        ("runs/laboratories/columns*.csv",),
    ),
    study("acceptance", "random", ("random.csv",), WALLS, 600.0),
    report("verification", ("verify",), "verification/verify.json", 300.0),
    report("bench", ("bench",), "bench/bench.json", 360.0),
    report("bench effects", ("bench", "--effects"), "bench/effects.json", 300.0),
)
