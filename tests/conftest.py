"""What all tests share: the same random examples in every run, one thread, and no window for a figure."""

import os
import signal

import hypothesis
import pytest

# under nohup too the tests are about signals that are not ignored
if signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
    signal.signal(signal.SIGHUP, signal.SIG_DFL)

os.environ.setdefault("MPLBACKEND", "Agg")
# one process for each core: more threads only wait for each other, and move the last digit
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("MKL_NUM_THREADS", "1")
# of two workers each compiles the half of the kernels that the other reaches last
WORKER = os.environ.get("PYTEST_XDIST_WORKER", "")
if WORKER:
    from fvcollapse.output.compilation import FIRST, HALF, SECOND

    os.environ[HALF] = SECOND if int(WORKER[2:]) % 2 else FIRST


@pytest.fixture(scope="session", autouse=True)
def kernels():
    """Where two workers find no kernels on the disk, one begins with the half that the other reaches last."""
    if WORKER and os.environ[HALF] == SECOND:
        from fvcollapse.case.case import Case
        from fvcollapse.output.compilation import share_compilation

        for effects in ({}, {"effects.thin_layer.length": 1.0}):
            share_compilation(Case().replace(**effects))


# Derandomised: a test that fails on one machine fails on all. No deadline: compilation is slow.
hypothesis.settings.register_profile("fvcollapse", derandomize=True, deadline=None)
hypothesis.settings.load_profile("fvcollapse")


@pytest.fixture(scope="session", autouse=True)
def no_wait_for_the_disk():
    """Files of tests need not outlive the power: forcing each to the disk takes ten times as long as writing it.

    That it is asked for is tested by a disk that is full when it is (`bad_input/test_result_files.py`). Processes that
    tests start still force theirs.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda handle: None)
        yield


@pytest.fixture
def started(monkeypatch):
    """Cases that the fake solver starts from t = 0, in order."""
    from fake_simulation import counted

    from fvcollapse.output import run as output

    cases = []
    monkeypatch.setattr(output, "Simulation", counted(cases))
    return cases
