"""What is seen of a collapse: effects that change the observation and not the flow.

`observe` applies them, in this order, to what it reads off a result:

- `transverse_profile`: a camera at the wall, or above the middle of the channel, sees grains that
  moved slower or faster than the mean of the width. What lies beyond the gate is seen at gate +
  factor x distance, heights unchanged: a purely kinematic surrogate for a curved front, and an upper
  bound, since a real front is fed from behind.
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
