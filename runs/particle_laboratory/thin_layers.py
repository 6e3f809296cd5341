"""The references of the particle laboratory, in which nothing is hidden, with and without friction of thin layers.

The length of the effect comes from outside the table, either from a chute, whose layers of 18 diameters stop at 26 deg
(2.31 diameters), or from the 10 deg control alone: the least length with which its front at rest is met within
6 mm and its final thickness within 4.5 mm rms (3.6 diameters on 8 mm cells).
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
FROM_CHUTE, FROM_CONTROL = 2.31, 3.6  # diameters
VARIANTS = {
    "without": None,
    "thickness, L of the chute": {"length": FROM_CHUTE},
    "thickness, L of the 10 deg control": {"length": FROM_CONTROL},
    "nonlocal, L of the chute": {"length": FROM_CHUTE, "closure": "nonlocal"},
}


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
