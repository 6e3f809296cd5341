"""`time.stop_at_rest`: a run ends at the first landing at which its pile has rested, resumed or not."""

import shutil

import numpy as np
import pytest
from fake_simulation import FakeSimulation
from same_result import differences

from fvcollapse import open_result
from fvcollapse.case.case import Case
from fvcollapse.output import run as output
from fvcollapse.output.rest import rests

END = {"time.end": 1.6}


@pytest.fixture(autouse=True)
def fake(monkeypatch):
    monkeypatch.setattr(output, "Simulation", FakeSimulation)


@pytest.fixture(scope="module")
def case():
    """It slows down to 1 mm/s at about 0.9 s."""
    changes = {"time.end": 1.5, "time.field_interval": 0.4, "time.stop_at_rest": True}
    return Case().replace(**{"grid.cell_size": 0.02}, **changes)


def going_on(case):
    return case.replace(**{"time.stop_at_rest": False})


@pytest.fixture(scope="module")
def rested(case, tmp_path_factory):
    """The folder of the run that ends at rest, which no test changes."""
    folder = tmp_path_factory.mktemp("rested")
    output.run_case(case, folder, quiet=True, simulate=FakeSimulation)
    return folder


@pytest.fixture(scope="module")
def whole(case, tmp_path_factory):
    """The folder of the run that goes on, which no test changes."""
    folder = tmp_path_factory.mktemp("whole")
    output.run_case(going_on(case), folder, quiet=True, simulate=FakeSimulation)
    return folder


@pytest.fixture
def parts(rested, tmp_path):
    """A copy of the run that ended at rest."""
    return shutil.copytree(rested, tmp_path / "parts")


def same(one, other):
    names = ("result.h5", "checkpoint.h5")
    return [line for name in names for line in differences(one / name, other / name)]


def test_a_run_ends_at_the_first_landing_at_rest(rested, whole):
    result, whole = open_result(rested), open_result(whole)
    landings = whole.profiles.time
    at_rest = [
        time
        for time in landings[landings >= 0.1]
        if whole.max_speed[(whole.time >= time - 0.1) & (whole.time <= time)].max() < 1.0e-3
    ]
    assert 0.8 < at_rest[0] < 1.2
    assert result.time[-1] == at_rest[0]
    rows = len(result.time)
    for name, values in result.series.items():
        if name != "front_velocity":  # its window is cut at the end
            np.testing.assert_array_equal(values, whole.series[name][:rows])
    assert result.profiles.time[-1] == result.field_times[-1] == at_rest[0]  # the deposit is stored


def test_the_result_says_that_it_ended_at_rest_and_is_complete(case, rested):
    result = open_result(rested)
    assert (result.complete, result.status) == (True, "complete")
    assert result.ended_at_rest
    assert result.summary()["ended_at_rest"]
    assert "of 1.5 s (ended at rest)" in result.summary_table()
    short = output.run(case.replace(**{"time.end": 0.4}))
    assert short.complete
    assert not short.ended_at_rest
    assert "rest)" not in short.summary_table()


@pytest.mark.parametrize("time", [0.5, 0.95])
def test_interrupted_and_resumed_it_ends_where_the_uninterrupted_one_does(
    case, time, rested, monkeypatch, tmp_path
):
    class Stopped(FakeSimulation):
        def advance(self, time_limit):
            if self.state.time >= time:
                raise KeyboardInterrupt
            return super().advance(time_limit)

    with monkeypatch.context() as patch:
        patch.setattr(output, "Simulation", Stopped)
        with pytest.raises(KeyboardInterrupt):
            output.run_case(case, tmp_path / "parts", quiet=True)
    output.run_case(case, tmp_path / "parts", resume=True, quiet=True)
    assert same(rested, tmp_path / "parts") == []


def test_killed_between_checkpoint_and_result_it_goes_no_further(case, rested, parts):
    (parts / "result.h5").unlink()
    output.run_case(case, parts, resume=True, quiet=True)
    assert same(rested, parts) == []


def test_a_run_that_ended_at_rest_goes_on_where_it_shall(case, whole, parts):
    result = output.run_case(going_on(case), parts, resume=True, quiet=True)
    assert result.time[-1] == 1.5
    assert not result.ended_at_rest
    assert same(whole, parts) == []


def test_a_run_that_ended_at_rest_has_reached_every_later_end(case, rested, parts, monkeypatch):
    first = open_result(rested)
    monkeypatch.setattr(output, "Simulation", None)  # a second run would need it
    for later in (case, case.replace(**END)):
        again = output.run_case(later, parts, resume=True, quiet=True)
        assert again.time[-1] == first.time[-1]
    earlier = going_on(case).replace(**{"time.end": 0.5})
    assert output.run_case(earlier, parts, resume=True, quiet=True).complete


def test_grains_behind_a_closed_gate_do_not_rest(case):
    closed = case.replace(**{"gate.speed": 0.0})
    assert output.run(closed).time[-1] == 1.5
    time = np.linspace(0.0, 0.5, 51)
    series = {"time": time, "max_speed": 0.0 * time, "max_thickness": 0.14 + 0.0 * time}
    assert rests(case, series)
    assert not rests(closed, series)
    late = case.replace(**{"effects.gate.speed": 2.3, "effects.gate.delay": 0.4})
    assert not rests(late, series)  # the gate is gone since 40 ms
