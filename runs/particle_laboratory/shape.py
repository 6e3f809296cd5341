"""Effects that could give the model the shape and the volume of the piles of the grains, in all references.

The pile of grains is higher at the back wall and lower in front of the middle than that of the model, and its volume
grows while it moves. Every effect has a value from outside the collapses where there is one: the length of thin layers
of a chute, the solid fraction in steady shear (0.561 - 0.121 I) and at the start; otherwise two values of its prior.
The longer length of thin layers is that which the 10 deg control chooses on these cells (`thin_layers.py`).
"""

import math

import numpy as np

from fvcollapse import load_case, load_experiment
from runs.particle_laboratory.readings import BEFORE_MIDDLE, LAST, REAR, of_grains, of_model
from runs.particle_laboratory.thin_layers import REFERENCES
from runs.study import run_cached
from runs.table import write_table

CELL_SIZE = 0.008  # m
AT_START = {"b03": 0.562}  # solid fraction of a reference that starts looser than 0.575
THIN = {"effects.thin_layer": {"length": 2.31}}
LONGER = {"effects.thin_layer": {"length": 4.0}}


def dilating(factor, at_start=0.575):
    """Settings of dilatancy with the solid fraction measured in steady shear."""
    section = {
        "dilatancy_factor": factor,
        "solid_fraction_critical": 0.561,
        "solid_fraction_slope": 0.121,
        "solid_fraction_0": at_start,
    }
    return {"effects.dilatancy": section}


def settled(delta_mu):
    """Settings of hysteresis."""
    return {"effects.friction_hysteresis": {"delta_mu": delta_mu}}


VARIANTS = {
    "without": {},
    "thin_layer 2.31 d": THIN,
    "thin_layer 4 d": LONGER,
    "dilatancy, K = 2": dilating(2.0),
    "dilatancy, K = 4": dilating(4.0),
    "hysteresis 0.03": settled(0.03),
    "hysteresis 0.06": settled(0.06),
    "back wall: 0": {"boundary.mu_back_wall": 0.0},
    "back wall: 1": {"boundary.mu_back_wall": 1.0},
    "back wall: no slip": {"boundary.mu_back_wall": math.inf},
    "thin_layer, dilatancy K = 4": THIN | dilating(4.0),
    "thin_layer 4 d, dilatancy K = 4": LONGER | dilating(4.0),
    "thin_layer, hysteresis 0.03": THIN | settled(0.03),
    "thin_layer, dilatancy K = 4, hysteresis 0.03": THIN | dilating(4.0) | settled(0.03),
    "thin_layer, dilatancy K = 4, hysteresis 0.06": THIN | dilating(4.0) | settled(0.06),
}


def shape(arguments, baseline):
    """Write shape.csv: final thickness, front and largest volume of every reference and variant.

    Parameters
    ----------
    arguments : argparse.Namespace
        Of the study.
    baseline : Path
        Case file of what is believed.
    """
    base, size = load_case(baseline), arguments.cell_size or CELL_SIZE
    experiments = [load_experiment(arguments.data / name) for name in REFERENCES]
    cases = {
        (one.name, words): as_packed(
            one.case(base).replace(**{"grid.cell_size": size}, **settings), one.name
        )
        for one in experiments
        for words, settings in VARIANTS.items()
    }
    results = run_cached(cases, arguments)
    rows = [
        {"experiment": one.name, "variant": words, "cell_size": size}
        | compared(of_model(results[one.name, words], one), of_grains(one))
        for one in experiments
        for words in VARIANTS
    ]
    write_table(arguments.tables / "shape.csv", rows)
    for row in rows:
        print("  ".join(f"{name} {value}" for name, value in row.items()))


def as_packed(case, name):
    """A case with dilatancy from the solid fraction at which this reference starts; any other as it is."""
    if case.effects.dilatancy is None or name not in AT_START:
        return case
    return case.replace(**{"effects.dilatancy.solid_fraction_0": AT_START[name]})


def compared(model, grains):
    """Model less grains in mm; largest and last relative volume change of both in %."""
    gap = 1e3 * (model.thickness - grains.thickness)
    way = grains.x / grains.front_at_rest
    low, high = BEFORE_MIDDLE
    found = {
        "front": 1e3 * (model.front_at_rest - grains.front_at_rest),
        "thickness_rms": np.sqrt(np.mean(gap**2)),
        "at_back_wall": gap[grains.x <= 0.5 * REAR].mean(),
        "before_middle": gap[(way >= low) & (way <= high)].mean(),
        "volume_model": 100.0 * model.volume.max(),
        "volume_grains": 100.0 * grains.volume.max(),
        "volume_model_end": 100.0 * model.volume[-LAST:].mean(),
        "volume_grains_end": 100.0 * grains.volume[-LAST:].mean(),
    }
    return {name: round(float(value), 1) for name, value in found.items()}
