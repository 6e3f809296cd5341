"""Reading and writing the tables of the comparison: csv files beside this one, and those of the data."""

import csv
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
AT = np.linspace(0.0, 6.0, 2401)  # distances from the symmetry plane, in column heights
PROFILE_HEADER = ("t_star", "x_over_h0", "h_over_h0")


def computed_profile(part, name, t_star):
    """A computed profile at the distances AT."""
    return np.interp(AT, *profile(part, name, t_star), right=0.0)


def profile(part, name, t_star=None):
    """Distances and heights of one computed profile; the last one without a time."""
    rows = [row for row in read(HERE / f"{part}_profiles.csv") if row["name"] == name]
    times = sorted({float(row["t_star"]) for row in rows})
    wanted = times[-1] if t_star is None else min(times, key=lambda time: abs(time - t_star))
    if t_star is not None and abs(wanted - t_star) > 0.01:
        raise ValueError(f"{part}, {name}: no profile at t* = {t_star}")
    rows = [row for row in rows if float(row["t_star"]) == wanted]
    return tuple(np.array([float(row[key]) for row in rows]) for key in PROFILE_HEADER[1:])


def profile_rows(t_star, h):
    """Every tenth point of a profile on AT, up to its end, for the figures."""
    last = np.flatnonzero(h > 0.0)[-1] + 2
    return [
        (int(t_star), round(float(x), 3), round(float(value), 4))
        for x, value in zip(AT[: last + 10 : 10], h[: last + 10 : 10], strict=True)
    ]


def table(path, columns=None):
    """A numeric table of the data, or some of its columns, by column name."""
    return np.genfromtxt(
        path, delimiter=",", names=True, dtype=None, encoding="utf-8", usecols=columns
    )


def line(comparison, quantity, at, data, uncertainty, computed):
    """One row of the table; `uncertainty` is None where the data state none."""
    difference = computed - data
    return (
        comparison,
        quantity,
        at,
        round(float(data), 4),
        "" if uncertainty is None else round(float(uncertainty), 4),
        round(float(computed), 4),
        round(float(difference / data), 4),
        "" if uncertainty is None else round(float(difference / uncertainty), 2),
    )


def read(path):
    """Rows of a table as dictionaries; none if it is missing."""
    if not path.exists():
        return []
    with path.open() as file:
        return list(csv.DictReader(file))


def write(path, header, rows):
    """Write a table."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)
