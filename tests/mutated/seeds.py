"""One valid input of every kind, made once: what the mutations start from."""

import json
import shutil
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from blind_suite import make_wedges
from experiment_folder import FILES, SETTINGS
from fake_simulation import FakeSimulation
from report_example import example

from fvcollapse import open_result
from fvcollapse.case.case import Case
from fvcollapse.diagnosis.report.report_file import to_json
from fvcollapse.output import run as output
from fvcollapse.output.extract import extract_image

CASES = [
    Case().to_toml(),
    """[geometry]
slope_angle_deg = 16.5
polygon = [[0.0, 0.0], [0.2, 0.0], [0.15, 0.1], [0.0, 0.12]]
channel_width = inf
[grid]
cell_size = 0.01
cell_size_z = 0.008
[rheology]
law = "mu_I"
[time]
end = 0.5
output_times = [0.1, 0.2, 0.35]
[effects.lateral_friction]
mu_wall = 0.2
closure = "sink_weakening"
[effects.gate]
delay = 0.01
""",
    """# a comment
geometry = { height_0 = 0.1, length_0 = 0.15 }
grid.cell_size = 5e-3
boundary.right_end = "open"
boundary.domain_length = 1.2
rheology.law = "drucker_prager"
effects.cohesion.kappa_0 = 20.0
effects.dilatancy = {}
""",
]
OVERRIDES = [
    *("geometry.height_0=0.2", "grid.cell_size=0.01", "rheology.law=bingham", "time.end=1"),
    *("geometry.polygon=[[0,0],[0.2,0],[0,0.1]]", "effects.gate.delay=0.01", "gate.speed=inf"),
    "time.output_times=[0.1, 0.2]",
]
CURVES = {
    "points": "0.0,0.2\n0.1,0.25\n0.2,0.31\n0.3,0.37\n",
    "semicolons": "x;y\n0,0;0,2\n0,1;0,25\n0,2;0,31\n",
    "tabs": "# digitised\n0.0\t0.2\n0.1\t0.25\n0.2\t0.31\n",
}
ANSWERS = {
    "case_001": {"verdict": "none", "probability": {"none": 0.9, "gate": 0.1}, "set": ["none"]},
    "case_002": {"verdict": "unknown", "probability": {"unknown": 1.0}, "set": []},
    "case_003": {
        "verdict": "effect",
        "probability": {"gate": 0.8, "none": 0.2},
        "set": ["gate"],
        "reduction": {"predicted": 0.5, "actual": 0.6, "runner_up": 0.2},
        "parameters": {"gate": {"delay": {"value": 0.01, "low": 0.0, "high": 0.02}}},
    },
    "case_004": {
        "verdict": "several",
        "probability": {"cohesion+gate": 0.6, "gate": 0.4},
        "set": ["cohesion+gate", "gate"],
        "reduction": {"predicted": 0.5, "actual": 0.6, "winner": 0.4, "runner_up": None},
    },
}
EVIDENCE = {
    "format": "fvcollapse-evidence",
    "solver": "x",
    "experiments": ["slope16_width10"],
    "hypotheses": {
        name: {
            **dict.fromkeys(("log_evidence", "log_evidence_wide", "log_prior"), -1.5),
            **{
                "sigma": 1.0,
                "p_value": 0.3,
                "residual_outside": 0.1,
                "u": [0.5],
                "low": [0.2],
                "high": [0.8],
            },
            **{"variant": [0], "p_by_run": {"slope16_width10": 0.4}},
        }
        for name in ("none", "gate", "cohesion", "cohesion+gate")
    },
    "mass_balance": None,
    "classes": [["gate"], ["cohesion"]],
    "simple": {
        "chi_square": {"none": [9.0, 0.001], "gate": [3.0, 0.2]},
        "signature": {"none": 0.001, "gate": 0.3},
    },
}


def make(folder):
    """All seeds below a folder, as a namespace of bytes and folders."""
    case = Case().replace(
        **{"grid.cell_size": 0.035, "time.end": 0.01, "time.field_interval": 0.005}
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(output, "Simulation", FakeSimulation)
        output.run_case(case, folder / "run", quiet=True)
        make_wedges(patch, folder / "suite")
    with h5py.File(folder / "outside.h5", "w") as file:
        file["secret"] = np.arange(1000.0)
    experiment = folder / "experiment"
    experiment.mkdir()
    (experiment / "experiment.toml").write_text(SETTINGS)
    for name, text in FILES.items():
        (experiment / name).write_text(text)
    (folder / "answers.json").write_text(json.dumps(ANSWERS))
    (folder / "distances.json").write_text(json.dumps({"case_003": 3.5, "case_004": 1.0}))
    (folder / "report.json").write_text(to_json(example("effect")))
    (folder / "evidence.json").write_text(json.dumps(EVIDENCE))
    return SimpleNamespace(
        folder=folder,
        case=case,
        result=(folder / "run/result.h5").read_bytes(),
        checkpoint=(folder / "run/checkpoint.h5").read_bytes(),
        extract=extract_image(open_result(folder / "run")),
        labels=(folder / "suite.labels.json").read_bytes(),
        seal=(folder / "suite/SEAL.json").read_bytes(),
        outside=folder / "outside.h5",
    )


def fresh(folder, name, source):
    """A copy of a seed folder at a place that is emptied before."""
    place = folder / name
    shutil.rmtree(place, ignore_errors=True)
    return shutil.copytree(source, place)
