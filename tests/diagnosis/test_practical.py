"""Whether what is left of a gap asks for an explanation: beyond chance, calibration and what two codes differ by."""

import numpy as np
import pytest
from gaps_by_hand import HEIGHT, analysed, stub, thickness_of, tongue

from fvcollapse.diagnosis.practical import CROSS_CODE, something_unexplained
from fvcollapse.diagnosis.report.remainder import practical_of


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    return tongue(tmp_path_factory.mktemp("tongue") / "s16")


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


def test_the_report_has_the_sizes_in_practice(swelling):
    parts = practical_of(swelling)
    assert set(parts) == {"front", "profiles", "volume", "interface"}
    assert parts["volume"].is_larger
    for part in parts.values():
        assert 0.0 <= part.beyond <= part.gap
        assert part.share == pytest.approx((part.beyond / part.gap) ** 2)
        assert part.controls is None
