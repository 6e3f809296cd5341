"""Combinations of friction, bed, viscosity, walls and effects at 22 deg among which a slow phase is looked for.

Every combination of the main choices; then one effect at a time, on each bed and with each friction; then pairs of
effects on what came nearest.
"""

import math

SLOPE, END = 22.0, 2.5  # deg, s
FRICTION = {  # mu_1, mu_2
    "0.48, 0.73": (0.48, 0.73),  # Table I
    "0.44, 0.69": (0.44, 0.69),
    "0.38, 0.64": (0.38, 0.64),  # chutes
}
SLIDES, NO_SLIP, ROUGH = "slides", "no slip", "no slip, L = 1.65 d"
BEDS = {  # whether the grains slide with mu_b = mu_1, and the length of thin_layer in diameters
    SLIDES: (True, None),
    NO_SLIP: (False, None),
    ROUGH: (False, 1.65),
}
MU_I = "mu(I)"
LAWS = {MU_I: None, "0.4 Pa s": 0.4, "1 Pa s": 1.0, "2 Pa s": 2.0}
NARROW = "w = 10 cm"
WALLS = {NARROW: 0.10, "w = 20 cm": 0.20, "no walls": math.inf}
LAWS_OF_OTHER_WALLS = (MU_I, "1 Pa s")

DENSE = {  # middle of the literature; dense beads of the paper
    "dilatancy_factor": 4.0,
    "solid_fraction_critical": 0.60,
    "solid_fraction_slope": 0.15,
    "solid_fraction_0": 0.62,
}
THIN = "effects.thin_layer"
LENGTHS = {"L = 0.8 d": {THIN: {"length": 0.8}}, "L = 4 d": {THIN: {"length": 4.0}}}
ADDED = {  # words: settings
    "hysteresis 0.03": {"effects.friction_hysteresis": {"delta_mu": 0.03}},
    "hysteresis 0.06": {"effects.friction_hysteresis": {"delta_mu": 0.06}},
    "dilatancy from 0.62": {"effects.dilatancy": DENSE},
    "dilatancy from 0.60": {"effects.dilatancy": DENSE | {"solid_fraction_0": 0.60}},
    "dilatancy from 0.58": {"effects.dilatancy": DENSE | {"solid_fraction_0": 0.58}},
    "gate 0.8 m/s, rubs": {
        "effects.gate": {"speed": 0.8, "time_constant": 0.06, "mu_gate": 0.2},
    },
    "walls of 0.25": {"effects.lateral_friction": {"mu_wall": 0.25}},
}
MORE = LENGTHS | ADDED


def collapse(friction, bed, law, walls, added=()):
    """Settings of one combination, by the words of its choices."""
    (mu_1, mu_2), (slides, length) = FRICTION[friction], BEDS[bed]
    width, viscosity = WALLS[walls], LAWS[law]
    settings = {
        "geometry.slope_angle_deg": SLOPE,
        "geometry.channel_width": width,
        "time.end": END,
        "time.field_interval": END,
        "rheology.mu_1": mu_1,
        "rheology.mu_2": mu_2,
        "boundary.mu_bed": mu_1 if slides else math.inf,
        "effects.lateral_friction": None if math.isinf(width) else {},
        THIN: None if length is None else {"length": length},
    }
    if viscosity is not None:
        settings |= {"rheology.law": "drucker_prager", "rheology.viscosity": viscosity}
    for words in added:
        settings |= MORE[words]
    return settings


def name_of(friction, bed, law, walls, added=()):
    """The name of a combination."""
    return "; ".join((friction, bed, law, walls, *added))


def main_choices():
    """Every friction, bed and law in the narrow channel, and two laws beside other walls."""
    return [
        (friction, bed, law, walls)
        for walls in WALLS
        for friction in FRICTION
        for bed in BEDS
        for law in (LAWS if walls == NARROW else LAWS_OF_OTHER_WALLS)
    ]


def one_effect():
    """One effect more on each bed, and other lengths of thin_layer: mu(I), narrow channel."""
    added = [(bed, words) for bed in (SLIDES, NO_SLIP) for words in ADDED]
    added += [(bed, words) for bed in (SLIDES, NO_SLIP) for words in LENGTHS]
    return [
        (friction, bed, MU_I, NARROW, (words,)) for friction in FRICTION for bed, words in added
    ]


def all_sets():
    """{name: settings} of all combinations."""
    return {name_of(*chosen): collapse(*chosen) for chosen in main_choices() + one_effect()}
