"""Profiles and rows of the comparison, from the tables of the study and those of the data."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from fvcollapse.errors import InputError
from runs.table import read_table, write_table

AT = np.linspace(0.0, 6.0, 2401)  # distances from the symmetry plane, in column heights
PROFILE_HEADER = ("t_star", "x_over_h0", "h_over_h0")


class Folders(NamedTuple):
    """Where the published data and the tables of the study are."""

    data: Path
    tables: Path

    def computed(self, part):
        """Rows of the table of a part.

        Raises
        ------
        InputError
            There are none.
        """
        path = self.tables / f"{part}.csv"
        rows = read_table(path)
        if not rows:
            raise InputError(path, "file", "no such table", f"the part {part} first")
        return rows

    def write(self, name, columns, rows):
        """Write a table of rows that are sequences."""
        write_table(
            self.tables / name, [dict(zip(columns, row, strict=True)) for row in rows], columns
        )


def computed_profile(of, part, name, t_star):
    """A computed profile at the distances AT."""
    return np.interp(AT, *profile(of, part, name, t_star), right=0.0)


def profile(of, part, name, t_star=None):
    """Distances and heights of one computed profile; the last one without a time."""
    rows = [row for row in of.computed(f"{part}_profiles") if row["name"] == name]
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
