"""Guards: what no collapse can do ends a run at once, and what no run may grow to ends it too.

After every step three laws are checked. They hold for any material, grid and effect, so a run that
breaks one of them is wrong, whatever follows:

- **Volume.** The mass of the grains (their volume, unless they dilate) is that of the start, less
  what left and plus what came, to `VOLUME_LIMIT`. The surface is corrected to it after every step;
  a drift means that the correction has nothing left to act on.
- **Speed.** Grains that fall from the top of the column to the lowest point that the flow has reached
  are as fast as v = sqrt(2 g drop). Pressure passes energy on from grain to grain, but the front of
  even an ideal fluid (Ritter's dam break) is only sqrt(2) times as fast as the fall of its height.
  Nothing is faster than `SPEED_LIMIT` v. A gate that rubs may drag grains to its own speed.
- **Energy.** Kinetic and potential energy together never exceed those of the start, less what left,
  plus the work of the gate, by more than `ENERGY_LIMIT` of the energy that lifted the column from
  the bed and that its fall down the slope has released. Friction only takes.

The limits leave room for the errors of coarse grids, and none for a run that explodes, which passes
them within a few steps. In 48 ordinary collapses (every law, every variant of every effect at medium
and full strength, columns of 4 to 24 cells, slopes of 0 to 30 degrees, ideal fluids) the largest drift
of the volume was 1.8 % (4 cells), the largest speed 1.6 v (ideal fluid; 1.1 v with friction), and the
largest gain of energy 0.15 %. Runs known to explode reach 80 % and more, 16 v and 80 % within 10 ms.

In a periodic stretch the flow falls for ever: its drop is that of the free slide since t = 0, and its
energy is not bounded.
"""

import math
from typing import NamedTuple

import numpy as np

from fvcollapse.case.case import GRAVITY
from fvcollapse.case.limits import CELLS_MAX, STEPS_MAX
from fvcollapse.errors import LimitReached

from .compiled import inner_jit
from .erodible_bed import layer_thickness
from .flow import ENERGY_OUTFLOW, KINETIC, POTENTIAL, TIME, VOLUME_0, VOLUME_OUTFLOW, WORK_GATE
from .gate import gate_velocity

VOLUME_LIMIT = 0.1  # of the volume at the start
SPEED_LIMIT = 3.0  # of the speed of free fall
ENERGY_LIMIT = (
    0.1  # of the potential energy of the column above the bed and of what its fall has released
)


NO_LAW, VOLUME, MASS, SPEED, ENERGY = range(5)  # the laws


class Watch(NamedTuple):
    """The constants of the guards: `height` of the column, m; `rubs`: whether the gate drags grains along."""

    start_energy: float
    sine: float
    cosine: float
    height: float
    rubs: bool


def watch_of(case, start_energy):
    """The `Watch` of a resolved case that starts with this kinetic and potential energy (J/m)."""
    slope, gate = math.radians(case.geometry.slope_angle_deg), case.effects.gate
    height = case.geometry.height_max + layer_thickness(case)
    rubs = gate is not None and gate.mu_gate > 0.0
    return Watch(float(start_energy), math.sin(slope), math.cos(slope), height, rubs)


@inner_jit()
def broken_law(flow, watch, relative_volume, speed):
    """The law that a state breaks, with the value and the limit of what it breaks; (`NO_LAW`, 0, 0) if none.

    Parameters
    ----------
    flow : Flow
        After a step.
    watch : Watch
    relative_volume : float
        Drift of the volume since the start.
    speed : float
        Largest one, m/s.
    """
    drift, law = relative_volume, VOLUME
    if flow.fields.solid_fraction.size > 0:
        drift, law = mass_drift(flow), MASS
    if not abs(drift) <= VOLUME_LIMIT:  # true for NaN
        return law, drift, VOLUME_LIMIT
    most = SPEED_LIMIT * math.sqrt(2.0 * GRAVITY * drop(flow, watch))
    if watch.rubs:
        most = max(most, gate_velocity(flow.fields.numbers[TIME], flow.constants.lift))
    if not speed <= most:
        return SPEED, speed, most
    gained = energy_gained(flow, watch)
    if not gained <= ENERGY_LIMIT:
        return ENERGY, gained, ENERGY_LIMIT
    return NO_LAW, 0.0, 0.0


@inner_jit()
def mass_drift(flow):
    """Drift of the mass of grains that dilate, relative to that of the start."""
    geometry, constants, numbers = flow.geometry, flow.constants, flow.fields.numbers
    here = 0.0
    for i in range(geometry.filled.shape[0]):
        for k in range(geometry.filled.shape[1]):
            here += geometry.filled[i, k] * geometry.packing[i, k]
    here *= constants.dx * constants.dz / constants.packing_0
    return (here + numbers[VOLUME_OUTFLOW]) / numbers[VOLUME_0] - 1.0


@inner_jit()
def drop(flow, watch):
    """Height from the top of the column to the lowest grains, m; in a periodic stretch that of the free slide."""
    geometry = flow.geometry
    if geometry.first > 0:
        run = 0.5 * GRAVITY * watch.sine * flow.fields.numbers[TIME] ** 2
    else:
        last = geometry.reach.size
        while last > 0 and geometry.reach[last - 1] == 0:
            last -= 1
        run = last * flow.constants.dx
    return watch.height * watch.cosine + run * watch.sine


@inner_jit()
def energy_gained(flow, watch):
    """Energy gained, over that which lifted the column and that its fall has released; 0 in a periodic stretch."""
    if flow.geometry.first > 0:
        return 0.0
    numbers, potential = flow.fields.numbers, flow.energy[POTENTIAL]
    energy = flow.energy[KINETIC] + potential + numbers[ENERGY_OUTFLOW] + numbers[WORK_GATE]
    density = flow.constants.balance.density
    lifted = 0.5 * density * GRAVITY * watch.height * numbers[VOLUME_0]
    released = watch.start_energy - potential - numbers[ENERGY_OUTFLOW]
    return (energy - watch.start_energy) / (lifted + max(released, 0.0))


def broken_words(law, value, limit):
    """What a broken law says."""
    if law in (VOLUME, MASS):
        what = "volume" if law == VOLUME else "mass"
        return (
            f"guard on the {what}: it has drifted by {100 * value:+.3g} % (limit {100 * limit:g} %)"
        )
    if law == SPEED:
        fall = value / limit * SPEED_LIMIT
        return f"guard on the speed: {value:.3g} m/s, {fall:.3g} times free fall (limit {limit:.3g} m/s)"
    return (
        f"guard on the energy: gained {100 * value:.3g} % of the energy that lifted the column and that its fall "
        f"has released (limit {100 * limit:g} %)"
    )


def fastest_place(simulation):
    """Where the grains are fastest, in words."""
    dx, dz = simulation.spacing
    speed = np.where(simulation.geometry.index_u >= 0, np.abs(simulation.state.u), -1.0)
    if np.isnan(speed).all():
        return "nowhere in particular"
    i, k = np.unravel_index(np.nanargmax(speed), speed.shape)
    return f"the fastest grains at x = {i * dx:.3g} m, z = {(k + 0.5) * dz:.3g} m"


# -- what a run may grow to ----------------------------------------------------------------------


def refuse_growth(case, shape, spacing, time):
    """End a run whose domain would outgrow its limits.

    Parameters
    ----------
    case : Case
    shape : (int, int)
        Cells along the bed and normal to it that the domain would have.
    spacing : (float, float)
        m.
    time : float
        s.

    Raises
    ------
    LimitReached
    """
    length, limit = shape[0] * spacing[0], case.domain_max
    if length > limit:
        raise LimitReached(
            f"still moving; the domain limit of {limit:g} m is reached (boundary.domain_max)",
            time=time,
        )
    if shape[0] * shape[1] > CELLS_MAX:
        raise LimitReached(
            f"still moving; the limit of {CELLS_MAX:g} cells is reached",
            f"domain of {length:.3g} m by {shape[1] * spacing[1]:.3g} m",
            time,
        )


def steps_left(step, time):
    """Number of steps that may still be stored of a run that has taken `step` steps until `time` (s).

    Raises
    ------
    LimitReached
    """
    if step >= STEPS_MAX:
        raise LimitReached(f"the limit of {STEPS_MAX:g} steps is reached", time=time)
    return STEPS_MAX - step
