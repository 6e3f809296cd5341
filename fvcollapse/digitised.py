"""Curves from digitising tools (x, y in columns, one file per curve) as an experiment folder.

Such files differ in the mark between the columns (comma, semicolon, tab, blanks) and in the decimal
mark (point, comma). The first combination that reads every line as two finite numbers is taken.
"""

from math import isfinite
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fvcollapse.case import parse_value
from fvcollapse.case_keys import read_text, toml_value
from fvcollapse.curves import FORMS, curve_text
from fvcollapse.errors import InputError, OutputError
from fvcollapse.experiment import SETTINGS, load_experiment
from fvcollapse.experiment_keys import describe_keys, settings_from_table
from fvcollapse.files import write_atomic

# (mark between the columns, None = blanks; decimal mark), less ambiguous ones first
STYLES = ((";", "."), (";", ","), ("\t", "."), ("\t", ","), (",", "."), (None, "."), (None, ","))
LENGTHS = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001}
TIMES = {"s": 1.0, "ms": 0.001}
RATIOS = {"1": 1.0, "%": 0.01}
OVER_TIME = ("front", "volume")  # curves over time; the others are one file per instant


class Source(NamedTuple):
    """One digitised file: which curve it belongs to, and at what time [s] (None: x is the time)."""

    name: str
    path: Path
    time: float | None


def write_experiment(sources, folder, length="m", time="s", ratio="1", settings=()):
    """Write digitised curves into an experiment folder.

    Parameters
    ----------
    sources : sequence of Source
        At most one of front and of volume; profiles and interface at different times.
    folder : str or Path
        Made if need be; a curve that is already there is never overwritten.
    length, time, ratio : str
        Units of the files: keys of `LENGTHS`, `TIMES`, `RATIOS`. `Source.time` is in s.
    settings : sequence of str
        "section.key=value" for a new `experiment.toml`.

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
    factors = LENGTHS[length], TIMES[time], RATIOS[ratio]
    texts = {f"{name}.csv": text for name, text in curve_texts(sources, *factors).items()}
    if settings or not (folder / SETTINGS).exists():
        texts[SETTINGS] = settings_text(settings, folder / SETTINGS)
    for name in texts:
        if (folder / name).exists():
            raise InputError(folder / name, "file", "one that is already there", "another folder")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(folder, error, running=False) from None
    for name, text in texts.items():
        write_atomic(folder / name, text.encode(), running=False)
    return [folder / name for name in texts]


def curve_texts(sources, length, time, ratio):
    """{name of the curve: CSV text} of digitised files; the factors take them to SI units."""
    blocks = {}
    for source in sorted(sources, key=lambda source: source.time or 0.0):
        x, y = read_pairs(source.path).T
        if source.name in OVER_TIME:
            value = y * (ratio if source.name == "volume" else length)
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
        for name in FORMS
        if name in blocks
    }


def read_pairs(path):
    """Pairs of a digitised file in order of their abscissa, (n, 2).

    Empty lines, lines that begin with # and a first line of words are passed over. Points with the
    same abscissa (a point clicked twice) become their mean.

    Raises
    ------
    InputError
        The file is not two columns of numbers in any of the styles.
    """
    lines = enumerate(read_text(path, "two-column").splitlines(), start=1)
    lines = [(at, line.strip()) for at, line in lines if line.strip() and line.strip()[0] != "#"]
    if lines and not any(letter.isdigit() for letter in lines[0][1]):
        lines = lines[1:]
    if not lines:
        raise InputError(path, "file", "no points", "two columns of numbers")
    attempts = [parse(lines, *style) for style in STYLES]
    for pairs, _ in attempts:
        if len(pairs) == len(lines):
            return merge_repeats(np.array(sorted(pairs)))
    at, line = max((stopped for _, stopped in attempts), key=lambda stopped: stopped[0])
    raise InputError(path, f"line {at}", repr(line[:60]), "two finite numbers, as all lines before")


def parse(lines, between, decimal):
    """(pairs up to the first line that is not one in this style, that line or None)."""
    pairs = []
    for at, line in lines:
        cells = [cell.strip().replace(decimal, ".") for cell in line.split(between)]
        foreign = decimal == "," and "." in line  # of another style
        try:
            pair = tuple(float(cell) for cell in cells)
        except ValueError:
            pair = ()
        if foreign or len(pair) != 2 or not all(isfinite(value) for value in pair):
            return pairs, (at, line)
        pairs.append(pair)
    return pairs, None


def merge_repeats(pairs):
    """The pairs, those of one abscissa replaced by their mean."""
    x, where, count = np.unique(pairs[:, 0], return_inverse=True, return_counts=True)
    return np.column_stack([x, np.bincount(where, pairs[:, 1]) / count])


def settings_text(settings, path):
    """Text of a new `experiment.toml`: what is known, and as comments the keys that are not."""
    table = {}
    for setting in settings:
        name, equals, value = (part.strip() for part in setting.partition("="))
        if not (name and equals):
            raise InputError(
                path, f"--set {setting}", "no key or no '='", "--set section.key=VALUE"
            )
        section, _, last = name.rpartition(".")
        inner = table.setdefault(section, {}) if section else table
        inner[last] = parse_value(value)
    settings_from_table(table, path)
    lines, header = [], ""
    for info in describe_keys():
        section, _, name = info.name.rpartition(".")
        if section != header:
            lines += ["", f"[{section}]"]
            header = section
        inner = table.get(section, {}) if section else table
        known = f"{name} = {toml_value(inner[name])}" if name in inner else f"# {name} ="
        lines.append(f"{known}    # {info.unit}, {info.description}")
    return "# What was not measured stays a comment.\n\n" + "\n".join(lines) + "\n"


def missing_settings(folder):
    """What an experiment folder still lacks to be read, as one line; "" if nothing."""
    try:
        load_experiment(folder)
    except InputError as error:
        return str(error)
    return ""
