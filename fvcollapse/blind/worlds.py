"""Worlds: what the experiments of one synthetic laboratory have in common.

A world has hidden physics of its own, which the believed model lacks, and with it its own measuring errors and
controls, experiments in which nothing more is hidden. What is hidden in a case is added to its world. In a `slight`
world the believed model is off by as much as another code would be; in a `strong` one by an effect of its own as
well: such a laboratory can be diagnosed with its controls only.

Worlds of training and of blind suites have other kinds of physics (`Style.worlds`).
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fvcollapse.blind.outside import draw_smooth_error
from fvcollapse.blind.plain_values import Force, Keys, World
from fvcollapse.blind.set_ups import BELIEVED, LABORATORIES, MATERIAL_SD, STATEMENTS, SetUp
from fvcollapse.effects.catalogue import CATALOGUE

if TYPE_CHECKING:
    from fvcollapse.blind.causes import Style

SLIGHT, STRONG = "slight", "strong"
SIZES = {SLIGHT: (0.05, 0.25), STRONG: (0.4, 1.0)}  # of the physics
ERROR_SIZES = (0.2, 1.0)  # of the smooth error, in worlds of either strength
PHYSICS = {SLIGHT: (0.5, 0.5, 0.0), STRONG: (0.0, 0.6, 0.4)}  # shares of worlds with 0, 1, 2 kinds
# kinds that vanish with their size, the only ones of slight worlds: grains that slide on the bed, dilate or lie on it
# loosely do so however little
GENTLE = ("thin_layers", "uneven_bed", "thin_layers_without_fluidity", "rubbing_walls")
MOST_CONTROLS = 4
QUALITY = (0.7, 1.6)  # errors of single readings, relative to those of a good camera
STEP = 0.02  # longest time step in sqrt(height / g), before that of a world is drawn
WAVES = 8
BED_LENGTH = 0.08  # m over which the friction of an uneven bed varies


class Physics(NamedTuple):
    """What a kind of hidden physics adds: tables `[effects.<name>]`, and forces (see `outside`)."""

    effects: dict[str, Keys]
    forces: tuple[Force, ...] = ()


def effect_keys(name: str, size: float, closure: int = 0) -> Keys:
    """Keys of an effect of the catalogue at a size in (0, 1): the quantiles of its priors, from the weak end."""
    return CATALOGUE[name].keys(min(max(size, 0.02), 0.98), CATALOGUE[name].variants[closure])


def thin_layers(size: float, rng: np.random.Generator, mu_1: float) -> Physics:
    """Thin layers are stronger than the model has them."""
    return Physics({"thin_layer": {"length": 0.2 + 2.3 * size, "closure": "thickness"}})


def thin_layers_without_fluidity(size: float, rng: np.random.Generator, mu_1: float) -> Physics:
    """The same by granular fluidity that vanishes on the bed."""
    return Physics({"thin_layer": {"length": 0.2 + 2.3 * size, "closure": "nonlocal"}})


def dilatant_grains(size: float, rng: np.random.Generator, mu_1: float) -> Physics:
    """The packing loosens as it flows."""
    return Physics({"dilatancy": effect_keys("dilatancy", 0.7 * size)})


def hysteretic_grains(size: float, rng: np.random.Generator, mu_1: float) -> Physics:
    """Grains at rest are held by more friction than grains that flow."""
    return Physics({"friction_hysteresis": effect_keys("friction_hysteresis", size)})


def slippery_bed(size: float, rng: np.random.Generator, mu_1: float) -> Physics:
    """Grains slide on the bed."""
    return Physics({"bed_friction": {"mu_bed": mu_1 * (1.0 - 0.35 * size)}})


def loose_bed(size: float, rng: np.random.Generator, mu_1: float) -> Physics:
    """Grains of an earlier run lie on the bed."""
    return Physics({"erodible_bed": {"thickness": 0.001 + 0.005 * size}})


def rubbing_walls(size: float, rng: np.random.Generator, mu_1: float) -> Physics:
    """The lateral walls rub a little, most near the surface."""
    keys: Keys = {"closure": "sink_weakening", "mu_wall": 0.15 * size, "deep_ratio": 0.3}
    return Physics({"lateral_friction": keys})


def uneven_bed(size: float, rng: np.random.Generator, mu_1: float) -> Physics:
    """The friction of the bed varies from place to place."""
    force = {
        "kind": "uneven_friction",
        "friction": 0.08 * size * mu_1,
        "waves": (rng.standard_normal(WAVES) / BED_LENGTH).tolist(),
        "phases": rng.uniform(0.0, 2.0 * np.pi, WAVES).tolist(),
    }
    return Physics({}, (force,))


KINDS = {
    draw.__name__: draw
    for draw in (
        thin_layers,
        dilatant_grains,
        slippery_bed,
        uneven_bed,
        thin_layers_without_fluidity,
        hysteretic_grains,
        rubbing_walls,
        loose_bed,
    )
}


def draw_world(
    name: str, style: "Style", seed: int | Sequence[int], cells: tuple[float, float] | None = None
) -> World:
    """The world of a name, as plain values.

    Parameters
    ----------
    name : str
    style : causes.Style
    seed : int
    cells : (float, float), optional
        Instead of `style.cells`.

    Returns
    -------
    dict
        `name`, `strength`, `kinds`, `effects` {name: keys}, `forces`, `readings`, `material`, `numerics`,
        `statement` (one of `LABORATORIES`), `quality`, `common` {quantity: error in standard deviations; empty where
        every experiment has its own}, and `set_ups` of the controls.
    """
    rng = np.random.default_rng(seed)
    strength = SLIGHT if rng.random() < style.slight_share else STRONG
    count = int(rng.choice(3, p=PHYSICS[strength]))
    possible = [kind for kind in style.worlds if strength == STRONG or kind in GENTLE]
    kinds = [str(kind) for kind in rng.choice(possible, count, replace=False)]
    material = {key: folded(rng, BELIEVED[key], sd) for key, sd in MATERIAL_SD.items()}
    mu_1 = material["rheology.mu_1"]
    effects: dict[str, Keys] = {}
    forces: list[Force] = []
    for kind in kinds:
        physics = KINDS[kind](float(rng.uniform(*SIZES[strength])), rng, mu_1)
        effects |= physics.effects
        forces += physics.forces
    statement = str(rng.choice(LABORATORIES))
    places = sorted({place for design in style.designs for place in design})
    controls = rng.choice(places, rng.integers(1, MOST_CONTROLS + 1), replace=False)
    return {
        "name": name,
        "strength": strength,
        "kinds": kinds,
        "effects": effects,
        "forces": forces,
        "readings": [draw_smooth_error(rng, rng.uniform(*ERROR_SIZES), style.error_lengths)],
        "material": material,
        "numerics": draw_numerics(style, rng, cells or style.cells),
        "statement": statement,
        "quality": float(rng.uniform(*QUALITY)),
        "common": draw_common(rng) if STATEMENTS[statement].common else {},
        "set_ups": [str(place) for place in controls],
    }


def draw_common(rng: np.random.Generator) -> dict[str, float]:
    """Errors, in standard deviations, that all experiments of a laboratory share: set-up, scale, origin and clock."""
    names = (*STATEMENTS["one_tank"].sd, "scale", "offset", "time")
    return {name: float(rng.standard_normal()) for name in names}


def draw_numerics(
    style: "Style", rng: np.random.Generator, cells: tuple[float, float]
) -> dict[str, float]:
    """A grid (cells in the height), a time step and a regularisation that no diagnosis has, over their defaults."""
    return {
        "cells": float(rng.uniform(*cells)),
        "stretch": float(rng.uniform(*style.stretch)),
        "step": float(rng.uniform(*style.step)),
        "shear_rate_min": float(np.exp(rng.uniform(*np.log(style.shear_rate_min)))),
    }


def numerics_keys(numerics: Mapping[str, float], set_up: SetUp) -> dict[str, float]:
    """Case keys of the numerics of a world, for a set-up."""
    size = set_up.height / numerics["cells"]
    return {
        "grid.cell_size": size,
        "grid.cell_size_z": size * numerics["stretch"],
        "time.step_max": STEP * (set_up.height / 9.81) ** 0.5 * numerics["step"],
        "numerics.shear_rate_min": numerics["shear_rate_min"],
    }


def folded(rng: np.random.Generator, mean: float, sd: float) -> float:
    """A normal number, folded to positive values (a slope of zero is one of either sign)."""
    return float(abs(mean + sd * rng.standard_normal()))


def world_seeds(count: int, rng: np.random.Generator) -> dict[str, int]:
    """{name of a world: seed} of some worlds."""
    digits = max(2, len(str(count)))
    return {
        f"world_{number:0{digits}d}": int(rng.integers(2**63)) for number in range(1, count + 1)
    }
