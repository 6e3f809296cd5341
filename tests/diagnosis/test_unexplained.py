"""What is left of a gap: whether it asks for an explanation, and how it describes itself.

Gaps are made by hand on the points of a filmed collapse, so that place, time, direction and size are known.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from toy_laboratory import ToyRunner, film, settings

from fvcollapse import load_experiment
from fvcollapse.diagnosis import unexplained as module
from fvcollapse.diagnosis.analysis import analyse
from fvcollapse.diagnosis.covariance import floored
from fvcollapse.diagnosis.emulator import Response
from fvcollapse.diagnosis.gap_map import gap_map
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.diagnosis.practical import CROSS_CODE, something_unexplained
from fvcollapse.diagnosis.question import Question
from fvcollapse.diagnosis.report.remainder import practical_of, unexplained_of
from fvcollapse.diagnosis.report.unexplained_words import unexplained_words
from fvcollapse.diagnosis.unexplained import unexplained
from fvcollapse.measure.curves import curve_text

HEIGHT = 0.14  # m, of the column of the toy laboratory
EFFECTS = ("lateral_friction", "gate", "cohesion", "bed_friction")


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    """The points of a wedge behind a tongue 8 mm thick; the thickness is known to a fifth of a millimetre."""
    folder = tmp_path_factory.mktemp("tongue") / "s16"
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


# -- is there anything to explain? -----------------------------------------------------------------


def analysed(folder, **hidden):
    experiments = tuple(
        load_experiment(film(folder / f"s{slope:g}", slope, 0.1, seed=n, **hidden))
        for n, slope in enumerate((10.0, 16.0))
    )
    return analyse(Question(experiments), ToyRunner(), effects=EFFECTS)


@pytest.fixture(scope="module")
def swelling(tmp_path_factory):
    """A change of the volume that no effect knows."""
    return analysed(tmp_path_factory.mktemp("swelling"), swelling=0.08)


def test_nothing_hidden_leaves_nothing(tmp_path):
    left = something_unexplained(analysed(tmp_path, mu_1=0.458))
    assert not left.is_something
    assert not left.is_significant
    assert left.regions == 0
    assert left.left == left.gain == 0.0


def test_a_hidden_change_of_volume_is_something_that_no_effect_closes(swelling):
    left = something_unexplained(swelling)
    assert left.is_something
    assert left.is_significant
    assert left.gain < 0.1
    larger = {part.observable for part in left.practical if part.is_larger}
    assert "volume" in larger
    volume = next(part for part in left.practical if part.observable == "volume")
    assert volume.beyond == pytest.approx(0.064, abs=0.01)  # 8 % times the progress of the front
    assert volume.codes is None


@pytest.mark.parametrize(("size", "expected"), [(0.001, False), (0.004, True)])
def test_what_two_codes_differ_by_is_no_unknown_cause(points, size, expected):
    """Both are significant, by five and by twenty standard deviations of every thickness."""
    left = something_unexplained(stub(points, thickness_of(points, size)))
    assert left.is_significant
    assert left.regions > 0
    thickness = next(part for part in left.practical if part.observable == "profiles")
    assert thickness.codes == pytest.approx(CROSS_CODE["profiles"] * HEIGHT)
    assert thickness.gap == pytest.approx(size)
    assert left.is_practical is left.is_something is expected


def test_controls_take_the_place_of_other_codes(points):
    """A model that its controls show to err by 6 mm may be off by 4; without them it may not."""
    gap = thickness_of(points, 0.004)
    error = np.where(points.observable == "profiles", 0.006, 1e-6)
    taught = something_unexplained(stub(points, gap, controls=("one",), model_error=error))
    thickness = next(part for part in taught.practical if part.observable == "profiles")
    assert thickness.controls == pytest.approx(0.006)
    assert not thickness.is_larger
    assert something_unexplained(stub(points, gap)).is_practical


def test_what_a_calibration_explains_is_not_left(points):
    slope = thickness_of(points, 0.004) * np.sin(7.0 * np.nan_to_num(points.x))
    explained = something_unexplained(stub(points, 1.5 * slope, slopes=slope[None]))
    assert explained.left == 0.0
    assert not explained.is_something
    assert something_unexplained(stub(points, 1.5 * slope)).is_something


# -- it describes itself ---------------------------------------------------------------------------


def late_thin_layers(points, size):
    """A gap of the thickness in thin layers near the front, after 0.6 s, and of the front then."""
    place = module.places_of(points, points.measured)
    late = np.nan_to_num(points.time) > 0.6
    thin = (points.observable == "profiles") & np.isin(place, (module.THIN, module.FRONT))
    gap = np.where(thin & late, size, 0.0)
    return gap + np.where((points.observable == "front") & late, 20.0 * size, 0.0)


@pytest.mark.parametrize(
    ("size", "words", "direction"),
    [
        (0.004, "something that holds thin layers", 1.0),
        (-0.002, "something that lets thin layers move more easily", -1.0),
    ],
)
def test_late_thin_layers_are_told_as_such(points, size, words, direction):
    found = unexplained_of(stub(points, late_thin_layers(points, size)), verdict(UNKNOWN))
    assert found.words.startswith("tip of the flow only, in the thin part, from 0.6")
    assert words in found.words
    assert found.direction == direction
    assert found.t_range[0] > 0.6
    assert {share.place for share in found.shares} <= {module.FRONT, module.THIN}
    assert sum(share.share for share in found.shares) == pytest.approx(1.0)
    assert found.sizes["profiles"].mean == pytest.approx(size)
    assert found.sizes["front"].rms == pytest.approx(20.0 * abs(size))


def test_places_and_motion(points):
    """Too little at the back wall and too much at the front are one motion."""
    place = module.places_of(points, points.measured)
    profile = points.observable == "profiles"
    assert set(place[profile]) == {module.FRONT, module.THIN, module.MIDDLE, module.BACK}
    assert (points.x[profile & (place == module.BACK)] < 0.1).all()  # half of the 20 cm
    assert (points.measured[place == module.THIN] < 0.1 * HEIGHT).all()
    tilted = np.where(place == module.BACK, -1.0, 1.0)
    motion = module.motion_of(points, place, tilted)
    assert (motion[profile & (place == module.BACK)] == 1).all()
    assert (motion[profile & (place == module.FRONT)] == 1).all()
    assert (motion[profile & (place == module.MIDDLE)] == 0).all()
    assert (motion[points.observable == "volume"] == 0).all()
    interface = points.observable == "interface"
    assert (motion[interface] == -tilted[interface]).all()


def test_a_change_of_the_volume_reads_as_one(swelling):
    found = unexplained_of(swelling, verdict(UNKNOWN))
    assert found.beside == NONE
    assert found.shares[0].place == module.PILE
    assert "something that makes the grains take more room" in found.words
    assert "relative volume" in unexplained_words(found)
    assert found.sizes["volume"].mean < 0.0


def verdict(kind, names=()):
    probability = dict.fromkeys((NONE, UNKNOWN, "gate", "spoils"), 0.25)
    return SimpleNamespace(kind=kind, set=names, probability=probability)


def test_a_named_cause_leaves_nothing_unexplained(swelling):
    assert unexplained_of(swelling, verdict("effect", ("gate",))) is None
    assert unexplained_of(swelling, verdict("none", ("none", "gate"))) is not None


def test_open_causes_without_a_region_are_not_described(points):
    found = stub(points, np.zeros(len(points)))
    assert unexplained_of(found, verdict("none", ("none", "gate"))) is None
    alone = unexplained_of(found, verdict(UNKNOWN))
    assert alone.regions == []
    told = "no place or moment stands out; only all points together are off by more than chance explains."
    assert unexplained_words(alone) == told
    found.evidence.hypotheses[NONE].p_value = 0.99
    told = "no place or moment stands out; chance explains all points together."
    assert unexplained_words(unexplained_of(found, verdict(UNKNOWN))) == told


# -- what it resembles -----------------------------------------------------------------------------


def test_likeness_has_a_sign_and_a_strength(points):
    gap = late_thin_layers(points, 0.004)
    effects = {"weak": -0.4 * gap, "opposite": 0.7 * gap, "other": thickness_of(points, 0.003)}
    alike = {one.effect: one for one in unexplained(stub(points, gap, effects=effects)).resembles}
    assert alike["weak"].cosine == pytest.approx(1.0)
    assert alike["weak"].strength == pytest.approx(2.5)  # it would need 1 / 0.4 of its largest
    assert alike["weak"].worse == ()
    assert alike["opposite"].cosine == pytest.approx(-1.0)
    assert alike["opposite"].strength == 0.0


def test_what_a_verdict_does_not_compare_explains_nothing(points):
    """A pair of effects that is ahead, and has no probability in a verdict that compares single effects only."""
    gap = late_thin_layers(points, 0.004)
    found = stub(points, gap, effects={"arms": -0.4 * gap, "cups": -0.2 * gap})
    pair = SimpleNamespace(name="arms+cups", difference=-gap, p_value=0.9)
    found.evidence.hypotheses = {"arms+cups": pair} | found.evidence.hypotheses
    assert unexplained(found).beside == "arms+cups"
    assert unexplained(found, [NONE, UNKNOWN, "arms", "cups"]).beside == NONE


def test_an_effect_that_spoils_another_observable_is_told(points):
    """It takes the gap of the thickness away, and moves the front, where there is none."""
    gap = thickness_of(points, 0.004)
    spoils = np.where(points.observable == "front", 0.02, -gap)
    (one,) = unexplained(stub(points, gap, effects={"spoils": spoils})).resembles
    assert one.worse == ("front",)
    assert 0.3 < one.cosine < 1.0
    text = unexplained_words(
        unexplained_of(stub(points, gap, effects={"spoils": spoils}), verdict(UNKNOWN))
    )
    assert "spoils" in text
    assert "front position would fit worse" in text


def test_the_response_of_an_effect_that_closes_most_is_taken_off(points):
    """What is left beside it is described, and it is not compared with itself."""
    late, all_over = late_thin_layers(points, 0.004), thickness_of(points, 0.012)
    found = stub(points, late + all_over, effects={"gate": -all_over})
    gate = SimpleNamespace(name="gate", difference=-all_over, p_value=1e-3)
    found.evidence.hypotheses = {UNKNOWN: found.evidence.hypotheses[UNKNOWN], "gate": gate} | {
        NONE: found.evidence.hypotheses[NONE]
    }
    left = unexplained(found)
    assert left.beside == "gate"
    assert left.p_value == gate.p_value
    assert left.resembles == ()
    assert {share.place for share in left.shares} <= {module.FRONT, module.THIN}


def test_the_report_has_the_sizes_in_practice(swelling):
    parts = practical_of(swelling)
    assert set(parts) == {"front", "profiles", "volume", "interface"}
    assert parts["volume"].is_larger
    for part in parts.values():
        assert 0.0 <= part.beyond <= part.gap
        assert part.share == pytest.approx((part.beyond / part.gap) ** 2)
        assert part.controls is None
