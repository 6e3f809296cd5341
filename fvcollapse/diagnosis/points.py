"""The points at which simulation and measurement are compared.

All experiments and all observables are stacked into one vector. Both sides go through the same
observation operator (`fvcollapse.observe`) and the same interpolation (`fvcollapse.measure.align`).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fvcollapse.measure.align import align, align_curve
from fvcollapse.measure.curves import Curve
from fvcollapse.measure.quantities import CURVES, QUANTITIES

if TYPE_CHECKING:
    from typing import Literal

    from fvcollapse.measure.experiment import Experiment
    from fvcollapse.measure.observables import Observations

    Kind = Literal["value", "upper", "lower"]

PHASES = ("release", "spreading", "arrest", "deposit")
STEP = 0.01  # of duration and length: half the span of the differences for `Sensitivity`


class Block(NamedTuple):
    """One observable of one experiment; `start:stop` are its points in the stacked vectors.

    `time` and `x` (n,) are NaN where the observable has none; `kind` is "value", or "upper" or "lower"
    where the measurement is a bound. SI units, the clock of the experiment.
    """

    experiment: str
    observable: str
    units: str
    time: np.ndarray
    x: np.ndarray
    kind: "Kind"
    start: int
    stop: int


class Run(NamedTuple):
    """Scales of one experiment: X of its farthest grains [m], and when its phases end [s]."""

    name: str
    length: float
    phase_ends: tuple[float, ...]

    @property
    def duration(self) -> float:
        """When the front has come to rest [s]."""
        return self.phase_ends[-1]


@dataclass(frozen=True)
class Points:
    """What is compared; vectors over all N points, SI units.

    Attributes
    ----------
    experiments : tuple of Experiment
    blocks : tuple of Block
        Those of one experiment follow one another.
    measured, sigma : (N,) arrays
        Measured value (or bound), and its standard deviation.
    runs : tuple of Run
        One for each experiment.
    """

    experiments: "tuple[Experiment, ...]"
    blocks: tuple[Block, ...]
    measured: np.ndarray
    sigma: np.ndarray
    runs: tuple[Run, ...]

    def __len__(self) -> int:
        return len(self.measured)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the experiments."""
        return tuple(run.name for run in self.runs)

    def of(self, experiment: "Experiment | str") -> slice:
        """Slice of the points of one experiment (the object or its name)."""
        name = getattr(experiment, "name", experiment)
        own = [block for block in self.blocks if block.experiment == name]
        return slice(own[0].start, own[-1].stop)

    def part(self, name: str) -> "Points":
        """The `Points` of one experiment, alone."""
        rows = self.of(name)
        blocks = tuple(
            block._replace(start=block.start - rows.start, stop=block.stop - rows.start)
            for block in self.blocks
            if block.experiment == name
        )
        return Points(
            tuple(experiment for experiment in self.experiments if experiment.name == name),
            blocks,
            self.measured[rows],
            self.sigma[rows],
            tuple(run for run in self.runs if run.name == name),
        )

    @cached_property
    def parts(self) -> "dict[str, Points]":
        """{name of an experiment: its `Points`}."""
        return {name: self.part(name) for name in self.names}

    def run(self, block: Block) -> Run:
        """The `Run` a block belongs to."""
        return next(run for run in self.runs if run.name == block.experiment)

    def per_point(self, value: Callable[[Block], float | str]) -> np.ndarray:
        """(N,) array of `value(block)`, a number or a string for each block."""
        parts = [np.full(block.stop - block.start, value(block)) for block in self.blocks]
        return np.concatenate(parts)

    @property
    def experiment(self) -> np.ndarray:
        """Name of the experiment of each point, (N,)."""
        return self.per_point(lambda block: block.experiment)

    @property
    def observable(self) -> np.ndarray:
        """Name of the observable of each point, (N,)."""
        return self.per_point(lambda block: block.observable)

    @property
    def kind(self) -> np.ndarray:
        """Value, upper or lower, (N,)."""
        return self.per_point(lambda block: block.kind)

    @property
    def time(self) -> np.ndarray:
        """Time of each point, (N,), s; NaN for scalars."""
        return np.concatenate([block.time for block in self.blocks])

    @property
    def x(self) -> np.ndarray:
        """Abscissa of each point, (N,), m; NaN where there is none."""
        return np.concatenate([block.x for block in self.blocks])

    @property
    def phase(self) -> np.ndarray:
        """Phase of each point, (N,): "release", "spreading", "arrest" or "deposit"."""
        return np.concatenate([self._phase_of(block) for block in self.blocks])

    def _phase_of(self, block: Block) -> np.ndarray:
        if QUANTITIES[block.observable].phase:
            return np.array([QUANTITIES[block.observable].phase])
        # side left: the moment at which a phase ends belongs to it
        return np.array(PHASES)[np.searchsorted(self.run(block).phase_ends, block.time)]

    def simulated(self, observations: "Mapping[str, Observations]") -> np.ndarray:
        """Simulated values on the points, (N,).

        Parameters
        ----------
        observations : dict
            Name of each experiment -> `Observations`, as `observe(result, experiment)` gives them.

        Raises
        ------
        InputError
            A simulation that ends in motion before the last measured time.
        """
        parts = []
        for experiment in self.experiments:
            aligned = align(observations[experiment.name], self._thinned(experiment))
            parts += [each.simulated for each in aligned]
        return np.concatenate(parts)

    def _thinned(self, experiment: "Experiment") -> "Experiment":
        """The experiment with its curves cut down to the points."""
        curves = {}
        for block in self.blocks:
            if block.experiment == experiment.name and block.observable in CURVES:
                own = slice(block.start, block.stop)
                x = None if np.isnan(block.x).all() else block.x
                curves[block.observable] = Curve(block.time, x, self.measured[own], self.sigma[own])
        return replace(experiment, curves=curves)

    def sensitivity(self, observations: "Mapping[str, Observations]") -> "Sensitivity":
        """How the values that are read change with an error of the clock and of the origin of X.

        Parameters
        ----------
        observations : dict
            As for `simulated`.

        Returns
        -------
        Sensitivity
            Central differences over 2 % of the duration and of the length of each run.
        """
        clock, origin = np.zeros(len(self)), np.zeros(len(self))
        for experiment, run in zip(self.experiments, self.runs, strict=True):
            seen, thinned = observations[experiment.name], self._thinned(experiment)
            for block in self.blocks:
                if block.experiment != run.name:
                    continue
                own, name = slice(block.start, block.stop), block.observable
                clock[own], origin[own] = QUANTITIES[name].clock, QUANTITIES[name].origin
                if name in CURVES:
                    clock[own] = -slope_of(seen, thinned, name, "time", STEP * run.duration)
                    if thinned.curves[name].x is not None:
                        origin[own] = -slope_of(seen, thinned, name, "x", STEP * run.length)
        return Sensitivity(clock, origin)


class Sensitivity(NamedTuple):
    """Change of the values that are read, (N,).

    `clock` per second by which the clock is ahead (a curve y(t) is read as y(t - 1 s)), `origin` per
    metre by which every X is read too large.
    """

    clock: np.ndarray
    origin: np.ndarray


def slope_of(
    observations: "Observations", thinned: "Experiment", name: str, axis: str, step: float
) -> np.ndarray:
    """Derivative of the simulated curve with respect to time or x at its points, (n,)."""
    curve = thinned.curves[name]
    sides = []
    for shift in (-step, step):
        moved = curve._replace(**{axis: getattr(curve, axis) + shift})
        shifted = replace(thinned, curves={name: moved})
        sides.append(align_curve(observations, shifted, name).simulated)
    return (sides[1] - sides[0]) / (2.0 * step)
