"""What a side view makes of a volume, on piles whose area is known, and the cases that are read in this way."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from fvcollapse.case.case import GRAVITY, Case
from fvcollapse.effects.transverse_profile import view_factor
from fvcollapse.output.result import Profiles
from plots import paper_volume_seen
from runs.paper import volume, volume_seen
from runs.table import as_line, read_table

X = np.linspace(0.0, 1.0, 1001)  # m
TIMES = np.array([0.0, 0.1, 0.2])  # s
HEIGHT, LENGTH = 0.14, 0.2  # m
AREA = HEIGHT * LENGTH  # m2


def block(length, area=AREA):
    """Thickness of a rectangle of a given length and area; its face is one interval wide, half of it inside."""
    return area / length * np.clip((length - X) / (X[1] - X[0]) + 0.5, 0.0, 1.0)


def result_of(heights, **keys):
    """A result with these profiles, one for each time."""
    thickness = np.array(heights)
    time = TIMES[: len(thickness)]
    profiles = Profiles(time, X, thickness, np.zeros_like(thickness))
    series = {"relative_volume": np.trapezoid(thickness, X, axis=1) / AREA - 1.0}
    return SimpleNamespace(profiles=profiles, case=Case().replace(**keys), time=time, series=series)


def test_a_pile_that_only_moves_keeps_its_area_and_one_that_swells_gains_it():
    found = volume_seen.as_it_is(result_of([block(0.2), block(0.4), block(0.8, 1.1 * AREA)]))
    np.testing.assert_allclose(found, [0.0, 0.0, 0.1], atol=1e-9)


def test_a_vertical_face_between_two_nodes_is_no_change():
    """Profiles that miss half an interval of the column, of a flow that has its volume."""
    sharp = np.where(X < LENGTH - 1e-9, HEIGHT, 0.0)
    of = result_of([sharp, block(0.4)])
    of.series["relative_volume"] = np.zeros(2)
    assert np.trapezoid(sharp, X) < 0.998 * AREA
    for found in (volume_seen.as_it_is(of), volume_seen.above(of, 1e-3)):
        np.testing.assert_allclose(found, 0.0, atol=1e-9)


@pytest.mark.parametrize(("view", "sign"), [("wall", -1.0), ("centre", 1.0)])
def test_from_a_side_what_has_passed_the_gate_is_stretched(view, sign):
    keys = {"effects.transverse_profile": {"velocity_ratio": 1.5}, "geometry.channel_width": 0.1}
    found = volume_seen.from_a_side(result_of([block(0.2), block(0.4)], **keys), view)
    stretch = view_factor(1.5, view) - 1.0  # -1/4 at the wall, +1/8 in the middle
    np.testing.assert_allclose(found, [0.0, 0.5 * stretch], atol=2e-3)
    assert sign * found[1] > 0.05


def test_what_is_thinner_than_a_threshold_is_lost():
    tongue = np.where((X > 0.2) & (X < 0.7), 0.004, 0.0)
    column = block(0.2, AREA - 0.5 * 0.004)
    found = volume_seen.above(result_of([block(0.2), column + tongue]), 0.005)
    np.testing.assert_allclose(found, [0.0, -0.5 * 0.004 / AREA], atol=1e-3)


def test_a_wrong_zero_counts_along_the_whole_pile():
    found = volume_seen.raised(result_of([block(0.2), block(0.9)]), 7e-4)
    np.testing.assert_allclose(found, [0.0, 0.7 * 7e-4 / AREA], atol=1e-4)


def test_a_long_exposure_sees_where_the_grains_are_and_where_they_come_to():
    heights = [block(0.2), block(0.3), block(0.3)]
    found = volume_seen.blurred(result_of(heights), 0.1)
    ahead = 0.1 * AREA / 0.3  # of the longer one beyond the gate
    np.testing.assert_allclose(found, [ahead / AREA, 0.0, 0.0], atol=5e-3)
    np.testing.assert_allclose(volume_seen.blurred(result_of(heights), 0.01), 0.0, atol=1e-9)


# -- beads above the surface ---------------------------------------------------------------------


def field_of(h, speed, dx=0.01, dz=0.005, nz=20):
    """A field with layers of the thickness h (nx + 1,) at the nodes, in which u grows linearly to `speed` at z = h."""
    z = dz * np.arange(nz + 1)
    centre = dz * (np.arange(nz) + 0.5)
    u = np.where(h > 0.0, speed / np.where(h > 0.0, h, 1.0), 0.0)[:, None] * centre
    level_set = z[None, :] - h[:, None]
    return {"dx": dx, "dz": dz, "level_set": level_set, "u": u, "w": np.zeros((len(h) - 1, nz + 1))}


def test_the_speed_of_a_surface_is_that_of_its_uppermost_grains():
    h = np.full(11, 0.04)
    h[6:] = 0.0
    found = volume_seen.surface_speed(field_of(h, 0.8), Case())
    np.testing.assert_allclose(found[:5], 0.8 * 0.0375 / 0.04)  # the cell below the surface
    np.testing.assert_allclose(found[6:], 0.0)
    assert volume_seen.moving_length(field_of(h, 0.8), Case()) == pytest.approx(0.06)
    assert volume_seen.moving_length(field_of(h, 0.005), Case()) == 0.0


def test_a_cloud_hides_what_is_behind_it_up_to_where_a_line_of_sight_meets_one_grain():
    case = Case().replace(**{"geometry.channel_width": 0.1})
    scale = 0.002
    lost = 0.3 * case.rheology.density_grain / case.rheology.density_bulk
    top = volume_seen.cloud_height(scale, case) + lost * scale
    at_top = 0.3 * math.exp(-top / scale)
    assert 1.5 * at_top * 0.1 / case.rheology.grain_diameter == pytest.approx(1.0)
    wide = case.replace(**{"geometry.channel_width": 0.2})
    rise = volume_seen.cloud_height(scale, wide) - volume_seen.cloud_height(scale, case)
    assert rise == pytest.approx(scale * math.log(2.0))


def test_a_cloud_needs_the_square_of_a_speed_and_a_surface_that_moves():
    case = Case().replace(**{"geometry.channel_width": 0.1, "geometry.slope_angle_deg": 22.0})
    fields = [field_of(np.full(11, 0.04), speed) for speed in (0.8, 0.0)]
    result = SimpleNamespace(case=case, field_times=TIMES[:2], field=lambda index: fields[index])
    found = volume_seen.cloud(result, 0.1)
    scale = (0.1 * 0.75) ** 2 / (GRAVITY * math.cos(math.radians(22.0)))
    assert found[0] == pytest.approx(0.1 * volume_seen.cloud_height(scale, case) / AREA)
    assert found[1] == 0.0
    assert volume_seen.cloud(result, 0.2)[0] == pytest.approx(4.0 * found[0])


# -- the part of the study -----------------------------------------------------------------------


def test_every_case_is_one_that_the_solver_takes():
    for settings in volume.cases().values():
        Case().replace(**settings, **{"grid.cell_size": 0.02})


def test_a_row_has_the_largest_change_and_what_is_left_of_it():
    row = volume.row_of(TIMES, np.array([0.0, -0.08, -0.02]))
    assert row == pytest.approx({"largest_percent": -8.0, "at_s": 0.1, "last_percent": -2.0})


def test_each_kind_of_run_is_read_in_its_own_ways():
    plain = result_of([block(0.2), block(0.4)], **{"geometry.channel_width": math.inf})
    words = [name for name, *_ in volume.seen(plain)]
    assert words[0] == "grains"
    assert len(words) == 1 + len(volume.THRESHOLDS) + len(volume.ZEROS) + len(volume.EXPOSURES)
    swelling = {"effects.dilatancy": {"dilatancy_factor": 4.0}}
    assert [name for name, *_ in volume.seen(result_of([block(0.2)], **swelling))] == ["grains"]
    seen_from = {"effects.transverse_profile": {"velocity_ratio": 1.2}}
    found = [name for name, *_ in volume.seen(result_of([block(0.2)], **seen_from))]
    assert found == ["grains", "from the wall", "from the centre"]


def test_the_changes_of_the_figure_are_kept_by_name_and_made_by_a_case(tmp_path):
    path = tmp_path / "changes.csv"
    first, second = volume.SHOWN[:2]
    for change in (np.zeros(3), np.array([0.0, 0.05, 0.01])):
        volume.add_lines(path, [volume.line_of(name, TIMES, change) for name in (first, second)])
    rows = {row["case"]: as_line(row) for row in read_table(path)}
    assert list(rows) == [first, second]
    assert rows[first].values.max() == pytest.approx(5.0)
    assert rows[first].at[-1] == pytest.approx(TIMES[-1])
    for name in volume.SHOWN:
        assert name.rpartition("; ")[0] in volume.cases()


def test_the_figure_draws_what_is_kept():
    names = [
        f"{paper_volume_seen.GRAINS}; {width}; {kind}"
        for width in paper_volume_seen.WANTED
        for kind in paper_volume_seen.KINDS
    ]
    assert names == volume.SHOWN
    assert [value / 100.0 for value in paper_volume_seen.WANTED.values()] == list(volume.WANTED)


def test_the_search_writes_runs_what_is_seen_and_the_lines_of_the_figure(tmp_path, monkeypatch):
    names = [volume.name_of(volume.MAIN, 0.1, kind) for kind in ("plain", "K = 4, from 0.60")]
    short = {name: volume.cases()[name] | {"time.end": 0.2} for name in names}
    monkeypatch.setattr(volume, "cases", lambda: short)
    options = SimpleNamespace(out=tmp_path, tables=tmp_path, cell_size=0.03, workers=1)
    for _ in range(2):  # the second finds all done
        assert volume.search(options) == []
        found = {
            part: read_table(tmp_path / "volume" / f"{part}.csv")
            for part in ("runs", "seen", "changes")
        }
        assert [row["name"] for row in found["runs"]] == names
        assert {row["case"] for row in found["changes"]} == {
            name for name in volume.SHOWN if name.rpartition("; ")[0] in names
        }
        swelling = [row for row in found["seen"] if row["name"] == f"{names[1]}; grains"]
        assert 0.0 < float(swelling[0]["largest_percent"]) < 5.0
