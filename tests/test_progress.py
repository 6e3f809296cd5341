"""What is told while something runs: bars on a terminal, and once that the solver is compiled."""

import io
import sys

import pytest
from fake_terminal import Terminal

from fvcollapse.case.case import Case
from fvcollapse.console.bars import progress_bar, runs_bar
from fvcollapse.output import compilation
from fvcollapse.output import run as output


@pytest.fixture(scope="module")
def case():
    return Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.3})


def test_progress_bar_only_on_a_terminal(case, monkeypatch):
    for stream, quiet, shown in (
        (Terminal(), False, True),
        (Terminal(), True, False),
        (io.StringIO(), False, False),
    ):
        monkeypatch.setattr("sys.stderr", stream)
        with progress_bar(case, 0.0, quiet) as bar:
            bar.set_postfix_str("step 3, dt 1.0e-03 s", refresh=False)
            bar.update(0.15)
            bar.refresh()
        text = stream.getvalue()
        assert bool(text) == shown
        assert not shown or ("0.150/0.300 s" in text and "step 3, dt" in text)


@pytest.mark.parametrize("columns", ["80", "0"])
def test_a_bar_over_runs_counts_them(columns, monkeypatch):
    """Also where the terminal says that it has no columns."""
    monkeypatch.setenv("COLUMNS", columns)
    monkeypatch.setattr("sys.stderr", Terminal())
    with runs_bar(4, quiet=False) as bar:
        bar.update()
        bar.refresh()
        assert "1/4" in sys.stderr.getvalue()


@pytest.mark.parametrize("stream", [Terminal, io.StringIO])
@pytest.mark.parametrize(
    ("compiled", "quiet", "told"), [(False, False, 1), (True, False, 0), (False, True, 0)]
)
def test_the_first_start_says_once_that_it_compiles(compiled, quiet, told, stream, monkeypatch):
    """Also where stderr is a file: it would be silent for a minute."""
    monkeypatch.setattr(compilation, "TOLD", [])
    monkeypatch.setattr(compilation, "is_compiled", lambda: compiled)
    monkeypatch.setattr("sys.stderr", stream())
    compilation.tell_compilation(quiet)
    compilation.tell_compilation(quiet)
    assert sys.stderr.getvalue().count(compilation.NOTICE) == told


@pytest.mark.parametrize("compiled", [False, True])
def test_the_log_of_a_run_says_that_it_compiles(compiled, case, tmp_path, monkeypatch):
    monkeypatch.setattr(compilation, "is_compiled", lambda: compiled)
    output.run_case(case.replace(**{"time.end": 0.002}), tmp_path, quiet=True)
    text = (tmp_path / "run.log").read_text(encoding="utf-8")
    assert (compilation.NOTICE in text) == (not compiled)


def test_kernels_that_have_run_are_compiled(case, tmp_path):
    output.run_case(case.replace(**{"time.end": 0.002}), tmp_path, quiet=True)
    assert compilation.is_compiled()
