"""Observables, simulated or measured, with names, units and coordinates."""

from collections.abc import Iterable, Mapping

import numpy as np

from fvcollapse.files.labelled import Labelled
from fvcollapse.measure.curves import Curve, Scalar
from fvcollapse.measure.quantities import CURVES, QUANTITIES, SCALAR_UNITS

BOUNDS = {"value": "", "upper": "at most ", "lower": "at least "}


def labelled_rows(name: str, rows: np.ndarray) -> dict[str, Labelled]:
    """A curve as labelled arrays: over time, and over x where it is a profile."""
    quantity = CURVES[name]
    label = quantity.reading or name
    clock = "time on the clock of the experiment"
    if not quantity.is_profile:
        value = Labelled(("time",), rows[:, 1], quantity.unit, quantity.words)
        return {"time": Labelled(("time",), rows[:, 0], "s", clock), label: value}
    width = int(np.count_nonzero(rows[:, 0] == rows[0, 0]))
    heights = rows[:, 2].reshape(-1, width)
    return {
        "time": Labelled(("time",), rows[::width, 0], "s", clock),
        "x": Labelled(("x",), rows[:width, 1], "m", "distance along the bed from the back wall"),
        label: Labelled(("time", "x"), heights, quantity.unit, quantity.words),
    }


def labelled_points(name: str, curve: Curve) -> dict[str, Labelled]:
    """The points of a curve as labelled arrays."""
    quantity, points = QUANTITIES[name], ("point",)
    words = f"standard deviation of {quantity.words}"
    found = {
        "time": Labelled(points, curve.time, "s", "time on the clock of the experiment"),
        quantity.reading or name: Labelled(points, curve.value, quantity.unit, quantity.words),
        "sigma": Labelled(points, curve.sigma, quantity.unit, words),
    }
    if curve.x is not None:
        about = ("m", "distance along the bed from the back wall")
        found["x"] = Labelled(points, curve.x, *about)
    return found


def measured_rows(curves: Mapping[str, Curve], scalars: Iterable[Scalar]) -> list[tuple[str, str]]:
    """What was measured, in words: (observable, number of points and times, or the number)."""
    rows = [
        (
            QUANTITIES[name].words,
            f"{len(curve.time)} points, t = {curve.time[0]:.3g} to {curve.time[-1]:.3g} s",
        )
        for name, curve in curves.items()
    ]
    return rows + [
        (
            QUANTITIES[one.name].words,
            f"{BOUNDS[one.kind]}{one.value:.4g} ± {one.sigma:.2g} {SCALAR_UNITS[one.name]}",
        )
        for one in scalars
    ]
