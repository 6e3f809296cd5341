"""Random legal cases: every law, effect, shape, gate and boundary, six cells in the height or more.

A number stands for a case, always the same. Values go to the ends of what is physical and beyond: no
friction, friction coefficients above one, no slip, gates that crawl or vanish, notched columns.
"""

import math
from typing import NamedTuple

import numpy as np

from fvcollapse import open_result
from fvcollapse.case.case import GRAVITY, Case
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.errors import CaseError, NumericalError
from fvcollapse.output import run as output
from fvcollapse.output.trust import largest_drift

INF = math.inf
LAWS = ("mu_I", "drucker_prager", "bingham", "newtonian", "mu_I_regularised")
TRIES = 200
EFFECT_SHARE = 0.2  # of the cases have a given effect
# columns on the unit square: rectangle apart, all with gate.speed = inf or inside length_0
SHAPES = {
    "triangle": [(0, 0), (1, 0), (0, 1)],
    "trapezium": [(0, 0), (1, 0), (0.5, 1), (0, 1)],
    "notched": [(0, 0), (1, 0), (1, 1), (0.5, 0.5), (0, 1)],
    "leaning": [(0, 0), (0.6, 0), (1, 1), (0, 1)],
}
# words of an end that is no defect of the program
NAMED = (
    "guard on the ",
    "still moving; ",
    "the nonlinear sweeps still change the velocity",
    "the factorisation meets pivot",
    "the linear solve leaves",
    "the time step falls below",
    "the mass has reached the end of the domain",
)


def random_case(number):
    """The legal `Case` of a number; its law goes round."""
    rng = np.random.default_rng([16, number])
    for _ in range(TRIES):
        changes = drawn(rng, LAWS[number % len(LAWS)])
        try:
            case = Case().replace(**changes)
        except CaseError:  # values that cannot be together
            continue
        return case
    raise AssertionError(f"no legal case among {TRIES} draws of number {number}")


def drawn(rng, law):
    """Keys of a case, legal or not."""
    height, aspect = loguniform(rng, 0.03, 0.5), loguniform(rng, 0.3, 5.0)
    size_z = height / rng.integers(6, 13)
    size = size_z * rng.choice([0.75, 1.0, 1.0, 1.0, 1.5])
    return (
        {
            "geometry.height_0": height,
            "geometry.length_0": height / aspect,
            "geometry.slope_angle_deg": float(rng.choice([0.0, rng.uniform(0.0, 30.0)])),
            "geometry.channel_width": float(rng.choice([0.03, 0.1, 0.3, INF])),
            "geometry.surface": str(rng.choice(["parallel", "parallel", "horizontal"])),
            "grid.cell_size": float(min(size, height / aspect / 3.0)),
            "grid.cell_size_z": float(size_z),
            "time.end": 3.0 * math.sqrt(height / GRAVITY),
            "time.cfl": float(rng.choice([0.5, 0.5, 0.1, 1.0])),
            "front.thickness": 0.1 * height,
        }
        | material(rng, law)
        | surroundings(rng, height, height / aspect)
        | numerics(rng)
        | effects(rng)
    )


def material(rng, law):
    """Keys of [rheology]."""
    mu_1 = float(rng.choice([0.0, rng.uniform(0.2, 0.7), rng.uniform(0.2, 0.7), 2.0]))
    cohesion = float(rng.choice([0.0, loguniform(rng, 1.0, 1000.0)]))
    return {
        "rheology.law": law,
        "rheology.mu_1": mu_1,
        "rheology.mu_2": mu_1 + float(rng.choice([0.0, rng.uniform(0.1, 0.4)])),
        "rheology.I_0": float(rng.choice([0.279, loguniform(rng, 1e-3, 10.0)])),
        "rheology.viscosity": float(rng.choice([0.0, loguniform(rng, 1e-2, 10.0)])),
        "rheology.cohesion": loguniform(rng, 10.0, 1000.0) if law == "bingham" else cohesion,
        "rheology.grain_diameter": float(rng.choice([7e-4, loguniform(rng, 1e-5, 5e-3)])),
    }


def surroundings(rng, height, length):
    """Keys of [boundary], [gate] and the shape of the column."""
    changes = {
        "boundary.mu_bed": float(rng.choice([0.0, 0.2, 0.48, 0.48, 2.0, INF])),
        "boundary.mu_back_wall": float(rng.choice([0.0, 0.48, 0.48, INF])),
        "boundary.right_end": str(rng.choice(["grow", "grow", "open", "error"])),
        "gate.speed": float(rng.choice([INF, INF, 0.0, 0.05, 0.5, 2.3, 2.3, 20.0])),
        "gate.time_constant": float(rng.choice([0.0, 0.0, 0.05, 1.0])),
    }
    if changes["boundary.right_end"] != "grow":
        changes["boundary.domain_length"] = length + rng.uniform(1.0, 8.0) * height
    if rng.random() < 0.05:
        changes["boundary.ends"] = "periodic"
    elif rng.random() < 0.25:
        shape = SHAPES[str(rng.choice(list(SHAPES)))]
        changes["geometry.polygon"] = [[length * x, height * z] for x, z in shape]
        changes["geometry.surface"] = "parallel"
    return changes


def numerics(rng):
    """Keys of [numerics]."""
    return {
        "numerics.method": str(rng.choice(["coupled"] * 9 + ["projection"])),
        "numerics.unilateral": bool(rng.random() < 0.8),
        "numerics.film_thickness": float(rng.choice([0.0, 1.5e-3, 1.5e-3])),
        "numerics.shear_rate_min": float(rng.choice([5e-4, 5e-4, 1e-2, 1e-6])),
    }


def effects(rng):
    """Sections of [effects], each with one chance in five, at any strength."""
    changes = {}
    for name, effect in CATALOGUE.items():
        if rng.random() < EFFECT_SHARE:
            variant = effect.variants[rng.integers(len(effect.variants))]
            changes[f"effects.{name}"] = effect.keys(float(rng.uniform(0.05, 0.95)), variant)
    return changes


def loguniform(rng, low, high):
    return float(np.exp(rng.uniform(math.log(low), math.log(high))))


class Ending(NamedTuple):
    """How a run ended: `word` is "complete" or the error; largest drift of the volume at any time."""

    word: str
    drift: float


def ending_of(number, folder):
    """The `Ending` of the run of a number, into a folder."""
    case = random_case(number)
    try:
        output.run_case(case, folder, quiet=True)
        word = "complete"
    except NumericalError as error:
        word = str(error)
    return Ending(word, largest_drift(open_result(folder).relative_volume, case))
