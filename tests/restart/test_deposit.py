"""A run that starts from the deposit of another one: it is that deposit, and it lies still until something changes."""

import numpy as np
import pytest
from fake_simulation import FakeSimulation

import fvcollapse
from fvcollapse.case.case import Case
from fvcollapse.case.rules import VERTICES_MAX
from fvcollapse.commands.command_line import main
from fvcollapse.errors import CaseError, InputError
from fvcollapse.output import run as output
from fvcollapse.output.deposit import deposit, thinned

CASE = Case().replace(
    **{
        "geometry.slope_angle_deg": 10.0,
        "effects.lateral_friction": {},
        "grid.cell_size": 0.02,
        "time.end": 1.6,
    }
)


@pytest.fixture(scope="module")
def first():
    return fvcollapse.run(CASE)


def test_the_deposit_lies_still_and_a_steeper_bed_sets_it_going(first):
    end = {"time.end": 0.3}
    case = fvcollapse.from_deposit(first).replace(**end)
    second = fvcollapse.run(case)
    before, after = first.profiles, second.profiles
    areas = [
        np.trapezoid(h, seen.x)
        for seen, h in ((before, before.thickness[-1]), (after, after.thickness[0]))
    ]
    assert areas[1] == pytest.approx(areas[0], rel=2e-3)
    assert second.front_position[0] == pytest.approx(first.front_position[-1], abs=0.1 * 0.02)
    assert second.max_thickness[0] == pytest.approx(first.max_thickness[-1], rel=5e-3)
    assert second.max_speed.max() < 2e-3
    assert second.front_position[-1] == pytest.approx(second.front_position[0], abs=1e-4)
    steep = fvcollapse.run(case.replace(**{"geometry.slope_angle_deg": 24.0}))
    assert steep.max_speed.max() > 0.2
    assert steep.front_position[-1] > steep.front_position[0] + 0.02


def test_the_case_holds_all_of_it(first):
    """The new case is read back from its own text, without the first run."""
    case = fvcollapse.from_deposit(first)
    assert fvcollapse.case.case.case_from_text(case.to_toml()) == case
    assert case.gate.speed == float("inf")
    assert case.geometry.length_max > first.x_99[-1]
    finer = fvcollapse.from_deposit(first, CASE.replace(**{"grid.cell_size": 0.01}))
    assert finer.grid.cell_size == 0.01
    assert finer.geometry.polygon == case.geometry.polygon


def test_a_long_profile_has_as_many_points_as_a_polygon_may_have():
    x = np.linspace(0.0, 1.0, 2000)
    points = thinned(x, 1.0 - x)
    assert len(points) == VERTICES_MAX - 2
    assert points[0] == (0.0, 1.0)
    assert points[-1] == (1.0, 0.0)


def test_what_is_no_deposit_is_refused(first, monkeypatch):
    monkeypatch.setattr(output, "Simulation", FakeSimulation)
    moving = output.run(Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.1}))
    with pytest.raises(InputError, match=r"grains as fast as .* allowed: a run at rest"):
        deposit(moving)
    moving.complete, moving.status = False, "interrupted"
    with pytest.raises(InputError, match="found interrupted; allowed: a complete run"):
        deposit(moving)
    with pytest.raises(CaseError, match=r"geometry\.polygon"):
        fvcollapse.from_deposit(first, CASE.replace(**{"effects.erodible_bed.thickness": 0.03}))


def test_the_command_starts_from_a_run(tmp_path, monkeypatch, capsys):
    (tmp_path / "case.toml").write_text(CASE.to_toml())
    monkeypatch.chdir(tmp_path)
    assert main(["run", "case.toml", "--out", "first", "--quiet"]) == 0
    again = ["run", "case.toml", "--set", "time.end=0.1", "--from", "first", "--out", "second"]
    assert main([*again, "--quiet"]) == 0
    assert main([*again, "--quiet"]) == 0  # finds its own result
    made = fvcollapse.open_result("second")
    assert made.case.geometry.polygon == deposit(fvcollapse.open_result("first"))
    capsys.readouterr()
    assert main([*again[:-2], "--out", "third", "--from", "missing"]) == 2
    assert "missing" in capsys.readouterr().err
