"""The gate at X = length_0: a rigid free-slip wall lifted normal to the bed, closing Z > z_gate(t).

z_gate(t) = v t, or v (t - tau (1 - exp(-t/tau))) for the start-up law v (1 - exp(-t/tau)). The
partly uncovered face is open by its uncovered fraction, in the divergence as well as in the
pressure force: opening it at once would give a pressure spike at every cell the gate passes.
"""

import math

import numpy as np


def gate_height(time, speed, time_constant):
    """Height of the gate's lower edge above the bed at `time`, m."""
    if math.isinf(speed):
        return math.inf
    if time_constant <= 0.0:
        return speed * time
    return speed * (time + time_constant * math.expm1(-time / time_constant))


def open_fractions(aperture, height, column, dz):
    """Set the open fraction of every x-face: 1, but for the gate at `column` (negative: no gate)."""
    aperture[:] = 1.0
    if 0 < column < aperture.shape[0] - 1:
        rows = np.clip((height - dz * np.arange(aperture.shape[1])) / dz, 0.0, 1.0)
        rows[rows < 1e-9] = 0.0
        aperture[column] = rows
