"""Curves from digitising tools (x, y in columns, one file per curve) as an experiment folder."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

from fvcollapse.case.case import parse_value
from fvcollapse.case.grammar import read_text
from fvcollapse.errors import InputError, OutputError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.files.regular import refuse_unreadable
from fvcollapse.files.targets import ELSEWHERE, has_contents, is_there, make_folder
from fvcollapse.measure.curves import curve_text, read_curve
from fvcollapse.measure.digitised_table import read_table
from fvcollapse.measure.experiment import (
    SETTINGS,
    is_complete,
    load_experiment,
    read_draft,
    read_measurements,
)
from fvcollapse.measure.experiment_keys import rule_required
from fvcollapse.measure.quantities import CURVES, PROFILES, plain_unit
from fvcollapse.measure.settings_text import settings_text
from fvcollapse.measure.uncertainty import Uncertainty

LENGTHS = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001}
TIMES = {"s": 1.0, "ms": 0.001}
RATIOS = {"1": 1.0, "%": 0.01}
FAR = 10.0  # m that no front of a laboratory reaches
GATE = "geometry.length_0"  # where the gate stands


class Source(NamedTuple):
    """One digitised file.

    Attributes
    ----------
    name : str
        Of the curve that it belongs to.
    path : Path
    time : float or None
        At what time [s]; None: x is the time.
    origin : float
        Added to the positions of a front, which are then from the back wall [m].
    """

    name: str
    path: Path
    time: float | None
    origin: float = 0.0


class Units(NamedTuple):
    """Units of digitised files: keys of `LENGTHS`, `TIMES` and `RATIOS`. `Source.time` is in s."""

    length: str = "m"
    time: str = "s"
    ratio: str = "1"

    def factors(self) -> tuple[float, float, float]:
        """Factors that take length, time and ratio to SI units."""
        return LENGTHS[self.length], TIMES[self.time], RATIOS[self.ratio]


def write_experiment(
    sources: Sequence[Source],
    folder: Path,
    units: Units = Units(),  # noqa: B008 (immutable)
    settings: Sequence[str] = (),
    force: bool = False,
) -> Any:
    """Write digitised curves into an experiment folder.

    Parameters
    ----------
    sources : sequence of Source
        At most one of front and of volume; profiles and interface at different times.
    folder : str or Path
        Made if need be.
    units : Units
        Of the files.
    settings : sequence of str
        "section.key=value" for a new `experiment.toml`.
    force : bool
        Overwrite curves that are already there with other contents; see `question`.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    InputError, OutputError
        Nothing is written then.
    """
    folder = Path(folder)
    if not (sources or settings):
        allowed = "one or more curves; `fvcollapse new experiment` makes an empty folder"
        raise InputError("command line", "import-curves", "no curve and no --set", allowed)
    refuse_missing([source.path for source in sources])
    texts = {f"{name}.csv": text for name, text in curve_texts(sources, *units.factors()).items()}
    if settings or not is_there(folder / SETTINGS):
        texts[SETTINGS] = settings_text(settings, folder / SETTINGS)
    for name in texts:
        path = folder / name
        if is_there(path) and not force and not has_contents(path, texts[name].encode()):
            raise InputError(path, "file", "one that is already there", ELSEWHERE)
    refuse_unfit(texts, folder)
    write_all(texts, folder)
    return [folder / name for name in texts]


def refuse_missing(paths: Sequence[Path]) -> None:
    """Refuse files that are not there or cannot be read, all of them in one line.

    Raises
    ------
    InputError
    """
    refused = []
    for path in dict.fromkeys(paths):
        try:
            refuse_unreadable(path, "a readable two-column file")
        except InputError as error:
            refused.append(error)
    if len(refused) == 1:
        raise refused[0]
    if refused:
        files = ", ".join(error.file for error in refused)
        problems = ", ".join(dict.fromkeys(error.found for error in refused))
        raise InputError(files, "file", problems, "readable two-column files")


def refuse_unfit(texts: Mapping[str, str], folder: Path) -> None:
    """Refuse files that could not be read again, or that no collapse can show, before they are written.

    Without slope and column only the form of the curves is looked at.
    """
    with TemporaryDirectory() as made:
        trial = Path(made)
        for name, text in texts.items():
            (trial / name).write_text(text, encoding="utf-8")
        if SETTINGS not in texts:
            text = read_text(folder / SETTINGS, "TOML")
            (trial / SETTINGS).write_text(text, encoding="utf-8")
        try:
            if texts.keys() - {SETTINGS}:
                read_measurements(trial, Uncertainty())
                if is_complete(trial / SETTINGS):
                    load_experiment(trial)
        except InputError as error:
            file = folder / Path(error.file).name
            raise InputError(file, error.key, error.found, error.allowed) from None


def write_all(texts: Mapping[str, str], folder: Path) -> None:
    """Write the files of an experiment, {name: text}, all of them or none."""
    new, written = not folder.exists(), []
    make_folder(folder)
    try:
        for name, text in texts.items():
            write_atomic(folder / name, text.encode(), running=False)
            written.append(folder / name)
    except OutputError:
        for path in written:
            path.unlink(missing_ok=True)
        if new:
            folder.rmdir()
        raise


def curve_texts(
    sources: Sequence[Source], length: float, time: float, ratio: float
) -> dict[str, str]:
    """{name of the curve: CSV text} of digitised files; the factors take them to SI units."""
    blocks: dict = {}
    for source in sorted(sources, key=lambda source: source.time or 0.0):
        x, y = read_pairs(source.path).T
        if not CURVES[source.name].is_profile:  # profiles are one file per instant
            factor = ratio if CURVES[source.name].unit == "1" else length
            value = y * factor + source.origin
            rows = np.column_stack([x * time, value])
        else:
            rows = np.column_stack([np.full(len(x), source.time), x * length, y * length])
        same = [other for _, other in blocks.get(source.name, ()) if other.time == source.time]
        if same:
            moment = "" if source.time is None else f" at {source.time:g} s"
            found = f"a second file for {source.name}{moment}, beside {same[0].path}"
            raise InputError(source.path, "file", found, "one file per curve")
        blocks.setdefault(source.name, []).append((rows, source))
    return {
        name: curve_text(name, np.vstack([rows for rows, _ in blocks[name]]))
        for name in CURVES
        if name in blocks
    }


def read_pairs(path: Path) -> np.ndarray:
    """Pairs of a digitised file in order of their abscissa, (n, 2).

    Points with the same abscissa (a point clicked twice) become their mean.

    Raises
    ------
    InputError
        See `digitised_table.read_table`.
    """
    return merge_repeats(np.array(sorted(read_table(path))))


def merge_repeats(pairs: np.ndarray) -> np.ndarray:
    """The pairs, those of one abscissa replaced by their mean."""
    x, where, count = np.unique(pairs[:, 0], return_inverse=True, return_counts=True)
    return np.column_stack([x, np.bincount(where, pairs[:, 1]) / count])


def read_ranges(paths: Sequence[Path]) -> list[str]:
    """What was read into each curve of an experiment folder, in words: number of points, and their ranges in SI."""
    lines = []
    for path in paths:
        if path.stem not in CURVES:
            continue
        quantity = CURVES[path.stem]
        rows = read_curve(path, path.stem, 1.0)
        parts = [("t", rows.time, "s"), (quantity.columns[-1], rows.value, quantity.unit)]
        if rows.x is not None:
            parts.insert(1, ("X", rows.x, "m"))
        spans = [
            f"{name.removesuffix('_m')} = {of.min():.4g} to {of.max():.4g} {plain_unit(unit)}"
            for name, of, unit in parts
        ]
        lines.append(f"{path.name}: {len(rows.time)} points, {', '.join(spans).rstrip()}")
        far = rows.x if path.stem in PROFILES else rows.value if path.stem == "front" else None
        if far is not None and far.max() > FAR:
            lines.append(f"{path.name}: grains at {far.max():.4g} m: in cm? --length-unit cm")
    return lines


def missing_settings(folder: Path) -> str:
    """What an experiment folder still lacks to be read, as one line; "" if nothing."""
    path = Path(folder) / SETTINGS
    absent = [key for key, *_ in rule_required(read_draft(path))]
    if absent:
        return f"{', '.join(absent)} in {path}"
    try:
        load_experiment(folder)
    except InputError as error:
        return str(error)
    return ""


def gate_position(settings: Sequence[str], folder: Path) -> float:
    """Distance of the gate from the back wall, geometry.length_0 [m], of new settings or of the folder.

    Raises
    ------
    InputError
        It is in neither.
    """
    path, table = Path(folder) / SETTINGS, {}
    for setting in settings:
        name, _, value = (part.strip() for part in setting.partition("="))
        table[name] = parse_value(value)
    length = table.get(GATE)
    if length is None and is_there(path):
        length = read_draft(path).geometry.length_0
    if not isinstance(length, int | float) or isinstance(length, bool):
        allowed = f"with it --set {GATE}=VALUE, the distance of the gate from the back wall"
        raise InputError("command line", "--front-from", f"gate, and no number in {GATE}", allowed)
    return float(length)
