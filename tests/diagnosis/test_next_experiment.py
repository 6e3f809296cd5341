"""What to measure next, on collapses by formula and on numbers with a known answer."""

import numpy as np
import pytest
from toy_laboratory import ToyRunner, film

from fvcollapse import load_experiment
from fvcollapse.diagnosis import next_experiment as following
from fvcollapse.diagnosis.analysis import analyse
from fvcollapse.diagnosis.next_candidates import candidates
from fvcollapse.diagnosis.next_experiment import (
    choices,
    entropy,
    expected_gain,
    leading,
    repeats,
    with_readings,
)
from fvcollapse.diagnosis.point_choice import choose_points
from fvcollapse.diagnosis.question import Question
from fvcollapse.diagnosis.report.words import candidate_words


@pytest.fixture(scope="module")
def analysis(tmp_path_factory):
    folder = film(tmp_path_factory.mktemp("toy") / "s16", effects={"cohesion": {"kappa_0": 20.0}})
    for name in ("volume", "interface"):
        (folder / f"{name}.csv").unlink()
    effects = ("lateral_friction", "cohesion", "gate")
    return analyse(Question((load_experiment(folder),)), ToyRunner(), effects=effects)


def test_a_narrower_channel_tells_walls_from_cohesion(analysis):
    runner = ToyRunner()
    chance = {"cohesion": 0.5, "lateral_friction": 0.4, "none": 0.05, "unknown": 0.05}
    found = choices(analysis, chance, runner)
    assert [each.gain for each in found] == sorted((each.gain for each in found), reverse=True)
    assert set(found[0].separates) == {"cohesion", "lateral_friction"}
    assert 0.0 < found[0].gain <= entropy(np.array([0.5, 0.4, 0.05]) / 0.95)
    gain = {candidate_words(each.candidate): each.utility for each in found}
    narrow = next(words for words in gain if "5 cm wide" in words)
    best = sorted(gain, key=gain.get, reverse=True)[
        :3
    ]  # friction of the walls doubles, adhesion does not
    assert narrow in best
    assert len(runner.asked) <= 5 * len(found)
    assert choices(analysis, chance, ToyRunner()) == found


def test_nothing_to_do_when_one_is_left(analysis):
    assert choices(analysis, {"cohesion": 0.985, "none": 0.015}, ToyRunner()) == []
    assert choices(analysis, {"cohesion": 0.995, "none": 0.0, "gate": 0.005}, ToyRunner()) == []


def test_what_is_not_measured_yet_is_a_candidate(analysis):
    (experiment,) = analysis.experiments
    found = candidates(experiment, analysis.library.cases[experiment.name])
    more = found[0]
    assert "relative volume and static–flowing interface measured too" in candidate_words(more)
    assert set(more.observables) == {"front", "profiles", "volume", "interface"}
    assert all(set(each.observables) == {"front", "profiles"} for each in found[1:])
    slopes = [
        each.changes["geometry.slope_angle_deg"]
        for each in found
        if len(each.changes) == 1 and "geometry.slope_angle_deg" in each.changes
    ]
    assert slopes == [10.0, 22.0]


def test_readings_of_a_planned_experiment_are_those_of_the_baseline(analysis):
    (experiment,) = analysis.experiments
    seen = analysis.library.seen[experiment.name]
    read = with_readings(experiment, ("front", "profiles"), seen, float(seen.front[-1, 0]))
    points = choose_points((read,))
    assert 100 < len(points) < 300
    assert points.measured == pytest.approx(points.simulated({read.name: seen}), abs=1e-9)


def test_leading_hypotheses_can_be_run_and_sum_to_one():
    chance = {"a": 0.4, "b": 0.3, "none": 0.1, "unknown": 0.1, "a+b": 0.06, "c": 0.04}
    found = leading(chance, {"a": [], "b": []})
    assert list(found) == ["a", "b", "none"]
    assert sum(found.values()) == pytest.approx(1.0)


def test_expected_gain_grows_from_nothing_to_everything():
    rng = np.random.default_rng(0)
    chance = np.array([0.5, 0.5])
    assert expected_gain(np.zeros((2, 5)), chance, rng) == pytest.approx(0.0, abs=1e-9)
    far = np.array([[0.0, 0.0], [20.0, 0.0]])
    assert expected_gain(far, chance, rng) == pytest.approx(1.0, abs=1e-3)
    # two normal distributions one standard deviation apart: 1 bit less the entropy that is left
    assert expected_gain(far / 20.0, chance, rng) == pytest.approx(0.16, abs=0.02)


def test_repeats_average_the_measurement_only():
    mean = np.array([1.0])
    one, nothing = np.array([[1.0]]), np.array([[0.0]])
    # 0.5 n >= 5
    assert repeats(mean, one, nothing) == 10
    assert repeats(mean, one, 0.5 * one) is None
    assert repeats(4.0 * mean, one, nothing) == 1
    assert following.LOG_BAYES_FACTOR == 5.0
