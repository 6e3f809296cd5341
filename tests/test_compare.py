"""`fvcollapse compare`: a run beside another run, and beside an experiment."""

import csv

import numpy as np
import pytest

import fvcollapse
from fvcollapse.__main__ import main
from fvcollapse.measure.comparison import between_runs

COARSE = {"grid.cell_size": 0.03, "time.end": 0.06, "time.output_interval": 0.02}
SETTINGS = "[geometry]\nslope_angle_deg = 22\nheight_0 = 0.14\nlength_0 = {}\n"


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    case = fvcollapse.load_case("runs/collapse_22deg_w10cm.toml").replace(**COARSE)
    fvcollapse.run(case, folder / "given")
    fvcollapse.run(case.replace(**{"rheology.mu_1": 0.3}), folder / "weak")
    return folder


def experiment(folder, result, shift=0.01, length=0.2):
    """An experiment whose front is that of a run, less `shift`."""
    folder.mkdir()
    (folder / "experiment.toml").write_text(SETTINGS.format(length))
    time, front = result.series["time"], result.series["front_position"]
    places = np.linspace(0, len(time) - 1, 5).astype(int)
    lines = [f"{time[n]},{front[n] - shift},0.005" for n in places]
    (folder / "front.csv").write_text("\n".join(["t_s,x_front_m,sigma_m", *lines]) + "\n")
    return folder


def table(folder):
    with (folder / "differences.csv").open(encoding="utf-8", newline="") as file:
        return {row["observable"]: row for row in csv.DictReader(file)}


def test_two_runs(runs, tmp_path, capsys):
    given, weak = runs / "given", runs / "weak"
    assert main(["compare", str(given), str(weak), "--out", str(tmp_path / "out")]) == 0
    printed = capsys.readouterr().out
    rows = table(tmp_path / "out")
    first, second = (fvcollapse.open_result(path) for path in (given, weak))
    gap = first.series["runout"][-1] - second.series["runout"][-1]
    assert float(rows["runout"]["difference"]) == pytest.approx(gap)
    assert float(rows["rms difference of profiles"]["difference"]) > 0.0
    assert rows["rms difference of profiles"]["first"] == ""
    assert (tmp_path / "out" / "comparison.png").stat().st_size > 10_000
    assert "rms difference of front" in printed
    assert "given" in printed.splitlines()[0]


def test_a_run_is_equal_to_itself(runs):
    result = fvcollapse.open_result(runs / "given")
    assert all(row.difference in (None, 0.0) for row in between_runs(result, result))


def test_a_run_and_an_experiment(runs, tmp_path, capsys):
    result = fvcollapse.open_result(runs / "given")
    beads = experiment(tmp_path / "beads", result)
    assert main(["compare", str(runs / "given"), str(beads), "--out", str(tmp_path / "out")]) == 0
    row = table(tmp_path / "out")["rms difference of front"]
    assert float(row["difference"]) == pytest.approx(0.01, rel=1e-6)
    assert float(row["uncertainty"]) == pytest.approx(0.005)


def test_an_experiment_of_another_set_up_is_refused(runs, tmp_path, capsys):
    result = fvcollapse.open_result(runs / "given")
    beads = experiment(tmp_path / "beads", result, length=0.19)
    out = tmp_path / "out"
    assert main(["compare", str(runs / "given"), str(beads), "--out", str(out)]) == 2
    assert "geometry.length_0: found 0.2; allowed: 0.19, as beads has it" in capsys.readouterr().err
    assert not out.exists()


def test_a_run_that_still_moves_is_no_deposit(runs, tmp_path, capsys):
    """Curves count as far as the run goes; a measured deposit beside it has no difference."""
    beads = experiment(tmp_path / "beads", fvcollapse.open_result(runs / "given"))
    with (beads / "front.csv").open("a", encoding="utf-8") as file:
        file.write("0.5,0.6,0.005\n")
    (beads / "scalars.csv").write_text("name,value,sigma,kind\nrunout,0.475,0.005,value\n")
    out = tmp_path / "out"
    assert main(["compare", str(runs / "given"), str(beads), "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    assert "given still moves at its end, t = 0.06 s" in printed
    assert "another setting: boundary.mu_bed is 0.48 in the run, inf in beads" in printed
    assert "another setting: gate.speed is 2.3 in the run, inf in beads" in printed
    rows = table(out)
    assert (rows["runout"]["difference"], rows["runout"]["note"]) == ("", "still moves")
    assert float(rows["runout"]["second"]) == 0.475
    assert rows["rms difference of front"]["note"] == "to 0.06 s, 5 of 6 points"
    assert float(rows["rms difference of front"]["difference"]) == pytest.approx(0.01, rel=1e-6)


def test_the_package_shows_its_public_names_only():
    shown = [name for name in dir(fvcollapse) if not name.startswith("__")]
    assert shown == sorted(name for name in fvcollapse.__all__ if name != "__version__")
    assert callable(fvcollapse.align)
