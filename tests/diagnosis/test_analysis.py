"""From runs and measurements to gap map and evidence, on collapses by formula."""

from types import SimpleNamespace

import numpy as np
import pytest
from fake_points import fake_points
from toy_laboratory import ToyRunner, film, only_numbers

from fvcollapse import load_experiment
from fvcollapse.diagnosis.analysis import analyse
from fvcollapse.diagnosis.controls import Shown, condition, learn, set_ups_apart
from fvcollapse.diagnosis.covariance import discrepancy_kernel
from fvcollapse.diagnosis.diagnose import with_known
from fvcollapse.diagnosis.question import Question
from fvcollapse.errors import InputError

EFFECTS = ("lateral_friction", "gate", "cohesion", "bed_friction")
SET_UPS = ((10.0, 0.1), (16.0, 0.1), (16.0, 0.2))


def filmed(folder, set_ups=SET_UPS, **hidden):
    """Experiments with the same thing hidden."""
    return [
        load_experiment(film(folder / f"s{slope:g}_w{width:g}", slope, width, seed=n, **hidden))
        for n, (slope, width) in enumerate(set_ups)
    ]


def analysed(folder, set_ups=SET_UPS[1:], **hidden):
    """Of two widths of the channel, by which its walls and the bed are told apart."""
    question = Question(tuple(filmed(folder, set_ups, **hidden)))
    return analyse(question, ToyRunner(), effects=EFFECTS)


@pytest.fixture(scope="module")
def walls(tmp_path_factory):
    folder = tmp_path_factory.mktemp("walls")
    return analysed(folder, SET_UPS[:2], effects={"lateral_friction": {"mu_wall": 0.22}})


def test_nothing_hidden_is_found_as_nothing(tmp_path):
    found = analysed(tmp_path, mu_1=0.458)  # within its standard deviation
    assert found.evidence.hypotheses["none"].p_value > 0.05
    assert found.evidence.best.name == "none"
    assert found.gap_map.regions == ()


@pytest.mark.parametrize(
    ("name", "section"),
    [
        ("lateral_friction", {"mu_wall": 0.22, "pressure_ratio": 0.9}),
        ("gate", {"speed": 1.0, "time_constant": 0.05, "mu_gate": 0.1, "delay": 0.01}),
        ("bed_friction", {"mu_bed": 0.25}),
    ],
)
def test_a_hidden_effect_is_the_best_explanation(tmp_path, name, section):
    found = analysed(tmp_path, effects={name: section})
    assert found.evidence.best.name == name
    assert found.evidence.best.p_value > 0.01
    assert found.gap_map.regions


def test_the_strength_is_inside_its_interval(walls):
    best = walls.evidence.best
    closure = walls.library.closures[best.name][best.variant[0]]
    product = [np.prod(list(closure.values(u).values())[:2]) for u in (best.low, best.u, best.high)]
    assert product[0] < 0.22 < product[2]  # mu_wall x pressure ratio is what the data see


def test_uncertainties_add_up(walls):
    total = walls.measurement + walls.numerical + walls.calibration
    assert np.allclose(walls.covariance, total)
    assert np.linalg.eigvalsh(walls.covariance).min() > 0.0
    assert not walls.shift.any()
    assert walls.discrepancy is None


def test_sensitivities_are_the_slopes_of_the_runs(walls):
    library = walls.library
    keys = [each.key for each in library.quantities]
    slopes = library.sensitivities
    own = library.points.of("s16_w0.1")
    front = (library.points.observable == "front")[own]
    assert slopes[keys.index("rheology.mu_1"), own][front][-1] < -0.005  # m per 0.012 of mu_1
    other = [n for n, each in enumerate(library.quantities) if each.experiments == ("s10_w0.1",)]
    assert not slopes[other, own].any()
    assert np.linalg.matrix_rank(library.set_up_covariance) <= 8


def test_separability_and_null_test_name_effects(walls):
    assert set(walls.separability.names) == set(EFFECTS)
    assert sum(walls.null_wins.values()) == pytest.approx(1.0)
    assert walls.null_wins.get("gate", 0.0) < 0.2


def test_the_evidence_of_some_effects_is_that_without_the_others(walls):
    again = walls.evidence_of(EFFECTS)
    assert again.log_evidence() == walls.evidence.log_evidence()
    assert again.balance == walls.evidence.balance
    layer = SimpleNamespace(classes=EFFECTS[1:], covers=lambda evidence: False)
    both, known = with_known(walls, layer)  # the layer does not know lateral friction
    single = {name for name in known.hypotheses if "+" not in name}
    assert single == {*EFFECTS[1:], "none", "unknown"}
    pairs = set(known.hypotheses) - single
    assert len(pairs) == 3  # of the effects that it knows
    assert set(both.evidence.hypotheses) == set(walls.evidence.hypotheses) | pairs
    for name in single:
        first, second = walls.evidence.hypotheses[name], known.hypotheses[name]
        assert second.log_evidence == pytest.approx(first.log_evidence)
        assert second.residual_outside > first.residual_outside  # fewer responses span less
    layer = SimpleNamespace(classes=EFFECTS, covers=lambda evidence: True)
    assert with_known(walls, layer) == (walls, None)


def test_bounds_alone_can_be_diagnosed(tmp_path):
    """As of the paper's experiments: the runout is less than something, nothing else is known."""
    folder = only_numbers(film(tmp_path / "bounds"), "runout,0.9,0.01,upper")
    question = Question((load_experiment(folder),))
    found = analyse(question, ToyRunner(), effects=("lateral_friction", "gate"))
    assert found.evidence.hypotheses["none"].p_value > 0.05
    assert set(found.evidence.hypotheses) >= {"none", "unknown", "lateral_friction"}


def test_two_experiments_of_one_name_are_refused(tmp_path):
    one = load_experiment(film(tmp_path / "a" / "same"))
    two = load_experiment(film(tmp_path / "b" / "same"))
    with pytest.raises(InputError, match="the name same twice"):
        analyse(Question((one,), controls=(two,)), ToyRunner())


# -- controls ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def taught(swelling):
    """Of the collapse with walls, whose model error was learned from the controls."""
    one, _, controls = swelling
    return analyse(Question((one,), controls=tuple(controls)), ToyRunner(), effects=EFFECTS)


@pytest.fixture(scope="module")
def swelling(tmp_path_factory):
    """Collapses of grains that swell, which no effect does: with walls, and two controls."""
    folder = tmp_path_factory.mktemp("swelling")
    controls = filmed(folder / "controls", SET_UPS[:2], swelling=0.05)
    hidden = {"lateral_friction": {"mu_wall": 0.22, "pressure_ratio": 0.9}}
    (one,) = filmed(folder / "walls", ((16.0, 0.12),), effects=hidden, swelling=0.05)
    (none,) = filmed(folder / "none", ((13.0, 0.1),), swelling=0.05)
    return one, none, controls


def test_without_controls_an_error_of_the_model_is_taken_for_a_cause(swelling):
    _, none, _ = swelling
    found = analyse(Question((none,)), ToyRunner(), effects=EFFECTS)
    assert found.evidence.hypotheses["none"].p_value < 1.0e-3
    assert any(region.observable == "volume" for region in found.gap_map.regions)


def test_controls_teach_the_error_of_the_model(swelling, taught):
    _, none, controls = swelling
    found = analyse(Question((none,), controls=tuple(controls)), ToyRunner(), effects=EFFECTS)
    assert found.evidence.best.name == "none"
    assert not any(region.observable == "volume" for region in found.gap_map.regions)
    assert found.discrepancy.factors["volume"] > found.discrepancy.factors["front"]
    volume = found.points.observable == "volume"
    assert found.shift[volume][-1] == pytest.approx(-0.05, abs=0.02)
    assert taught.evidence.best.name == "lateral_friction"


def test_points_of_the_controls_are_not_those_of_the_experiment(taught):
    found = taught
    assert len(found.library.points) > len(found.points) == len(found.shift)
    assert found.everything.shape == (len(found.library.points),) * 2
    assert found.covariance.shape == (len(found.points),) * 2
    assert np.linalg.eigvalsh(found.covariance).min() > 0.0


def test_conditioning_is_that_of_two_correlated_numbers():
    given, wanted = np.array([False, True]), np.array([True, False])
    covariance = np.array([[4.0, 3.0], [3.0, 9.0]])
    found = condition(given, wanted, np.array([0.0, 6.0]), covariance)
    assert found.mean == pytest.approx([3.0 / 9.0 * 6.0])
    assert found.covariance == pytest.approx(np.array([[4.0 - 9.0 / 9.0]]))


def test_set_ups_are_apart_by_slope_and_size(tmp_path):
    """6 degrees are one; a channel of 0.7 instead of 1.4 heights is 1.4."""
    experiments = filmed(tmp_path, ((10.0, 0.1), (16.0, 0.1), (10.0, 0.2)))
    found = set_ups_apart(experiments)
    assert found[0] == pytest.approx([0.0, 1.0, 1.4])
    assert found[1, 2] == pytest.approx(np.hypot(1.0, 1.4))


def test_set_ups_of_other_grains_or_another_gate_are_apart(tmp_path):
    """As the files state it: friction 0.1 more is one, a gate half as fast sqrt(g h) / (2 v) / 0.5."""
    one, other = filmed(tmp_path, ((16.0, 0.1), (16.0, 0.2)))
    text = (one.folder / "experiment.toml").read_text(encoding="utf-8")
    folder = other.folder
    (folder / "experiment.toml").write_text(text.replace("mu_1 = 0.45", "mu_1 = 0.55"))
    assert set_ups_apart((one, load_experiment(folder)))[0, 1] == pytest.approx(1.0)
    speed = one.case().gate.speed
    (folder / "experiment.toml").write_text(
        text.replace(f"speed = {speed:g}", f"speed = {speed / 2:g}")
    )
    apart = np.sqrt(9.81 * one.case().geometry.height_0) / speed / 0.5
    assert set_ups_apart((one, load_experiment(folder)))[0, 1] == pytest.approx(apart)


@pytest.mark.parametrize(("distance", "share"), [(0.0, (0.9, 1.0)), (8.0, (-0.1, 0.1))])
def test_a_control_of_the_same_set_up_teaches_most(distance, share):
    """The gap that a control shows is expected again where it was set up alike, and not far from there."""
    points = fake_points(runs=2, places=20, kinds=())
    kernel = discrepancy_kernel(points, 5.0 * points.sigma)
    known, given = np.diag(points.sigma**2), points.experiment == "r0"
    gap = 10.0 * points.sigma
    apart = np.where(points.experiment[:, None] == points.experiment, 0.0, distance)
    learned = learn(Shown(points, given, gap), known, kernel, apart)
    found = condition(given, ~given, gap, known + learned.covariance)
    low, high = share
    assert low < np.mean(found.mean / gap[~given]) < high


def test_learning_finds_the_size_of_a_known_discrepancy():
    """Factors and correlation of gaps drawn from the very model."""
    points = fake_points(runs=4, places=20, kinds=())
    rng = np.random.default_rng(3)
    known = np.diag(points.sigma**2)
    kernel = discrepancy_kernel(points, 5.0 * points.sigma)
    factor = np.where(points.observable == "front", 2.0, 0.5)
    covariance = known + kernel * np.outer(factor, factor)
    gap = np.linalg.cholesky(covariance) @ rng.standard_normal(len(points))
    apart = np.where(points.experiment[:, None] == points.experiment, 0.0, 1.0)
    found = learn(Shown(points, np.ones(len(points), bool), gap), known, kernel, apart)
    assert 0.8 < found.factors["front"] < 5.0
    assert 0.25 < found.factors["profiles"] < 1.0
    assert 0.02 < found.correlation < 0.98
