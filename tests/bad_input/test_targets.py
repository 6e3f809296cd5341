"""Places that cannot be written or entered: one line and exit status 2, before anything is computed."""

import errno
import json
import os
import stat
import tempfile
from contextlib import contextmanager
from pathlib import Path

import pytest
from blind_suite import make_wedges
from experiment_folder import write_experiment
from fake_simulation import FakeSimulation

from fvcollapse import verification
from fvcollapse.__main__ import main
from fvcollapse.case.case import Case
from fvcollapse.errors import OutputError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.files.targets import make_folder, refuse_bad_target
from fvcollapse.output import run as output

LONG = "x" * 300
NOBODY = 65534


@pytest.fixture(scope="module")
def made():
    """A folder that every user may enter, with a case, an experiment, a curve and a result."""
    with tempfile.TemporaryDirectory() as name, pytest.MonkeyPatch.context() as monkeypatch:
        folder = Path(name)
        folder.chmod(0o755)
        (folder / "case.toml").write_text("grid.cell_size = 0.035\ntime.end = 0.01\n")
        (folder / "front_curve.csv").write_text("0,0.2\n0.1,0.3\n")
        write_experiment(folder / "experiment")
        monkeypatch.setattr(output, "Simulation", FakeSimulation)
        case = Case().replace(**{"grid.cell_size": 0.035, "time.end": 0.005})
        output.run_case(case, folder / "run", quiet=True)
        make_wedges(monkeypatch, folder / "suite")
        (folder / "answers.json").write_text("{}")
        (folder / "file").write_text("")
        (folder / "locked").mkdir(mode=0o700)
        (folder / "read_only").mkdir(mode=0o555)
        yield folder


@pytest.fixture
def place(made, monkeypatch):
    """The same as the working folder."""
    monkeypatch.chdir(made)
    return made


def commands(target):
    """Command lines that write to a folder `target`."""
    return {
        "run": ["run", "case.toml", "--quiet", "--out", target],
        "plot": ["plot", "run", "--out", target],
        "import-curves": ["import-curves", "--front", "front_curve.csv", "--out", target],
        "sweep": ["sweep", "case.toml", "--vary", "time.end=0.01,0.02", "--out", target],
        "converge": ["converge", "case.toml", "--cell-size", "0.035", "0.03", "0.025"]
        + ["--quiet", "--out", target],
        "diagnose": ["diagnose", "experiment", "--out", target],
        "blind make": ["blind", "make", "--cases", "1", "--out", target],
    }


def commands_of_files(target):
    """Command lines that write a file `target` at their end."""
    score = ["blind", "score", "suite", "answers.json", "--labels", "suite.labels.json"]
    return {
        "verify": ["verify", "tilted_box", "--json", target],
        "verify markdown": ["verify", "tilted_box", "--markdown", target],
        "converge": ["converge", "case.toml", "--cell-size", "0.035", "0.03", "0.025"]
        + ["--quiet", "--out", "converged", "--json", target],
        "bench": ["bench", "--json", target],
        "score": [*score, "--json", target],
        "labels": ["blind", "make", "--cases", "1", "--out", "new", "--labels", target],
    }


@contextmanager
def as_nobody():
    """What a user may do who owns nothing here; root may write anywhere."""
    if os.geteuid() != 0:
        yield
        return
    os.seteuid(NOBODY)
    try:
        yield
    finally:
        os.seteuid(0)


@pytest.fixture
def no_computation(monkeypatch):
    """Nothing may be computed."""

    def compute(*arguments, **options):
        pytest.fail("computed before the target was refused")

    monkeypatch.setattr(output, "Simulation", compute)
    for module in ("blind.make", "studies.sweep", "studies.cache", "studies.members"):
        monkeypatch.setattr(f"fvcollapse.{module}.run_all", compute)
    monkeypatch.setattr("fvcollapse.verification.problem.solve", compute)
    monkeypatch.setattr("fvcollapse.studies.bench.run_member", compute)
    monkeypatch.setattr("fvcollapse.diagnosis.diagnose.analyse", compute)


def refused(capsys, arguments, words):
    """The command ends with exit status 2 and one line that holds the words."""
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1, error
    assert any(word in error for word in words), error


UNWRITABLE = {
    "below a file": (
        "file/target",
        ("Not a directory", "not a directory", "no such folder", "a file"),
    ),
    "name too long": (LONG, ("File name too long", "file name too long")),
    "name too long inside": (f"{LONG}/target", ("too long",)),
}
FORBIDDEN = {
    "may not be entered": ("locked/target", ("Permission denied", "permission denied")),
    "may not be written": ("read_only/target", ("Permission denied",)),
}


@pytest.mark.parametrize("name", UNWRITABLE)
@pytest.mark.parametrize("command", commands(""))
def test_folder_that_cannot_be_made(place, no_computation, capsys, command, name):
    target, words = UNWRITABLE[name]
    refused(capsys, commands(target)[command], words)


@pytest.mark.parametrize("name", UNWRITABLE)
@pytest.mark.parametrize("command", commands_of_files(""))
def test_file_that_cannot_be_written(place, no_computation, capsys, command, name):
    target, words = UNWRITABLE[name]
    refused(capsys, commands_of_files(target)[command], words)


@pytest.mark.skipif(not hasattr(os, "seteuid"), reason="permissions of POSIX")
@pytest.mark.parametrize("name", FORBIDDEN)
@pytest.mark.parametrize("command", commands(""))
def test_folder_without_permission(place, no_computation, capsys, command, name):
    target, words = FORBIDDEN[name]
    with as_nobody():
        refused(capsys, commands(target)[command], words)


@pytest.mark.skipif(not hasattr(os, "seteuid"), reason="permissions of POSIX")
@pytest.mark.parametrize("name", FORBIDDEN)
@pytest.mark.parametrize("command", commands_of_files(""))
def test_file_without_permission(place, no_computation, capsys, command, name):
    target, words = FORBIDDEN[name]
    (place / "converged").mkdir(exist_ok=True)
    (place / "converged").chmod(0o777)
    (place / "new").mkdir(exist_ok=True)
    (place / "new").chmod(0o777)
    with as_nobody():
        refused(capsys, commands_of_files(target)[command], words)


@pytest.mark.skipif(not hasattr(os, "seteuid"), reason="permissions of POSIX")
@pytest.mark.parametrize("arguments", [["plot", "locked"], ["plot", "locked/result.h5"]])
def test_results_in_a_folder_that_may_not_be_entered(place, capsys, arguments):
    with as_nobody():
        refused(capsys, arguments, ("permission denied", "no file but a folder"))


@pytest.mark.parametrize("command", ["plot", "sweep", "converge", "diagnose"])
def test_a_folder_where_a_file_will_be(place, no_computation, capsys, command):
    """The last file of a study is checked before the first run, also where results may be replaced."""
    last = {"plot": "volume.png", "sweep": "sweep.csv", "converge": "converge.csv"}
    out = f"{command}_out"
    (place / out / last.get(command, "report.html")).mkdir(parents=True)
    refused(capsys, [*commands(out)[command], "--force"], ("a folder",))


@pytest.mark.parametrize("command", commands_of_files(""))
def test_a_folder_or_a_device_for_a_file(place, no_computation, capsys, command):
    (place / "folder").mkdir(exist_ok=True)
    refused(capsys, commands_of_files("folder")[command], ("a folder", "directory"))
    if os.path.exists("/dev/null") and command != "labels":
        refused(capsys, commands_of_files("/dev/null")[command], ("a device or a pipe",))
        assert stat.S_ISCHR(os.stat("/dev/null").st_mode)


def test_read_only_disk_is_found_out_before_the_problems_are_solved(tmp_path, monkeypatch):
    monkeypatch.setattr(
        "fvcollapse.verification.problem.solve", lambda problem: pytest.fail("solved")
    )

    def read_only(folder):
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    monkeypatch.setattr("fvcollapse.files.targets.locked_temporary", read_only)
    with pytest.raises(OutputError, match="Read-only file system") as caught:
        verification.verify(["tilted_box"], tmp_path / "table.json")
    assert caught.value.exit_status == 2


@pytest.mark.parametrize("path", ["a\0b", "\ud800", "", "/"])
def test_paths_that_are_none(path):
    with pytest.raises(OutputError):
        refuse_bad_target(path)


def test_nothing_is_left_behind_by_the_proof(tmp_path):
    make_folder(tmp_path / "new" / "folder", "table.json")
    refuse_bad_target(tmp_path / "table.json")
    refuse_bad_target(None)
    assert list((tmp_path / "new" / "folder").iterdir()) == []
    assert [path.name for path in tmp_path.iterdir()] == ["new"]


# -- temporary files ---------------------------------------------------------------------------------


def test_temporary_file_is_new_and_private_from_its_first_byte(tmp_path, monkeypatch):
    """What waits for the writer at the old name of the temporary file is neither followed nor used."""
    victim = tmp_path / "victim"
    victim.write_text("precious")
    (tmp_path / ".labels.json.tmp").symlink_to(victim)
    opened = []
    real = os.open

    def watch(path, flags, mode=0o777, **options):
        opened.append((Path(path), flags, mode))
        return real(path, flags, mode, **options)

    monkeypatch.setattr(os, "open", watch)
    write_atomic(tmp_path / "labels.json", b"{}", private=True)
    (temporary, flags, mode), *_ = opened
    assert flags & os.O_EXCL
    assert flags & os.O_CREAT
    assert flags & os.O_NOFOLLOW
    assert mode == 0o600
    assert temporary.parent == tmp_path
    assert victim.read_text() == "precious"
    assert stat.S_IMODE((tmp_path / "labels.json").stat().st_mode) == 0o600


def test_a_planted_link_at_the_temporary_name_is_passed_over(tmp_path, monkeypatch):
    victim = tmp_path / "victim"
    victim.write_text("precious")
    monkeypatch.setattr(tempfile, "_get_candidate_names", lambda: iter(["known", "next"]))
    (tmp_path / ".fvcollapse-known.tmp").symlink_to(victim)
    write_atomic(tmp_path / "table.json", b"{}")
    assert victim.read_text() == "precious"
    assert (tmp_path / "table.json").read_bytes() == b"{}"


def test_ordinary_files_follow_the_umask(tmp_path):
    before = os.umask(0o027)
    try:
        write_atomic(tmp_path / "table.json", b"{}")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "table.json").stat().st_mode) == 0o640


def test_a_name_of_255_bytes_is_written(tmp_path):
    write_atomic(tmp_path / ("é" * 127), b"{}")
    assert json.loads((tmp_path / ("é" * 127)).read_text()) == {}


def test_truths_of_sealed_cases_are_private(tmp_path, monkeypatch):
    modes = []

    def keep(case_text, forces, path):
        work = path.parents[1]
        modes.append(stat.S_IMODE(work.stat().st_mode))
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("0.3")

    from fvcollapse.blind import make as making
    from fvcollapse.blind.labels import Draw

    make_wedges(monkeypatch, tmp_path / "other", classes=["none"])
    monkeypatch.setattr(making, "keep_truth", keep)
    making.make(1, tmp_path / "suite", draw=Draw(classes=["none"], seed=1))
    assert set(modes) == {0o700}
