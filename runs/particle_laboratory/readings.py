"""What is read off one collapse of the particle laboratory, of grains and of the model alike."""

from typing import NamedTuple

import numpy as np

from fvcollapse import observe
from fvcollapse.measure.align import align

LAST = 5  # readings of front and volume, whose mean is the value at rest: the front is jagged
REAR = 0.10  # m; "near the back wall"
BEFORE_MIDDLE = (0.5, 0.8)  # of the way to the front; "in front of the middle"


class Readings(NamedTuple):
    """Front (n,) at `time` (n,), the final profile `x`, `thickness` (m,), and the relative volume change (k,).

    SI units.
    """

    time: np.ndarray
    front: np.ndarray
    x: np.ndarray
    thickness: np.ndarray
    volume: np.ndarray

    @property
    def front_at_rest(self):
        """Mean of the last readings, m."""
        return float(np.mean(self.front[-LAST:]))

    @property
    def rear(self):
        """Mean thickness near the back wall, m."""
        return float(self.thickness[self.x <= REAR].mean())

    def front_at(self, time):
        """Front at a time, m."""
        return float(np.interp(time, self.time, self.front))


def of_grains(experiment):
    """`Readings` of an experiment."""
    front, profiles = experiment.curves["front"], experiment.curves["profiles"]
    final = profiles.time == profiles.time[-1]
    volume = experiment.curves["volume"].value
    return Readings(front.time, front.value, profiles.x[final], profiles.value[final], volume)


def of_model(result, experiment):
    """`Readings` of a run, at the times and places of the experiment."""
    pairs = {pair.name: pair for pair in align(observe(result, experiment), experiment)}
    front, profiles = pairs["front"], pairs["profiles"]
    final = profiles.time == profiles.time[-1]
    x, thickness = profiles.x[final], profiles.simulated[final]
    return Readings(front.time, front.simulated, x, thickness, pairs["volume"].simulated)
