"""An experiment: the folder that a laboratory, a particle simulation or a synthetic case leaves.

`experiment.toml` says what was set up, CSV files what was measured; what is absent was not
measured. The set-up of the experiment, put on top of what the user believes, is the case that a
simulation of it runs (`Experiment.case`). A `[truth]` section is never looked at.
"""

import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fvcollapse.case.case import Case
from fvcollapse.case.grammar import parse_toml, read_text
from fvcollapse.draw.html import html_table
from fvcollapse.errors import CaseError, InputError
from fvcollapse.files.labelled import tree
from fvcollapse.measure.curves import CSV_FILES, SCALARS, read_curve, read_scalars
from fvcollapse.measure.experiment_folder import SETTINGS, refuse_bad_name, refuse_parent
from fvcollapse.measure.experiment_keys import (
    CASE_KEYS,
    Settings,
    rule_required,
    settings_from_table,
)
from fvcollapse.measure.labels import labelled_points, measured_rows
from fvcollapse.measure.measured_files import measured_files
from fvcollapse.measure.plausibility import refuse_impossible
from fvcollapse.measure.quantities import CURVES, QUANTITIES, SCALAR_UNITS
from fvcollapse.measure.uncertainty import standard_deviation
from fvcollapse.measure.unstated import assumed_of_grains

if TYPE_CHECKING:
    import xarray

    from fvcollapse.draw.drawing import Picture
    from fvcollapse.measure.curves import Curve, Scalar
    from fvcollapse.measure.observables import Observations

# a header of a section whose name is `truth` in any spelling of TOML, and any header
TRUTH = re.compile(r"""\s*\[\[?\s*(truth|"truth"|'truth')\s*[].]""")
HEADER = re.compile(r"""\s*\[\[?\s*["']?[A-Za-z_][\w\s."'-]*\]\]?\s*(#.*)?$""")


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

    @cached_property
    def name(self) -> str:
        """Name of the folder."""
        return self.folder.resolve().name

    @property
    def front_thickness(self) -> float | None:
        """Thickness that defines the front [m]; None: as the case says."""
        return self.settings.front.thickness

    @property
    def time_origin(self) -> float:
        """Simulated time at which the clock of the measurements shows 0 [s]."""
        return self.settings.time.origin

    @property
    def time_end(self) -> float:
        """Simulated time of the last measured point [s]; 0 without curves."""
        last = [curve.time[-1] for curve in self.curves.values()]
        return max([0.0, *(float(time) + self.time_origin for time in last)])

    def stated(self, path: str) -> Any:
        """Value of a dotted key of `experiment.toml`; None if it is absent."""
        section, _, name = path.partition(".")
        return getattr(getattr(self.settings, section), name)

    def standard_deviation(self, name: str, value: float = 1.0) -> float:
        """Standard deviation of a quantity: as stated, else that of `assumed`, else `uncertainty.DEFAULTS`.

        `value` is the quantity itself, of which a relative default is a part.
        """
        assumed = self.assumed().get(f"material.{name}")
        if assumed is not None and getattr(self.settings.uncertainty, name) is None:
            return assumed.sd
        return standard_deviation(self.settings.uncertainty, name, value)

    def has_common(self, name: str) -> bool:
        """Whether the error of a quantity is that of all experiments of the laboratory; see `[common]`."""
        return getattr(self.settings.common, name, False)

    def assumed(self, base: Case | None = None) -> dict[str, Any]:
        """{key: `Assumed`} of what is not stated and follows from what is; see `unstated.assumed_of_grains`."""
        return assumed_of_grains(self.settings.material, base)

    def plot(self, observed: "Observations | None" = None) -> "Picture":
        """What was measured as a figure, which a notebook shows: the curves, and the numbers in words.

        Parameters
        ----------
        observed : Observations, optional
            What a run gives for this experiment, `observe(result, experiment)`: drawn beneath.
        """
        from fvcollapse.draw.curves import draw_observables  # loads matplotlib

        return draw_observables(observed, self.curves, self.scalars)

    def to_xarray(self) -> "xarray.DataTree":
        """The measured points as labelled arrays with units and standard deviations, one group for each curve.

        Raises
        ------
        ImportError
            xarray is not installed.
        """
        groups = {name: labelled_points(name, curve) for name, curve in self.curves.items()}
        about = {"title": self.settings.title, "source": self.settings.source}
        return tree(groups, about | {f"{one.name} ({one.kind})": one.value for one in self.scalars})

    def _repr_html_(self) -> str:
        rows = measured_rows(self.curves, self.scalars)
        return html_table(self.settings.title or self.name, rows)

    def case(self, base: Case | None = None) -> Case:
        """The case of this experiment.

        Geometry, gate, bed and what was measured of the material come from the experiment (absent:
        no lateral walls, a gate removed at once, no slip on the bed; mu_2 as far above a stated mu_1 as in
        the default); all else from `base`, and the end of the run is late enough for the last measured point.

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
        changes = case_changes(self, base)
        if base is None:
            base, changes["grid.cell_size"] = Case(), suitable_cell_size(self.settings.geometry)
        changes["time.end"] = max(base.time.end, self.time_end)
        try:
            return base.replace(**changes)
        except CaseError as error:
            own = next((own for own, (name, _) in CASE_KEYS.items() if name == error.key), None)
            kept = ""
            if own and self.stated(own) is None:
                assumed = self.assumed(base).get(own)
                kept = f" ({assumed.reason if assumed else 'of the case'}: none stated)"
            path, found = self.folder / SETTINGS, error.found + kept
            raise CaseError(path, own or error.key, found, error.allowed) from None


def load_experiment(folder: str | Path) -> Experiment:
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
    refuse_bad_name(folder)
    refuse_parent(folder)
    settings = read_settings(folder / SETTINGS)
    experiment = Experiment(folder, settings, *read_measurements(folder, settings.uncertainty))
    refuse_impossible(experiment)
    experiment.case()  # a set-up that no simulation can have is refused now
    return experiment


def read_settings(path: Path) -> Settings:
    """The `Settings` in a file."""
    settings = read_draft(path)
    missing = list(rule_required(settings))
    if missing:
        keys = ", ".join(key for key, _, _ in missing)
        raise InputError(path, keys, *missing[0][1:])
    return settings


def is_complete(path: Path) -> bool:
    """Whether the settings in a file state what every experiment has to state."""
    return not list(rule_required(read_draft(path)))


def read_draft(path: Path) -> Settings:
    """The `Settings` in a file that may still lack required keys."""
    table = parse_toml(strip_truth(read_text(path, "TOML")), path)
    table.pop("truth", None)  # as `truth = ...` or `truth.cause = ...`
    return settings_from_table(table, path)


def strip_truth(text: str) -> str:
    """The text without its `[truth]` sections, whatever stands in them."""
    kept, hidden = [], False
    for line in text.splitlines(keepends=True):
        if HEADER.match(line) or TRUTH.match(line):
            hidden = bool(TRUTH.match(line))
        if not hidden:
            kept.append(line)
    return "".join(kept)


def read_measurements(
    folder: Path, uncertainty: Any
) -> "tuple[dict[str, Curve], tuple[Scalar, ...]]":
    """(curves, scalars) of a folder."""
    files = measured_files(folder)
    curves = {
        name: read_curve(files[name], name, standard_deviation(uncertainty, quantity.uncertainty))
        for name, quantity in CURVES.items()
        if name in files
    }
    scalars: tuple[Scalar, ...] = ()
    if SCALARS in files:
        scalars = read_scalars(
            files[SCALARS],
            SCALAR_UNITS,
            lambda name: standard_deviation(uncertainty, QUANTITIES[name].uncertainty),
        )
    if not curves and not scalars:
        known = ", ".join(f"{name}.csv" for name in CSV_FILES)
        raise InputError(folder, "folder", "no measurement", f"one or more of {known}")
    return curves, scalars


def case_changes(experiment: Experiment, base: Case | None = None) -> dict[str, Any]:
    """Changes to a case, of which `base` is believed, that make it the set-up of an experiment."""
    assumed = experiment.assumed(base).items()
    changes = {CASE_KEYS[own][0]: one.value for own, one in assumed}
    for own, (name, absent) in CASE_KEYS.items():
        value = experiment.stated(own)
        if value is not None or absent is not None:
            changes[name] = absent if value is None else value
    material = experiment.settings.material
    fraction, grain = material.solid_fraction, material.density_grain
    if material.density_bulk is None and fraction is not None and grain is not None:
        changes["rheology.density_bulk"] = fraction * grain
    return changes


def suitable_cell_size(geometry: Any) -> float:
    """Default cell size [m], or the nearest that a column of this size may have."""
    finest = geometry.height_0 / 100
    coarsest = min(geometry.height_0, geometry.length_0) / 4
    return min(max(Case().grid.cell_size, finest), coarsest)
