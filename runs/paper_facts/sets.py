"""Sets of constants and effects of the paper's channel (w = 10 cm), by name.

The friction of the beads is that of the paper's Table I, that measured in chutes, or between the two. The bed holds the
grains, or they slide on it with mu_1. Everything else is an addition to these.
"""

import math

WIDTH = 0.10  # m
END = {
    0.0: 1.5,
    10.0: 1.5,
    16.0: 2.0,
    22.0: 2.5,
}  # s; beyond 1.76 s at 22 deg, where the paper looks
FRICTION = {  # mu_1, mu_2
    "0.38, 0.64": (0.38, 0.64),  # inclined planes
    "0.40, 0.66": (0.40, 0.66),
    "0.44, 0.69": (0.44, 0.69),
    "0.48, 0.73": (0.48, 0.73),  # Table I
}
LENGTHS = (
    None,
    1.65,
    2.31,
    4.0,
)  # diameters: off, chutes of beads, chutes of the particles, end of the prior
FEWER = "0.40, 0.66"  # with it, only those of ADDED that came nearest
SINK = {"mu_wall": 0.18}
DENSE = {  # middle of the literature; dense beads of the paper
    "dilatancy_factor": 4.0,
    "solid_fraction_critical": 0.60,
    "solid_fraction_slope": 0.15,
    "solid_fraction_0": 0.62,
}
CRITICAL = DENSE | {"solid_fraction_0": 0.60}
RUBBING_GATE = {"speed": 2.3, "mu_gate": 0.2}
SLOW_GATE = {"speed": 0.8, "time_constant": 0.06, "mu_gate": 0.2}
SETTLED = {"delta_mu": 0.03}
ADDED = {  # words: changes of the set "no slip, L = 1.65 d, sink"
    "dilatancy from 0.62": {"effects.dilatancy": DENSE},
    "dilatancy from 0.60": {"effects.dilatancy": CRITICAL},
    "gate rubs (0.2)": {"effects.gate": RUBBING_GATE},
    "gate 0.8 m/s, rubs": {"effects.gate": SLOW_GATE},
    "hysteresis 0.03": {"effects.friction_hysteresis": SETTLED},
    "dilatancy from 0.62, gate 0.8 m/s": {
        "effects.dilatancy": DENSE,
        "effects.gate": SLOW_GATE,
    },
    "dilatancy from 0.62, hysteresis": {
        "effects.dilatancy": DENSE,
        "effects.friction_hysteresis": SETTLED,
    },
    "dilatancy from 0.62, sink of 0.25": {
        "effects.dilatancy": DENSE,
        "effects.lateral_friction": {"mu_wall": 0.25},
    },
    "half the sink": {"effects.lateral_friction": {"mu_wall": 0.09}},
    "sink of 0.25": {"effects.lateral_friction": {"mu_wall": 0.25}},
    "sink of 0.30": {"effects.lateral_friction": {"mu_wall": 0.30}},
}
WITHOUT_THIN_LAYER = (  # of ADDED, also run without thin_layer
    "dilatancy from 0.62",
    "sink of 0.25",
    "sink of 0.30",
)
NEAREST = ("dilatancy from 0.62", "sink of 0.25", "dilatancy from 0.62, sink of 0.25")
NEAREST_SETS = (
    "0.38, 0.64; no slip; L = 1.65 d; dilatancy from 0.62, sink of 0.25",
    "0.40, 0.66; no slip; L = 1.65 d; dilatancy from 0.62",
    "0.44, 0.69; no slip; L = 1.65 d; dilatancy from 0.62",
    "0.48, 0.73; slip; L = 1.65 d; sink",
)


def bed(friction, slips, length):
    """Settings of the grains and of the bed; `length` of `thin_layer` in diameters, None: off."""
    mu_1, mu_2 = FRICTION[friction]
    return {
        "rheology.mu_1": mu_1,
        "rheology.mu_2": mu_2,
        "boundary.mu_bed": mu_1 if slips else math.inf,
        "effects.thin_layer": None if length is None else {"length": length},
    }


def fact_sets():
    """{name: settings} of the sets that are held against the printed facts."""
    sets = {}
    for friction in FRICTION:
        if friction != FEWER:
            sets |= beds_and_walls(friction)
        sets |= additions(friction, NEAREST if friction == FEWER else ADDED)
    return sets


def beds_and_walls(friction):
    """Sets of one friction: both beds, all lengths, with and without walls."""
    sets = {}
    for slips in (True, False):
        for length in LENGTHS:
            grains = bed(friction, slips, length)
            name = f"{friction}; {'slip' if slips else 'no slip'}{thin(length)}"
            sets[f"{name}; sink"] = grains | {"effects.lateral_friction": SINK}
            if length in (None, 1.65):
                sets[f"{name}; no sink"] = grains
    return sets


def additions(friction, wanted):
    """Sets of one friction on a bed without slip, with those of ADDED that are wanted."""
    sets = {}
    for words in wanted:
        for length in (1.65, None) if words in WITHOUT_THIN_LAYER else (1.65,):
            grains = bed(friction, False, length) | {"effects.lateral_friction": SINK}
            sets[f"{friction}; no slip{thin(length)}; {words}"] = grains | ADDED[words]
    return sets


def thin(length):
    """The words of a length of `thin_layer`; none where it is off."""
    return "" if length is None else f"; L = {length:g} d"


def collapse(slope, width, cell_size):
    """Settings of the set-up, without grains, bed and walls."""
    return {
        "geometry.slope_angle_deg": slope,
        "geometry.channel_width": width,
        "grid.cell_size": cell_size,
        "time.end": END[slope],
        "time.field_interval": END[slope],
        "time.output_times": (1.76,) if slope == 22.0 else (),
    }
