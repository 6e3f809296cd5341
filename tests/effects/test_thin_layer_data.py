"""h_stop of grains on a rough plane (digitised): mu_stop(h) through the points, and the solver beside them."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import least_squares

from fvcollapse.verification.flows import layer_case
from fvcollapse.verification.problems.thin_layers import flows

PUBLISHED = 1.65  # diameters, L of glass beads (Jop et al. 2005)
DIAMETER = 7e-4  # m


def points(series):
    """Slopes (deg) and h_stop in diameters of one symbol of the figure."""
    text = (Path(__file__).parent / "h_stop_digitised.csv").read_text().splitlines()
    rows = csv.DictReader(line for line in text if not line.startswith("#"))
    return np.array(
        [
            [float(row["theta_deg"]), float(row["h_over_d"])]
            for row in rows
            if row["series"] == series
        ]
    ).T


def angle(h, mu_1, mu_2, length):
    """Slope (deg) at which a layer of h diameters stops, closure `thickness`."""
    return np.degrees(np.arctan(mu_1 + (mu_2 - mu_1) / (1.0 + h / length)))


def fitted(series):
    """mu_1, mu_2 of the grains of one symbol with the published length, and the scatter about it, deg."""
    slopes, h = points(series)
    fit = least_squares(lambda mu: angle(h, *mu, PUBLISHED) - slopes, (0.4, 0.65))
    return fit.x, float(np.sqrt(np.mean(fit.fun**2)))


@pytest.mark.parametrize(
    ("series", "scatter"), [("squares", 0.26), ("circles", 0.21), ("diamonds", 0.30)]
)
def test_published_length_fits_the_points(series, scatter):
    """With L = 1.65 d and two frictions free, to 0.25, 0.20 and 0.29 deg; with L free too, to 0.25, 0.19, 0.25 deg."""
    frictions, found = fitted(series)
    assert found < scatter
    assert 0.3 < frictions[0] < 0.45
    assert frictions[1] > frictions[0] + 0.15


@pytest.mark.parametrize("series", ["squares", "circles", "diamonds"])
def test_layers_of_the_solver_stop_beside_the_points(series):
    """0.6 deg (two standard deviations) below the measured slope a layer stops, above it flows."""
    (mu_1, mu_2), _ = fitted(series)
    slopes, h = points(series)
    for n in np.linspace(0, len(h) - 1, 5).round().astype(int):
        depth = h[n] * DIAMETER
        for off in (-0.6, 0.6):
            case = layer_case(
                depth / 6,
                depth,
                geometry__slope_angle_deg=slopes[n] + off,
                boundary__mu_bed=math.inf,
                rheology__mu_1=mu_1,
                rheology__mu_2=mu_2,
                rheology__grain_diameter=DIAMETER,
                numerics__film_thickness=0.0,
                effects__thin_layer={"length": PUBLISHED},
            )
            assert flows(case, depth) == (off > 0.0)
