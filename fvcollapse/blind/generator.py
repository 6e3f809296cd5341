"""What is hidden in a synthetic case: cause, strength, closure, nuisances, numerics; drawn, not run.

A label is a tree of plain numbers from which the case can be made again. It is a function of a seed, a
class and a style, so that a suite can be continued.
"""

import numpy as np

from fvcollapse.blind.causes import draw_effect
from fvcollapse.blind.outside import UNKNOWNS
from fvcollapse.blind.set_ups import BELIEVED, DESIGNS, MATERIAL_SD, SET_UP_SD, SET_UPS
from fvcollapse.case.case import Case
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.errors import CaseError

TRIES = 200  # of values that fit together
ROUGHNESS = 0.02  # model-form error: standard deviation of the friction along the bed, relative
ROUGHNESS_LENGTH = 0.08  # m over which it varies
WAVES = 8
PROFILE_INTERVAL = 0.015  # s
END_MARGIN = 0.03  # s after the last frame
CLOCK_MARGIN = 1.15  # factor on the end where a clock may be slow


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
    changes |= {f"effects.{name}": drawn["section"] for name, drawn in effects.items()}
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
    measured = {key: positive(rng, stated[key], sd) for key, sd in SET_UP_SD.items()}
    slow_clock = any(reading["kind"] == "clock" for reading in outside.get("readings", ()))
    end = (CLOCK_MARGIN if slow_clock else 1.0) * set_up.end + END_MARGIN
    measured |= {
        "geometry.channel_width": set_up.width,
        "time.end": end,
        "time.output_interval": PROFILE_INTERVAL,
        "time.field_interval": end,
    }
    if "polygon" in outside:
        height, length = measured["geometry.height_0"], measured["geometry.length_0"]
        stretch = length / BELIEVED["geometry.length_0"], height / BELIEVED["geometry.height_0"]
        measured["geometry.polygon"] = [
            [stretch[0] * x, stretch[1] * z] for x, z in outside["polygon"]
        ]
    return Case().replace(**changes | measured)


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
