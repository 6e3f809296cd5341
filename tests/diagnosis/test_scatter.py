"""Grains that jump ahead of the front: what is compared is the mean over realisations, with their covariance."""

from dataclasses import replace

import numpy as np
import pytest
from toy_laboratory import ToyRunner, collapse, film

from fvcollapse import load_experiment
from fvcollapse.diagnosis.analysis import analyse, uncertain_levels
from fvcollapse.diagnosis.levels import closures_of, level_cases
from fvcollapse.diagnosis.question import Question
from fvcollapse.diagnosis.scatter import SEEDS
from fvcollapse.effects.front_saltation import (
    FrontSaltation,
    scatter_covariance,
    seen_with_beads,
)
from fvcollapse.measure.curves import curve_text
from fvcollapse.measure.observation import seen_front

SET_UPS = ((10.0, 0.1), (16.0, 0.1))
EFFECTS = ("front_saltation", "bed_friction", "cohesion", "lateral_friction")


def observed(case):
    """A collapse by formula, its front as it is seen."""
    seen = collapse(case)
    front = seen.front.copy()
    front[:, 1] = seen_front(*front.T, case)
    return replace(seen, front=front, scalars=seen.scalars | {"runout": float(front[:, 1].max())})


class SeeingRunner(ToyRunner):
    """A `ToyRunner` that also looks with the effects of the observation."""

    def observations(self, wanted, phase=""):
        _, failures = super().observations(wanted, phase)
        return {label: observed(case) for label, (_, case) in wanted.items()}, failures


def filmed(folder, seed, bias, spread):
    """Experiments whose fronts are seen with jumping grains of seeds of their own."""
    found = []
    for number, (slope, width) in enumerate(SET_UPS):
        place = film(folder / f"s{slope:g}", slope, width, seed=10 * seed + number)
        section = {"bias": bias, "spread": spread, "seed": 1000 + 10 * seed + number}
        case = load_experiment(place).case()
        case = case.replace(**{"grid.cell_size": 0.004, "effects.front_saltation": section})
        rows = observed(case).front[2::2]
        noise = np.random.default_rng(seed).standard_normal(len(rows))
        rows = np.column_stack([rows[:, 0], rows[:, 1] + 0.004 * noise])
        (place / "front.csv").write_text(curve_text("front", rows), encoding="utf-8")
        found.append(load_experiment(place))
    return tuple(found)


def analysed(folder, *numbers):
    question = Question(filmed(folder, *numbers))
    return analyse(question, SeeingRunner(), effects=EFFECTS, refinements=0)


@pytest.fixture(scope="module")
def jumping(tmp_path_factory):
    return analysed(tmp_path_factory.mktemp("jumping"), 1, 0.02, 0.015)


def test_the_stated_covariance_is_that_of_many_realisations():
    case = load_case()
    time = np.linspace(0.0, 1.6, 81)
    front = collapse(case).front[:, 1]
    section = FrontSaltation(spread=1.0)
    at = np.array([0.1, 0.2, 0.24, 0.4, 1.2, np.inf])
    draws = np.array(
        [
            np.interp(at, time, seen_with_beads(replace_seed(section, seed), case, time, front))
            for seed in range(1500)
        ]
    )
    stated = scatter_covariance(section, case, time, front, at)
    size = np.sqrt(np.diag(stated))
    np.testing.assert_allclose(np.cov(draws.T) / np.outer(size, size), corr(stated), atol=0.12)


def corr(covariance):
    size = np.sqrt(np.diag(covariance))
    return covariance / np.outer(size, size)


def replace_seed(section, seed):
    return FrontSaltation(spread=section.spread, seed=seed)


def load_case():
    from fvcollapse.case.case import Case

    return Case().replace(**{"geometry.slope_angle_deg": 10.0})


def test_a_level_is_read_with_every_seed_and_costs_no_run(jumping):
    (closure,) = closures_of("front_saltation")
    experiment = jumping.experiments[0]
    base = jumping.library.cases[experiment.name]
    found = level_cases((closure,), experiment, base)
    seeds = {case.effects.front_saltation.seed for _, case in found.values()}
    assert seeds == set(range(SEEDS))
    assert len(found) == SEEDS * (len(closure.levels()) + 1)


def test_errors_of_the_response_are_the_scatter_at_its_spread(jumping):
    """Its covariance at u is spread(u)^2 times that of the effect, the mean of `SEEDS` realisations included."""
    (closure,), (response,) = (
        jumping.library.closures["front_saltation"],
        jumping.responses["front_saltation"],
    )
    assert response.scatters
    assert all(name != "front_saltation" for name, *_ in uncertain_levels(jumping))
    u = response.levels[3]
    spread = closure.values(u)["spread"]
    points, name = jumping.points, jumping.experiments[0].name
    (block,) = [b for b in points.blocks if b.experiment == name and b.observable == "front"]
    rows = np.arange(block.start, block.stop)
    case = jumping.library.cases[name]
    front = collapse(case).front
    stated = scatter_covariance(FrontSaltation(), case, *front.T, block.time)
    expected = (1.0 + 1.0 / SEEDS) * spread**2 * stated
    found = response.covariance(u)
    np.testing.assert_allclose(found[np.ix_(rows, rows)], expected, atol=1e-9)
    others = points.experiment != name
    assert np.abs(found[np.ix_(rows, np.flatnonzero(others))]).max() == 0.0


def named(folder, seed):
    """The hypotheses of the largest evidence for biases to both sides, and for scatter alone."""
    return [
        analysed(folder / f"{seed}_{bias}", seed, bias, spread).evidence.best.name
        for bias, spread in ((0.02, 0.012), (-0.02, 0.012), (0.0, 0.02))
    ]


def test_jumping_grains_are_recognised(tmp_path):
    """The scatter alone, without a bias, too."""
    assert named(tmp_path, seed=0) == ["front_saltation"] * 3


@pytest.mark.slow
def test_jumping_grains_are_recognised_whatever_their_seed(tmp_path):
    won = [name for seed in range(4) for name in named(tmp_path, seed)]
    assert won.count("front_saltation") >= 11


@pytest.mark.parametrize("seed", [0, *(pytest.param(n, marks=pytest.mark.slow) for n in (1, 2))])
def test_without_jumping_grains_none_are_seen(tmp_path, seed):
    assert analysed(tmp_path, seed, 0.0, 0.0).evidence.best.name == "none"
