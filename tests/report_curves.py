"""Comparisons of three fitted and one held-out collapse, measured and simulated, from analytic curves.

The front follows x_f = L + R tanh^2(t / T), the thickness h = H (1 - (x / x_f)^2) with the volume kept,
the interface half of it behind the front. The "measurement" has a smaller reach R than the model,
as with lateral friction, and noise of its stated standard deviation.
"""

import numpy as np
from msgspec.structs import replace

from fvcollapse.diagnosis.names import BASELINE, RECALIBRATED, RUNNER_UP, WINNER
from fvcollapse.diagnosis.report import schema as form
from fvcollapse.measure.quantities import CURVES, QUANTITIES

FITTED = ("collapse_00deg_w10cm", "collapse_16deg_w10cm", "collapse_22deg_w10cm")
HELD_OUT = ("collapse_22deg_w20cm",)
EVERY = (*FITTED, *HELD_OUT)
SLOPE = dict(zip(EVERY, (0.0, 16.0, 22.0, 22.0), strict=True))
WIDTH = dict(zip(EVERY, (0.10, 0.10, 0.10, 0.20), strict=True))
HEIGHT, LENGTH = 0.14, 0.20  # m
REACH_TOO_FAR = {BASELINE: 0.28, RECALIBRATED: 0.10, WINNER: 0.01, RUNNER_UP: 0.07}
SIGMA = {"front": 0.01, "profiles": 0.002, "volume": 0.01, "interface": 0.003, "runout": 0.012}
PROFILE_TIMES = (0.1, 0.2, 0.32, 0.48, 0.7, 0.95, 1.4)
FRONT_TIMES = np.linspace(0.04, 1.4, 25)
PHASES = (("release", 0.15), ("spreading", 0.7), ("arrest", 1.0), ("deposit", np.inf))


# -- curves --------------------------------------------------------------------------------------


def front(experiment, time, model=None):
    """Position of the front [m]; model None: measured."""
    slope, walls = SLOPE[experiment] / 22.0, 0.5 if WIDTH[experiment] == 0.20 else 1.0
    excess = REACH_TOO_FAR[model] * walls * (0.4 + 0.6 * slope) if model else 0.0
    return LENGTH + (0.30 + 0.55 * slope) * (1.0 + excess) * np.tanh(time / 0.45) ** 2


def thickness(experiment, time, x, model=None):
    """Thickness normal to the bed [m]."""
    x_f = front(experiment, time, model)
    return 1.5 * HEIGHT * LENGTH / x_f * np.maximum(1.0 - (x / x_f) ** 2, 0.0)


def value(experiment, observable, time, x, model=None):
    """Any observable on its points."""
    if observable == "front":
        return front(experiment, time, model)
    if observable == "profiles":
        return thickness(experiment, time, x, model)
    if observable == "interface":
        return 0.5 * thickness(experiment, time, x, model) * np.minimum(time / 0.5, 1.0)
    if observable == "volume":
        return np.zeros_like(time) if model else 0.004 * np.tanh(time)
    return np.array([front(experiment, 3.0, model)])


def points(experiment, observable):
    """(time, x) of the points of an observable; None where it has none."""
    if observable not in CURVES:
        return None, None
    if not CURVES[observable].is_profile:
        return FRONT_TIMES[:: 1 if observable == "front" else 3], None
    count = CURVES[observable].places
    times = PROFILE_TIMES[: len(CURVES[observable].moments)]
    ends = [1.08 * front(experiment, time) for time in times]
    return np.repeat(times, count), np.concatenate([np.linspace(0.01, end, count) for end in ends])


# -- comparisons ---------------------------------------------------------------------------------


def comparison(experiment, observable, rng, models):
    """One observable of one experiment, with z."""
    time, x = points(experiment, observable)
    truth = value(experiment, observable, time, x)
    sigma = np.full(len(truth), SIGMA[observable])
    if observable == "profiles":
        sigma = sigma * (1.0 + 1.5 * (x > 0.9 * front(experiment, time)))
    measured = truth + sigma * rng.standard_normal(len(truth))
    combined = np.hypot(sigma, 0.03 * np.abs(truth) + 0.5 * sigma)
    simulated = {model: value(experiment, observable, time, x, model) for model in models}
    moments = [9.0] if time is None else time
    return form.Comparison(
        experiment=experiment,
        observable=observable,
        units=QUANTITIES[observable].unit,
        time=time,
        x=x,
        measured=measured,
        sigma=sigma,
        combined=combined,
        simulated=simulated,
        z={model: (values - measured) / combined for model, values in simulated.items()},
        region=[None] * len(truth),
        phase=[next(name for name, end in PHASES if t <= end) for t in moments],
    )


def with_regions(comparisons):
    """(comparisons with the region of each point, regions): of fitted curves, beyond 2 and of one sign."""
    regions, marked = [], []
    for pair in comparisons:
        z, index = pair.z[BASELINE], np.full(len(pair.measured), -1)
        for sign in (1, -1) if pair.experiment in FITTED and pair.time is not None else ():
            here = (np.abs(z) > 2.0) & (np.sign(z) == sign)
            if here.sum() >= 4:
                index[here] = len(regions)
                regions.append(region(pair, here))
        marked.append(replace(pair, region=[int(n) if n >= 0 else None for n in index]))
    return marked, regions


def region(pair, here):
    """The region of the points `here`."""
    gap = (pair.simulated[BASELINE] - pair.measured)[here]
    spans = [
        None if column is None else (float(column[here].min()), float(column[here].max()))
        for column in (pair.time, pair.x)
    ]
    return form.Region(
        experiment=pair.experiment,
        observable=pair.observable,
        t_range=spans[0],
        x_range=spans[1],
        gap=float(gap.mean()),
        gap_sd=float(pair.combined[here].mean()),
        units=pair.units,
        significance=float(np.abs(pair.z[BASELINE][here]).max()),
        p_value=0.002,
    )
