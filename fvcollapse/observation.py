"""What is seen of a collapse: effects that change the observation and not the flow.

`observe` applies them, in this order, to what it reads off a result:

- `transverse_profile`: a camera at the wall, or above the middle of the channel, sees grains that
  moved slower or faster than the mean of the width. What lies beyond the gate is seen at gate +
  factor x distance, heights unchanged: a purely kinematic surrogate for a curved front, and an upper
  bound, since a real front is fed from behind.
- `front_saltation`: beads detach ahead of the front and are taken for it: a bias, and a scatter that
  lasts as long as the flight of a bead. Both set in as the front travels the first height of the
  column, for before it moves no bead can detach.
- `time_origin`: the clock of the measurement started after the gate.
"""

import numpy as np

from fvcollapse.effects import with_effects
from fvcollapse.step.transverse_profile import view_factor


def seen_place(x, case):
    """Abscissae at which the grains at `x` are seen, m."""
    effect = case.effects.transverse_profile
    if effect is None:
        return x
    excess = view_factor(effect.velocity_ratio, effect.view) - 1.0
    return x + excess * np.maximum(x - with_effects(case).geometry.length_0, 0.0)


def seen_front(time, front, case):
    """Front that is measured, (n,), m, of a front at `front` (n,) at the times `time` (n,), s."""
    front = seen_place(front, case)
    effect = case.effects.front_saltation
    if effect is None:
        return front
    geometry = with_effects(case).geometry
    progress = np.clip((front - geometry.length_0) / geometry.height_0, 0.0, 1.0)
    scatter = correlated_scatter(time, effect.correlation_time, effect.seed)
    return front + progress * (effect.bias + effect.spread * scatter)


def correlated_scatter(time, correlation_time, seed):
    """Gaussian scatter (n,) of unit variance whose correlation falls as exp(-t/correlation_time).

    An Ornstein-Uhlenbeck process sampled at the given times, always the same for one seed.
    """
    draws = np.random.default_rng(seed).standard_normal(len(time))
    scatter = draws.copy()
    for n in range(1, len(time)):
        kept = np.exp(-(time[n] - time[n - 1]) / correlation_time)
        scatter[n] = kept * scatter[n - 1] + np.sqrt(1.0 - kept * kept) * draws[n]
    return scatter


def seen_time_origin(case):
    """Simulated time at which the clock of the measurement shows zero, s."""
    effect = case.effects.time_origin
    return 0.0 if effect is None else effect.offset
