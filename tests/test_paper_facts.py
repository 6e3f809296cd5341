"""The sets that are held against the paper's printed facts, and what is said to be met."""

import numpy as np
import pytest

from fvcollapse.case.case import Case
from runs.paper_facts import study
from runs.paper_facts.sets import collapse, fact_sets
from runs.particle_laboratory.readings import Readings
from runs.particle_laboratory.walls import Pair, model_rows


def test_every_set_is_a_case_that_the_solver_takes():
    for settings in fact_sets().values():
        Case().replace(**collapse(22.0, 0.1, 0.02), **settings)


def row(runout, height=0.14, flowing=0.0):
    """A row of the table of runs whose front stands at the same place at every thickness."""
    return dict.fromkeys(study.FRONTS, str(runout)) | {
        "height": height,
        "flowing_1.76s": flowing,
        "gain_1mm_after_1.76s": 0.2 * flowing,
    }


@pytest.mark.parametrize(
    ("flat", "middle", "steep", "met"),
    [
        (row(0.475), row(0.69), row(1.59), "runout0 height0 10 22 still22 rest22"),
        (row(0.449), row(0.71), row(1.61), "height0 still22 rest22"),
        (row(0.501, height=0.134), row(0.69), row(1.59, flowing=0.05), "10 22"),
    ],
)
def test_facts_that_are_met(flat, middle, steep, met):
    assert study.held_against_facts(flat, middle, steep)["met_5mm"] == met


def at(front):
    """Readings of a front at rest."""
    x = np.array([0.05, 0.15])
    return Readings(np.array([0.0, 1.0]), np.array([front, front]), x, x, 0.0)


def test_the_friction_of_the_walls_that_a_change_needs_is_interpolated():
    pair = Pair("walled", ("free",), 0.1, {})
    seen = {0.0: at(0.60), 0.1: at(0.56), 0.3: at(0.50)}
    rows = model_rows("22°", pair, None, seen, wanted=-70.0)
    assert [row["front"] for row in rows] == [-40.0, -100.0, -70.0]
    assert rows[-1]["of"] == "model, needed"
    assert rows[-1]["mu_w_K_w"] == pytest.approx(0.2)
    assert model_rows("22°", pair, None, seen, wanted=-120.0)[-1]["of"] == "model, at least needed"
