"""An experiment in memory that is plausible, and changes of it; for tests of what is not."""

from pathlib import Path

import numpy as np

from fvcollapse.measure.curves import Curve, Scalar
from fvcollapse.measure.experiment import Experiment
from fvcollapse.measure.experiment_keys import settings_from_table

CASES = Path(__file__).parent / "conventions"
SLOPE, HEIGHT, LENGTH = 22.0, 0.14, 0.2
TIMES = np.arange(0.0, 1.21, 0.05)
PLACES = np.arange(0.005, 0.8, 0.01)
GATE = "counted from the gate"


def front_at(time):
    """A front that covers half of its way in 0.3 s."""
    return LENGTH + 0.5 * (1.0 - np.exp(-((np.asarray(time) / 0.36) ** 2)))


def thickness_at(time, x):
    """A pile of the area of the column whose back sinks as its front runs."""
    reach = front_at(time)
    power = 2.0 + 58.0 * np.exp(-time / 0.1)
    back = HEIGHT * LENGTH / reach * (power + 1.0) / power
    return back * np.maximum(1.0 - (x / reach) ** power, 0.0)


def experiment(**changes):
    """A plausible experiment in memory.

    Parameters
    ----------
    **changes
        Dotted keys of the settings with `__` for the dot, and `front`, `profiles`, `volume`: functions
        (time, x, value) -> the same of what is measured; None leaves a curve out. `scalars`: rows.
    """
    table = {
        "geometry": {"slope_angle_deg": SLOPE, "height_0": HEIGHT, "length_0": LENGTH},
        "gate": {"speed": 2.3},
        "material": {"mu_1": 0.44},
        "uncertainty": {"front": 0.004, "thickness": 0.0015},
    }
    for name in [name for name in changes if "__" in name]:
        section, _, key = name.partition("__")
        table.setdefault(section, {})[key] = changes.pop(name)
    rows = [(t, x, thickness_at(t, x)) for t in TIMES for x in PLACES]
    time, x, height = (np.array(column) for column in zip(*rows, strict=True))
    curves = {
        "front": (TIMES, None, front_at(TIMES), 0.004),
        "profiles": (time, x, height, 0.0015),
        "volume": (TIMES, None, 0.02 * TIMES, 0.01),
    }
    measured = {}
    for name, (t, place, value, sigma) in curves.items():
        change = changes.get(name, lambda *columns: columns)
        if change is not None:
            t, place, value = change(t, place, value)
            measured[name] = Curve(t, place, value, np.full(len(value), sigma))
    scalars = tuple(Scalar(*row) for row in changes.get("scalars", ()))
    return Experiment(
        Path("beads"), settings_from_table(table, "experiment.toml"), measured, scalars
    )


def only(*scalars, **changes):
    """An experiment of single numbers."""
    bare = {"front": None, "profiles": None, "volume": None}
    return experiment(**bare, scalars=scalars, **changes)


def scaled(time=1.0, x=1.0, value=1.0, shift=0.0):
    """A change of a curve: factors of its columns, and a shift of X (for a front its value)."""

    def change(t, place, values):
        if place is None:
            return t * time, None, values * value + shift
        return t * time, place * x + shift, values * value

    return change
