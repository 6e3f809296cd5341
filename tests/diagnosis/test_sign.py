"""The sign counts: effects that cannot close a gap are out, and what an effect makes worse is told."""

import numpy as np
import pytest
from fake_points import fake_points

from fvcollapse.diagnosis.covariance import discrepancy_amplitude, discrepancy_kernel
from fvcollapse.diagnosis.emulator import Response
from fvcollapse.diagnosis.evidence import ModelComparison
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.diagnosis.sign import DISCREPANCY, LEAST_CLOSED, ruled_out
from fvcollapse.diagnosis.verdict import CAP, probable, verdict

LEVELS = np.array([[0.0], [0.5], [1.0]])
STRENGTH = np.array([[0.4], [0.8], [1.4]])


def is_front(points):
    return points.observable == "front"


def run_out(points, size):
    """A front that runs farther with time, and thicknesses that fall a little."""
    time = np.nan_to_num(points.time, nan=1.0)
    return size * np.where(is_front(points), time, -0.15 * time)


def back(points, size):
    """Thicknesses at the back wall alone."""
    return size * np.where(is_front(points), 0.0, np.exp(-5.0 * np.nan_to_num(points.x)))


@pytest.fixture(scope="module")
def points():
    return fake_points(2)


def kernel_of(points):
    """(smooth part of U, K_delta)."""
    smooth = discrepancy_kernel(points, points.sigma)
    return smooth, discrepancy_kernel(points, discrepancy_amplitude(points, np.diag(smooth)))


@pytest.fixture(scope="module")
def comparison(points):
    """One effect lengthens the run, one shortens it, one thickens the back."""
    smooth, kernel = kernel_of(points)
    shapes = {
        "farther": run_out(points, 0.1),
        "shorter": run_out(points, -0.1),
        "thicker": back(points, 0.02),
    }
    effects = {name: Response.fit(LEVELS, STRENGTH * shape) for name, shape in shapes.items()}
    return ModelComparison(np.diag(points.sigma**2) + smooth, kernel, effects, points)


def noise(points, seed):
    return points.sigma * np.random.default_rng(seed).standard_normal(len(points))


def test_an_effect_of_the_wrong_sign_is_out_with_the_reason(points, comparison):
    """Measured runs go farther than simulated ones: simulated - measured is negative."""
    evidence = comparison.evidence(noise(points, 1) - run_out(points, 0.1))
    closes = {name: evidence.hypotheses[name].closes for name in ("farther", "shorter", "thicker")}
    assert closes["farther"] > 0.5
    assert closes["shorter"] < 0.0
    reasons = ruled_out(evidence)
    assert reasons["shorter"] == "at every plausible strength it makes the gap larger"
    assert "farther" not in reasons
    mirrored = ruled_out(comparison.evidence(noise(points, 1) + run_out(points, 0.1)))
    assert "farther" in mirrored
    assert "shorter" not in mirrored


def test_closes_is_the_largest_share_of_chi_square_over_the_prior(points, comparison):
    gap = noise(points, 2) - run_out(points, 0.1)
    front = is_front(points)
    direction = comparison.direction
    rows = direction.significant(gap)
    full = comparison.covariance + DISCREPANCY**2 * kernel_of(points)[1]
    inverse = np.linalg.inv(full[np.ix_(rows, rows)])
    assert set(np.flatnonzero(front)) <= set(rows)
    (closure,) = comparison.closures["farther"]
    (response,) = closure.responses
    left = [gap + response.at(np.array([u])) for u in (np.arange(128) + 0.5) / 128]
    squares = [residual[rows] @ inverse @ residual[rows] for residual in (gap, *left)]
    expected = 1.0 - min(squares[1:]) / squares[0]
    assert direction.closes(gap, rows, [closure]) == pytest.approx(expected, rel=1e-9)


def test_nothing_is_out_without_a_significant_gap(points, comparison):
    evidence = comparison.evidence(0.8 * noise(points, 3))
    singles = [one for name, one in evidence.hypotheses.items() if "+" not in name]
    assert all(one.closes is None for one in singles)
    assert ruled_out(evidence) == {}


def test_what_an_effect_makes_worse_is_told(points, comparison):
    """A front far too short beside heights that agree: what moves both makes the heights worse."""
    gap = np.where(is_front(points), -0.1 * np.nan_to_num(points.time, nan=1.0), 0.0)
    evidence = comparison.evidence(gap)
    assert "profiles" in evidence.hypotheses["farther"].worsens
    assert "front" not in evidence.hypotheses["farther"].worsens
    assert "front" in evidence.hypotheses["shorter"].worsens


def test_the_verdict_gives_no_probability_to_what_is_out(points, comparison):
    evidence = comparison.evidence(noise(points, 4) - run_out(points, 0.06))
    before, after = probable(evidence, None, None, None), verdict(evidence)
    out = ruled_out(evidence)
    assert "shorter" in out
    assert all(before.probability[name] > 0.0 == after.probability[name] for name in out)
    assert not set(out) & set(after.set)
    assert sum(after.probability.values()) == pytest.approx(1.0)
    assert max(after.probability.values()) <= CAP + 1e-12
    left = [name for name in before.probability if name not in out]
    ratios = {after.probability[name] / before.probability[name] for name in left[1:]}
    assert max(ratios) == pytest.approx(min(ratios))
    assert (after.kind, after.effects) == ("effect", ("farther",))


def test_neither_none_nor_unknown_is_ever_out(points, comparison):
    """A wave along the thin part of the profiles, which no effect of the three makes."""
    x = np.nan_to_num(points.x)
    gap = noise(points, 5) + np.where(is_front(points), 0.0, 0.02 * np.sin(60.0 * x))
    evidence = comparison.evidence(gap)
    assert set(ruled_out(evidence)) >= {"farther", "shorter"}
    assert all(evidence.hypotheses[name].closes < LEAST_CLOSED for name in ruled_out(evidence))
    assert not {NONE, UNKNOWN} & set(ruled_out(evidence))
    assert not set(verdict(evidence).set) & set(ruled_out(evidence))
