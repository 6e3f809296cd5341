"""A short collapse, against stored values: a change of the numerics shows here first.

Remake the values with `python tests/regression/test_collapse.py` from the folder of the checkout,
after a change that is meant to move them, and say in the commit what moved and why.
"""

import json
from pathlib import Path

import numpy as np
import pytest

from fvcollapse.case.case import Case
from fvcollapse.simulation import Simulation
from fvcollapse.version import __version__

STORED = Path(__file__).with_name("collapse_22deg_12mm.json")
KEYS = {"grid.cell_size": 0.012, "geometry.channel_width": 0.10, "effects.lateral_friction": {}}
END = 0.4
THRESHOLD = 0.01  # m


def thickness(simulation):
    """Filled height above the bed in each column, m."""
    return simulation.geometry.filled.sum(1) * simulation.spacing[1]


def front(simulation):
    """Where the thickness falls through `THRESHOLD`, m; linear between the column centres."""
    height, x = thickness(simulation), simulation.grid.x_centres
    first = int(np.argmax(height < THRESHOLD))
    part = (height[first - 1] - THRESHOLD) / (height[first - 1] - height[first])
    return x[first - 1] + part * (x[first] - x[first - 1])


def measure():
    """Observables of the collapse at t = `END`."""
    simulation = Simulation(Case().replace(**KEYS))
    fastest = 0.0
    while simulation.state.time < END - 1e-12:
        simulation.advance(END)
        fastest = max(fastest, np.abs(simulation.state.u[simulation.geometry.mass_x > 0.5]).max())
    x, filled = simulation.grid.x_centres, simulation.geometry.filled
    return {
        "front_10mm": float(front(simulation)),
        "peak_velocity": float(fastest),
        "height_back_wall": float(thickness(simulation)[0]),
        "centre_of_mass": float(filled.sum(1) @ x / filled.sum()),
        "kinetic_energy": float(simulation.energies()["kinetic"]),
    }


@pytest.mark.skipif(not STORED.exists(), reason="no stored values: run this file to make them")
def test_collapse_is_as_stored():
    """To 1e-4: other processors and libraries round differently, the numerics have not changed."""
    stored = json.loads(STORED.read_text())
    found = measure()
    assert found == pytest.approx(stored["values"], rel=1e-4)


if __name__ == "__main__":
    provenance = {
        "version": __version__,
        "keys": KEYS,
        "time": END,
        "made_by": "tests/regression/test_collapse.py",
    }
    STORED.write_text(json.dumps({"provenance": provenance, "values": measure()}, indent=1) + "\n")
    print(STORED.read_text())
