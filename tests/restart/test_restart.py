"""A run stopped at any instant and resumed ends as the uninterrupted one, to the last bit."""

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
from fake_simulation import FakeSimulation
from same_result import differences

from fvcollapse import open_result
from fvcollapse.case.case import Case
from fvcollapse.errors import InputError, NumericalError
from fvcollapse.output import run as output
from fvcollapse.output.checkpoint import read_checkpoint
from fvcollapse.output.recorder import schedule

SCRIPT = Path(__file__).with_name("run_for_kill.py")


@pytest.fixture(scope="module")
def case():
    return Case().replace(
        **{
            "grid.cell_size": 0.02,
            "time.end": 0.2,
            "time.output_times": [0.0333],
            "time.field_interval": 0.05,
        }
    )


@pytest.fixture
def fake(monkeypatch):
    monkeypatch.setattr(output, "Simulation", FakeSimulation)


@pytest.fixture(scope="module")
def whole(case, tmp_path_factory):
    """The folder of the uninterrupted run, which no test changes."""
    folder = tmp_path_factory.mktemp("whole")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(output, "Simulation", FakeSimulation)
        output.run_case(case, folder, quiet=True)
    return folder


@pytest.fixture
def finished(whole, tmp_path):
    """A copy of it."""
    return shutil.copytree(whole, tmp_path / "finished")


def stop_at(step, error):
    """A simulation whose step number `step` raises after it has spoilt the state."""

    class Stopped(FakeSimulation):
        def advance(self, time_limit):
            if self.state.step + 1 == step:
                self.state.level_set[:] = np.nan
                self.state.time = -1.0
                raise error
            return super().advance(time_limit)

    return Stopped


@pytest.mark.parametrize("step", [1, 17])
@pytest.mark.parametrize(
    "error", [KeyboardInterrupt(), NumericalError("no pressure", "in the solve", 0.1)]
)
def test_stopped_and_resumed_is_uninterrupted(
    case, whole, fake, monkeypatch, tmp_path, step, error
):
    with monkeypatch.context() as patch:
        patch.setattr(output, "Simulation", stop_at(step, error))
        with pytest.raises(type(error)):
            output.run_case(case, tmp_path / "parts", quiet=True)
    partial = open_result(tmp_path / "parts")
    assert not partial.complete
    assert len(partial.steps["dt"]) == step - 1  # nothing before the failure is lost
    assert np.isfinite(partial.profiles.thickness).all()
    output.run_case(case, tmp_path / "parts", resume=True, quiet=True)
    for name in ("result.h5", "checkpoint.h5"):
        assert differences(whole / name, tmp_path / "parts" / name) == []
    xdmf = tmp_path / "parts/result.xdmf"
    assert (whole / xdmf.name).read_bytes() == xdmf.read_bytes()


def test_stopped_many_times_is_uninterrupted(case, whole, fake, monkeypatch, tmp_path):
    for step in range(2, 60, 8):
        with monkeypatch.context() as patch, contextlib.suppress(KeyboardInterrupt):
            patch.setattr(output, "Simulation", stop_at(step, KeyboardInterrupt()))
            output.run_case(case, tmp_path / "parts", resume=True, quiet=True)
    output.run_case(case, tmp_path / "parts", resume=True, quiet=True)
    assert differences(whole / "result.h5", tmp_path / "parts/result.h5") == []


def test_extended_run_is_the_longer_run(case, fake, tmp_path):
    """The field at the first end is not in the schedule of the longer run, and goes."""
    longer = case.replace(**{"time.end": 0.26})
    output.run_case(longer, tmp_path / "whole", quiet=True)
    output.run_case(case.replace(**{"time.end": 0.12}), tmp_path / "parts", quiet=True)
    assert open_result(tmp_path / "parts").field_times[-1] == 0.12
    output.run_case(longer, tmp_path / "parts", resume=True, quiet=True)
    assert differences(tmp_path / "whole/result.h5", tmp_path / "parts/result.h5") == []


def test_complete_result_is_left_alone(case, fake, finished):
    before = {p.name: p.read_bytes() for p in finished.glob("*.h5")}
    assert output.run_case(case, finished, resume=True, quiet=True).complete
    shorter = case.replace(**{"time.end": 0.1, "time.output_interval": 0.03})
    assert output.run_case(shorter, finished, resume=True, quiet=True).complete
    assert before == {p.name: p.read_bytes() for p in finished.glob("*.h5")}
    assert "nothing to do" in (finished / "run.log").read_text()


def test_resume_in_an_empty_folder_starts_from_zero(case, whole, fake, tmp_path):
    output.run_case(case, tmp_path / "a" / "b", resume=True, quiet=True)
    assert differences(tmp_path / "a/b/result.h5", whole / "result.h5") == []


def test_run_without_resume_refuses_what_is_there(case, fake, finished):
    (finished / "result.h5").rename(finished / "moved.h5")
    with pytest.raises(InputError, match=r"checkpoint.h5.*--resume"):
        output.run_case(case, finished, quiet=True)
    (finished / "moved.h5").rename(finished / "result.h5")
    with pytest.raises(InputError, match=r"result.h5.*--resume"):
        output.run_case(case, finished, quiet=True)


@pytest.mark.parametrize(
    ("key", "value"),
    [("rheology.mu_1", 0.4), ("effects.lateral_friction", {}), ("front.thickness", 0.004)],
)
@pytest.mark.parametrize("left", ["result.h5", "checkpoint.h5"])
def test_resume_with_another_case_names_the_key(case, fake, finished, key, value, left):
    for name in {"result.h5", "checkpoint.h5"} - {left}:
        (finished / name).unlink()
    before = (finished / left).read_bytes()
    with pytest.raises(InputError, match=key):
        output.run_case(case.replace(**{key: value}), finished, resume=True, quiet=True)
    assert (finished / left).read_bytes() == before


def test_checkpoint_of_the_end_without_result_only_needs_the_result(case, fake, finished):
    """Killed between the two last files."""
    before = (finished / "result.h5").rename(finished / "before.h5")
    output.run_case(case, finished, resume=True, quiet=True)
    assert differences(before, finished / "result.h5", ignore=()) == []


def test_state_keeps_every_bit(case, whole, fake):
    job = output.Job(case)
    with output.progress_bar(case, 0.0, quiet=True) as bar:
        job.march(bar)
    stored = read_checkpoint(whole / "checkpoint.h5").state
    for name, value in job.state.entries().items():
        assert isinstance(getattr(stored, name), int) == isinstance(value, int)
        assert np.array_equal(getattr(stored, name), value)


def test_times_are_multiples_and_land_exactly(case, fake):
    case = case.replace(**{"time.end": 0.3, "time.output_times": [0.1 + 1e-12, 0.777]})
    landings = schedule(case)
    result = output.run(case)
    assert [item.time for item in landings if item.profile] == result.profiles.time.tolist()
    assert [item.time for item in landings if item.field] == result.field_times.tolist()
    assert 7 * 0.02 in result.profiles.time
    assert len(result.profiles.time) == 16
    np.testing.assert_allclose(result.field_times, np.arange(7) * 0.05, atol=1e-12)


# -- killed for good ---------------------------------------------------------------------------


def start(case, folder, *kind):
    """A run in another process, with a checkpoint after every step."""
    folder.mkdir(exist_ok=True)
    (folder / "case.toml").write_text(case.to_toml())
    root = str(Path(output.__file__).parents[1])
    paths = os.pathsep.join([root, os.environ.get("PYTHONPATH", "")])
    command = [sys.executable, str(SCRIPT), str(folder / "case.toml"), str(folder), *kind]
    return subprocess.Popen(command, env=os.environ | {"PYTHONPATH": paths})


def wait_for_steps(folder, process, number):
    """Wait until the log shows `number` further checkpoints."""
    log, begun = folder / "run.log", None
    deadline = time.monotonic() + 500
    while process.poll() is None and time.monotonic() < deadline:
        count = log.read_text().count("checkpoint at") if log.exists() else 0
        begun = count if begun is None else begun
        if count >= begun + number:
            return
        time.sleep(0.002)


def kill_and_resume(case, tmp_path, *kind):
    """Run with three SIGKILLs, both files being readable after each, and then to the end."""
    folder = tmp_path / "killed"
    kills = 0
    for delay in (2, 3, 5):
        process = start(case, folder, *kind)
        wait_for_steps(folder, process, delay)
        if process.poll() is None:
            time.sleep(0.001 * delay)
            process.send_signal(signal.SIGKILL)
            kills += 1
            process.wait()
            read_checkpoint(folder / "checkpoint.h5")
            assert not open_result(folder).complete
        else:
            assert process.returncode == 0
    output.run_case(case, folder, resume=True, quiet=True)
    return folder, kills


@pytest.mark.slow
def test_sigkill_and_resume_is_uninterrupted(case, whole, fake, tmp_path):
    folder, kills = kill_and_resume(case, tmp_path, "fake")
    assert kills >= 2
    assert differences(whole / "result.h5", folder / "result.h5") == []


def test_sigkill_and_resume_of_the_solver_is_uninterrupted(case, tmp_path):
    case = case.replace(**{"time.end": 0.1, "effects.lateral_friction": {}})
    output.run_case(case, tmp_path / "whole", quiet=True)
    folder, kills = kill_and_resume(case, tmp_path)
    assert kills >= 2
    assert differences(tmp_path / "whole/result.h5", folder / "result.h5") == []


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signal_leaves_a_checkpoint_of_the_present(case, fake, monkeypatch, tmp_path, number):
    class Signalled(FakeSimulation):
        def advance(self, time_limit):
            if self.state.step == 11:
                os.kill(os.getpid(), number)
            return super().advance(time_limit)

    before = signal.getsignal(number)
    monkeypatch.setattr(output, "Simulation", Signalled)
    with pytest.raises(KeyboardInterrupt):
        output.run_case(case, tmp_path, quiet=True)
    assert read_checkpoint(tmp_path / "checkpoint.h5").state.step == 12
    assert signal.getsignal(number) is before


def test_second_interrupt_stops_at_once(case, fake, monkeypatch, tmp_path):
    class Impatient(FakeSimulation):
        def advance(self, time_limit):
            if self.state.step == 11:
                os.kill(os.getpid(), signal.SIGINT)
                os.kill(os.getpid(), signal.SIGINT)
            return super().advance(time_limit)

    monkeypatch.setattr(output, "Simulation", Impatient)
    with pytest.raises(KeyboardInterrupt):
        output.run_case(case, tmp_path, quiet=True)
    assert read_checkpoint(tmp_path / "checkpoint.h5").state.step == 11


def test_hdf5_keeps_no_dates(case, whole, fake, tmp_path):
    """Two runs differ in nothing but wall-clock times."""
    output.run_case(case, tmp_path, quiet=True)
    with h5py.File(tmp_path / "result.h5") as file:
        assert "date" not in " ".join(file.attrs)
    assert differences(tmp_path / "result.h5", whole / "result.h5") == []
