"""What makes a diagnosis hard, taken out of the label of a case, whose hidden cause stays the same.

Every function takes a label (see `generator.draw_label`) and returns another one, from which the case can be made
again. `LADDER` takes one thing after the other out, so that the same cases are answered on every rung of it.
"""

from copy import deepcopy
from functools import partial

from fvcollapse.blind.set_ups import BELIEVED, MATERIAL_SD, STATEMENTS, set_up_of
from fvcollapse.blind.worlds import STEP, numerics_keys
from fvcollapse.case.case import Case, case_from_text
from fvcollapse.diagnosis.baseline import CELLS, LONGEST_STEP, REFINEMENT
from fvcollapse.measure.comparison import value_of

EXACT = "exact"  # key of `STATEMENTS`
SIZES = ("geometry.length_0", "geometry.height_0")  # of the column
BETTER = 0.25  # errors of single readings in an exact laboratory, over those that the world was drawn with
# longest step of the finer runs of a diagnosis, over that of a world
USUAL_STEP = 0.5 * LONGEST_STEP / STEP


def catalogue_closures(label):
    """The label whose effects act by their closures of the catalogue."""
    label = deepcopy(label)
    label["form"] = None
    for run in label["experiments"].values():
        run.pop("without", None)
        run.pop("form", None)
    return label


def believed_physics(label):
    """The label in a world without physics of its own, and without a smooth error of the believed model."""
    label = deepcopy(label)
    world = label["world"]
    off = {f"effects.{name}": None for name in world["effects"]}
    for _, run in runs_of(label):
        recast(run, lambda case: off)
        for part in ("forces", "readings"):
            run[part] = [each for each in run[part] if each not in world[part]]
    world |= {"kinds": [], "effects": {}, "forces": [], "readings": []}
    return label


def usual_numerics(label):
    """The label whose truths are computed on the finer grid of a diagnosis, with its steps and regularisation."""
    label = deepcopy(label)
    world = label["world"]
    world["numerics"] = {
        "cells": CELLS / REFINEMENT,
        "stretch": 1.0,
        "step": USUAL_STEP,
        "shear_rate_min": Case().numerics.shear_rate_min,
    }
    for name, run in runs_of(label):
        recast(run, partial(with_numerics, numerics_keys(world["numerics"], set_up_of(name))))
    return label


def exact_measurement(label):
    """The label of a laboratory that measures everything, its material too, with a quarter of the errors or less.

    Draws of the set-up in standard deviations stay. Those of one tank stay common to all experiments, which the
    statement does not say.
    """
    label = deepcopy(label)
    world = label["world"]
    before, after = STATEMENTS[world["statement"]].sd, STATEMENTS[EXACT].sd
    shares = {key: after[key] / sd for key, sd in before.items()}
    shares |= dict.fromkeys(MATERIAL_SD, STATEMENTS[EXACT].material)
    for name, run in runs_of(label):
        recast(run, partial(drawn_closer, set_up_of(name).stated(), shares))
    material = world["material"]
    world["material"] = {key: closer(material[key], BELIEVED[key], shares[key]) for key in material}
    world["quality"] *= BETTER
    world |= {"statement": EXACT, "common": {}}
    return label


LADDER = {  # rung: what is taken out there, beside all that was taken out before
    "as_sealed": None,
    "closures": catalogue_closures,
    "physics": believed_physics,
    "numerics": usual_numerics,
    "measurement": exact_measurement,
}


def runs_of(label):
    """(name, run) of the experiments of a label, and of the controls of its world."""
    return [*label["experiments"].items(), *label["world"]["controls"].items()]


def recast(run, changes_of):
    """Change the truths of a run; `changes_of` gives the changes of a `Case`."""
    for part in ("case", "without"):
        if part in run:
            case = case_from_text(run[part])
            run[part] = case.replace(**changes_of(case)).to_toml()


def with_numerics(keys, case):
    """Changes of a case to other numerics, and to the scheme of lateral friction that a diagnosis uses."""
    if case.effects.lateral_friction is None:
        return keys
    return keys | {"effects.lateral_friction.scheme": None}


def drawn_closer(stated, shares, case):
    """Changes of a case that leave every key at a share of its distance from what is stated, a polygon with them."""
    values = {key: value_of(case, key) for key in shares}
    changes = {key: closer(values[key], stated[key], share) for key, share in shares.items()}
    if case.geometry.polygon is not None:
        sizes = [changes[key] / values[key] for key in SIZES]
        corners = [
            [size * at for size, at in zip(sizes, corner, strict=True)]
            for corner in case.geometry.polygon
        ]
        changes["geometry.polygon"] = corners
    return changes


def closer(value, stated, share):
    """A value at a share of its distance from what is stated."""
    return stated + share * (value - stated)
