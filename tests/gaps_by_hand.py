"""Gaps made by hand on the points of a filmed collapse, so that place, time, direction and size are known."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
from toy_laboratory import ToyRunner, film, settings

from fvcollapse import load_experiment
from fvcollapse.diagnosis.analysis import analyse
from fvcollapse.diagnosis.covariance import floored
from fvcollapse.diagnosis.emulator import Response
from fvcollapse.diagnosis.gap_map import gap_map
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.diagnosis.question import Question
from fvcollapse.measure.curves import curve_text

HEIGHT = 0.14  # m, of the column of the toy laboratory
EFFECTS = ("lateral_friction", "gate", "cohesion", "bed_friction")


def tongue(folder):
    """The points of a wedge behind a tongue 8 mm thick; the thickness is known to a fifth of a millimetre."""
    folder.mkdir()
    (folder / "experiment.toml").write_text(settings(16.0, 0.1), encoding="utf-8")
    time, place = np.linspace(0.0, 1.6, 81), np.linspace(0.0, 1.2, 121)
    front = 0.2 + 0.8 * np.tanh(time / 0.4) ** 2
    t, x = (grid.ravel() for grid in np.meshgrid(time, place, indexing="ij"))
    wedge = np.maximum(0.12 * (1.0 - x / 0.5), 0.0)
    thickness = np.where(x < np.repeat(front, len(place)), wedge + 0.008, 0.0)
    curves = {
        "front": np.column_stack([time, front]),
        "profiles": np.column_stack([t, x, thickness]),
        "volume": np.column_stack([time, 0.0 * time]),
        "interface": np.column_stack([t, x, 0.5 * wedge]),
    }
    for name, rows in curves.items():
        (folder / f"{name}.csv").write_text(curve_text(name, rows), encoding="utf-8")
    points = Question((load_experiment(folder),)).points
    fine = np.where(points.observable == "profiles", 2e-4, points.sigma)
    return replace(points, sigma=fine)


def stub(points, gap, slopes=None, effects=None, controls=(), model_error=None):
    """What an `Analysis` with this gap (N,) would be.

    Parameters
    ----------
    slopes : (n, N) array, optional
        Change per standard deviation of calibrated parameters.
    effects : dict, optional
        Name -> change (N,) at full strength.
    controls : tuple
    model_error : (N,) array, optional
        Standard deviation of the error that controls leave open.
    """
    count = len(points)
    slopes = np.zeros((1, count)) if slopes is None else slopes
    measurement, calibration = np.diag(floored(points) ** 2), slopes.T @ slopes
    covariance = measurement + calibration
    if model_error is not None:
        covariance = covariance + np.diag(model_error**2)
    changes = {name: change for name, change in (effects or {}).items()}
    responses = {
        name: [Response.fit(np.array([[0.0], [0.5], [1.0]]), np.outer([0.0, 0.5, 1.0], change))]
        for name, change in changes.items()
    }
    none = SimpleNamespace(name=NONE, difference=np.zeros(count), p_value=1e-9)
    unknown = SimpleNamespace(name=UNKNOWN, difference=np.zeros(count), p_value=0.4)
    return SimpleNamespace(
        points=points,
        gap=gap,
        measurement=measurement,
        numerical=np.zeros((count, count)),
        calibration=calibration,
        covariance=covariance,
        kernel=np.diag(floored(points) ** 2),
        controls=controls,
        responses=responses,
        evidence=SimpleNamespace(hypotheses={UNKNOWN: unknown, NONE: none}),
        gap_map=gap_map(points, points.measured + gap, covariance, np.random.default_rng(0)),
        seed=0,
    )


def thickness_of(points, size):
    """A gap of the thickness alone, of one sign."""
    return np.where(points.observable == "profiles", size, 0.0)


def analysed(folder, **hidden):
    """The analysis of films on two slopes; `hidden`: see `film`."""
    experiments = tuple(
        load_experiment(film(folder / f"s{slope:g}", slope, 0.1, seed=n, **hidden))
        for n, slope in enumerate((10.0, 16.0))
    )
    return analyse(Question(experiments), ToyRunner(), effects=EFFECTS)
