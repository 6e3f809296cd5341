"""What `test_plug_in.py` asks of a package with two more effects; prints the answers as JSON."""

import contextlib
import io
import json
import sys

import numpy as np

from fvcollapse import observe, run
from fvcollapse.__main__ import main
from fvcollapse.case.case import Case
from fvcollapse.diagnosis.verdict_model import VerdictModel, solver_of
from fvcollapse.effects.table import catalogue_table
from fvcollapse.measure.observation import flow_case
from fvcollapse.measure.series_readings import ENERGY_SPENT, LOSSES
from fvcollapse.simulation import Simulation
from fvcollapse.studies.bench.case_list import effect_cases, shortened
from fvcollapse.studies.bench.measured import member
from fvcollapse.verification.flows import layer, layer_case, run_until

SHORT = {"grid.cell_size": 0.02, "time.end": 0.1, "time.output_interval": 0.05}
EDGE = {  # a plug on a level plate without friction
    "geometry__slope_angle_deg": 0.0,
    "boundary__mu_bed": 0.0,
    "rheology__law": "newtonian",
}


def printed(*words):
    """Exit status and text of a command."""
    text = io.StringIO()
    with contextlib.redirect_stdout(text), contextlib.redirect_stderr(text):
        status = main(list(words))
    return status, text.getvalue()


def slowed(c, time):
    """(velocity, work of the drag) of a sliding plug, 4 cm thick and 1 cm long, after a time."""
    case = layer_case(0.01, 0.04, **EDGE, effects__linear_drag={"c": c})
    flow = layer(case, lambda z: 0.5 + 0.0 * z, dt=2e-3, slip=0.5)
    run_until(flow, time)
    return flow.mean_velocity(), flow.state.work_bulk


def budget(**effects):
    """(energy lost, energy booked, energy at the start) of a collapse."""
    simulation = Simulation(Case().replace(**SHORT, **effects))
    start = sum(simulation.energies().values())
    while simulation.state.time < 0.1:
        simulation.advance(0.1)
    booked = sum(getattr(simulation.state, name) for name in (*ENERGY_SPENT, *LOSSES))
    return start - sum(simulation.energies().values()), booked, start


def zero_is_nothing():
    """Whether a drag of no strength changes no bit of a collapse."""
    plain, idle = (run(Case().replace(**SHORT, **on)) for on in ({}, {"effects.linear_drag": {}}))
    return all(np.array_equal(values, idle.series[name]) for name, values in plain.series.items())


def seen():
    """(shift of the measured front, whether the flow is that without the effect)."""
    case = Case().replace(**SHORT, **{"effects.far_front": {"ahead": 0.03}})
    result = run(flow_case(case))
    shift = observe(result, case=case).front[:, 1] - observe(result).front[:, 1]
    return [float(shift.min()), float(shift.max())], flow_case(case) == Case().replace(**SHORT)


def answers():
    """All answers."""
    shipped = VerdictModel.load()
    cases = effect_cases()
    return {
        "slowed": slowed(3.0, 0.2),
        "budget": budget(**{"effects.linear_drag": {"c": 5.0}}),
        "zero_is_nothing": zero_is_nothing(),
        "seen": seen(),
        "keys": printed("keys")[1],
        "table": catalogue_table(),
        "diagnose": printed("diagnose", sys.argv[1], "--effects", "none_such", "--out", "nowhere"),
        "bench": list(cases),
        "cost": member(shortened(cases["linear_drag"]).to_toml())["wall_s"],
        "solver": solver_of(shipped.effects),
        "solver_with_drag": solver_of((*shipped.effects, "linear_drag")),
        "valid": shipped.is_of_this_solver,
    }


if __name__ == "__main__":
    print(json.dumps(answers()))
