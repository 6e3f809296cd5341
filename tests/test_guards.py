"""Guards and limits: what explodes, outgrows its limits or runs out of memory ends with a word and its data."""

import math
import re

import pytest

from fvcollapse import open_result
from fvcollapse.__main__ import main
from fvcollapse.case.case import Case
from fvcollapse.errors import LimitReached, NumericalError
from fvcollapse.output import run as output
from fvcollapse.output.recorder import Landing, Recorder
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
