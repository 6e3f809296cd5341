"""Guards and limits: what explodes, outgrows its limits or runs out of memory ends with a word and its data."""

import math
import re
from pathlib import Path

import pytest

from fvcollapse import open_result
from fvcollapse.__main__ import main
from fvcollapse.case.case import Case
from fvcollapse.errors import LimitReached, NumericalError
from fvcollapse.output import run as output
from fvcollapse.output import trust
from fvcollapse.output.recorder import Landing, Recorder
from fvcollapse.output.summary import cell_words
from fvcollapse.output.trust import Trust, trust_of
from fvcollapse.simulation import Simulation
from fvcollapse.step import guards
from fvcollapse.step.compiled import from_python

COARSE = {"grid.cell_size": 0.02, "time.end": 0.05, "geometry.channel_width": math.inf}

# from a search for faults: a column of 50 mm of strong, dilating grains on a slippery bed
# frictionless grains that dilate, in a jet under a slow gate: they gain energy from 0.125 s on
EXPLODING = """
[geometry]
slope_angle_deg = 20.314355109008375
height_0 = 0.03149107403175478
length_0 = 0.05124860782154069
channel_width = 0.1
[grid]
cell_size = 0.002952288190477011
cell_size_z = 0.0039363842539693475
[rheology]
mu_1 = 0.0
mu_2 = 0.0
I_0 = 0.1747436400831095
grain_diameter = 6.09383308621711e-05
[boundary]
mu_bed = 0.0
mu_back_wall = 0.0
[gate]
speed = 0.05
time_constant = 0.05
[front]
thickness = 0.003149107403175478
[time]
end = 0.16997321438130913
cfl = 0.1
[effects.lateral_friction]
mu_wall = 0.17058013447547912
pressure_ratio = 0.5823205379019165
[effects.dilatancy]
dilatancy_factor = 2.4272602091382205
solid_fraction_critical = 0.6007158079873157
solid_fraction_slope = 0.15509769146481223
solid_fraction_0 = 0.6130586148788874
[effects.friction_hysteresis]
delta_mu = 0.025474978014576648
I_start = 0.006196388733620642
strain = 0.020393865947976528
"""


@pytest.fixture
def exploding(tmp_path):
    path = tmp_path / "exploding.toml"
    path.write_text(EXPLODING)
    return path


LAW = from_python(guards.broken_law)


def case_of(**changes):
    return Case().replace(**COARSE | changes)


# -- guards --------------------------------------------------------------------------------------


def test_an_exploding_run_ends_at_once_and_keeps_its_last_good_state(exploding, tmp_path, capsys):
    folder = tmp_path / "out"
    assert main(["run", str(exploding), "--out", str(folder), "--quiet"]) == 1
    error = capsys.readouterr().err
    assert error.startswith("guard on the ")
    assert error.count("\n") == 1
    assert " m, at t = " in error
    result = open_result(folder)
    assert not result.complete
    assert result.status == f"failed: {error.strip()}"
    assert result.trust.verdict == "do not use"
    assert 0.12 < result.series["time"][-1] < 0.14
    speed, fall = result.series["max_speed"].max(), math.sqrt(2 * 9.81 * 0.06)
    assert speed < 4.0 * fall
    assert main(["run", str(exploding), "--out", str(folder), "--quiet", "--resume"]) == 1
    assert (
        capsys.readouterr().err == error
    )  # the checkpoint is the state before the step that failed


@pytest.mark.parametrize("mend", ["speed", "volume", "energy"])
def test_each_guard_names_itself(mend):
    simulation = Simulation(case_of())
    drift = speed = 0.0

    def broken():
        return LAW(simulation.flow(), simulation.watch, drift, speed)

    assert broken()[0] == guards.NO_LAW
    if mend == "speed":
        speed = 3.1 * math.sqrt(2 * 9.81 * (0.14 * math.cos(math.radians(22)) + 0.1))
    elif mend == "volume":
        drift = -0.11
    else:
        simulation.energy = simulation.energy | {"kinetic": 0.11 * 1550 * 9.81 * 0.14**2 / 2 * 0.2}
    assert guards.broken_words(*broken()).startswith(f"guard on the {mend}: ")
    simulation.energy = simulation.energies()
    drift, speed = 0.0, math.nan
    assert guards.broken_words(*broken()).startswith("guard on the speed: ")


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"grid.cell_size": 0.035},
        {"geometry.slope_angle_deg": 30.0, "boundary.mu_bed": 0.0, "boundary.mu_back_wall": 0.0},
        {
            "rheology.mu_1": 0.0,
            "rheology.mu_2": 0.0,
            "boundary.mu_bed": 0.0,
            "gate.speed": math.inf,
        },
        {"boundary.ends": "periodic", "geometry.slope_angle_deg": 30.0, "boundary.mu_bed": 0.0},
        {"boundary.right_end": "open", "boundary.domain_length": 0.3},
        {"effects.gate": {"speed": 5.0, "mu_gate": 1.0}},
        {"effects.dilatancy": {"dilatancy_factor": 4.0}},
        {"effects.erodible_bed": {"thickness": 0.02}, "geometry.slope_angle_deg": 10.0},
        {"rheology.law": "bingham", "rheology.cohesion": 50.0},
    ],
    ids=["paper", "4 cells", "ice", "fluid", "chute", "open", "gate", "dilatant", "bed", "bingham"],
)
def test_no_guard_is_near_in_an_ordinary_run(changes, monkeypatch):
    """A third of each limit is enough."""
    for name in ("VOLUME_LIMIT", "ENERGY_LIMIT"):
        monkeypatch.setattr(guards, name, getattr(guards, name) / 3.0)
    monkeypatch.setattr(guards, "SPEED_LIMIT", 1.7)  # an ideal fluid reaches sqrt(2)
    result = output.run(case_of(**{"time.end": 0.3}, **changes))
    assert result.complete


def test_a_step_that_fails_leaves_no_trace(monkeypatch):
    job = output.Job(case_of())
    landing = Landing(0.05, True, True)
    for _ in range(3):
        job.steps(landing)
    before = job.checkpoint_image()
    monkeypatch.setattr(Recorder, "add_rows", lambda *_: (_ for _ in ()).throw(MemoryError()))
    with pytest.raises(MemoryError):
        job.steps(landing)
    assert job.consistent()
    assert job.checkpoint_image() == before


@pytest.mark.parametrize("stage", ["advance", "record", "field"])
def test_want_of_memory_is_a_named_failure_with_the_state_kept(
    tmp_path, monkeypatch, capsys, stage
):
    def exhausted(*_):
        raise MemoryError

    original = Simulation.march

    def march(self, limit, steps, guarded=True):
        if self.state.step >= 4:
            if stage == "advance":
                raise MemoryError
            name = "add_rows" if stage == "record" else "add_field"
            monkeypatch.setattr(Recorder, name, exhausted)
        return original(self, limit, min(steps, 4), guarded)

    monkeypatch.setattr(Simulation, "march", march)
    case = tmp_path / "case.toml"
    case.write_text("grid.cell_size = 0.035\ntime = {end = 0.02, field_interval = 0.01}\n")
    assert main(["run", str(case), "--out", str(tmp_path / "out"), "--quiet"]) == 1
    assert "the memory is exhausted" in capsys.readouterr().err
    result = open_result(tmp_path / "out")
    assert result.status.startswith("failed: the memory is exhausted")
    assert len(result.steps["dt"]) >= 4
    assert result.trust.verdict == "do not use"
    monkeypatch.undo()
    assert main(["run", str(case), "--out", str(tmp_path / "out"), "--quiet", "--resume"]) == 0
    assert open_result(tmp_path / "out").status == "complete"


# -- limits --------------------------------------------------------------------------------------


def test_a_mass_that_never_stops_ends_at_the_limit_of_the_domain(tmp_path, capsys):
    case = tmp_path / "steep.toml"
    case.write_text(
        "geometry.slope_angle_deg = 30\nboundary = {mu_bed = 0.2, domain_max = 1.5}\n"
        "grid.cell_size = 0.035\ntime.end = 5\n"
    )
    folder = tmp_path / "out"
    assert main(["run", str(case), "--out", str(folder), "--quiet"]) == 1
    error = capsys.readouterr().err
    assert error.startswith(
        "still moving; the domain limit of 1.5 m is reached (boundary.domain_max), at t = "
    )
    result = open_result(folder)
    assert not result.complete
    assert result.status == f"stopped: {error.strip()}"
    assert result.trust.reasons[0] == result.status
    assert 0.9 < result.profiles.x[-1] <= 1.5 + 1e-9


def test_the_domain_has_a_limit_without_a_key():
    assert Case().domain_max == pytest.approx(34.0)
    assert case_of(**{"boundary.domain_length": 40.0}).domain_max == 40.0
    with pytest.raises(LimitReached, match="limit of 4e"):
        guards.refuse_growth(Case(), (3000, 2000), (0.006, 0.006), 1.0)


def test_the_number_of_steps_has_a_limit(monkeypatch):
    monkeypatch.setattr(guards, "STEPS_MAX", 3)
    job, landing = output.Job(case_of()), Landing(0.05, True, True)
    while job.state.step < 3:
        job.steps(landing)
    with pytest.raises(LimitReached, match=r"the limit of 3 steps is reached, at t = 0\.0"):
        job.steps(landing)
    assert job.state.step == 3


@pytest.mark.parametrize("speed", [1e9, math.nan])
def test_a_step_that_would_never_end_names_what_asks_for_it(speed):
    simulation = Simulation(case_of())
    simulation.state.u[3, 3] = speed
    with pytest.raises(
        NumericalError, match=rf"falls below .* s: a speed of {re.escape(f'{speed:.3g}')} m/s asks"
    ):
        simulation.advance(1.0)


# -- trust ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("status", "drift", "capped", "expected"),
    [
        ("complete", 0.002, 20, "fine"),
        ("complete", -0.0021, 0, "look at it: volume drifts 0.21 %"),
        ("complete", 0.138, 81, "do not use: volume drifts 13.8 %; 81 % of the steps are capped"),
        ("complete", 0.0, 21, "look at it: 21 % of the steps are capped"),
        ("running", 0.0, 0, "look at it: not at its end (running)"),
        ("failed: a guard", 0.0, 0, "do not use: failed: a guard"),
        ("stopped: a limit", 0.0, 0, "look at it: stopped: a limit"),
    ],
)
def test_what_makes_a_result_to_be_trusted(status, drift, capped, expected):
    assert str(trust_of(status, [0.0, drift, 0.0], 0.07, capped, 100, Case())) == expected


def test_the_readme_has_the_limits_of_trust():
    text = Path("fvcollapse/output/README.md").read_text(encoding="utf-8")
    table = [line for line in text.split("## Trust")[1].splitlines() if line.startswith("| ")]
    rows = {cells[1].strip(): cells[2:4] for cells in (line.split("|") for line in table)}
    stated = {
        name: [float(word) for cell in cells for word in re.findall(r"above ([\d.]+) %", cell)]
        for name, cells in rows.items()
    }
    limits = {
        "largest drift": (trust.VOLUME_LOOK, trust.VOLUME_USELESS),
        "sum of the corrections": (trust.CORRECTED_LOOK, trust.CORRECTED_USELESS),
        "share of capped steps": (trust.CAPPED_LOOK,),
    }
    for name, values in limits.items():
        (found,) = (of for row, of in stated.items() if row.startswith(name))
        assert found == pytest.approx([100.0 * value for value in values])
    assert rows["energy lost to the discretisation"][0].strip() == "not judged"


def test_grains_that_dilate_within_their_law_are_trusted():
    """From 0.62 to nu_eq(I = 1) = 0.60 - 0.15: the volume may grow by 38 %."""
    case = Case().replace(**{"effects.dilatancy": {"dilatancy_factor": 4.0}})
    assert trust_of("complete", [0.0, 0.37], 0.05, 0, 1, case).verdict == "fine"
    assert trust_of("complete", [0.0, 0.40], 0.05, 0, 1, case).verdict == "do not use"
    assert trust_of("complete", [0.0, -0.005], 0.05, 0, 1, case).verdict == "look at it"


def test_cohesive_grains_may_loosen_by_what_they_lose_of_the_solid_fraction():
    loss = {"effects.cohesion.adhesion": 20.0, "effects.cohesion.solid_fraction_loss": 0.02}
    case = Case().replace(**loss)  # 0.62 to 0.60: the volume grows by 3.3 %
    assert trust_of("complete", [0.0, 0.033], 0.05, 0, 1, case).verdict == "fine"
    assert trust_of("complete", [0.0, 0.037], 0.05, 0, 1, case).verdict == "look at it"
    without = case.replace(**{"effects.cohesion.solid_fraction_loss": 0.0})
    assert trust_of("complete", [0.0, 0.033], 0.05, 0, 1, without).verdict == "do not use"


def test_the_result_and_its_summary_say_how_far_to_trust_it(tmp_path, capsys):
    case = tmp_path / "case.toml"
    case.write_text("grid.cell_size = 0.02\ntime.end = 0.01\n")
    assert main(["run", str(case), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    printed = capsys.readouterr().out
    few = "7 cells in the height of the column, fewer than 12"
    assert f"trust                               look at it: {few}" in printed
    assert "what finer cells would change is not judged" in printed
    assert "20 mm along the bed, 20 mm normal to it; 10 x 7 in the column" in printed
    result = open_result(tmp_path / "out")
    assert (result.status, result.trust) == ("complete", Trust("look at it", (few,)))
    summary = result.summary()
    assert (summary["status"], summary["trust"], summary["trust_reasons"]) == (
        "complete",
        "look at it",
        few,
    )


def test_a_result_older_than_its_status_is_judged_from_its_record(tmp_path):
    import h5py

    output.run_case(case_of(**{"time.end": 0.01}), tmp_path, quiet=True)
    with h5py.File(tmp_path / "result.h5", "r+") as file:
        for name in ("status", "trust", "trust_reasons"):
            del file.attrs[name]
        file["series/relative_volume"][-1] = 0.02
    result = open_result(tmp_path)
    assert result.status == "complete"
    few = "7 cells in the height of the column, fewer than 12"
    assert str(result.trust) == f"do not use: volume drifts 2 %; {few}"


@pytest.mark.parametrize(
    ("size", "words"),
    [
        (0.14 / 12, "fine"),
        (0.0117, "look at it: 11.9 cells in the height of the column, fewer than 12"),
        (0.035, "4 cells in the height of the column, fewer than 12"),
    ],
)
def test_the_cells_in_the_column_are_judged(size, words):
    """As many as a diagnosis takes by itself are enough."""
    case = Case().replace(**{"grid.cell_size": size})
    assert words in str(trust_of("complete", [0.0], 0.0, 0, 1, case))


def test_cells_that_are_fitted_to_the_gate_are_said():
    case = Case().replace(**{"grid.cell_size": 0.03})
    assert "28.57 mm along the bed (cell_size = 30 mm, fitted to the gate), 30 mm" in cell_words(
        case
    )


def test_corrections_of_the_volume_are_judged():
    """A column ten times as high as long leaves the back wall at 22 degrees: 86 % of its volume is corrected."""
    verdicts = [
        trust_of("complete", [0.0], corrected, 0, 1, Case()) for corrected in (0.1, 0.35, 0.86)
    ]
    assert [trust.verdict for trust in verdicts] == ["fine", "look at it", "do not use"]
    assert "corrections of the volume sum to 86 % of it" in str(verdicts[2])


def test_thin_fluid_on_a_long_slope_breaks_no_guard():
    """What it gains by errors of the scheme is 0.2 % of what the slope has released, and more than lifted it."""
    changes = {
        "geometry.slope_angle_deg": 30.0,
        "geometry.height_0": 0.08,
        "geometry.length_0": 1.0,
        "grid.cell_size": 0.02,
        "rheology.law": "newtonian",
        "rheology.viscosity": 1e-3,
        "boundary.mu_bed": 0.0,
        "boundary.mu_back_wall": 0.0,
        "gate.speed": float("inf"),
        "time.end": 1.6,
    }
    assert output.run(Case().replace(**changes)).status == "complete"
