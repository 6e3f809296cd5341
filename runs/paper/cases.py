"""The cases of the paper's figures and of the questions it leaves open, each listed once, by group.

A group is a folder of tables. Names: `<law or change>_a<slope in degrees>_w<width in cm, or inf>`;
`w` infinite is the case without lateral friction. A member is run on one or more grids: at a
refinement r its cells are r times smaller than those the study is asked for, so that at 6 mm the
refinements 1, 1.5, 2, 3 and 4 are 6, 4, 3, 2 and 1.5 mm. Finer grids than those listed here are chosen by
the study where a statement asks for them (`finer.py`).
"""

import math
from typing import NamedTuple

from runs.table import REFINEMENTS

SLOPES = (0, 10, 16, 19, 22)  # deg
WIDTHS = {"w10": 0.10, "w20": 0.20, "winf": math.inf}  # m
END = {0: 1.5, 10: 1.5, 16: 2.0, 19: 2.0, 22: 2.5}  # s
FIELD_INTERVAL = 0.05  # s
# every time that a figure or a statement names, s
TIMES = (0.18, 0.30, 0.32, 0.48, 0.96, 1.0, 1.02, 1.5, 1.76, 1.8)
PROFILES = {  # s; profiles and interfaces of figures 3 and 4, by slope and width
    (10, "w10"): (0.18, 0.48, 1.0),
    (10, "w20"): (0.18, 0.48, 1.02),
    (10, "winf"): (0.18, 0.48, 1.0, 1.02),
    (22, "w10"): (0.32, 0.48, 0.96, 1.5, 1.76),
    (22, "w20"): (0.30, 1.02, 1.5, 1.8),
    (22, "winf"): (0.30, 0.32, 0.48, 0.96, 1.02, 1.5, 1.76, 1.8),
}
PAIR, TRIPLE = (1.0, 1.5), (1.0, 1.5, 2.0)


class Member(NamedTuple):
    """One case and the grids it is run on.

    Attributes
    ----------
    settings : dict
        {key of the case file: value}; what is not named has its default, the paper's Table I.
    refinements : tuple of float
        Asked cell size over the cell size of each run.
    profiles : tuple of float
        Times whose thickness profile and static–flowing interface enter the tables [s].
    keep : tuple of str
        What else enters them, by the names of `curves.KEPT`.
    """

    settings: dict
    refinements: tuple = (1.0,)
    profiles: tuple = ()
    keep: tuple = ()


def collapse(slope, width, end=None, **changes):
    """Settings of one collapse; `changes` by key, dots written as double underscores."""
    settings = {
        "geometry.slope_angle_deg": float(slope),
        "geometry.channel_width": WIDTHS[width],
        "effects.lateral_friction": {},
        "time.end": end or END[slope],
        "time.field_interval": FIELD_INTERVAL,
        "time.output_times": TIMES,
    }
    return settings | {key.replace("__", "."): value for key, value in changes.items()}


def lateral_friction():
    """Figures 3–8 and 11: mu(I) at every slope and width."""
    return {
        f"muI_a{slope}_{width}": Member(
            collapse(slope, width),
            REFINEMENTS
            if (slope, width) == (22, "w10")
            else TRIPLE
            if (slope, width) == (22, "winf")
            else PAIR,
            PROFILES.get((slope, width), ()),
            kept(slope, width),
        )
        for slope in SLOPES
        for width in WIDTHS
    }


def kept(slope, width):
    """What the tables keep of a mu(I) case beside its front and profiles."""
    names = ["fronts"]
    names += ["volume"] if width != "winf" and slope != 19 else []
    names += ["velocity"] if width != "w20" and slope in (10, 16, 22) else []
    names += ["peak", "viscosity"] if width == "w10" and slope != 19 else []
    names += ["pressure"] if width != "w20" and slope == 22 else []
    names += ["shear"] if width == "w10" and slope == 22 else []
    return tuple(names)


def viscosity():
    """Figures 9–18: constant viscosities."""
    wanted = [(0.4, slope, width) for slope in SLOPES for width in ("w10", "winf")]
    wanted += [
        (eta, slope, w) for eta in (0.1, 1) for slope in (10, 16, 22) for w in ("w10", "w20")
    ]
    wanted += [(2, 22, width) for width in ("w10", "w20")]
    return {
        f"eta{eta:g}_a{slope}_{width}": Member(
            collapse(slope, width, **constant(eta)),
            PAIR,
            (1.5, 1.76) if slope == 22 else (),
            ("fronts",)
            + (("peak",) if eta == 0.4 and width == "w10" and slope != 19 else ())
            + (("pressure",) if eta == 0.4 and slope == 22 else ()),
        )
        for eta, slope, width in wanted
    }


def constant(eta):
    """Settings of the Drucker–Prager law with a viscosity [Pa s]."""
    return {"rheology__law": "drucker_prager", "rheology__viscosity": float(eta)}


def older_closure():
    """Equation 21 instead of the sink: h = 5 cm, which adds about 0.1 at w = 10 cm; and half of it."""
    wanted = [("older", 0.050, slope, width) for slope in SLOPES for width in ("w10", "w20")]
    wanted += [("older25mm", 0.025, slope, "w10") for slope in SLOPES]
    return {
        f"{name}_a{slope}_{width}": Member(
            collapse(
                slope,
                width,
                effects__lateral_friction={
                    "closure": "friction_increase",
                    "flowing_thickness": thickness,
                },
            ),
            PAIR,
            (0.48,) if slope == 10 else (0.48, 0.96) if slope == 22 else (),
            ("velocity",) if slope in (10, 16, 22) and width == "w10" else (),
        )
        for name, thickness, slope, width in wanted
    }


def double_counting():
    """mu_1, mu_2 of the inclined plane (0.38, 0.64), the bed as in Table I and as the grains."""
    inclined = {"rheology__mu_1": 0.38, "rheology__mu_2": 0.64}
    beds = {"mu38": inclined, "mu38_bed38": inclined | {"boundary__mu_bed": 0.38}}
    return {
        f"{name}_a{slope}_{width}": Member(
            # without walls nothing stops it at 22 deg (tan = 0.404), so there is no end to wait for
            collapse(slope, width, end=2.0 if slope == 22 else None, **changes),
            PAIR if width == "w10" else (1.0,),
        )
        for name, changes in beds.items()
        for slope in SLOPES
        for width in WIDTHS
    }


def back_wall():
    """Friction mu_w on the back wall (equation 14) instead of mu_b (section VI)."""
    return {
        f"back0.18_a{slope}_w10": Member(collapse(slope, "w10", boundary__mu_back_wall=0.18), PAIR)
        for slope in SLOPES
    }


SENSITIVITIES = {  # of 22 deg without lateral friction: words, and changes by key
    "bed_no_slip": ("bed: no slip", {"boundary__mu_bed": math.inf}),
    "bed0.58": ("bed: µ_b = 0.58", {"boundary__mu_bed": 0.58}),
    "bed0.53": ("bed: µ_b = 0.53", {"boundary__mu_bed": 0.53}),
    "bed0.43": ("bed: µ_b = 0.43", {"boundary__mu_bed": 0.43}),
    "bed0.38": ("bed: µ_b = 0.38", {"boundary__mu_bed": 0.38}),
    "back_no_slip": ("back wall: no slip", {"boundary__mu_back_wall": math.inf}),
    "back0.18": ("back wall: 0.18", {"boundary__mu_back_wall": 0.18}),
    "back_free_slip": ("back wall: free slip", {"boundary__mu_back_wall": 0.0}),
    "gate_instant": ("gate: removed at once", {"gate__speed": math.inf}),
    "gate1.15": ("gate: half as fast", {"gate__speed": 1.15}),
    "rate_min5e-3": ("regularisation × 10", {"numerics__shear_rate_min": 5e-3}),
    "rate_min5e-5": ("regularisation / 10", {"numerics__shear_rate_min": 5e-5}),
    "regularised_law": ("well-posed µ(I)", {"rheology__law": "mu_I_regularised"}),
    "bilateral": ("suction allowed", {"numerics__unilateral": False}),
    "film_none": ("no film rule", {"numerics__film_thickness": 0.0}),
    "film3mm": ("film rule at 3 mm", {"numerics__film_thickness": 3e-3}),
    "step0.6ms": ("time step halved", {"time__step_max": 6e-4}),
    "tolerance1e-4": ("tolerance / 10", {"numerics__tolerance": 1e-4}),
    "grains0.6mm": ("grains 0.6 mm", {"rheology__grain_diameter": 6e-4}),
    "grains0.8mm": ("grains 0.8 mm", {"rheology__grain_diameter": 8e-4}),
}


def sensitivity():
    """What the runout at 22 deg without lateral friction depends on."""
    return {
        f"{name}_a22_winf": Member(collapse(22, "winf", **changes))
        for name, (_, changes) in SENSITIVITIES.items()
    }


def refinement():
    """Section IX: the regularised law on the grids of mu(I), to 1 s."""
    regularised = collapse(22, "w10", end=1.0, rheology__law="mu_I_regularised")
    return {"regularised_a22_w10": Member(regularised, TRIPLE, (0.48, 0.96), ("shear",))}


GROUPS = {
    group.__name__: group()
    for group in (
        lateral_friction,
        viscosity,
        older_closure,
        double_counting,
        back_wall,
        sensitivity,
        refinement,
    )
}
