"""Two throw-away effects, a term and another reading of the front: what one file each and a line make of them.

They stand in `tests/effects/plugged`. A new process finds them where effects live, and the catalogue with two more
lines; nothing else of the package differs.
"""

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import pytest
from experiment_folder import write_experiment

from fvcollapse.diagnosis.verdict_model import VerdictModel, solver_of
from fvcollapse.effects import catalogue

HERE = Path(__file__).parent / "plugged"
NEW = ("linear_drag", "far_front")
PLACES = {
    "linear_drag.py": "fvcollapse.effects.linear_drag.py",
    "far_front.py": "fvcollapse.effects.far_front.py",
    "linear_drag_term.py": "fvcollapse.step.linear_drag.py",
    "overlay.py": "sitecustomize.py",
    "questions.py": "questions.py",
}


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plugged")
    for name, place in PLACES.items():
        (folder / place).write_bytes((HERE / name).read_bytes())
    lines = Path(catalogue.__file__).read_text(encoding="utf-8")
    last = '    "time_origin",\n'
    assert lines.count(last) == 1
    lines = lines.replace(last, last + "".join(f'    "{name}",\n' for name in NEW))
    (folder / "fvcollapse.effects.catalogue.py").write_text(lines, encoding="utf-8")
    experiment = write_experiment(folder / "experiment")
    root = Path(catalogue.__file__).parents[2]
    done = subprocess.run(
        [sys.executable, str(folder / "questions.py"), str(experiment)],
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(folder), str(root)])},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_the_drag_slows_a_plug_exponentially(answers):
    """In steps of 2 ms, each with the work m u_n+1 (u_n - u_n+1)."""
    velocity, work = answers["slowed"]
    kept, left, mass = math.exp(-3.0 * 2e-3), math.exp(-3.0 * 0.2), 1550.0 * 0.04 * 0.01
    assert velocity == pytest.approx(0.5 * left, rel=1e-9)
    assert work == pytest.approx(mass * 0.25 * kept * (1.0 - left**2) / (1.0 + kept), rel=1e-9)


def test_its_energy_is_booked_in_a_collapse(answers):
    lost, booked, start = answers["budget"]
    assert lost == pytest.approx(booked, abs=1e-4 * start)
    assert lost > 0.0


def test_no_drag_changes_no_bit(answers):
    assert answers["zero_is_nothing"]


def test_the_front_is_read_ahead_of_the_same_flow(answers):
    shifts, same_flow = answers["seen"]
    assert shifts == pytest.approx([0.03, 0.03], abs=1e-12)
    assert same_flow


@pytest.mark.parametrize("name", NEW)
def test_they_are_known_wherever_effects_are(answers, name):
    assert f"effects.{name}." in answers["keys"]
    assert f"| [`{name}`]({name}.py) |" in answers["table"]
    status, refusal = answers["diagnose"]
    assert status == 2
    assert name in refusal


def test_the_bench_measures_the_one_that_flows(answers):
    assert "linear_drag" in answers["bench"]
    assert "far_front" not in answers["bench"]
    assert answers["cost"] > 0.0


def test_the_shipped_layer_stays_as_valid_as_it_was(answers):
    shipped = VerdictModel.load()
    assert answers["valid"] == shipped.is_of_this_solver
    assert answers["solver"] == solver_of(shipped.effects)
    assert answers["solver_with_drag"] != answers["solver"]
