"""The cases of the benchmark."""

import math

from fvcollapse.case.case import Case
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import PHYSICAL

SLOPES = {22: 2.0, 0: 1.0}  # deg: time simulated, s
WIDTHS = {"w10cm": 0.10, "winf": float("inf")}
SIZES = (0.012, 0.006, 0.003)  # m
FINEST = 0.0015  # m; minutes each, on demand
NO_EFFECT = "no_effect"
ROUGH = "_rough"  # end of the names on a bed on which nothing slides


def cases(finest: bool = False) -> dict[str, Case]:
    """The cases by name; the mass is released at once, as in the code that they are compared with."""
    return {
        f"{slope}deg_{width}_{1e3 * size:g}mm": Case().replace(
            **{
                "geometry.slope_angle_deg": float(slope),
                "geometry.channel_width": value,
                "effects.lateral_friction": {},
                "gate.speed": math.inf,
                "grid.cell_size": size,
                "time.end": end,
                "time.field_interval": end,
            }
        )
        for slope, end in SLOPES.items()
        for width, value in WIDTHS.items()
        for size in (*SIZES, *([FINEST] if finest else []))
    }


def effect_cases() -> dict[str, Case]:
    """The collapse at 22 deg, 10 cm and 6 mm without any effect, then with each that changes the flow.

    Every parameter has the median of its prior; of several variants the default one is taken. `thin_layer` is there
    with both closures, and again on a rough bed, for which it is made, in the channel with lateral friction.
    """
    base = cases()["22deg_w10cm_6mm"].replace(
        **{"effects.lateral_friction": None, "gate.speed": Case().gate.speed}
    )
    with_each = {
        name: base.replace(**{f"effects.{name}": effect.keys(0.5)})
        for name, effect in CATALOGUE.items()
        if effect.kind == PHYSICAL
    }
    rough = base.replace(**{"boundary.mu_bed": math.inf, "effects.lateral_friction": {}})
    layer = CATALOGUE["thin_layer"]
    thickness, fluidity = (layer.keys(0.5, variant) for variant in layer.variants)
    layers = {
        "thin_layer_nonlocal": base.replace(**{"effects.thin_layer": fluidity}),
        NO_EFFECT + ROUGH: rough,
        "thin_layer" + ROUGH: rough.replace(**{"effects.thin_layer": thickness}),
        "thin_layer_nonlocal" + ROUGH: rough.replace(**{"effects.thin_layer": fluidity}),
    }
    return {NO_EFFECT: base} | with_each | layers


def without_effect(name: str) -> str:
    """Name of the case that one with an effect is compared with."""
    return NO_EFFECT + (ROUGH if name.endswith(ROUGH) else "")


def shortened(case: Case) -> Case:
    """A short coarse run that calls the kernels of a case."""
    return until(case.replace(**{"grid.cell_size": 0.03}), 0.05)


def until(case: Case, end: float) -> Case:
    """The case cut short at a time, s."""
    end = min(end, case.time.end)
    return case.replace(**{"time.end": end, "time.field_interval": end})
