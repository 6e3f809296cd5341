"""Combinations of friction, bed, viscosity, walls and effects at 22 deg among which a slow phase is looked for.

Every combination of the main choices; then one effect at a time, on each bed and with each friction; then what came
nearest, with friction between, and with more effects.
"""

import math

SLOPE, END = 22.0, 2.5  # deg, s
FRICTION = {  # mu_1, mu_2
    "0.48, 0.73": (0.48, 0.73),  # Table I
    "0.44, 0.69": (0.44, 0.69),
    "0.42, 0.67": (0.42, 0.67),
    "0.40, 0.66": (0.40, 0.66),
    "0.38, 0.64": (0.38, 0.64),  # chutes
}
BETWEEN = ("0.42, 0.67", "0.40, 0.66")  # on either side of tan 22 deg = 0.404
MAIN = tuple(name for name in FRICTION if name not in BETWEEN)
LOOSEST = MAIN[-1]
SLIDES, NO_SLIP, ROUGH = "slides", "no slip", "no slip, L = 1.65 d"
BEDS = {  # whether the grains slide with mu_b = mu_1, and the length of thin_layer in diameters
    SLIDES: (True, None),
    NO_SLIP: (False, None),
    ROUGH: (False, 1.65),
}
MU_I = "mu(I)"
LAWS = {MU_I: None, "0.4 Pa s": 0.4, "1 Pa s": 1.0, "2 Pa s": 2.0}
NARROW, WIDE = "w = 10 cm", "w = 20 cm"
WALLS = {NARROW: 0.10, WIDE: 0.20, "no walls": math.inf}
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
    "slow gate that rubs": {
        "effects.gate": {"speed": 0.8, "time_constant": 0.06, "mu_gate": 0.2},
    },
    "walls of 0.25": {"effects.lateral_friction": {"mu_wall": 0.25}},
}
MORE = LENGTHS | ADDED
PAIRS = {  # law, walls: effects beside the friction of chutes on a bed without slip, where phases were found
    ("1 Pa s", NARROW): [(words,) for words in ADDED] + [("L = 4 d",)],
    ("1 Pa s", WIDE): [("hysteresis 0.03",), ("dilatancy from 0.62",), ("L = 4 d",)],
    (MU_I, NARROW): [
        ("dilatancy from 0.62", "hysteresis 0.03"),
        ("dilatancy from 0.62", "slow gate that rubs"),
        ("dilatancy from 0.62", "walls of 0.25"),
        ("hysteresis 0.03", "slow gate that rubs"),
        ("L = 4 d", "hysteresis 0.03"),
        ("L = 4 d", "dilatancy from 0.62"),
    ],
}
FINER_SETS = (  # on finer grids: one of each kind that has a phase on 6 mm cells, what comes near, and Table I
    "0.38, 0.64; no slip; mu(I); w = 10 cm",
    "0.38, 0.64; no slip; mu(I); w = 20 cm",
    "0.38, 0.64; no slip; mu(I); no walls",
    "0.38, 0.64; no slip; mu(I); w = 10 cm; dilatancy from 0.60",
    "0.38, 0.64; no slip; mu(I); w = 10 cm; hysteresis 0.03; slow gate that rubs",
    "0.38, 0.64; no slip; mu(I); w = 10 cm; L = 4 d; hysteresis 0.03",
    "0.38, 0.64; no slip; mu(I); w = 10 cm; walls of 0.25",
    "0.40, 0.66; no slip; mu(I); w = 10 cm",
    "0.40, 0.66; no slip; mu(I); w = 20 cm",
    "0.42, 0.67; no slip; mu(I); w = 10 cm",
    "0.42, 0.67; no slip; mu(I); w = 20 cm",
    "0.44, 0.69; no slip; mu(I); w = 10 cm",
    "0.48, 0.73; no slip; mu(I); w = 10 cm",
    "0.38, 0.64; no slip; 0.4 Pa s; w = 10 cm",
    "0.38, 0.64; no slip; 1 Pa s; w = 10 cm",
    "0.38, 0.64; no slip; 1 Pa s; w = 20 cm",
    "0.38, 0.64; no slip; 1 Pa s; no walls",
    "0.38, 0.64; no slip; 1 Pa s; w = 20 cm; dilatancy from 0.62",
    "0.40, 0.66; no slip; 1 Pa s; w = 20 cm",
    "0.44, 0.69; no slip; 1 Pa s; w = 10 cm",
    "0.48, 0.73; no slip; 1 Pa s; w = 10 cm",
    "0.38, 0.64; slides; 1 Pa s; w = 20 cm",
    "0.44, 0.69; slides; mu(I); w = 10 cm",
    "0.48, 0.73; slides; mu(I); no walls",
    "0.48, 0.73; slides; mu(I); w = 10 cm",
    "0.48, 0.73; slides; 1 Pa s; w = 10 cm",
    "0.48, 0.73; slides; 2 Pa s; w = 10 cm",
)
SHOWN = (
    "0.38, 0.64; no slip; mu(I); w = 10 cm",
    "0.42, 0.67; no slip; mu(I); w = 10 cm",
    "0.38, 0.64; no slip; 1 Pa s; w = 10 cm",
    "0.48, 0.73; slides; 1 Pa s; w = 10 cm",
)  # in the figure


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
        for friction in MAIN
        for bed in BEDS
        for law in (LAWS if walls == NARROW else LAWS_OF_OTHER_WALLS)
    ]


def one_effect():
    """One effect more on each bed, and other lengths of thin_layer: mu(I), narrow channel."""
    return [
        (friction, bed, MU_I, NARROW, (words,))
        for friction in MAIN
        for words in MORE
        for bed in (SLIDES, NO_SLIP)
    ]


def near():
    """Friction near the slope on a bed without slip, and effects on what came nearest."""
    found = [
        (friction, NO_SLIP, law, walls)
        for friction in BETWEEN
        for law in LAWS
        for walls in (NARROW, WIDE)
    ]
    return found + [
        (LOOSEST, NO_SLIP, law, walls, added)
        for (law, walls), pairs in PAIRS.items()
        for added in pairs
    ]


def all_sets():
    """{name: settings} of all combinations."""
    chosen = main_choices() + one_effect() + near()
    return {name_of(*of): collapse(*of) for of in chosen}
