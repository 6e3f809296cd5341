"""The time step: the smallest of the limits that the terms set. Viscosity and friction are implicit and set none."""

import math


def limit_advection(speed_max, cfl, spacing):
    """The surface and the momentum move at most `cfl` cells, s."""
    return cfl * spacing / speed_max if speed_max > 0.0 else math.inf


def limit_surface_wave(gravity, spacing):
    """The free surface is moved explicitly: half the period of the shortest gravity wave, s."""
    return 0.5 * math.sqrt(spacing / (math.pi * gravity))


def limit_gate(gate_speed, is_moving, spacing):
    """While it moves the gate uncovers at most a quarter of a cell per step, s."""
    if not is_moving or math.isinf(gate_speed) or gate_speed <= 0.0:
        return math.inf
    return 0.25 * spacing / gate_speed


def fit_to(time_limit, time, dt):
    """Divide what is left until `time_limit` into equal steps of at most dt, so that no tiny last step arises."""
    left = time_limit - time
    return left / math.ceil(left / dt * (1.0 - 1e-12))
