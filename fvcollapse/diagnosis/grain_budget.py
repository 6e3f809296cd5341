"""Whether the measured profiles hold the grains of the column: a mass balance of the data, without any model.

    B(t) = integral of h dx / (height_0 length_0 (1 + V(t)))  -  1  =  shift + stretch phi(t)

with the measured relative change of volume V, and phi the part of the grains that is beyond the gate.
Whatever moves the grains, both are zero. Lengths that are read wrongly shift B from the first picture on. A
camera at the wall or above the middle, where grains move slower or faster than the mean of the width
(`transverse_profile`), sees all that has passed the gate stretched by view factor - 1. Comparison with
simulated profiles hides this behind the discrepancy of a model; no model can err here.

On 547 synthetic cases shift / standard deviation has rms 1.1 where grains are conserved and 4.9 where lengths are
read 3 to 8 % wrong; stretch has rms 1.5 and, with the view, 3.6 and 14 (in units of what the frames alone tell).
On particle collapses without an effect the shift is 0.0 and 0.1 %, the stretch 0.6 and 0.9 %.

References
----------
Bartlett (1935), J. R. Stat. Soc. 98, 536 (variance where neighbours in time are correlated).
"""

from typing import NamedTuple

import numpy as np
from scipy.integrate import trapezoid

SWELLING = 0.03  # standard deviation of V where it was not measured
THIN = 0.012  # of the stretch: the thin rim that is not seen; grains conserved have 1.5 times the scatter of frames
BARE = 3.0  # standard deviations of the last thickness up to which all grains are in view
NEAR_WALL = 0.1  # of length_0: where profiles must begin
LEAST_PLACES, LEAST_FRAMES = 5, 5
LARGEST_CORRELATION = 0.9  # from one frame to the next
# standard deviations of shift and stretch where lengths are read wrongly, and where the flow is seen from a side
WRONG, VIEW = (0.05, 0.0), (0.0, 0.1)


class Budget(NamedTuple):
    """Shift and stretch of the grains in view, (2,), and their covariance, (2, 2)."""

    mean: np.ndarray
    covariance: np.ndarray

    def log_odds(self, spread):
        """Ln of the density of `mean` if shift and stretch scatter by `spread` (2,) more, over that if they do not."""
        wide = self.covariance + np.diag(np.square(spread))
        precision, wide_precision = np.linalg.inv(self.covariance), np.linalg.inv(wide)
        gain = self.mean @ (precision - wide_precision) @ self.mean
        return 0.5 * float(gain - np.linalg.slogdet(wide @ precision)[1])


def grain_budget(experiments):
    """The `Budget` of all experiments together, their weighted mean; None if none of them tells.

    Parameters
    ----------
    experiments : sequence of Experiment
    """
    found = [each for each in map(budget_of, experiments) if each is not None]
    if not found:
        return None
    precisions = [np.linalg.inv(each.covariance) for each in found]
    covariance = np.linalg.inv(sum(precisions))
    weighted = sum(own @ each.mean for own, each in zip(precisions, found, strict=True))
    return Budget(covariance @ weighted, covariance)


def budget_of(experiment):
    """The `Budget` of one experiment; None without five profiles of different reach that show all grains.

    The scale of heights and the origin of X are as uncertain as the column itself: both count twice.
    """
    frames = np.array(list(budget_frames(experiment)))
    if len(frames) < LEAST_FRAMES or np.ptp(frames[:, 1]) == 0.0:
        return None
    excess, beyond = frames.T
    columns = np.column_stack([np.ones_like(beyond), beyond])
    mean, *_ = np.linalg.lstsq(columns, excess, rcond=None)
    rest = excess - columns @ mean
    scatter = rest @ rest / (len(rest) - 2) * inflation(rest)
    covariance = scatter * np.linalg.inv(columns.T @ columns)
    geometry, volume = experiment.settings.geometry, experiment.curves.get("volume")
    column = [
        experiment.standard_deviation(key, size) / size
        for key, size in (("height_0", geometry.height_0), ("length_0", geometry.length_0))
    ]
    swelling = SWELLING if volume is None else float(np.median(volume.sigma))
    shared = 2.0 * np.square(column).sum(), swelling**2 + THIN**2
    return Budget(mean, covariance + np.diag(shared))


def budget_frames(experiment):
    """(B, phi) of every later profile that shows all grains; at t = 0 the upright face is between two places."""
    geometry, curves = experiment.settings.geometry, experiment.curves
    if "profiles" not in curves:
        return
    time, x, h, sigma = curves["profiles"]
    for moment in np.unique(time[time > time.min()]):
        own = time == moment
        place, thickness = x[own], h[own]
        begins = len(place) >= LEAST_PLACES and place[0] <= NEAR_WALL * geometry.length_0
        if not begins or abs(thickness[-1]) > BARE * sigma[own][-1]:
            continue
        swollen = 1.0
        if "volume" in curves:
            swollen += np.interp(moment, curves["volume"].time, curves["volume"].value)
        area = thickness[0] * place[0] + trapezoid(thickness, place)
        column = geometry.height_0 * geometry.length_0 * swollen
        yield area / column - 1.0, area_beyond(place, thickness, geometry.length_0) / area


def area_beyond(x, thickness, gate):
    """Area under a profile beyond the gate."""
    further = x > gate
    at_gate = np.interp(gate, x, thickness)
    return trapezoid(np.append(at_gate, thickness[further]), np.append(gate, x[further]))


def inflation(rest):
    """Factor of the variance of a mean over residuals that follow one another in time."""
    square = float(rest @ rest)
    correlation = float(rest[1:] @ rest[:-1]) / square if square > 0.0 else 0.0
    correlation = min(max(correlation, 0.0), LARGEST_CORRELATION)
    return (1.0 + correlation) / (1.0 - correlation)
