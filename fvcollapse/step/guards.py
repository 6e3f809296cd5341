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

import numpy as np

from fvcollapse.case.case import GRAVITY
from fvcollapse.case.limits import CELLS_MAX, STEPS_MAX
from fvcollapse.errors import LimitReached, NumericalError

from .erodible_bed import layer_thickness
from .gate import gate_lift, gate_velocity

WATCHED = ("relative_volume", "max_speed")  # the series that the guards read
VOLUME_LIMIT = 0.1  # of the volume at the start
SPEED_LIMIT = 3.0  # of the speed of free fall
ENERGY_LIMIT = (
    0.1  # of the potential energy of the column above the bed and of what its fall has released
)


class Guards:
    """The laws that every step of a run must keep.

    Parameters
    ----------
    case : Case
        Its effects on keys applied (`Case.resolved`).
    start_energy : float
        Kinetic and potential energy at t = 0, J/m.
    """

    def __init__(self, case, start_energy):
        self.case, self.start_energy, self.lift = case, start_energy, gate_lift(case)
        slope = math.radians(case.geometry.slope_angle_deg)
        self.sine, self.cosine = math.sin(slope), math.cos(slope)
        self.height = case.geometry.height_max + layer_thickness(case)
        self.periodic = case.boundary.ends == "periodic"

    def check(self, simulation, row):
        """Refuse a state that breaks a law.

        Parameters
        ----------
        simulation : Simulation
            After a step.
        row : dict
            Values at this moment of the series `WATCHED`.

        Raises
        ------
        NumericalError
            Names the law, the place of the fastest grains and the time.
        """
        broken = (
            self.broken_volume(simulation, row["relative_volume"])
            or self.broken_speed(simulation, row["max_speed"])
            or self.broken_energy(simulation)
        )
        if broken:
            raise NumericalError(broken, fastest_place(simulation), simulation.state.time)

    def broken_volume(self, simulation, relative_volume):
        """What is wrong with the mass; "" if nothing is."""
        drift, what = relative_volume, "volume"
        state = simulation.state
        if state.solid_fraction is not None:
            geometry, what = simulation.geometry, "mass"
            here = np.sum(geometry.filled * geometry.packing) * math.prod(simulation.spacing)
            drift = (here / simulation.packing_0 + state.volume_outflow) / state.volume_0 - 1.0
        if abs(drift) <= VOLUME_LIMIT:  # false for NaN
            return ""
        limit = f"{100 * VOLUME_LIMIT:g} %"
        return f"guard on the {what}: it has drifted by {100 * drift:+.3g} % (limit {limit})"

    def broken_speed(self, simulation, speed):
        """What is wrong with the largest speed (m/s); "" if nothing is."""
        fall = math.sqrt(2.0 * GRAVITY * self.drop(simulation))
        limit = max(SPEED_LIMIT * fall, self.gate_speed(simulation.state.time))
        if speed <= limit:
            return ""
        return f"guard on the speed: {speed:.3g} m/s, {speed / fall:.3g} times free fall (limit {limit:.3g} m/s)"

    def broken_energy(self, simulation):
        """What is wrong with the energy; "" if nothing is."""
        if self.periodic:
            return ""
        state = simulation.state
        energy = sum(simulation.energy.values()) + state.energy_outflow + state.work_gate
        density = self.case.rheology.density_bulk
        lifted = 0.5 * density * GRAVITY * self.height * state.volume_0
        released = self.start_energy - simulation.energy["potential"] - state.energy_outflow
        scale = lifted + max(released, 0.0)
        gained = energy - self.start_energy
        if gained <= ENERGY_LIMIT * scale:
            return ""
        share = f"{100 * gained / scale:.3g} %"
        return (
            f"guard on the energy: gained {share} of the energy that lifted the column and that its fall has "
            f"released (limit {100 * ENERGY_LIMIT:g} %)"
        )

    def drop(self, simulation):
        """Height from the top of the column to the lowest grains, m."""
        if self.periodic:
            run = 0.5 * GRAVITY * self.sine * simulation.state.time**2
        else:
            columns = np.flatnonzero(simulation.geometry.reach)
            run = (columns[-1] + 1) * simulation.spacing[0] if columns.size else 0.0
        return self.height * self.cosine + run * self.sine

    def gate_speed(self, time):
        """Speed to which a rubbing gate may drag the grains, m/s."""
        effect = self.case.effects.gate
        if effect is None or effect.mu_gate == 0.0:
            return 0.0
        return gate_velocity(time, self.lift)


def fastest_place(simulation):
    """Where the grains are fastest, in words."""
    dx, dz = simulation.spacing
    speed = np.where(simulation.geometry.index_u >= 0, np.abs(simulation.state.u), -1.0)
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


def refuse_step(step, time):
    """End a run that has taken as many steps as may be stored.

    Raises
    ------
    LimitReached
    """
    if step >= STEPS_MAX:
        raise LimitReached(f"the limit of {STEPS_MAX:g} steps is reached", time=time)
