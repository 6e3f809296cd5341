"""The references of the particle laboratory, in which nothing is hidden, with and without friction of thin layers.

L = 2.31 diameters was fixed from a chute, whose layers of 18 diameters stop at 26 deg, before any collapse was run: it
is the untuned value. The other lengths are not. 2.31, 3, 4 and 5 had been run on all references, and lengths from 2.31
to 4.5 on the 10 deg control, before the rule was fixed that chooses 3.6: the least L whose front at rest is within 6 mm
and whose final thickness is within 4.5 mm rms at 10 deg. The front at 10 deg alone would choose 5, which is too short
at 22 deg.
"""

from fvcollapse import load_case, load_experiment, observe
from fvcollapse.measure.align import align
from runs.study import run_cached
from runs.table import write_table

CELL_SIZE = 0.008  # m
REFERENCES = (  # folder; the five blind cases were opened after their answers had been scored
    "blind/b01",
    "labelled/control_10deg",
    "labelled/control_16deg",
    "blind/b03",
    "blind/b09",
    "blind/b02",
    "blind/b06",
)
FROM_CHUTE = 2.31  # diameters
LENGTHS = (FROM_CHUTE, 3.0, 3.6, 4.0, 5.0)  # diameters
VARIANTS = (
    {"without": None}
    | {f"thickness, L = {length:g} d": {"length": length} for length in LENGTHS}
    | {"nonlocal, L = 2.31 d": {"length": FROM_CHUTE, "closure": "nonlocal"}}
)


def thin_layers(arguments, baseline, measures):
    """Write thin_layers.csv: front at rest and final thickness of every reference and variant.

    Parameters
    ----------
    arguments : argparse.Namespace
        Of the study.
    baseline : Path
        Case file of what is believed.
    measures : callable
        Pairs -> what one comparison says, lengths in m.
    """
    base = load_case(baseline)
    experiments = [load_experiment(arguments.data / name) for name in REFERENCES]
    size = arguments.cell_size or CELL_SIZE
    cases = {
        (one.name, variant): one.case(base).replace(
            **{"grid.cell_size": size, "effects.thin_layer": effect}
        )
        for one in experiments
        for variant, effect in VARIANTS.items()
    }
    results = run_cached(cases, arguments)
    rows = []
    for one in experiments:
        for variant in VARIANTS:
            found = measures(align(observe(results[one.name, variant], one), one))
            rows.append(
                {
                    "experiment": one.name,
                    "slope_deg": one.case(base).geometry.slope_angle_deg,
                    "variant": variant,
                    "cell_size": size,
                }
                | {name: found[name] for name in COLUMNS}
            )
    write_table(arguments.tables / "thin_layers.csv", rows)
    for row in rows:
        print("  ".join(f"{name} {value}" for name, value in row.items()))


COLUMNS = (
    "front_measured",
    "front_simulated",
    "front_difference",
    "final_thickness_rms",
    "thickness_rms_all_times",
)
