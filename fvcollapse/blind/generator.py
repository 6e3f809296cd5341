"""What is hidden in a synthetic case: cause, strength, closure, nuisances, numerics; drawn, not run.

A label is a tree of plain numbers from which the case can be made again. It is a function of a seed, a
class and a style, so that a suite can be continued. What an experiment folder states is the same for
every label: set-up, material as the laboratory believes it, and standard deviations.
"""

from math import inf
from typing import NamedTuple

import numpy as np

from fvcollapse.blind.measurement import Errors
from fvcollapse.blind.outside import UNKNOWNS
from fvcollapse.case.case import Case
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import NUISANCE
from fvcollapse.errors import CaseError

TRIES = 200  # of values that fit together
QUANTILES = (0.02, 0.98)  # of the priors, from which causes are drawn
ROUGHNESS = 0.02  # model-form error: standard deviation of the friction along the bed, relative
ROUGHNESS_LENGTH = 0.08  # m over which it varies
WAVES = 8
PROFILE_INTERVAL = 0.015  # s
END_MARGIN = 0.03  # s after the last frame
CLOCK_MARGIN = 1.15  # factor on the end where a clock may be slow

BELIEVED = {  # what the laboratory states of its grains and of the gate
    "rheology.mu_1": 0.44,
    "rheology.mu_2": 0.70,
    "rheology.I_0": 0.279,
    "boundary.mu_bed": inf,
    "boundary.mu_back_wall": 0.30,
    "gate.speed": 2.3,
    "geometry.height_0": 0.14,
    "geometry.length_0": 0.20,
    "front.thickness": 0.005,
}
# standard deviations: of what belongs to all runs of a case, and of what is set up anew for each
MATERIAL_SD = {
    "rheology.mu_1": 0.015,
    "rheology.mu_2": 0.03,
    "rheology.I_0": 0.056,
    "boundary.mu_back_wall": 0.05,
}
SET_UP_SD = {
    "geometry.slope_angle_deg": 0.2,
    "geometry.height_0": 0.0014,
    "geometry.length_0": 0.0015,
    "gate.speed": 0.1,
}
ERRORS = Errors(
    thickness=0.0012,
    front=0.005,
    relative_volume=0.005,
    interface=0.0025,
    scale=SET_UP_SD["geometry.height_0"] / BELIEVED["geometry.height_0"],
    offset=SET_UP_SD["geometry.length_0"],
    time=0.005,
)


class SetUp(NamedTuple):
    """One experiment: slope [deg], channel width [m], last frame [s], last place on the film [m]."""

    slope: float
    width: float
    end: float
    reach: float


SET_UPS = {
    "slope00_width10": SetUp(0.0, 0.10, 0.80, 0.70),
    "slope10_width10": SetUp(10.0, 0.10, 1.00, 0.90),
    "slope16_width10": SetUp(16.0, 0.10, 1.32, 1.20),
    "slope16_width05": SetUp(16.0, 0.05, 1.32, 1.20),
    "slope16_width20": SetUp(16.0, 0.20, 1.32, 1.20),
    "slope20_width10": SetUp(20.0, 0.10, 1.68, 1.60),
}
DESIGNS = (  # the experiments of a case
    ("slope10_width10", "slope16_width10", "slope20_width10"),
    ("slope16_width05", "slope16_width10", "slope16_width20"),
    ("slope00_width10", "slope16_width10", "slope16_width20"),
    ("slope10_width10", "slope16_width05"),
    ("slope16_width10",),
)


class Style(NamedTuple):
    """How the truths of a suite are made: no two suites that are compared share one.

    Attributes
    ----------
    cells : (float, float)
        Range of the number of cells in the height of the column.
    stretch : (float, float)
        Range of the cell size normal to the bed over that along it.
    step : (float, float)
        Range of the longest time step over its default.
    shear_rate_min : (float, float)
        Range of the regularisation [1/s].
    scheme : str
        Of the lateral friction, where it is a sink.
    first_closure : int
        Every second closure of an effect, from this one on; an effect with one keeps it.
    unknowns : tuple of str
        Kinds of causes outside the catalogue.
    """

    cells: tuple
    stretch: tuple
    step: tuple
    shear_rate_min: tuple
    scheme: str
    first_closure: int
    unknowns: tuple


TRAINING = Style(
    cells=(10.0, 11.5),
    stretch=(0.85, 1.0),
    step=(1.0, 1.6),
    shear_rate_min=(5e-4, 2e-3),
    scheme="implicit",
    first_closure=0,
    unknowns=("linear_drag", "rough_strip", "sloping_surface", "clock", "grain_loss"),
)
BLIND = Style(
    cells=(17.0, 20.0),
    stretch=(1.0, 1.15),
    step=(0.6, 1.0),
    shear_rate_min=(1e-4, 5e-4),
    scheme="split",
    first_closure=1,
    unknowns=(
        "quadratic_drag",
        "slippery_strip",
        "slumped_column",
        "magnification",
        "short_channel",
    ),
)


# -- causes ------------------------------------------------------------------------------------------------


def known_effects():
    """Names of the effects that can be a cause."""
    return tuple(name for name, effect in CATALOGUE.items() if effect.kind != NUISANCE)


def draw_classes(count, rng):
    """Classes of a blind suite: their frequencies are drawn as well, and not told.

    About three in ten are none, two in ten unknown, one in twenty a pair; the rest single effects of
    unequal frequency.
    """
    none = round(count * rng.uniform(0.28, 0.34))
    unknown = round(count * rng.uniform(0.17, 0.22))
    pairs = round(count * rng.uniform(0.04, 0.08))
    single = max(count - none - unknown - pairs, 0)
    effects = list(known_effects())
    shares = rng.dirichlet(np.full(len(effects), 8.0))
    classes = [NONE] * none + [UNKNOWN] * unknown
    classes += [draw_pair(rng) for _ in range(pairs)]
    classes += rng.choice(effects, single, p=shares).tolist()
    return rng.permutation(classes[:count]).tolist()


def draw_pair(rng):
    """Name of two effects together."""
    return "+".join(sorted(rng.choice(known_effects(), 2, replace=False).tolist()))


def draw_effect(name, style, rng):
    """{"closure": index, "section": keys of `[effects.<name>]`, "quantiles": {parameter: u}}."""
    effect = CATALOGUE[name]
    own = range(len(effect.variants))[style.first_closure :: 2] or (0,)
    closure = int(rng.choice(own))
    variant = effect.variants[closure]
    section = {key: value for key, value in variant.items() if value is not None}
    quantiles = {}
    for parameter, prior in effect.priors.items():
        if variant.get(parameter, "") is None:
            continue
        quantiles[parameter] = float(rng.uniform(*QUANTILES))
        section[parameter] = float(prior.distribution().ppf(quantiles[parameter]))
    if name == "lateral_friction" and section.get("closure", "sink") != "friction_increase":
        section["scheme"] = style.scheme
    return {"closure": closure, "section": section, "quantiles": quantiles}


# -- a case ------------------------------------------------------------------------------------------------


def draw_label(cause, style, seed, cells=None, design=None):
    """The label of a case.

    Parameters
    ----------
    cause : str
        "none", "unknown", an effect, or two joined by "+".
    style : Style
    seed : int
    cells : (float, float), optional
        Instead of `style.cells`.
    design : sequence of str, optional
        Keys of `SET_UPS`; default: drawn of `DESIGNS`.

    Returns
    -------
    dict
        `cause`, `unknown_kind` (None unless unknown), `effects` {name: `draw_effect`}, `outside`,
        `material`, `roughness`, and for each of the `experiments`: `case` (TOML text of the truth),
        `forces`, `readings` and `noise` (seed).
    """
    for attempt in range(TRIES):
        rng = np.random.default_rng([seed, attempt])
        try:
            return try_label(cause, style, rng, cells or style.cells, design)
        except CaseError:  # values that cannot be together
            continue
    raise ValueError(f"{TRIES} draws for {cause} do not fit together")


def try_label(cause, style, rng, cells, design):
    """One draw of a label.

    Raises
    ------
    CaseError
    """
    names = design or DESIGNS[rng.integers(len(DESIGNS))]
    base = Case().replace(**BELIEVED)
    kind = str(rng.choice(style.unknowns)) if cause == UNKNOWN else None
    outside = UNKNOWNS[kind](rng, base.geometry) if kind else {}
    chosen = () if cause in (NONE, UNKNOWN) else cause.split("+")
    effects = {name: draw_effect(name, style, rng) for name in chosen}
    material = {key: positive(rng, BELIEVED[key], sd) for key, sd in MATERIAL_SD.items()}
    numerics = draw_numerics(style, rng, cells)
    roughness = draw_roughness(rng, material["rheology.mu_1"])
    forces = [roughness, *outside.get("forces", ())]
    changes = BELIEVED | material | numerics
    changes |= {f"effects.{name}": each["section"] for name, each in effects.items()}
    if "channel_end" in outside:
        changes |= {
            "boundary.right_end": "open",
            "boundary.domain_length": outside["channel_end"],
        }
    return {
        "cause": cause,
        "unknown_kind": kind,
        "effects": effects,
        "outside": outside,
        "material": material,
        "roughness": roughness["friction"],
        "experiments": {
            name: {
                "case": draw_truth(SET_UPS[name], changes, outside, rng).to_toml(),
                "forces": forces,
                "readings": list(outside.get("readings", ())),
                "noise": int(rng.integers(2**63)),
            }
            for name in names
        },
    }


def draw_truth(set_up, changes, outside, rng):
    """The `Case` of one run: the set-up as it really was."""
    stated = BELIEVED | {"geometry.slope_angle_deg": set_up.slope}
    own = {key: positive(rng, stated[key], sd) for key, sd in SET_UP_SD.items()}
    slow_clock = any(reading["kind"] == "clock" for reading in outside.get("readings", ()))
    end = (CLOCK_MARGIN if slow_clock else 1.0) * set_up.end + END_MARGIN
    own |= {
        "geometry.channel_width": set_up.width,
        "time.end": end,
        "time.output_interval": PROFILE_INTERVAL,
        "time.field_interval": end,
    }
    if "polygon" in outside:
        height, length = own["geometry.height_0"], own["geometry.length_0"]
        stretch = length / BELIEVED["geometry.length_0"], height / BELIEVED["geometry.height_0"]
        own["geometry.polygon"] = [[stretch[0] * x, stretch[1] * z] for x, z in outside["polygon"]]
    return Case().replace(**changes | own)


def positive(rng, mean, sd):
    """A normal number, folded to positive values (a slope of zero is one of either sign)."""
    return float(abs(mean + sd * rng.standard_normal()))


def draw_numerics(style, rng, cells):
    """Case keys of a grid, a time step and a regularisation that no diagnosis has."""
    size = BELIEVED["geometry.height_0"] / rng.uniform(*cells)
    step = 0.01 * (BELIEVED["geometry.height_0"] / 9.81) ** 0.5
    return {
        "grid.cell_size": size,
        "grid.cell_size_z": size * rng.uniform(*style.stretch),
        "time.step_max": step * rng.uniform(*style.step),
        "numerics.shear_rate_min": float(np.exp(rng.uniform(*np.log(style.shear_rate_min)))),
    }


def draw_roughness(rng, mu_1):
    """The force of a bed whose friction varies from place to place."""
    return {
        "kind": "uneven_friction",
        "friction": ROUGHNESS * mu_1,
        "waves": (rng.standard_normal(WAVES) / ROUGHNESS_LENGTH).tolist(),
        "phases": rng.uniform(0.0, 2.0 * np.pi, WAVES).tolist(),
    }


# -- what the laboratory states -----------------------------------------------------------------------------


def settings_text(name):
    """`experiment.toml` of a set-up; nothing in it depends on a label."""
    set_up = SET_UPS[name]
    return f"""title = "synthetic collapse, {set_up.slope:g} deg, w = {100 * set_up.width:g} cm"
source = "fvcollapse blind"

[geometry]
slope_angle_deg = {set_up.slope}
height_0 = {BELIEVED["geometry.height_0"]}
length_0 = {BELIEVED["geometry.length_0"]}
channel_width = {set_up.width}

[gate]
speed = {BELIEVED["gate.speed"]}

[material]
mu_1 = {BELIEVED["rheology.mu_1"]}
mu_2 = {BELIEVED["rheology.mu_2"]}
I_0 = {BELIEVED["rheology.I_0"]}
mu_back_wall = {BELIEVED["boundary.mu_back_wall"]}

[uncertainty]
thickness = {ERRORS.thickness}
front = {ERRORS.front}
relative_volume = {ERRORS.relative_volume}
interface = {ERRORS.interface}
time = {ERRORS.time}
slope_angle_deg = {SET_UP_SD["geometry.slope_angle_deg"]}
height_0 = {SET_UP_SD["geometry.height_0"]}
length_0 = {SET_UP_SD["geometry.length_0"]}
speed = {SET_UP_SD["gate.speed"]}
mu_1 = {MATERIAL_SD["rheology.mu_1"]}
mu_2 = {MATERIAL_SD["rheology.mu_2"]}
I_0 = {MATERIAL_SD["rheology.I_0"]}
mu_back_wall = {MATERIAL_SD["boundary.mu_back_wall"]}

[front]
thickness = {BELIEVED["front.thickness"]}
"""
