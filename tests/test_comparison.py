"""Reductions of published profiles on outlines whose answer is known on paper."""

import numpy as np
import pytest

from runs.comparison import analysis

AT = np.linspace(0.0, 3.0, 3001)


def test_mean_half_and_asymmetry_of_a_lopsided_triangle():
    """Sides of length 1 and 2: areas 1/2 and 1, so each is 1/3 of the mean area from the mean."""
    x, h = np.array([-2.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
    mean = analysis.mean_half(x, h, AT)
    assert mean[500] == pytest.approx(0.5 * (0.5 + 0.75))
    assert np.trapezoid(mean, AT) == pytest.approx(0.75)
    assert analysis.asymmetry(x, h, AT) == pytest.approx(1.0 / 3.0)


def test_l1_difference_of_shifted_triangles():
    wedge = np.maximum(1.0 - AT, 0.0)
    assert analysis.l1_difference(AT, wedge, wedge) == 0.0
    assert analysis.l1_difference(AT, 1.5 * wedge, wedge) == pytest.approx(0.5)
    assert analysis.l1_difference(AT, 0.0 * wedge, wedge) == pytest.approx(1.0)


def test_top_of_segments_takes_the_highest_and_bridges_gaps():
    """A drop's roof over a floor, given in pairs of end points, with a rounding gap between two."""
    x = np.array([0.0, 1.0, 0.4, 0.6, 1.001, 2.0])
    y = np.array([1.0, 1.0, 1.5, 1.5, 1.0, 0.0])
    at = np.array([0.2, 0.5, 1.0005, 1.5, 2.5])
    top = analysis.top_of_segments(x, y, at)
    np.testing.assert_allclose(top, [1.0, 1.5, 1.0, 0.5005, 0.0], atol=1e-3)


def test_scaling_to_area_keeps_the_shape():
    wedge = np.maximum(1.0 - AT, 0.0)
    np.testing.assert_allclose(analysis.scaled_to_area(AT, 0.8 * wedge, wedge), wedge)


def test_power_law_and_curve_are_exact_for_powers():
    aspect = np.array([0.5, 1.0, 4.0])
    coefficient, spread = analysis.power_coefficient(aspect, 2.3 * aspect ** (2 / 3), 2 / 3)
    assert coefficient == pytest.approx(2.3)
    assert spread == pytest.approx(0.0, abs=1e-12)
    at = np.array([0.4, 0.7, 3.0])
    found = analysis.on_curve(aspect, 2.3 * aspect ** (2 / 3), at)
    assert np.isnan(found[0])
    np.testing.assert_allclose(found[1:], 2.3 * at[1:] ** (2 / 3))
