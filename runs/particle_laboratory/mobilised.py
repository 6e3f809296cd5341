"""Friction that the lateral walls of the model mobilise on average, as the grains say it of theirs.

The grains give the mean of tangential over normal force on the walls. That of the model is the sum of its wall friction
mu_w K_w p |u|/sqrt(|u|^2 + slip^2) over the sum of its normal stress K_w p, over all cells. Grains that slide on a wall
have a friction of 0.3 there, so the like-for-like run is mu_w = 0.3 with K_w = 1; beside it stands the run with
mu_w = the mean that the grains mobilised. The mean over time is that over the stored fields, each with the same weight;
over which time the grains took theirs is not published.
"""

import numpy as np

from fvcollapse import load_case, load_experiment, run
from fvcollapse.step.balance import balance_at_rest
from runs.particle_laboratory.walls import CELL_SIZE, PAIRS, SLIDING, settings
from runs.table import write_table

INTERVAL = 0.02  # s, between two fields
NO_GATE = -1  # column of a gate that is not there
STOPPED = 0.002  # m; a front that is no farther from its last place has stopped


def mobilised(arguments, baseline):
    """Write mobilised.csv: mean friction of the walls of the model at every slope that has grains between walls.

    Parameters
    ----------
    arguments : argparse.Namespace
        Of the study.
    baseline : Path
        Case file of what is believed.
    """
    size, rows = arguments.cell_size or CELL_SIZE, []
    for words, pair in walled_once().items():
        case = load_experiment(arguments.data / pair.walled).case(load_case(baseline))
        for mu_wall in (pair.mobilised, SLIDING):
            keys = settings(mu_wall, size) | pair.both
            done = run(case.replace(**keys, **{"time.field_interval": INTERVAL}))
            first = {"pair": words, "grains": pair.mobilised, "mu_wall": mu_wall, "cell_size": size}
            rows.append(first | means(done, mu_wall))
            print("  ".join(f"{name} {value}" for name, value in rows[-1].items()), flush=True)
    write_table(arguments.tables / "mobilised.csv", rows)


def walled_once():
    """{words: Pair} of `PAIRS` with friction, each collapse between walls once."""
    found = {}
    for words, pair in PAIRS.items():
        if pair.mobilised and pair.walled not in [of.walled for of in found.values()]:
            found[words] = pair
    return found


def means(result, mu_wall):
    """Mean friction of the walls over the whole run, until the front stops, and after that."""
    times = np.array(result.field_times)
    values = np.array([friction(result.case, result.field(n), mu_wall) for n in range(len(times))])
    stop = front_stop(result.series["time"], result.series["front_position"])
    flowing = (times > 0.0) & (times <= stop)
    return {
        "whole_run": round(float(values[times > 0.0].mean()), 4),
        "until_front_stops": round(float(values[flowing].mean()), 4),
        "after": round(float(values[times > stop].mean()), 4) if times[-1] > stop else "",
        "front_stops": round(stop, 2),
    }


def front_stop(time, front):
    """First time from which the front stays within `STOPPED` of its last place, s."""
    away = np.flatnonzero(np.abs(front - front[-1]) > STOPPED)
    return float(time[away[-1] + 1]) if len(away) else float(time[0])


def friction(case, field, mu_wall):
    """Mean friction of the walls at one time: sum of wall friction over sum of normal stress of the cells."""
    pressure = np.maximum(field["pressure"], 0.0)
    u = 0.5 * (field["u"][1:] + field["u"][:-1])
    w = 0.5 * (field["w"][:, 1:] + field["w"][:, :-1])
    speed = np.hypot(u, w)
    slip = balance_at_rest(case, (0.0, 0.0), NO_GATE, None).slip_min  # that of the solver
    return mu_wall * float((pressure * speed / np.hypot(speed, slip)).sum() / pressure.sum())
