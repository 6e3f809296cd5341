"""Walls with friction in the model against walls of the grains: what they change, at every slope that has both.

The grains say how much friction they mobilised on the walls: the mean of tangential over normal force. That is
mu_w of the sink; K_w, which was not measured, has the range of its prior. Only their product acts. A change is that of
the collapse with walls less the mean of those without, of the grains and of the model alike.
"""

from typing import NamedTuple

import numpy as np

from fvcollapse import load_case, load_experiment
from runs.particle_laboratory.readings import of_grains, of_model
from runs.study import run_cached
from runs.table import write_table

CELL_SIZE = 0.008  # m
LENGTHS = (None, 2.31)  # diameters, of thin_layer: off, of the chute
EARLY = (0.3, 0.5, 0.7)  # s
RATIOS = (0.5, 0.75, 1.0, 1.1)  # K_w
SLIDING = 0.3  # friction of a grain that slides on the wall
SLOW_GATE = {"effects.gate": {"speed": 0.4, "mu_gate": 0.5}}


class Pair(NamedTuple):
    """A collapse between walls, those without their friction, the friction mobilised, what else acts in both."""

    walled: str
    free: tuple
    mobilised: float
    both: dict


PERIODIC_16 = ("labelled/control_16deg", "blind/b09")
WALLED_16 = "labelled/lateral_walls_16deg"
PAIRS = {  # of WALLED_16 no friction was published; 0.10 is between those of the others
    "0°": Pair("blind/b13", ("blind/b01",), 0.0906, {}),
    "16°": Pair(WALLED_16, PERIODIC_16, 0.10, {}),
    "16°, less frictionless walls": Pair(WALLED_16, ("blind/b03",), 0.10, {}),
    "16°, slow gate": Pair("blind/b07", ("labelled/slow_gate_16deg",), 0.1128, SLOW_GATE),
    "22°": Pair("blind/b04", ("blind/b02", "blind/b06"), 0.1014, {}),
    "16°, frictionless walls": Pair("blind/b03", PERIODIC_16, 0.0, {}),
}


def walls(arguments, baseline):
    """Write walls.csv: change of front and rear by the walls, of the grains and of the model.

    Parameters
    ----------
    arguments : argparse.Namespace
        Of the study.
    baseline : Path
        Case file of what is believed.
    """
    names = {name for pair in PAIRS.values() for name in (pair.walled, *pair.free)}
    experiments = {name: load_experiment(arguments.data / name) for name in names}
    size = arguments.cell_size or CELL_SIZE
    cases = {
        (words, length, product): experiments[pair.walled]
        .case(load_case(baseline))
        .replace(**settings(length, product, size), **pair.both)
        for words, pair in PAIRS.items()
        for length in LENGTHS
        for product in products(pair)
    }
    results = run_cached(cases, arguments)
    rows = []
    for words, pair in PAIRS.items():
        shown = changes(
            of_grains(experiments[pair.walled]),
            [of_grains(experiments[name]) for name in pair.free],
        )
        rows.append({"pair": words, "of": "grains", "mobilised": pair.mobilised} | shown)
        for length in LENGTHS if pair.mobilised else ():
            seen = {
                product: of_model(results[words, length, product], experiments[pair.walled])
                for product in products(pair)
            }
            rows += model_rows(words, pair, length, seen, shown["front"])
    write_table(arguments.tables / "walls.csv", rows)
    for row in rows:
        print("  ".join(f"{name} {value}" for name, value in row.items()))


def settings(length, product, size):
    """Changes of the baseline by key."""
    return {
        "grid.cell_size": size,
        "effects.thin_layer": None if length is None else {"length": length},
        "effects.lateral_friction": {"mu_wall": product},
    }


def products(pair):
    """mu_w K_w of the runs of a pair: none, the range of K_w, and grains that all slide on the walls."""
    return (0.0, *(round(ratio * pair.mobilised, 5) for ratio in RATIOS), SLIDING)


def model_rows(words, pair, length, seen, wanted):
    """A row for every mu_w K_w, and one for that with which the front changes as that of the grains (`wanted`)."""
    label = {"pair": words, "of": "model", "mobilised": pair.mobilised, "thin_layer": length}
    by_product = {
        product: changes(values, [seen[0.0]]) for product, values in seen.items() if product > 0.0
    }
    rows = [label | {"mu_w_K_w": product} | found for product, found in by_product.items()]
    fronts = [0.0, *(-found["front"] for found in by_product.values())]  # grow with the friction
    needed = float(np.interp(-wanted, fronts, list(seen)))
    beyond = -wanted > fronts[-1]
    name = "model, at least needed" if beyond else "model, needed"
    return [*rows, label | {"of": name, "mu_w_K_w": needed, "front": wanted}]


def changes(walled, free):
    """Changes in mm from the mean of the `Readings` without to those with friction of the walls."""
    quantities = {
        "front": lambda of: of.front_at_rest,
        "rear": lambda of: of.rear,
        **{f"front_{time:g}s": lambda of, time=time: of.front_at(time) for time in EARLY},
    }
    return {
        name: round(1e3 * float(value(walled) - np.mean([value(of) for of in free])), 1)
        for name, value in quantities.items()
    }
