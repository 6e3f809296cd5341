"""The grammar of `experiment.toml`: its keys, what ties them together, and where they stand in a case."""

from collections.abc import Iterator
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from fvcollapse.case.grammar import Section, convert, key, key_table
from fvcollapse.case.rules import rule_finite
from fvcollapse.errors import InputError
from fvcollapse.measure.uncertainty import DEFAULTS, Uncertainty

if TYPE_CHECKING:
    from fvcollapse.case.grammar import KeyInfo


REQUIRED = ("geometry.slope_angle_deg", "geometry.height_0", "geometry.length_0")
# where a key of the experiment stands in the case; absent = the value in the second column, or
# (None) what the case says without it
CASE_KEYS = {
    "geometry.slope_angle_deg": ("geometry.slope_angle_deg", None),
    "geometry.height_0": ("geometry.height_0", None),
    "geometry.length_0": ("geometry.length_0", None),
    "geometry.channel_width": ("geometry.channel_width", inf),
    "gate.speed": ("gate.speed", inf),
    "gate.time_constant": ("gate.time_constant", 0.0),
    "material.grain_diameter": ("rheology.grain_diameter", None),
    "material.density_grain": ("rheology.density_grain", None),
    "material.density_bulk": ("rheology.density_bulk", None),
    "material.mu_1": ("rheology.mu_1", None),
    "material.mu_2": ("rheology.mu_2", None),
    "material.I_0": ("rheology.I_0", None),
    "material.mu_bed": ("boundary.mu_bed", inf),
    "material.mu_back_wall": ("boundary.mu_back_wall", None),
    "front.thickness": ("front.thickness", None),
}


class Geometry(Section):
    """The set-up; whether lateral walls rub is a hypothesis, not a part of it."""

    slope_angle_deg: Annotated[float, key("deg", "inclination of the bed", ge=0, le=30)] | None = (
        None
    )
    height_0: Annotated[float, key("m", "height of the column", gt=0, le=1000)] | None = None
    length_0: Annotated[float, key("m", "length of the column", gt=0, le=1000)] | None = None
    channel_width: (
        Annotated[float, key("m", "channel width; absent = no walls", gt=0, inf=True)] | None
    ) = None


class Gate(Section):
    """The gate; absent = removed at once."""

    speed: Annotated[float, key("m/s", "lifting speed", ge=0, inf=True)] | None = None
    time_constant: (
        Annotated[float, key("s", "tau of the speed law v (1 - exp(-t/tau))", ge=0, le=1000)] | None
    ) = None


class Material(Section):
    """What was measured of the grains, and of the surfaces they touch."""

    grain_diameter: Annotated[float, key("m", "grain diameter", gt=0, le=1)] | None = None
    density_grain: (
        Annotated[float, key("kg/m3", "density of the grain material", gt=0, le=1e5)] | None
    ) = None
    density_bulk: (
        Annotated[float, key("kg/m3", "density of the packed grains", gt=0, le=1e5)] | None
    ) = None
    solid_fraction: (
        Annotated[float, key("-", "solid fraction of the column at rest", gt=0, le=1)] | None
    ) = None
    mu_1: Annotated[float, key("-", "friction coefficient at rest", ge=0, le=10)] | None = None
    mu_2: (
        Annotated[float, key("-", "friction coefficient at high inertial number", ge=0, le=10)]
        | None
    ) = None
    I_0: Annotated[float, key("-", "inertial-number scale of mu(I)", gt=0, le=1000)] | None = None
    mu_bed: (
        Annotated[float, key("-", "friction on the bed; absent = no slip", ge=0, inf=True)] | None
    ) = None
    mu_back_wall: Annotated[float, key("-", "friction on the back wall", ge=0, inf=True)] | None = (
        None
    )
    mu_wall: Annotated[float, key("-", "friction on the lateral walls", ge=0, le=10)] | None = None
    repose_angle_deg: Annotated[float, key("deg", "angle of repose (stop)", ge=0, lt=90)] | None = (
        None
    )
    avalanche_angle_deg: (
        Annotated[float, key("deg", "angle of avalanche (start)", ge=0, lt=90)] | None
    ) = None


class Front(Section):
    """How the front was read."""

    thickness: (
        Annotated[
            float,
            key("m", "the front is where the thickness falls below this", gt=0, le=1000),
        ]
        | None
    ) = None


class Time(Section):
    """The clock of the measurements."""

    origin: Annotated[
        float,
        key("s", "t = 0 of the CSV files, after the gate starts to rise", ge=-1000, le=1000),
    ] = 0.0


class Common(Section):
    """Errors that all experiments of a laboratory share: the same tank, gate and camera.

    Every experiment that says `true` has the same error of that quantity; of `height_0` and `length_0` also the same
    scale of the picture and the same origin of X.
    """

    slope_angle_deg: Annotated[bool, key("-", "the inclination is off by the same angle")] = False
    height_0: Annotated[bool, key("-", "the height is off by the same length")] = False
    length_0: Annotated[bool, key("-", "the length is off by the same length")] = False
    speed: Annotated[bool, key("-", "the gate is faster or slower by the same speed")] = False
    time: Annotated[bool, key("-", "the clock is ahead by the same time")] = False


class Settings(Section):
    """All of `experiment.toml` but its `[truth]`."""

    title: Annotated[str, key("-", "one line that names the experiment")] = ""
    source: Annotated[str, key("-", "where the numbers come from")] = ""
    geometry: Geometry = Geometry()
    gate: Gate = Gate()
    material: Material = Material()
    front: Front = Front()
    time: Time = Time()
    uncertainty: Uncertainty = Uncertainty()
    common: Common = Common()


def describe_keys() -> "list[KeyInfo]":
    """All keys of `experiment.toml`, as `case.describe_keys` does for a case.

    The default of an uncertainty is what holds where neither the key nor a column states one.
    """
    return [
        with_default(info, DEFAULTS[name]) if section == "uncertainty" else info
        for info in key_table(Settings).values()
        for section, _, name in [info.name.partition(".")]
    ]


def with_default(info: "KeyInfo", default: Any) -> "KeyInfo":
    """The row of an uncertainty with its value and the reason for it."""
    value = f"{100 * default.value:g} %" if default.relative else f"{default.value:g}"
    return info._replace(default=value, description=f"{info.description} ({default.reason})")


def settings_from_table(table: dict, path: str | Path) -> Settings:
    """The `Settings` in nested dictionaries; every key that is there is right, none is required."""
    settings, refused = convert(table, Settings)
    for refusal in refused or (*rule_finite(settings), *rule_gate(settings)):
        raise InputError(path, *refusal)
    return settings


def rule_required(settings: Settings) -> Iterator[tuple[str, str, str]]:
    """There is no collapse without slope and column."""
    for path in REQUIRED:
        section, _, name = path.partition(".")
        if getattr(getattr(settings, section), name) is None:
            yield path, "no such key", "a number: an experiment states its slope and its column"


def rule_gate(settings: Settings) -> Iterator[tuple[str, str, str]]:
    """A speed law has a speed."""
    if settings.gate.time_constant is not None and settings.gate.speed is None:
        yield "gate.time_constant", f"{settings.gate.time_constant:g}", "beside gate.speed"
