"""What is seen of a collapse: effects that change the observation and not the flow.

`observe` applies them, in this order, to what it reads off a result:

- `transverse_profile`: a camera at the wall, or above the middle of the channel, sees grains that
  moved slower or faster than the mean of the width. What lies beyond the gate is seen at gate +
  factor x distance, heights unchanged: a purely kinematic surrogate for a curved front, and an upper
  bound, since a real front is fed from behind.
- `front_saltation`: beads detach ahead of the front and are taken for it: a bias, and a scatter that
  lasts as long as the flight of a bead. Both set in as the front travels the first height of the
  column, for before it moves no bead can detach; when it has stopped, the last beads lie where they
  fell. Profiles and volume are seen without them.
- `time_origin`: the clock of the measurement started after the gate.

None of them changes the flow, so that one run serves all their strengths: that of `flow_case`,
given to `observe` together with the case itself.
"""

import numpy as np
from msgspec.structs import replace

from fvcollapse.effects.catalogue import with_effects
from fvcollapse.step.transverse_profile import view_factor

AT_REST = 1.0e-3  # m; a front so near to its last place has stopped
TONES = 256  # of the scatter; its correlation is exact to 1/sqrt(2 TONES) for each seed


def flow_case(case):
    """The case whose run serves `case` as well: without what only the observation knows of."""
    effects, profile = case.effects, case.effects.transverse_profile
    if profile is not None:
        profile = replace(profile, view="average")
    effects = replace(effects, front_saltation=None, time_origin=None, transverse_profile=profile)
    return replace(case, effects=effects)


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
    stop = time[np.argmax(front > front.max() - AT_REST)]
    scatter = correlated_scatter(np.minimum(time, stop), effect.correlation_time, effect.seed)
    return front + progress * (effect.bias + effect.spread * scatter)


def correlated_scatter(time, correlation_time, seed):
    """Gaussian scatter (n,) of unit variance whose correlation falls as exp(-t/correlation_time).

    A function of time and seed alone, so that it does not depend on the time steps of a run: tones
    whose frequencies are drawn from the spectrum of that correlation, a Lorentzian, with random
    phases (Shinozuka & Deodatis 1991, Appl. Mech. Rev. 44, 191).
    """
    draws = np.random.default_rng(seed)
    frequency = draws.standard_cauchy(TONES) / correlation_time
    phase = draws.uniform(0.0, 2.0 * np.pi, TONES)
    return np.sqrt(2.0 / TONES) * np.cos(np.multiply.outer(time, frequency) + phase).sum(axis=1)


def seen_time_origin(case):
    """Simulated time at which the clock of the measurement shows zero, s."""
    effect = case.effects.time_origin
    return 0.0 if effect is None else effect.offset
