"""Broken files, full disks, unwritable folders: one clear line, and nothing lost."""

import contextlib
import errno
import logging
import os
import pickle
import shutil

import h5py
import numpy as np
import pytest
from fake_simulation import FakeSimulation
from same_result import differences

from fvcollapse import open_result
from fvcollapse.case.case import Case
from fvcollapse.errors import InputError, OutputError
from fvcollapse.output import run as output
from fvcollapse.output.checkpoint import read_checkpoint
from fvcollapse.output.run_folder import usable_checkpoint

try:
    import fcntl
except ImportError:
    fcntl = None


@pytest.fixture(scope="module")
def case():
    return Case().replace(**{"grid.cell_size": 0.03, "time.end": 0.06, "time.field_interval": 0.03})


@pytest.fixture(scope="module")
def finished(case, tmp_path_factory):
    folder = tmp_path_factory.mktemp("finished") / "run"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(output, "Simulation", FakeSimulation)
        output.run_case(case, folder, quiet=True)
    return folder


@pytest.fixture
def folder(finished, monkeypatch, tmp_path):
    monkeypatch.setattr(output, "Simulation", FakeSimulation)
    return shutil.copytree(finished, tmp_path / "run")


def truncate(part):
    def spoil(path):
        data = path.read_bytes()
        path.write_bytes(data[: int(len(data) * part)])

    return spoil


def edit(change):
    def spoil(path):
        with h5py.File(path, "r+") as file:
            change(file)

    return spoil


def remove(name):
    return edit(lambda file: file.__delitem__(name))


def replace(name, values):
    def change(file):
        del file[name]
        file[name] = values

    return edit(change)


def set_attribute(name, value):
    return edit(lambda file: file.attrs.__setitem__(name, value))


def flip_bytes(path):
    data = bytearray(path.read_bytes())
    middle = len(data) // 2
    data[middle : middle + 3000] = bytes(255 - b for b in data[middle : middle + 3000])
    path.write_bytes(bytes(data))


class Trap:
    """Unpickling it would leave a trace."""

    def __reduce__(self):
        return os.mkdir, ("unpickled",)


BROKEN = {
    "empty": lambda path: path.write_bytes(b""),
    "text": lambda path: path.write_text("not HDF5\n" * 1000),
    "zeros": lambda path: path.write_bytes(bytes(20000)),
    "pickle": lambda path: path.write_bytes(pickle.dumps(Trap())),
    "only_the_signature": truncate(0.001),
    "half": truncate(0.5),
    "one_byte_short": truncate(0.9999),
    "foreign_hdf5": lambda path: h5py.File(path, "w").close(),
    "other_format": set_attribute("format", "something else"),
    "format_is_a_number": set_attribute("format", 3),
    "case_is_not_toml": set_attribute("case", "[geometry"),
    "case_has_unknown_key": set_attribute("case", "[geometry]\nheigth_0 = 1.0\n"),
    "case_is_an_array": set_attribute("case", np.arange(3)),
    "case_missing": edit(lambda file: file.attrs.__delitem__("case")),
    "series_missing": remove("series"),
    "one_series_missing": remove("series/runout"),
    "series_is_a_number": replace("series/runout", 3.0),
    "series_too_short": replace("series/runout", np.zeros(2)),
    "steps_missing": remove("steps"),
    "step_log_incomplete": remove("steps/sweeps"),
    "profiles_missing": remove("profiles"),
    "profiles_of_wrong_shape": replace("profiles/thickness", np.zeros((2, 3))),
    "field_missing": remove("fields/0"),
    "field_without_level_set": remove("fields/1/level_set"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_result_is_one_line(folder, name):
    BROKEN[name](folder / "result.h5")
    with pytest.raises(InputError) as error:
        open_result(folder)
    text = str(error.value)
    assert "\n" not in text
    assert "result.h5" in text
    assert error.value.exit_status == 2
    assert not os.path.exists("unpickled")


def test_a_result_older_than_a_series_is_read(folder):
    """What an effect added later is zero in a file that does not know it."""
    remove("series/work_gate")(folder / "result.h5")
    result = open_result(folder)
    assert result.work_gate.shape == result.time.shape
    assert not result.work_gate.any()


def test_missing_result(tmp_path):
    for path in (tmp_path / "nothing.h5", tmp_path):
        with pytest.raises(InputError, match=r"(?i)no such file"):
            open_result(path)


def test_flipped_bytes_never_crash(folder):
    """HDF5 has no checksum of everything: damage may pass, but nothing else may be raised."""
    flip_bytes(folder / "result.h5")
    with contextlib.suppress(InputError):
        result = open_result(folder)
        for index in range(len(result.field_times)):
            result.field(index)


def test_field_that_breaks_later_is_one_line(folder):
    result = open_result(folder)
    truncate(0.5)(folder / "result.h5")
    with pytest.raises(InputError, match="result.h5"):
        result.field(0)


# what is not in a result and must be in a checkpoint, besides
BROKEN_CHECKPOINT = BROKEN | {
    "state_missing": remove("state"),
    "field_of_the_state_missing": remove("state/u"),
    "state_of_wrong_shape": replace("state/w", np.zeros((3, 3))),
    "scalar_missing": edit(lambda file: file["state"].attrs.__delitem__("dt")),
    "record_of_another_time": edit(lambda file: file["state"].attrs.__setitem__("time", 0.01)),
}


@pytest.mark.parametrize("name", sorted(BROKEN_CHECKPOINT))
def test_broken_checkpoint_is_one_line_and_not_used(folder, caplog, name):
    path = folder / "checkpoint.h5"
    BROKEN_CHECKPOINT[name](path)
    with pytest.raises(InputError) as error:
        read_checkpoint(path)
    assert "\n" not in str(error.value)
    assert usable_checkpoint(folder, logging.getLogger("fvcollapse.test")) is None
    assert "checkpoint not usable, the run starts from t = 0: " in caplog.text


# of the file, of its header, of the state: what follows is the same for all
@pytest.mark.parametrize("name", ["half", "case_missing", "state_missing"])
def test_broken_checkpoint_restarts_from_zero_with_a_warning(case, folder, tmp_path, name):
    whole = (folder / "result.h5").rename(tmp_path / "whole.h5")
    BROKEN_CHECKPOINT[name](folder / "checkpoint.h5")
    output.run_case(case, folder, resume=True, quiet=True)
    log = (folder / "run.log").read_text()
    assert "WARNING checkpoint not usable" in log
    assert log.count("start from t = 0") == 2
    assert differences(whole, folder / "result.h5") == []


def test_broken_result_beside_a_good_checkpoint_is_rewritten(case, folder, tmp_path):
    (tmp_path / "whole.h5").write_bytes((folder / "result.h5").read_bytes())
    truncate(0.5)(folder / "result.h5")
    output.run_case(case, folder, resume=True, quiet=True)
    assert "WARNING previous result not usable" in (folder / "run.log").read_text()
    assert differences(tmp_path / "whole.h5", folder / "result.h5") == []


# -- disks that are full, folders that cannot be written ---------------------------------------


def fill_disk(monkeypatch, after):
    """Let `after` files be forced to the disk, then none."""
    real, count = os.fsync, []

    def fsync(handle):
        count.append(handle)
        if len(count) > after:
            raise OSError(errno.ENOSPC, "No space left on device")
        real(handle)

    monkeypatch.setattr(os, "fsync", fsync)


def test_full_disk_at_the_start(case, monkeypatch, tmp_path):
    monkeypatch.setattr(output, "Simulation", FakeSimulation)
    fill_disk(monkeypatch, 0)
    with pytest.raises(OutputError, match="No space left on device") as error:
        output.run_case(case, tmp_path, quiet=True)
    assert "\n" not in str(error.value)
    assert {path.name for path in tmp_path.iterdir()} == {"run.log"}


@pytest.mark.parametrize("after", range(6, 13))
def test_full_disk_keeps_the_previous_files(case, finished, monkeypatch, tmp_path, after):
    """Six at the start (file and folder, three files); then full at a moment of the end."""
    monkeypatch.setattr(output, "Simulation", FakeSimulation)
    with monkeypatch.context() as patch:
        fill_disk(patch, after)
        if after < 12:
            with pytest.raises(OutputError, match="No space left on device") as error:
                output.run_case(case, tmp_path / "full", quiet=True)
            assert error.value.exit_status == 1
        else:
            output.run_case(case, tmp_path / "full", quiet=True)
    names = {path.name for path in (tmp_path / "full").iterdir()}
    assert names == {"result.h5", "result.xdmf", "checkpoint.h5", "run.log"}
    assert open_result(tmp_path / "full").complete == (after > 8)
    read_checkpoint(tmp_path / "full/checkpoint.h5")
    output.run_case(case, tmp_path / "full", resume=True, quiet=True)
    assert differences(finished / "result.h5", tmp_path / "full/result.h5") == []


def test_full_disk_under_the_log_alone_stops_nothing(case, monkeypatch, tmp_path):
    monkeypatch.setattr(output, "Simulation", FakeSimulation)
    if not os.path.exists("/dev/full"):
        pytest.skip("no /dev/full here")
    (tmp_path / "run.log").symlink_to("/dev/full")
    assert output.run_case(case, tmp_path, quiet=True).complete


def test_folder_under_a_file(case, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be written") as error:
        output.run_case(case, tmp_path / "file" / "run", quiet=True)
    assert error.value.exit_status == 2


def test_folder_that_is_a_file(case, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be written"):
        output.run_case(case, tmp_path / "file", quiet=True)


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may write anywhere")
def test_folder_without_permission(case, tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(OutputError, match="Permission denied"):
        output.run_case(case, tmp_path, quiet=True)


@pytest.mark.skipif(fcntl is None, reason="no such locks on this system")
@pytest.mark.parametrize("name", ["result.h5", "checkpoint.h5"])
def test_file_that_another_program_has_locked_is_told_and_stays(case, folder, name):
    """A run that is resumed does not begin again because it cannot read now what it has."""
    before = {path.name: path.read_bytes() for path in folder.glob("*.h5")}
    longer = case.replace(**{"time.end": 0.1})
    with open(folder / name, "rb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)  # as HDF5 does for a writer
        for options in ({"resume": True}, {"force": True}):
            with pytest.raises(InputError, match=f"{name}.*locked.*HDF5_USE_FILE_LOCKING"):
                output.run_case(longer, folder, quiet=True, **options)
    assert {path.name: path.read_bytes() for path in folder.glob("*.h5")} == before
    assert output.run_case(longer, folder, resume=True, quiet=True).time[-1] == 0.1


def test_result_that_is_only_read_elsewhere_is_replaced(case, folder):
    longer = case.replace(**{"time.end": 0.1})
    with h5py.File(folder / "result.h5", "r") as file:
        assert output.run_case(longer, folder, resume=True, quiet=True).complete
        assert file["series/time"][-1] == case.time.end  # what was opened stays what it was
