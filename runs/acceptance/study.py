"""The numbers that the solver must reach on real collapses, one row per case.

    python -m runs.acceptance.study matrix grid time_step random --workers 2

Each part writes runs/acceptance/<part>.csv and prints the new rows. Cases that are already in the table are
not run again; delete the table to remake it.
"""

import json
import sys
from functools import partial

import numpy as np
from scipy.optimize import brentq

from runs.study import Study, add_rows, cost, run_settings
from runs.study import main as call
from runs.table import read_table

SLOPES = (0, 10, 16, 19, 22)
WIDTHS = (0.10, 0.20, float("inf"))
LAWS = ("mu_I", "drucker_prager", "bingham", "newtonian", "mu_I_regularised")


def matrix():
    """Every slope and width of the paper at 6 mm, to rest."""
    return {
        f"a{slope}_w{width:g}": collapse(slope, width, end=3.0)
        for slope in SLOPES
        for width in WIDTHS
    }


def grid():
    """22 deg, w = 10 cm on three grids."""
    return {
        f"dx{1e3 * size:g}mm": collapse(22, 0.10, **{"grid.cell_size": size})
        for size in (0.006, 0.004, 0.003)
    }


def time_step():
    """22 deg, w = 10 cm with the time step halved."""
    return {
        f"dt{1e3 * step:g}ms": collapse(22, 0.10, **{"time.step_max": step})
        for step in (1.195e-3, 0.5975e-3)
    }


def random():
    """60 random cases: every law, slope 0-28 deg, aspect ratio 0.3-7, w 3 cm to infinity, 4-12 mm."""
    rng = np.random.default_rng(20)
    cases = {}
    for number in range(60):
        law = LAWS[number % len(LAWS)]
        aspect = float(np.exp(rng.uniform(np.log(0.3), np.log(7.0))))
        height = float(np.clip(0.14 * aspect**0.5, 0.05, 0.35))
        width = float(rng.choice([0.03, 0.1, 0.2, np.inf]))
        cases[f"r{number:02d}"] = collapse(
            float(rng.uniform(0.0, 28.0)),
            width,
            end=1.5,
            **{
                "geometry.height_0": height,
                "geometry.length_0": height / aspect,
                "rheology.law": law,
                "rheology.cohesion": 50.0 if law == "bingham" else 0.0,
                "grid.cell_size": float(
                    min(rng.uniform(0.004, 0.012), height / 4, height / aspect / 3)
                ),
                "boundary.right_end": "grow" if rng.random() < 0.5 else "open",
                "boundary.domain_length": max(1.0, 2.0 * height / aspect),
            },
        )
    return cases


def collapse(slope, width, end=2.5, **changes):
    """Settings of one case, by key."""
    settings = {
        "geometry.slope_angle_deg": float(slope),
        "geometry.channel_width": width,
        "time.end": end,
        "time.field_interval": end,
        "effects.lateral_friction": {},
    }
    if changes.get("boundary.right_end") == "grow":
        changes.pop("boundary.domain_length")
    return settings | changes


def row_of(first, result, problem, cpu_s):
    """A finished run as a row; a failed one is a row as well, with its reason."""
    if result is None:
        return first | {"failure": problem}
    return first | {"failure": "", **measure(result), "cpu_s": round(cpu_s, 1)}


def measure(result):
    """Numbers of one finished run."""
    series = {key: np.asarray(value) for key, value in result.series.items()}
    t = series["time"]
    still = np.flatnonzero(series["max_speed"] >= 1e-3)
    row = {
        key: float(series[key][-1])
        for key in (
            "runout_10mm",
            "runout",
            "runout_1mm",
            "x_99",
            "max_thickness",
            "volume_correction",
            "max_speed",
        )
    }
    row["runout_1.76s"] = float(np.interp(1.76, t, series["runout"]))
    row["front_curve"] = json.dumps(
        np.interp(np.arange(0.1, t[-1] + 1e-9, 0.1), t, series["runout"]).round(4).tolist()
    )
    row["peak_front_velocity"] = float(series["front_velocity"].max())
    row["rest_since"] = (
        float(t[still[-1] + 1]) if still.size and still[-1] + 1 < t.size else float("nan")
    )
    row["relative_volume_max"] = float(np.abs(series["relative_volume"]).max())
    row["correction_step_max"] = float(np.abs(np.diff(series["volume_correction"])).max())
    row["detached_max"] = float(series["detached_volume"].max())
    row["steps"] = t.size - 1
    row["finite"] = all(np.isfinite(value).all() for value in series.values())
    return row


def do_part(part, options):
    """Run what is missing of one part, and add its rows to the table."""
    path, folder = options.tables / f"{part}.csv", options.out / part
    rows = [
        row_of(first, result, problem, cost(folder / name))
        for name, first, result, problem in run_settings(
            path, PARTS[part](), folder, options.workers
        )
    ]
    add_rows(path, rows)
    for row in rows:
        print({key: value for key, value in row.items() if key != "settings"})
    if part == "grid":
        print_richardson(path)


def print_richardson(path):
    """Observed order and extrapolated value of the grid study, where the three grids are monotone."""
    rows = sorted(read_table(path), key=cell_size, reverse=True)
    sizes = [cell_size(row) for row in rows]
    for name in ("runout_10mm", "runout", "runout_1mm", "x_99", "peak_front_velocity"):
        values = [float(row[name]) for row in rows]
        coarse, fine = values[0] - values[1], values[1] - values[2]

        def mismatch(order, ratio=coarse / fine):
            a, b, c = (size**order for size in sizes)
            return (a - b) / (b - c) - ratio

        if coarse * fine <= 0.0 or mismatch(0.1) * mismatch(8.0) > 0.0:
            print(f"{name}: {values}, no order (not monotone, or slower than 0.1)")
            continue
        order = brentq(mismatch, 0.1, 8.0)
        limit = values[2] - fine * sizes[2] ** order / (sizes[1] ** order - sizes[2] ** order)
        print(f"{name}: {values}, order {order:.2f}, extrapolated {limit:.4f}")


def cell_size(row):
    """Nominal cell size of a row of the grid study, m."""
    return json.loads(row["settings"]).get("grid.cell_size", 0.006)


PARTS = {"matrix": matrix, "grid": grid, "time_step": time_step, "random": random}
STUDY = Study("acceptance", __doc__, {part: partial(do_part, part) for part in PARTS}, uses=())
main = partial(call, STUDY)


if __name__ == "__main__":
    sys.exit(main())
