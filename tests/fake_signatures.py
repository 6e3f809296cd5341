"""Signatures of made-up effects on points of comparison, with the covariance of what is known with an uncertainty."""

import numpy as np
from fake_points import fake_points

from fvcollapse.diagnosis.covariance import discrepancy_amplitude, discrepancy_kernel
from fvcollapse.diagnosis.emulator import Response

SHAPES = {
    "arms": lambda t, x: np.where(np.isnan(x), t, 0.1 * x),
    "bars": lambda t, x: np.where(np.isnan(x), np.exp(-3.0 * t), 0.1 * np.sin(9.0 * x) * t),
    "cups": lambda t, x: np.where(np.isnan(x), t * (1.0 - t), 0.1 * np.cos(12.0 * x)),
}


def setting(runs=2, kinds=()):
    """Points, U and K_delta; U holds a smooth part as large as the scatter."""
    points = fake_points(runs, kinds=kinds)
    smooth = discrepancy_kernel(points, points.sigma)
    kernel = discrepancy_kernel(points, discrepancy_amplitude(points, np.diag(smooth)))
    return points, np.diag(points.sigma**2) + smooth, kernel


def shape(points, name, size=0.05):
    """A signature on the points."""
    time = np.nan_to_num(points.time, nan=1.0)
    return size * SHAPES[name](time, points.x)


def responses(points, size=0.05):
    """Three effects, bent in their parameter."""
    levels = np.array([[0.0], [0.5], [1.0]])
    bend = levels + 0.3 * levels**2 + 0.1
    return {name: Response.fit(levels, bend * shape(points, name, size)) for name in SHAPES}
