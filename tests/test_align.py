"""A simulation beside an experiment: no gap to itself, the front read alike, bounds, and times that it must cover."""

import numpy as np
import pytest
from experiment_folder import rows, write_experiment
from fake_simulation import FakeSimulation

from fvcollapse import load_experiment, observe
from fvcollapse.case.case import Case
from fvcollapse.errors import InputError
from fvcollapse.measure.align import align, on_points
from fvcollapse.output import run as output


@pytest.fixture
def experiment(tmp_path):
    return load_experiment(write_experiment(tmp_path / "beads"))


@pytest.fixture
def fake(monkeypatch):
    monkeypatch.setattr(output, "Simulation", FakeSimulation)


def test_simulation_meets_itself(fake, tmp_path):
    """An experiment made of a result has no gap to it, at stored times and places."""
    case = Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.2, "front.thickness": 0.0105})
    result = output.run(case)
    seen = observe(result)
    picked = seen.profiles[::7]
    text = {
        "front": "t_s,x_front_m\n" + rows(seen.front[::3]),
        "profiles": "t_s,x_m,h_m\n" + rows(picked),
        "volume": "t_s,relative_volume_change\n" + rows(seen.volume[::4]),
        "interface": "t_s,x_m,z_static_m\n" + rows(seen.interface[1::5]),
        "scalars": "name,value\n" + f"runout,{seen.scalars['runout']!r}\n",
    }
    experiment = load_experiment(write_experiment(tmp_path, **text))
    aligned = align(observe(result, experiment), experiment)
    assert [each.name for each in aligned] == ["front", "profiles", "volume", "interface", "runout"]
    assert [each.units for each in aligned] == ["m", "m", "1", "m", "m"]
    for each in aligned:
        np.testing.assert_allclose(each.gap, 0.0, atol=1e-12)
        assert each.gap.shape == each.sigma.shape == each.time.shape == each.x.shape
    np.testing.assert_array_equal(aligned[1].x, picked[:, 1])


def test_gap_is_simulated_minus_measured(experiment, fake):
    case = Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.3})
    seen = observe(output.run(case), experiment)
    front = align(seen, experiment)[0]
    expected = np.interp([0.0, 0.1, 0.2], seen.front[:, 0], seen.front[:, 1]) - [0.2, 0.24, 0.31]
    np.testing.assert_allclose(front.gap, expected)


def test_both_sides_read_the_front_at_the_same_thickness(experiment, fake):
    result = output.run(Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.2}))
    ours, theirs = observe(result).front, observe(result, experiment).front
    assert theirs[-1, 1] < ours[-1, 1]  # 10.5 mm instead of 5 mm
    again = output.run(result.case.replace(**{"front.thickness": 0.0105}))
    series = observe(again, experiment).front  # every step, instead of every profile
    np.testing.assert_allclose(np.interp(theirs[:, 0], *series.T), theirs[:, 1], atol=1e-12)


def test_bounds_count_only_what_is_beyond_them(fake, tmp_path):
    text = "name,value,sigma,kind\nrunout,0.5,0.01,{}\nfinal_height,0.0,0.01,lower\n"
    result = output.run(Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.3}))
    runout = observe(result, None, front_thickness=0.0105).scalars["runout"]
    assert runout > 0.5
    for kind, expected in (("upper", runout - 0.5), ("lower", 0.0), ("value", runout - 0.5)):
        folder = write_experiment(tmp_path / kind, scalars=text.format(kind))
        experiment = load_experiment(folder)
        *_, front, height = align(observe(result, experiment), experiment)
        assert front.gap[0] == pytest.approx(expected)
        assert height.gap[0] == 0.0


def test_simulation_that_ends_in_motion_must_cover_the_measurements(experiment, fake):
    seen = observe(output.run(Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.15})))
    assert seen.scalars["time_stop"] is None
    with pytest.raises(InputError, match=r"front.csv: t_s: found 0.2; allowed: <= 0.15"):
        align(seen, experiment)


def test_motion_that_goes_on_stops_at_the_end_at_the_earliest(experiment, fake):
    seen = observe(output.run(Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.25})))
    stop = align(seen, experiment)[-1]
    assert stop.name == "time_stop"
    assert stop.simulated[0] == 0.25
    assert stop.gap[0] == 0.0  # the bound is 1.4 s


def test_interpolation_is_exact_for_what_is_linear():
    time, x = np.array([0.0, 0.1, 0.3]), np.linspace(0.0, 1.0, 6)
    values = 0.2 + time[:, None] + 0.5 * x[None, :]
    at_time, at_x = np.array([0.05, 0.05, 0.2, 0.2, 0.2]), np.array([0.1, 0.9, 0.0, 0.33, 1.1])
    found = on_points(time, x, values, at_time, at_x)
    np.testing.assert_allclose(found[:4], 0.2 + at_time[:4] + 0.5 * at_x[:4])
    assert found[4] == 0.0  # no grains beyond the domain
    early, late = np.array([-1.0]), np.array([9.0])
    assert on_points(time, x, values, early, x[:1])[0] == values[0, 0]
    assert on_points(time, x, values, late, x[:1])[0] == values[2, 0]
    assert on_points(time[:1], x, values[:1], late, x[1:2])[0] == values[0, 1]
