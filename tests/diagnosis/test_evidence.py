"""Evidence: a known effect recovered, none and unknown, pairs, closures, and what a check or a bound says."""

import numpy as np
import pytest
from fake_signatures import SHAPES, responses, setting, shape
from scipy.special import logsumexp
from scipy.stats import binom

from fvcollapse.diagnosis.emulator import Response
from fvcollapse.diagnosis.evidence import ModelComparison, compare, joined_pairs


def posterior(evidence):
    """Probabilities by evidences and prior odds alone."""
    logs = [each.log_evidence + each.log_prior for each in evidence.hypotheses.values()]
    return np.exp(logs - logsumexp(logs))


def test_a_known_effect_wins_and_its_parameter_is_recovered():
    points, covariance, kernel = setting()
    effects = responses(points)
    comparison = ModelComparison(covariance, kernel, effects, points)
    factor, rng = np.linalg.cholesky(covariance + 0.1**2 * kernel), np.random.default_rng(5)
    names, won, covered = list(effects), 0, 0
    for case in range(40):
        name, u = names[case % 3], rng.uniform(0.3, 1.0, 1)
        gap = -effects[name].at(u) + factor @ rng.standard_normal(len(points))
        evidence = comparison.evidence(gap)
        won += evidence.best.name == name
        found = evidence.hypotheses[name]
        covered += bool(found.low[0] <= u[0] <= found.high[0])
        assert found.variant == (0,)
    assert won >= 38
    assert binom.ppf(0.005, 40, 0.9) <= covered <= 40


def test_nothing_is_found_where_there_is_nothing():
    points, covariance, kernel = setting()
    comparison = ModelComparison(covariance, kernel, responses(points), points)
    factor, rng = np.linalg.cholesky(covariance), np.random.default_rng(6)
    none, confident, p_values = 0, 0, []
    for _ in range(60):
        evidence = comparison.evidence(factor @ rng.standard_normal(len(points)))
        none += evidence.best.name == "none"
        confident += evidence.best.name != "none" and max(posterior(evidence)) > 0.9
        p_values.append(evidence.hypotheses["none"].p_value)
        assert sum(posterior(evidence)) == pytest.approx(1.0)
    assert none >= 46  # raw evidences: weak effects and none look alike
    assert confident <= 3
    assert np.mean(np.array(p_values) < 0.05) <= binom.ppf(0.995, 60, 0.05) / 60.0


def test_a_smooth_gap_of_another_shape_is_unknown():
    points, covariance, kernel = setting()
    comparison = ModelComparison(covariance, kernel, responses(points), points)
    rng, found = np.random.default_rng(7), 0
    # round-off alone can make the kernel indefinite
    strange = np.linalg.cholesky(16.0 * kernel + 1.0e-3 * np.diag(points.sigma**2))
    for _ in range(20):
        gap = strange @ rng.standard_normal(len(points))
        evidence = comparison.evidence(gap + points.sigma * rng.standard_normal(len(points)))
        found += evidence.best.name == "unknown"
        effects = [evidence.hypotheses[name].p_value for name in SHAPES]
        assert max(effects) < 0.01
    assert found >= 18


def test_the_best_effects_are_joined_with_every_other_one():
    points, covariance, kernel = setting()
    effects = responses(points, 0.15)
    noise = np.linalg.cholesky(covariance) @ np.random.default_rng(8).standard_normal(len(points))
    gap = noise - effects["cups"].at(np.array([0.6])) - effects["arms"].at(np.array([0.8]))
    best = compare(gap, covariance, kernel, effects, points).best
    assert best.name == "arms+cups"
    assert best.log_prior == pytest.approx(np.log(0.1))
    assert best.variant == (0, 0)
    np.testing.assert_allclose(best.u, [0.8, 0.6], atol=0.25)
    assert (best.low <= [0.8, 0.6]).all()
    assert (best.high >= [0.8, 0.6]).all()
    gap = noise - effects["arms"].at(np.array([0.8]))
    single = compare(gap, covariance, kernel, effects, points)
    pairs = {name: each for name, each in single.hypotheses.items() if "+" in name}
    assert set(pairs) == {"arms+bars", "arms+cups", "bars+cups"}
    assert single.best.name == "arms"
    assert max(each.log_evidence for each in pairs.values()) < single.best.log_evidence + 3.0


def test_no_more_than_three_effects_are_joined_with_others():
    single = list("abcdef")
    pairs = joined_pairs(single)
    assert len(pairs) == 5 + 4 + 3
    assert all(set(pair) & set("abc") for pair in pairs)
    assert len({frozenset(pair) for pair in pairs}) == len(pairs)


def test_closures_share_the_prior_of_their_effect():
    points, covariance, kernel = setting()
    one, other = responses(points)["arms"], responses(points)["bars"]
    gap = -other.at(np.array([0.5]))
    alone = [compare(gap, covariance, kernel, {"a": each}).hypotheses["a"] for each in (one, other)]
    both = compare(gap, covariance, kernel, {"a": [one, other]}).hypotheses["a"]
    expected = np.logaddexp(alone[0].log_evidence, alone[1].log_evidence) - np.log(2.0)
    assert both.log_evidence == pytest.approx(expected)
    assert both.variant == (1,)
    np.testing.assert_allclose(both.difference, alone[1].difference)


def test_checks_name_the_run_and_the_phase_that_fail():
    points, covariance, kernel = setting()
    gap = np.zeros(len(points))
    late = (points.experiment == "r1") & (points.phase == "deposit")
    gap[late & (points.observable == "profiles")] = 0.012 * (-1.0) ** np.arange(16)
    none = compare(gap, covariance, kernel, {}, points).hypotheses["none"]
    assert none.p_by_run["r1"] < 1e-6 < 0.9 < none.p_by_run["r0"]
    assert none.p_by_phase["r1", "deposit"] < 1e-6
    assert none.p_by_phase["r1", "spreading"] > 0.9
    assert none.residual_outside > 1.0


def test_a_bound_that_is_far_contributes_nothing():
    kinds = (("runout", "upper"), ("final_height", "lower"))
    points, covariance, kernel = setting(1, kinds)
    gap = 0.01 * np.random.default_rng(9).standard_normal(len(points))
    gap[-2:] = (-50.0, 50.0)
    effects = {name: Response.of_one_level(shape(points, name)) for name in SHAPES}
    found = compare(gap, covariance, kernel, effects, points)
    rest = slice(0, len(points) - 2)
    fewer = {name: Response.of_one_level(shape(points, name)[rest]) for name in SHAPES}
    expected = compare(gap[rest], covariance[rest, rest], kernel[rest, rest], fewer)
    for name in ("none", "unknown", *SHAPES):
        assert found.log_evidence()[name] == pytest.approx(expected.log_evidence()[name], abs=1e-6)
    assert found.hypotheses["none"].p_value == pytest.approx(
        expected.hypotheses["none"].p_value, abs=1e-6
    )


def test_the_winner_is_that_of_the_whole_evidence():
    points, covariance, kernel = setting()
    known = responses(points, 0.1)
    comparison = ModelComparison(covariance, kernel, known, points)
    rng = np.random.default_rng(4)
    for name in (*known, None, None):
        gap = rng.multivariate_normal(np.zeros(len(points)), covariance)
        gap = gap if name is None else gap - known[name].at(np.array([0.6]))
        assert comparison.best_name(gap) == comparison.evidence(gap, pairs=False).best.name
