"""Points of comparison: thinning, phases, the simulated side, errors of clock and origin."""

import numpy as np
import pytest
from experiment_folder import write_experiment

from fvcollapse.diagnosis.point_choice import choose_points
from fvcollapse.diagnosis.points import PHASES
from fvcollapse.errors import InputError
from fvcollapse.measure.experiment import load_experiment
from fvcollapse.measure.observables import Observations

TIMES = np.arange(0.0, 1.51, 0.02)
PLACES = np.arange(0.0, 0.8, 0.01)


def front_at(time):
    """A front that starts at 0.2 m and covers 0.4 m, 98 % of it before 0.8 s."""
    return 0.2 + 0.4 * (1.0 - np.exp(-((np.asarray(time) / 0.4) ** 2)))


def thickness_at(time, x):
    """A smooth pile that spreads."""
    return 0.1 * np.exp(-(x**2) / (0.1 + 0.2 * time))


def film():
    """CSV texts of a dense film."""
    front = "".join(f"{t:.2f},{front_at(t):.5f}\n" for t in TIMES)
    rows = [(t, x, thickness_at(t, x)) for t in TIMES for x in PLACES[2:]]
    profiles = "".join(f"{t:.2f},{x:.4f},{h:.6f}\n" for t, x, h in rows)
    interface = "".join(f"{t:.2f},{x:.4f},{0.5 * h:.6f}\n" for t, x, h in rows)
    volume = "".join(f"{t:.2f},{0.01 * t:.5f}\n" for t in TIMES)
    return {
        "front": "t_s,x_front_m\n" + front,
        "profiles": "t_s,x_m,h_m\n" + profiles,
        "interface": "t_s,x_m,z_static_m\n" + interface,
        "volume": "t_s,relative_volume_change\n" + volume,
    }


def simulation():
    """The same film as a simulation sees it, on a finer grid."""
    time, x = np.arange(0.0, 1.6, 0.01), np.arange(0.0, 0.9, 0.002)
    grid = np.column_stack([np.repeat(time, len(x)), np.tile(x, len(time))])
    h = thickness_at(grid[:, 0], grid[:, 1])
    scalars = {"runout": 0.6, "final_height": 0.1, "time_stop": 1.0, "peak_front_velocity": 1.0}
    return Observations(
        np.column_stack([time, front_at(time)]),
        np.column_stack([grid, h]),
        np.column_stack([time, 0.01 * time]),
        np.column_stack([grid, 0.5 * h]),
        scalars,
    )


@pytest.fixture(scope="module")
def dense(tmp_path_factory):
    folder = tmp_path_factory.mktemp("film") / "dense"
    return load_experiment(write_experiment(folder, **film()))


@pytest.fixture
def sparse(tmp_path):
    return load_experiment(write_experiment(tmp_path / "sparse"))


def test_a_film_is_thinned_to_about_200_measured_points(dense):
    points = choose_points([dense])
    assert 150 <= len(points) <= 250
    for block in points.blocks[:4]:
        curve = dense.curves[block.observable]
        for time, x, value in zip(
            block.time, block.x, points.measured[block.start : block.stop], strict=True
        ):
            here = curve.time == time
            if curve.x is not None:
                here &= curve.x == x
            assert curve.value[here] == value


def test_every_phase_of_a_film_has_a_profile(dense):
    points = choose_points([dense])
    assert set(points.phase[points.observable == "profiles"]) == set(PHASES)
    assert set(points.phase[points.observable == "front"]) == set(PHASES)


def test_phases_end_where_the_front_has_covered_its_shares(dense):
    (run,) = choose_points([dense]).runs
    ends = np.array(run.phase_ends)
    covered = (front_at(ends) - 0.2) / (front_at(1.5) - 0.2)
    before = (front_at(ends - 0.02) - 0.2) / (front_at(1.5) - 0.2)
    shares = np.array([0.10, 0.80, 0.98])
    assert (covered >= shares).all()
    assert (before < shares).all()
    assert run.duration == ends[-1]


def test_phases_without_a_front_follow_the_free_fall(tmp_path):
    changes = dict.fromkeys(("front", "profiles", "volume", "interface"))
    points = choose_points([load_experiment(write_experiment(tmp_path / "numbers", **changes))])
    fall = np.sqrt(0.14 / 9.81)
    assert points.runs[0].phase_ends == pytest.approx([fall, 2.5 * fall, 3.5 * fall])
    assert list(points.phase) == ["deposit", "arrest"]


def test_blocks_of_an_experiment_follow_one_another(dense, sparse):
    points = choose_points([dense, sparse])
    assert points.names == ("dense", "sparse")
    assert points.of("dense").stop == points.of(sparse).start
    assert points.of(sparse).stop == len(points)
    assert set(points.experiment[points.of(dense)]) == {"dense"}
    # all of a short record is kept
    assert (points.observable[points.of(sparse)] == "front").sum() == 3
    assert list(points.kind[-2:]) == ["value", "upper"]


def test_no_measured_point_of_a_short_curve_is_left_out(tmp_path):
    rows = "".join(f"{0.02 + 0.1 * n:.2f},{0.2 + 0.05 * n:.3f}\n" for n in range(10))
    folder = write_experiment(tmp_path / "ten", front="t_s,x_front_m\n" + rows)
    points = choose_points([load_experiment(folder)])
    assert (points.observable == "front").sum() == 10


def test_a_simulation_of_the_film_itself_leaves_no_gap(dense):
    points = choose_points([dense])
    simulated = points.simulated({"dense": simulation()})
    curves = ~np.isin(points.observable, ("runout", "time_stop"))
    np.testing.assert_allclose(simulated[curves], points.measured[curves], atol=2.0e-5)
    assert list(simulated[~curves]) == [0.6, 1.0]


def test_sensitivity_is_the_derivative_of_what_is_read(dense):
    points = choose_points([dense])
    clock, origin = points.sensitivity({"dense": simulation()})
    name = points.observable
    t, x = points.time, points.x
    own = (name == "profiles") & (t > 0.05)
    spread = 0.1 + 0.2 * t[own]
    h = thickness_at(t[own], x[own])
    np.testing.assert_allclose(origin[own], 2.0 * x[own] / spread * h, atol=2.0e-3)
    np.testing.assert_allclose(clock[own], -0.2 * x[own] ** 2 / spread**2 * h, atol=1.0e-3)
    own = (name == "front") & (t > 0.05) & (t < 1.4)
    rate = 0.4 * 2.0 * t[own] / 0.16 * np.exp(-((t[own] / 0.4) ** 2))
    np.testing.assert_allclose(clock[own], -rate, atol=5.0e-3)
    assert set(origin[name == "front"]) == {1.0}
    assert set(origin[name == "volume"]) == {0.0}
    assert (clock[name == "time_stop"], origin[name == "time_stop"]) == (1.0, 0.0)
    assert (clock[name == "runout"], origin[name == "runout"]) == (0.0, 1.0)


def test_two_experiments_of_one_name_are_refused(tmp_path):
    folders = [write_experiment(tmp_path / name / "same") for name in "ab"]
    with pytest.raises(InputError, match="the name same twice"):
        choose_points([load_experiment(folder) for folder in folders])


def test_a_copy_under_another_name_is_refused(tmp_path):
    folders = [write_experiment(tmp_path / name) for name in ("one", "copy")]
    with pytest.raises(InputError, match=r"copy: front: found the curve of one;"):
        choose_points([load_experiment(folder) for folder in folders])


def test_curves_without_a_change_may_agree(tmp_path):
    front = "t_s,x_front_m\n0.0,0.2\n0.1,{}\n0.2,0.31\n"
    rest = {"profiles": None, "interface": None, "volume": "t_s,relative_volume_change\n0,0\n1,0\n"}
    folders = [
        write_experiment(tmp_path / name, front=front.format(place), **rest)
        for name, place in (("one", 0.24), ("other", 0.25))
    ]
    assert len(choose_points([load_experiment(folder) for folder in folders])) > 0
