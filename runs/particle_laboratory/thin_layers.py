"""The references of the particle laboratory, in which nothing is hidden, with and without friction of thin layers.

L = 2.31 diameters was fixed from a chute, whose layers of 18 diameters stop at 26 deg, before any collapse was run: it
is the untuned value. They flow at 27 deg, so the chute allows up to 3.85. Another length is chosen by a rule on the
10 deg control: the least L whose front at rest is within `FRONT_LIMIT` and whose final thickness is within
`THICKNESS_LIMIT` rms. The rule was fixed with an earlier solver. Before that, 2.31, 3, 4 and 5 had been run on all
references, and lengths from 2.31 to 4.5 on the 10 deg control.
"""

from fvcollapse import load_case, load_experiment, observe
from fvcollapse.measure.align import align
from runs.study import run_cached
from runs.table import write_table

CELL_SIZES = (0.008, 0.006)  # m
REFERENCES = (  # folder; the five blind cases were opened after their answers had been scored
    "blind/b01",
    "labelled/control_10deg",
    "labelled/control_16deg",
    "blind/b03",
    "blind/b09",
    "blind/b02",
    "blind/b06",
)
FINER = 0.004  # m; without the closure `nonlocal`
FROM_CHUTE = 2.31  # diameters
LENGTHS = (FROM_CHUTE, 3.0, 3.6, 4.0, 5.0)  # diameters
TEACHER, FRONT_LIMIT, THICKNESS_LIMIT = "control_10deg", 0.006, 0.0045  # of the rule; m
FRONT_ASKED, THICKNESS_ASKED = 0.015, 0.0045  # m, of every reference
VARIANTS = (
    {"without": None}
    | {f"thickness, L = {length:g} d": {"length": length} for length in LENGTHS}
    | {"nonlocal, L = 2.31 d": {"length": FROM_CHUTE, "closure": "nonlocal"}}
)


def thin_layers(arguments, baseline, measures):
    """Write thin_layers.csv: front at rest and final thickness of every reference, variant and cell size.

    Parameters
    ----------
    arguments : argparse.Namespace
        Of the study.
    baseline : Path
        Case file of what is believed.
    measures : callable
        Pairs -> what one comparison says, lengths in m.
    """
    sizes = (arguments.cell_size,) if arguments.cell_size else CELL_SIZES
    compare(arguments, baseline, measures, {size: VARIANTS for size in sizes}, "thin_layers.csv")


def thin_layers_finer(arguments, baseline, measures):
    """Write thin_layers_finer.csv: the closure `thickness` on finer cells; see `thin_layers` for the arguments."""
    variants = {words: of for words, of in VARIANTS.items() if not words.startswith("nonlocal")}
    size = arguments.cell_size or FINER
    compare(arguments, baseline, measures, {size: variants}, "thin_layers_finer.csv")


def compare(arguments, baseline, measures, by_size, table):
    """Run the references and write a table.

    Parameters
    ----------
    arguments, baseline, measures
        See `thin_layers`.
    by_size : dict
        Cell size in m -> its variants.
    table : str
        Name of the table.
    """
    base = load_case(baseline)
    experiments = [load_experiment(arguments.data / name) for name in REFERENCES]
    cases = {
        (one.name, variant, size): one.case(base).replace(
            **{"grid.cell_size": size, "effects.thin_layer": effect}
        )
        for size, variants in by_size.items()
        for one in experiments
        for variant, effect in variants.items()
    }
    results = run_cached(cases, arguments)
    rows = []
    for size, variants in by_size.items():
        for one in experiments:
            for variant in variants:
                found = measures(align(observe(results[one.name, variant, size], one), one))
                slope = one.case(base).geometry.slope_angle_deg
                first = {"experiment": one.name, "slope_deg": slope}
                second = {"variant": variant, "cell_size": size}
                rows.append(first | second | {name: found[name] for name in COLUMNS})
    write_table(arguments.tables / table, rows)
    for row in rows:
        print("  ".join(f"{name} {value}" for name, value in row.items()))


COLUMNS = (
    "front_measured",
    "front_simulated",
    "front_difference",
    "final_thickness_rms",
    "thickness_rms_all_times",
)
