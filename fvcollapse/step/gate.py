"""The gate at X = length_0: a rigid free-slip wall lifted normal to the bed, closing Z > z_gate(t).

z_gate(t) = v t, or v (t - tau (1 - exp(-t/tau))) for the start-up law v (1 - exp(-t/tau)). The partly uncovered face
is open by its uncovered fraction, in the divergence as well as in the pressure force: opening it at once would give a
pressure spike at every cell the gate passes.
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
    """Set the open fraction of the x-faces at `column`; return the first row that is closed even in part."""
    nz = aperture.shape[1]
    aperture[:] = 1.0
    if not 0 < column < aperture.shape[0] - 1:
        return nz
    rows = np.clip((height - dz * np.arange(nz)) / dz, 0.0, 1.0)
    rows[rows < 1e-9] = 0.0
    aperture[column] = rows
    closed = np.flatnonzero(rows < 1.0)
    return int(closed[0]) if closed.size else nz
