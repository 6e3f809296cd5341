"""How what is left of a gap describes itself: its place, time and direction, and the effects that it resembles."""

from types import SimpleNamespace

import numpy as np
import pytest
from gaps_by_hand import HEIGHT, stub, thickness_of, tongue

from fvcollapse.diagnosis import unexplained as module
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.diagnosis.report.remainder import unexplained_of
from fvcollapse.diagnosis.report.unexplained_words import unexplained_words
from fvcollapse.diagnosis.unexplained import unexplained


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    return tongue(tmp_path_factory.mktemp("tongue") / "s16")


# -- it describes itself -------------------------------------------------------------------------


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


# -- what it resembles ---------------------------------------------------------------------------


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
