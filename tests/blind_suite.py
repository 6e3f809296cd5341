"""A sealed suite without solver runs: the truths are wedges; for tests of what surrounds them."""

import numpy as np

from fvcollapse.blind import make as making
from fvcollapse.blind.labels import Draw
from fvcollapse.blind.truth import View
from fvcollapse.errors import NumericalError

CLASSES = ("none", "unknown", "gate", "cohesion+gate")


def wedge(path, case, label):
    """What is seen of a wedge whose foot moves with a speed that the file tells."""
    speed = float(path.read_text())
    time, x = np.linspace(0.0, 2.0, 81), np.linspace(0.0, 1.8, 181)
    foot = 0.2 + speed * time
    thickness = np.maximum(0.1 * (1.0 - x / foot[:, None]), 0.0)
    curve = np.column_stack([time, foot])
    return View(curve, curve * [1.0, 0.0], time, x, thickness, 0.5 * thickness)


def keep_wedge(case_text, forces, path):
    """Write the file of a wedge."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("0.3")


def make_wedges(monkeypatch, folder, classes=CLASSES, failures=(), **options):
    """A sealed suite in `folder`; the n-th runs in `failures` cannot be computed. Paths and calls."""
    calls = []

    def keep(case_text, forces, path):
        calls.append(path)
        if len(calls) - 1 in failures:
            raise NumericalError("no pivot", time=0.1)
        keep_wedge(case_text, forces, path)

    monkeypatch.setattr(making, "keep_truth", keep)
    monkeypatch.setattr(making, "view_of", wedge)
    draw = Draw(classes=classes, seed=1)
    seal = making.make(len(classes), folder, draw=draw, **options)
    return seal, calls
