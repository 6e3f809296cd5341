"""Standard uncertainties of an experiment: what a file may state, and what holds where it does not.

Every number that an experiment folder leaves open is in `DEFAULTS`, with the reason for it. A range
that the literature gives is read as one of 90 %: standard deviation = range / 3.29.
"""

from typing import Annotated, Any

import msgspec

from fvcollapse.case.grammar import Section, key
from fvcollapse.measure.quantities import MEASURED_DEFAULTS, Default


def absolute(unit: str, value: float, reason: str) -> Default:
    """A default in the unit of the quantity."""
    return Default(unit, value, False, reason)


def relative(unit: str, value: float, reason: str) -> Default:
    """A default that is a part of the quantity; `unit` is that of a stated value."""
    return Default(unit, value, True, reason)


DEFAULTS = {
    # what is measured of the collapse, and never without an error
    **MEASURED_DEFAULTS,
    "time": absolute("s", 0.005, "one frame at 200 frames per second"),
    # set-up
    "slope_angle_deg": absolute("deg", 0.2, "tilt error +-0.3 deg as 90 %"),
    "height_0": absolute("m", 0.001, "a ruler"),
    "length_0": absolute("m", 0.001, "a ruler"),
    "channel_width": absolute("m", 0.001, "a ruler"),
    "speed": relative("m/s", 0.1, "chosen: few gates are filmed"),
    "time_constant": relative("s", 0.2, "chosen: few gates are filmed"),
    # material
    "grain_diameter": relative("m", 0.1, "0.7 +- 0.1 mm (Martin et al. 2017) as 90 %"),
    "density_grain": relative("kg/m3", 0.01, "chosen: glass is well known"),
    "density_bulk": relative("kg/m3", 0.03, "solid fraction 0.58 to 0.64"),
    "solid_fraction": absolute("-", 0.018, "0.58 to 0.64"),
    "mu_1": absolute("-", 0.02, "glass beads without walls: 0.38 to 0.44"),
    "mu_2": absolute("-", 0.03, "mu_2 - mu_1 from 0.20 to 0.30"),
    "I_0": absolute("-", 0.1, "published fits from 0.069 to 0.40"),
    "mu_bed": absolute("-", 0.02, "as mu_1"),
    "mu_back_wall": absolute("-", 0.1, "between smooth and as rough as the grains, 0.18 to 0.48"),
    "mu_wall": absolute("-", 0.02, "glass beads on glass or acrylic: 0.18 to 0.25"),
    "repose_angle_deg": absolute("deg", 0.5, "Lajeunesse et al. 2005"),
    "avalanche_angle_deg": absolute("deg", 0.5, "Lajeunesse et al. 2005"),
}
LARGEST = {"m": 1000.0, "s": 1000.0, "m/s": 1000.0, "deg": 90.0, "-": 10.0, "kg/m3": 1.0e5}


def stated_key(name: str) -> tuple[str, Any, None]:
    """The optional key of one quantity, as msgspec wants it: (name, type, default)."""
    unit, *_ = DEFAULTS[name]
    least: dict[str, Any] = {"gt": 0} if name in MEASURED_DEFAULTS else {"ge": 0}
    limits = key(unit, f"standard deviation of {name}", **least, le=LARGEST[unit])
    return name, Annotated[float, limits] | None, None


Uncertainty = msgspec.defstruct(
    "Uncertainty",
    [stated_key(name) for name in DEFAULTS],
    bases=(Section,),
    frozen=True,
    forbid_unknown_fields=True,
    kw_only=True,
    module=__name__,
    namespace={"__doc__": "Standard deviations that the experimenter states; absent = `DEFAULTS`."},
)


def standard_deviation(stated: Any, name: str, value: float = 1.0) -> float:
    """Standard deviation of a quantity: as stated, else the default.

    Parameters
    ----------
    stated : Uncertainty
    name : str
        Key of `DEFAULTS`.
    value : float
        The quantity itself; a relative default is a part of it.
    """
    given = getattr(stated, name)
    if given is not None:
        return given
    default = DEFAULTS[name]
    return default.value * abs(value) if default.relative else default.value
