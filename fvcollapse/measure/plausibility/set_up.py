"""Plausibility of `experiment.toml`: angles, coefficients, sizes and densities against one another.

A range of single keys (`experiment_keys`) holds what is legal. Here each number meets the others.
"""

from collections.abc import Iterator
from math import atan, degrees, isfinite, radians, tan
from typing import TYPE_CHECKING

from fvcollapse.measure.plausibility.finding import ERROR, WARNING, Finding, scales_of

if TYPE_CHECKING:
    from fvcollapse.measure.experiment import Experiment


FILE = "experiment.toml"
# 3 to 30 deg in radians; as degrees a bed is that nearly level, and still stated as sloping, only by chance
RADIANS = (radians(3.0), radians(30.0))
# mu_1 is the tangent of the angle of repose: less than 1 deg apart in the shipped experiments; 5.4 deg between
# repose and avalanche (Lajeunesse et al. 2005); a heap in a narrow channel stands some degrees steeper
ANGLES_ODD, ANGLES_APART = 10.0, 15.0
# deg; spheres without any friction stand at 5.8 (Peyneau & Roux 2008, Phys. Rev. E 78, 011307)
LEAST_REPOSE = 5.0
READING = 1.0  # deg; twice the error of an angle
STEEPEST = 2.0  # friction coefficient of a slope of 63 deg
COARSEST = 4.0  # grains in the smaller side of a column: below, no continuum
LIGHTEST = 100.0  # kg/m3; below are beads of expanded polystyrene alone
PACKED = (0.4, 0.91)  # solid fraction: fine powder, discs in a plane
NARROWEST = 3.0  # grains in the width of a channel
ROUND_OFF = 1.0e-9  # relative: a slot of just as many grains is no narrower
FASTEST_GATE = 50.0  # m/s; gates in print: 1 to 3.5
THICKEST_FRONT = 1.0 / 3.0  # of the column
ASPECT = 100.0  # of a column or its inverse; 0.1 to 20 in print


def slope_in_radians(experiment: "Experiment") -> Iterator[Finding]:
    """A slope of a fraction of a degree that would be a usual one in radians."""
    slope = experiment.settings.geometry.slope_angle_deg
    if RADIANS[0] <= slope <= RADIANS[1]:
        yield Finding(
            WARNING,
            FILE,
            "geometry.slope_angle_deg",
            f"{slope:g} deg",
            f"0, or more than {RADIANS[1]:.2f} deg",
            f"in radians ({degrees(slope):.1f} deg)?",
        )


def angles_against_friction(experiment: "Experiment") -> Iterator[Finding]:
    """Angles of repose and avalanche are those of mu_1, and the second is the larger one."""
    material = experiment.settings.material
    repose, avalanche = material.repose_angle_deg, material.avalanche_angle_deg
    for name, angle in (("repose_angle_deg", repose), ("avalanche_angle_deg", avalanche)):
        if angle is not None:
            yield from angle_against_friction(f"material.{name}", angle, material.mu_1)
    if None not in (repose, avalanche) and avalanche < repose - READING:
        allowed = f">= repose_angle_deg = {repose:g} deg"
        key = "material.avalanche_angle_deg"
        yield Finding(WARNING, FILE, key, f"{avalanche:g} deg", allowed, "the two exchanged?")


def angle_against_friction(key: str, angle: float | None, mu_1: float | None) -> Iterator[Finding]:
    """One angle beside mu_1 (None: not stated)."""
    if mu_1 is None:
        if angle < LEAST_REPOSE:
            found, allowed = f"{angle:g} deg", f">= {LEAST_REPOSE:g} deg"
            yield Finding(WARNING, FILE, key, found, allowed, other_angle(angle, None))
        return
    stated = degrees(atan(mu_1))
    apart = abs(angle - stated)
    if apart > ANGLES_ODD:
        yield Finding(
            ERROR if apart > ANGLES_APART else WARNING,
            FILE,
            key,
            f"{angle:g} deg beside mu_1 = {mu_1:g}",
            f"about {stated:.1f} deg, whose tangent is mu_1",
            other_angle(angle, stated),
        )


def other_angle(angle: float, stated: float) -> str:
    """What an angle is if it is not one in degrees, as a question; `stated` is the one expected [deg]."""
    meanings = {"in radians": degrees(angle), "a tangent": degrees(atan(angle))}
    if stated is not None:
        meanings = {
            name: value for name, value in meanings.items() if abs(value - stated) < ANGLES_ODD
        }
    elif not RADIANS[0] <= angle <= 1.0:
        meanings = {}
    if not meanings:
        return ""
    return " or ".join(f"{name} ({value:.1f} deg)" for name, value in meanings.items()) + "?"


def coefficients(experiment: "Experiment") -> Iterator[Finding]:
    """Friction coefficients that would be walls; angles in degrees are larger still."""
    material = experiment.settings.material
    for name in ("mu_1", "mu_2", "mu_bed", "mu_back_wall", "mu_wall"):
        value = getattr(material, name)
        if value is not None and isfinite(value) and value > STEEPEST:
            likely = f"an angle in degrees (mu = {tan(radians(min(value, 89.0))):.3f})?"
            key, allowed = f"material.{name}", f"<= {STEEPEST:g}"
            yield Finding(WARNING, FILE, key, f"{value:g}", allowed, likely)


def grains_against_column(experiment: "Experiment") -> Iterator[Finding]:
    """Grains are smaller than the column and than the channel."""
    geometry, grain = experiment.settings.geometry, experiment.settings.material.grain_diameter
    if grain is None:
        return
    key, side = "material.grain_diameter", min(geometry.height_0, geometry.length_0)
    if grain > side / COARSEST:
        severity = ERROR if grain >= side else WARNING
        allowed = f"< {side / COARSEST:g} m, a quarter of the smaller side of the column"
        likely = "in mm instead of m?" if grain >= side else ""
        yield Finding(severity, FILE, key, f"{grain:g} m", allowed, likely)
    width = geometry.channel_width
    if width is not None and width < NARROWEST * grain * (1.0 - ROUND_OFF):
        severity = ERROR if width < grain else WARNING
        found, allowed = f"{width:g} m", f">= {NARROWEST:g} grain diameters of {grain:g} m"
        yield Finding(severity, FILE, "geometry.channel_width", found, allowed)


def densities(experiment: "Experiment") -> Iterator[Finding]:
    """Densities of solids, and the packing that they make."""
    material = experiment.settings.material
    grain, bulk = material.density_grain, material.density_bulk
    for name, value in (("density_grain", grain), ("density_bulk", bulk)):
        if value is not None and value < LIGHTEST:
            key, allowed = f"material.{name}", f">= {LIGHTEST:g} kg/m3"
            likely = "in g/cm3 instead of kg/m3?"
            yield Finding(WARNING, FILE, key, f"{value:g} kg/m3", allowed, likely)
    packed = material.solid_fraction
    if packed is None and None not in (grain, bulk):
        packed = bulk / grain
    if packed is not None and not PACKED[0] <= packed <= PACKED[1]:
        allowed = f"{PACKED[0]:g} to {PACKED[1]:g}"
        yield Finding(WARNING, FILE, "material.solid_fraction", f"{packed:.3g}", allowed)


def column_and_gate(experiment: "Experiment") -> Iterator[Finding]:
    """The shape of the column, the speed of the gate, and the thickness that defines the front."""
    settings, scales = experiment.settings, scales_of(experiment)
    aspect = scales.height / scales.length
    if not 1.0 / ASPECT <= aspect <= ASPECT:
        found = f"{scales.height:g} m beside length_0 = {scales.length:g} m"
        allowed = f"{1 / ASPECT:g} to {ASPECT:g} times the length"
        likely = "height and length in different units?"
        yield Finding(WARNING, FILE, "geometry.height_0", found, allowed, likely)
    speed = settings.gate.speed
    if speed is not None and speed > FASTEST_GATE and isfinite(speed):
        found, allowed = f"{speed:g} m/s", f"<= {FASTEST_GATE:g} m/s, or inf"
        yield Finding(WARNING, FILE, "gate.speed", found, allowed, "in mm/s or cm/s?")
    thickness = settings.front.thickness
    if thickness is not None and thickness > THICKEST_FRONT * scales.height:
        severity = ERROR if thickness >= scales.height else WARNING
        allowed = f"< {THICKEST_FRONT * scales.height:.3g} m, a third of the height of the column"
        likely = "in mm or cm instead of m?"
        yield Finding(severity, FILE, "front.thickness", f"{thickness:g} m", allowed, likely)


CHECKS = (
    slope_in_radians,
    angles_against_friction,
    coefficients,
    grains_against_column,
    densities,
    column_and_gate,
)
