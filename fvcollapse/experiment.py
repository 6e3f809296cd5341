"""An experiment: the folder that a laboratory, a particle simulation or a synthetic case leaves.

`experiment.toml` says what was set up, CSV files what was measured; what is absent was not
measured. The set-up of the experiment, put on top of what the user believes, is the case that a
simulation of it runs (`Experiment.case`). A `[truth]` section is never looked at.
"""

import re
from dataclasses import dataclass
from difflib import get_close_matches
from math import inf
from pathlib import Path
from typing import Annotated

import msgspec

from fvcollapse.case import Case
from fvcollapse.case_keys import Section, key, key_table, parse_toml, read_text, refusal_of_type
from fvcollapse.case_rules import rule_finite
from fvcollapse.curves import CSV_FILES, FORMS, SCALARS, read_curve, read_scalars
from fvcollapse.errors import CaseError, InputError
from fvcollapse.observables import SCALAR_UNITS
from fvcollapse.uncertainty import DEFAULTS, Uncertainty, standard_deviation

SETTINGS = "experiment.toml"
REQUIRED = ("geometry.slope_angle_deg", "geometry.height_0", "geometry.length_0")
# key of [uncertainty] of each scalar
SCALAR_UNCERTAINTY = {name: name for name in SCALAR_UNITS} | {
    "runout": "front",
    "final_height": "thickness",
}
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
# a header of a section whose name is `truth` in any spelling of TOML, and any header
TRUTH = re.compile(r"""\s*\[\[?\s*(truth|"truth"|'truth')\s*[].]""")
HEADER = re.compile(r"""\s*\[\[?\s*["']?[A-Za-z_][\w\s."'-]*\]\]?\s*(#.*)?$""")


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


@dataclass(frozen=True)
class Experiment:
    """What was set up and what was measured.

    Attributes
    ----------
    folder : Path
    settings : Settings
        `experiment.toml`; None in a key = not stated.
    curves : dict
        {name: Curve}, of front, profiles, volume and interface those that were measured.
    scalars : tuple of Scalar
    """

    folder: Path
    settings: Settings
    curves: dict
    scalars: tuple

    @property
    def name(self):
        """Name of the folder."""
        return self.folder.resolve().name

    @property
    def front_thickness(self):
        """Thickness that defines the front [m]; None: as the case says."""
        return self.settings.front.thickness

    @property
    def time_origin(self):
        """Simulated time at which the clock of the measurements shows 0 [s]."""
        return self.settings.time.origin

    @property
    def time_end(self):
        """Simulated time of the last measured point [s]; 0 without curves."""
        last = [curve.time[-1] for curve in self.curves.values()]
        return max([0.0, *(float(time) + self.time_origin for time in last)])

    def stated(self, path):
        """Value of a dotted key of `experiment.toml`; None if it is absent."""
        section, _, name = path.partition(".")
        return getattr(getattr(self.settings, section), name)

    def standard_deviation(self, name, value=1.0):
        """Standard deviation of a quantity, as stated or by default; see `uncertainty.DEFAULTS`.

        `value` is the quantity itself, of which a relative default is a part.
        """
        return standard_deviation(self.settings.uncertainty, name, value)

    def case(self, base=None):
        """The case of this experiment.

        Geometry, gate, bed and what was measured of the material come from the experiment (absent:
        no lateral walls, a gate removed at once, no slip on the bed); all else from `base`, and the
        end of the run is late enough for the last measured point.

        Parameters
        ----------
        base : Case, optional
            What the user believes; without it the defaults, no effects, and cells of 6 mm (within a
            quarter and a hundredth of the height).

        Raises
        ------
        CaseError
            The two do not fit together.
        """
        changes = case_changes(self)
        if base is None:
            base, changes["grid.cell_size"] = Case(), suitable_cell_size(self.settings.geometry)
        changes["time.end"] = max(base.time.end, self.time_end)
        try:
            return base.replace(**changes)
        except CaseError as error:
            own = next((own for own, (name, _) in CASE_KEYS.items() if name == error.key), None)
            kept = " (of the case: none stated)" if own and self.stated(own) is None else ""
            path, found = self.folder / SETTINGS, error.found + kept
            raise CaseError(path, own or error.key, found, error.allowed) from None


def describe_keys():
    """All keys of `experiment.toml`, as `case.describe_keys` does for a case.

    The default of an uncertainty is what holds where neither the key nor a column states one.
    """
    return [
        with_default(info, DEFAULTS[name]) if section == "uncertainty" else info
        for info in key_table(Settings).values()
        for section, _, name in [info.name.partition(".")]
    ]


def with_default(info, default):
    """The row of an uncertainty with its value and the reason for it."""
    value = f"{100 * default.value:g} %" if default.relative else f"{default.value:g}"
    return info._replace(default=value, description=f"{info.description} ({default.reason})")


def load_experiment(folder):
    """The experiment in a folder (or whose `experiment.toml` is given).

    Parameters
    ----------
    folder : str or Path

    Returns
    -------
    Experiment

    Raises
    ------
    InputError
        One line that names file, key or column, what was found and what is allowed.
    """
    folder = Path(folder)
    if folder.name == SETTINGS:
        folder = folder.parent
    settings = read_settings(folder / SETTINGS)
    experiment = Experiment(folder, settings, *read_measurements(folder, settings.uncertainty))
    experiment.case()  # a set-up that no simulation can have is refused now
    return experiment


def read_settings(path):
    """The `Settings` in a file."""
    table = parse_toml(strip_truth(read_text(path, "TOML")), path)
    table.pop("truth", None)  # as `truth = ...` or `truth.cause = ...`
    settings = settings_from_table(table, path)
    for refusal in rule_required(settings):
        raise InputError(path, *refusal)
    return settings


def settings_from_table(table, path):
    """The `Settings` in nested dictionaries; every key that is there is right, none is required."""
    try:
        settings = msgspec.convert(table, Settings)
    except msgspec.ValidationError as error:
        raise InputError(path, *refusal_of_type(table, Settings, str(error))) from None
    for refusal in (*rule_finite(settings), *rule_gate(settings)):
        raise InputError(path, *refusal)
    return settings


def strip_truth(text):
    """The text without its `[truth]` sections, whatever stands in them."""
    kept, hidden = [], False
    for line in text.splitlines(keepends=True):
        if HEADER.match(line) or TRUTH.match(line):
            hidden = bool(TRUTH.match(line))
        if not hidden:
            kept.append(line)
    return "".join(kept)


def rule_required(settings):
    """There is no collapse without slope and column."""
    for path in REQUIRED:
        section, _, name = path.partition(".")
        if getattr(getattr(settings, section), name) is None:
            yield path, "no such key", "a number: an experiment states its slope and its column"


def rule_gate(settings):
    """A speed law has a speed."""
    if settings.gate.time_constant is not None and settings.gate.speed is None:
        yield "gate.time_constant", f"{settings.gate.time_constant:g}", "beside gate.speed"


def read_measurements(folder, uncertainty):
    """(curves, scalars) of a folder."""
    refuse_misspelt(folder)
    curves = {}
    for name, form in FORMS.items():
        path = folder / f"{name}.csv"
        if path.exists():
            sigma = standard_deviation(uncertainty, form.uncertainty)
            curves[name] = read_curve(path, name, sigma)
    path, scalars = folder / f"{SCALARS}.csv", ()
    if path.exists():
        scalars = read_scalars(
            path,
            SCALAR_UNITS,
            lambda name: standard_deviation(uncertainty, SCALAR_UNCERTAINTY[name]),
        )
    if not curves and not scalars:
        files = ", ".join(f"{name}.csv" for name in CSV_FILES)
        raise InputError(folder, "folder", "no measurement", f"one or more of {files}")
    return curves, scalars


def refuse_misspelt(folder):
    """Refuse a CSV file whose name nearly is one that is read: it would be passed over in silence."""
    for path in sorted(folder.glob("*.csv")):
        nearest = get_close_matches(path.stem, CSV_FILES, n=1, cutoff=0.8)
        if nearest and path.stem not in CSV_FILES:
            raise InputError(path, "file", "a name that is not read", f"{nearest[0]}.csv")


def case_changes(experiment):
    """Changes to a case that make it the set-up of an experiment."""
    changes = {}
    for own, (name, absent) in CASE_KEYS.items():
        value = experiment.stated(own)
        if value is not None or absent is not None:
            changes[name] = absent if value is None else value
    material = experiment.settings.material
    known = (material.solid_fraction, material.density_grain)
    if material.density_bulk is None and None not in known:
        changes["rheology.density_bulk"] = material.solid_fraction * material.density_grain
    return changes


def suitable_cell_size(geometry):
    """Default cell size [m], or the nearest that a column of this size may have."""
    finest = geometry.height_0 / 100
    coarsest = min(geometry.height_0, geometry.length_0) / 4
    return min(max(Case().grid.cell_size, finest), coarsest)
