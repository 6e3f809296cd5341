"""Choice of the points of comparison, about 200 for each experiment.

A dense film is thinned to single measured points, not averaged: what neighbouring points share is the matter of
the covariance.

Phases of a collapse, by the share of its whole advance that the front has covered for the first time:
release up to 10 %, spreading up to 80 %, arrest up to 98 %, then deposit. Without a measured front the
edge of the measured profiles serves; without both, the times 1, 2.5 and 3.5 sqrt(height_0 / g).
"""

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.case.case import GRAVITY
from fvcollapse.diagnosis.points import Block, Points, Run
from fvcollapse.errors import InputError
from fvcollapse.measure.curves import Curve
from fvcollapse.measure.observables import front_position
from fvcollapse.measure.quantities import CURVES, PROFILES, SCALAR_UNITS

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fvcollapse.diagnosis.points import Kind
    from fvcollapse.measure.experiment import Experiment
    from fvcollapse.measure.experiment_keys import Geometry

ADVANCE = (0.10, 0.80, 0.98)  # share of the advance of the front at which a phase ends
FREE_FALLS = (1.0, 2.5, 3.5)  # the same in sqrt(height_0 / g), where no front was measured


def choose_points(experiments: "Iterable[Experiment]") -> Points:
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


def refuse_copies(experiments: "Sequence[Experiment]") -> None:
    """The same curve under two names is no second experiment (single numbers, or nothing but zeros, may agree).

    Raises
    ------
    InputError
        A curve of two experiments has the same times, places and values.
    """
    seen: dict[tuple, Experiment] = {}
    for experiment in experiments:
        for name, curve in experiment.curves.items():
            if np.ptp(curve.value) == 0.0:
                continue
            content = name, *(None if part is None else part.tobytes() for part in curve[:3])
            if (other := seen.setdefault(content, experiment)) is not experiment:
                allowed = "each experiment once: fitted, held out or a control"
                raise InputError(experiment.folder, name, f"the curve of {other.name}", allowed)


def scalars(experiment: "Experiment") -> "Iterator[tuple[str, str, Kind, Curve]]":
    """(name, units, kind, Curve of one point) of each measured number."""
    for each in experiment.scalars:
        value, sigma = np.array([each.value]), np.array([each.sigma])
        curve = Curve(np.array([np.nan]), None, value, sigma)
        yield each.name, SCALAR_UNITS[each.name], each.kind, curve


def chosen_curves(experiment: "Experiment", run: Run) -> "Iterator[tuple[str, str, Kind, Curve]]":
    """(name, units, kind, Curve) of each measured curve, thinned."""
    for name, curve in experiment.curves.items():
        if curve.x is None:
            rows = chosen_times(curve.time, run, *CURVES[name].times)
        else:
            rows = chosen_places(curve, run, CURVES[name].moments, CURVES[name].places)
        x = None if curve.x is None else curve.x[rows]
        thinned = Curve(curve.time[rows], x, curve.value[rows], curve.sigma[rows])
        yield name, CURVES[name].unit, "value", thinned


def nearest(values: "ArrayLike", targets: Iterable[float]) -> np.ndarray:
    """Indices, increasing and each once, of the values nearest to the targets."""
    values = np.asarray(values)
    return np.unique([int(np.argmin(np.abs(values - target))) for target in targets])


def chosen_times(time: np.ndarray, run: Run, moving: int, resting: int) -> np.ndarray:
    """Rows of a curve over time: `moving` of them until the front stops and `resting` after; all of a short curve."""
    if len(time) <= moving + resting:
        return np.arange(len(time))
    stop = min(max(run.duration, time[0]), time[-1])
    before = np.linspace(time[0], stop, moving + 1)[1:]
    after = np.linspace(stop, time[-1], resting + 1)[1:]
    return nearest(time, [*before, *after])


def chosen_places(
    curve: Curve, run: Run, moments: Sequence[tuple[int, float]], places: int
) -> np.ndarray:
    """Rows of a curve over time and place: at some moments, near `places` even abscissae."""
    ends = (0.0, *run.phase_ends, max(run.duration, curve.time[-1]))
    targets = [ends[phase] + share * (ends[phase + 1] - ends[phase]) for phase, share in moments]
    times = np.unique(curve.time)
    edges = np.linspace(curve.x.min(), curve.x.max(), places + 1)  # type: ignore[union-attr]
    centres = 0.5 * (edges[:-1] + edges[1:])
    rows = []
    for time in times[nearest(times, targets)]:
        row = np.flatnonzero(curve.time == time)
        inside = centres[centres <= curve.x[row[-1]] + 0.5 * (edges[1] - edges[0])]  # type: ignore[index]
        rows.append(row[nearest(curve.x[row], inside)] if len(inside) else row[:1])  # type: ignore[index]
    return np.concatenate(rows)


def run_of(experiment: "Experiment") -> Run:
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


def measured_front(experiment: "Experiment") -> np.ndarray:
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


def phase_ends(front: np.ndarray, geometry: "Geometry") -> tuple[float, ...]:
    """Times at which release, spreading and arrest end [s]; see the head of this module."""
    if len(front) > len(ADVANCE):
        reach = np.maximum.accumulate(np.maximum(front[:, 1], geometry.length_0))  # type: ignore[arg-type]
        share = (reach - geometry.length_0) / max(reach[-1] - geometry.length_0, 1.0e-12)
        if share[-1] > 0.0:
            return tuple(float(front[np.argmax(share >= end), 0]) for end in ADVANCE)
    fall = float(np.sqrt(geometry.height_0 / GRAVITY))  # type: ignore[operator]
    return tuple(fall * multiple for multiple in FREE_FALLS)
