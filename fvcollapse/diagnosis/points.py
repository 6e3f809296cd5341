"""The points at which simulation and measurement are compared, about 200 for each experiment.

All experiments and all observables are stacked into one vector. Both sides go through the same
observation operator (`fvcollapse.observe`) and the same interpolation (`fvcollapse.measure.align`). A dense film
is thinned to single measured points, not averaged: what neighbouring points share is the matter of
the covariance.

Phases of a collapse, by the share of its whole advance that the front has covered for the first time:
release up to 10 %, spreading up to 80 %, arrest up to 98 %, then deposit. Without a measured front the
edge of the measured profiles serves; without both, the times 1, 2.5 and 3.5 sqrt(height_0 / g).
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from fvcollapse.case.case import GRAVITY
from fvcollapse.errors import InputError
from fvcollapse.measure.align import align, align_curve
from fvcollapse.measure.curves import Curve
from fvcollapse.measure.observables import front_position
from fvcollapse.measure.quantities import CURVES, PROFILES, QUANTITIES, SCALAR_UNITS

PHASES = ("release", "spreading", "arrest", "deposit")
ADVANCE = (0.10, 0.80, 0.98)  # share of the advance of the front at which a phase ends
FREE_FALLS = (1.0, 2.5, 3.5)  # the same in sqrt(height_0 / g), where no front was measured
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
    kind: str
    start: int
    stop: int


class Run(NamedTuple):
    """Scales of one experiment: X of its farthest grains [m], and when its phases end [s]."""

    name: str
    length: float
    phase_ends: tuple

    @property
    def duration(self):
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

    experiments: tuple
    blocks: tuple
    measured: np.ndarray
    sigma: np.ndarray
    runs: tuple

    def __len__(self):
        return len(self.measured)

    @property
    def names(self):
        """Names of the experiments."""
        return tuple(run.name for run in self.runs)

    def of(self, experiment):
        """Slice of the points of one experiment (the object or its name)."""
        name = getattr(experiment, "name", experiment)
        own = [block for block in self.blocks if block.experiment == name]
        return slice(own[0].start, own[-1].stop)

    def run(self, block):
        """The `Run` a block belongs to."""
        return next(run for run in self.runs if run.name == block.experiment)

    def per_point(self, value):
        """(N,) array of `value(block)`, a number or a string for each block."""
        parts = [np.full(block.stop - block.start, value(block)) for block in self.blocks]
        return np.concatenate(parts)

    @property
    def experiment(self):
        """Name of the experiment of each point, (N,)."""
        return self.per_point(lambda block: block.experiment)

    @property
    def observable(self):
        """Name of the observable of each point, (N,)."""
        return self.per_point(lambda block: block.observable)

    @property
    def kind(self):
        """Value, upper or lower, (N,)."""
        return self.per_point(lambda block: block.kind)

    @property
    def time(self):
        """Time of each point, (N,), s; NaN for scalars."""
        return np.concatenate([block.time for block in self.blocks])

    @property
    def x(self):
        """Abscissa of each point, (N,), m; NaN where there is none."""
        return np.concatenate([block.x for block in self.blocks])

    @property
    def phase(self):
        """Phase of each point, (N,): "release", "spreading", "arrest" or "deposit"."""
        return np.concatenate([self._phase_of(block) for block in self.blocks])

    def _phase_of(self, block):
        if QUANTITIES[block.observable].phase:
            return np.array([QUANTITIES[block.observable].phase])
        # side left: the moment at which a phase ends belongs to it
        return np.array(PHASES)[np.searchsorted(self.run(block).phase_ends, block.time)]

    def simulated(self, observations):
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

    def _thinned(self, experiment):
        """The experiment with its curves cut down to the points."""
        curves = {}
        for block in self.blocks:
            if block.experiment == experiment.name and block.observable in CURVES:
                own = slice(block.start, block.stop)
                x = None if np.isnan(block.x).all() else block.x
                curves[block.observable] = Curve(block.time, x, self.measured[own], self.sigma[own])
        return replace(experiment, curves=curves)

    def sensitivity(self, observations):
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


def slope_of(observations, thinned, name, axis, step):
    """Derivative of the simulated curve with respect to time or x at its points, (n,)."""
    curve = thinned.curves[name]
    sides = []
    for shift in (-step, step):
        moved = curve._replace(**{axis: getattr(curve, axis) + shift})
        shifted = replace(thinned, curves={name: moved})
        sides.append(align_curve(observations, shifted, name).simulated)
    return (sides[1] - sides[0]) / (2.0 * step)


def choose_points(experiments):
    """The points of several experiments.

    Profiles are taken at seven moments of the collapse and about 22 places, the interface at five and
    eight, front and volume at 25 and 10 times, two thirds of them before the front has stopped; scalars
    all. Of several points that were measured the nearest is taken.

    Parameters
    ----------
    experiments : sequence of Experiment

    Returns
    -------
    Points

    Raises
    ------
    InputError
        Two experiments of the same name, or with the same curves.
    """
    experiments = tuple(experiments)
    names = [experiment.name for experiment in experiments]
    for experiment in experiments:
        if names.count(experiment.name) > 1:
            alike = [one.folder.resolve() for one in experiments if one.name == experiment.name]
            if len(set(alike)) < len(alike):
                allowed = "each folder once: fitted, held out or a control"
                raise InputError(experiment.folder, "folder", "it is given twice", allowed)
            twice = f"the name {experiment.name} twice"
            raise InputError(experiment.folder, "folder", twice, "folders of different names")
    refuse_copies(experiments)
    blocks, measured, sigma, runs, start = [], [], [], [], 0
    for experiment in experiments:
        run = run_of(experiment)
        for name, units, kind, curve in (*chosen_curves(experiment, run), *scalars(experiment)):
            stop = start + len(curve.value)
            x = np.full(len(curve.value), np.nan) if curve.x is None else curve.x
            blocks.append(Block(run.name, name, units, curve.time, x, kind, start, stop))
            measured.append(curve.value)
            sigma.append(curve.sigma)
            start = stop
        runs.append(run)
    return Points(
        experiments, tuple(blocks), np.concatenate(measured), np.concatenate(sigma), tuple(runs)
    )


def refuse_copies(experiments):
    """The same curve under two names is no second experiment (single numbers, or nothing but zeros, may agree).

    Raises
    ------
    InputError
        A curve of two experiments has the same times, places and values.
    """
    seen = {}
    for experiment in experiments:
        for name, curve in experiment.curves.items():
            if np.ptp(curve.value) == 0.0:
                continue
            content = name, *(None if part is None else part.tobytes() for part in curve[:3])
            if (other := seen.setdefault(content, experiment)) is not experiment:
                allowed = "each experiment once: fitted, held out or a control"
                raise InputError(experiment.folder, name, f"the curve of {other.name}", allowed)


def scalars(experiment):
    """(name, units, kind, Curve of one point) of each measured number."""
    for each in experiment.scalars:
        value, sigma = np.array([each.value]), np.array([each.sigma])
        curve = Curve(np.array([np.nan]), None, value, sigma)
        yield each.name, SCALAR_UNITS[each.name], each.kind, curve


def chosen_curves(experiment, run):
    """(name, units, kind, Curve) of each measured curve, thinned."""
    for name, curve in experiment.curves.items():
        if curve.x is None:
            rows = chosen_times(curve.time, run, *CURVES[name].times)
        else:
            rows = chosen_places(curve, run, CURVES[name].moments, CURVES[name].places)
        x = None if curve.x is None else curve.x[rows]
        thinned = Curve(curve.time[rows], x, curve.value[rows], curve.sigma[rows])
        yield name, CURVES[name].unit, "value", thinned


def nearest(values, targets):
    """Indices, increasing and each once, of the values nearest to the targets."""
    values = np.asarray(values)
    return np.unique([int(np.argmin(np.abs(values - target))) for target in targets])


def chosen_times(time, run, moving, resting):
    """Rows of a curve over time: `moving` of them until the front stops and `resting` after."""
    stop = min(max(run.duration, time[0]), time[-1])
    before = np.linspace(time[0], stop, moving + 1)[1:]
    after = np.linspace(stop, time[-1], resting + 1)[1:]
    return nearest(time, [*before, *after])


def chosen_places(curve, run, moments, places):
    """Rows of a curve over time and place: at some moments, near `places` even abscissae."""
    ends = (0.0, *run.phase_ends, max(run.duration, curve.time[-1]))
    targets = [ends[phase] + share * (ends[phase + 1] - ends[phase]) for phase, share in moments]
    times = np.unique(curve.time)
    edges = np.linspace(curve.x.min(), curve.x.max(), places + 1)
    centres = 0.5 * (edges[:-1] + edges[1:])
    rows = []
    for time in times[nearest(times, targets)]:
        row = np.flatnonzero(curve.time == time)
        inside = centres[centres <= curve.x[row[-1]] + 0.5 * (edges[1] - edges[0])]
        rows.append(row[nearest(curve.x[row], inside)] if len(inside) else row[:1])
    return np.concatenate(rows)


def run_of(experiment):
    """The scales of an experiment."""
    geometry = experiment.settings.geometry
    front = measured_front(experiment)
    length = max([geometry.length_0, *front[:, 1]])
    for name in PROFILES:
        if name in experiment.curves:
            length = max(length, float(experiment.curves[name].x.max()))
    runouts = [each.value for each in experiment.scalars if each.name == "runout"]
    length = max([length, *runouts])
    return Run(experiment.name, float(length), phase_ends(front, geometry))


def measured_front(experiment):
    """(n, 2) time and position of the front: as measured, else the edge of the profiles."""
    curves = experiment.curves
    if "front" in curves:
        return np.column_stack([curves["front"].time, curves["front"].value])
    if "profiles" not in curves:
        return np.empty((0, 2))
    time, x, h, _ = curves["profiles"]
    threshold = experiment.case().front.thickness
    rows = [(moment, time == moment) for moment in np.unique(time)]
    return np.array([(t, front_position(x[row], h[row], threshold)) for t, row in rows])


def phase_ends(front, geometry):
    """Times at which release, spreading and arrest end [s]; see the head of this module."""
    if len(front) > len(ADVANCE):
        reach = np.maximum.accumulate(np.maximum(front[:, 1], geometry.length_0))
        share = (reach - geometry.length_0) / max(reach[-1] - geometry.length_0, 1.0e-12)
        if share[-1] > 0.0:
            return tuple(float(front[np.argmax(share >= end), 0]) for end in ADVANCE)
    fall = float(np.sqrt(geometry.height_0 / GRAVITY))
    return tuple(fall * multiple for multiple in FREE_FALLS)
