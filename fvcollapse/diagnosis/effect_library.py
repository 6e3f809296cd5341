"""The runs that a diagnosis needs, and what they say on the points of comparison.

For every experiment: the baseline on two grids, an ensemble with calibrated parameters and set-up drawn
from their uncertainty, and every effect of the catalogue at a few quantiles of its priors, closure by
closure. None of them depends on what was measured, only on how: they come from the cache of runs, and an
experiment with the same set-up finds them done. Ensemble and effects are runs on the coarser grid;
only their differences to the baseline there are used, on top of the baseline on the finer grid, those of
effects after the correction that one level of each on both grids shows (`grid_correction`).

An effect that changes what is seen and not what flows is read off the run without it.
"""

import zlib
from contextlib import suppress
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, inf, sqrt
from typing import NamedTuple

import numpy as np
from scipy.stats import norm

from fvcollapse.case.case import GRAVITY
from fvcollapse.diagnosis.emulator import Response
from fvcollapse.diagnosis.grid_correction import GridCorrection, reference_level
from fvcollapse.diagnosis.points import choose_points
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import NUISANCE
from fvcollapse.errors import CaseError, InputError, NumericalError, failures_named
from fvcollapse.measure.observables import observe
from fvcollapse.measure.observation import flow_case
from fvcollapse.studies.cache import EXTRACT, RunCache, default_folder

# cells of the coarser grid, in the height and in the length of the column at least
CELLS, CELLS_LENGTH = 12, 6
LEAST_CELLS = 5  # in both, of a cell size that is asked for
REFINEMENT = 0.75  # cell size of the finer grid over that of the coarser
DRAWS = 20  # of the ensemble
LONGEST_STEP = 0.02  # of the coarser grid, in sqrt(height_0 / g): twice the default
END_MARGIN, END_STEP = 0.02, 0.5  # s; ends are rounded up, so that similar films share their runs
ARREST = 2.5  # s; least end of a run whose state of rest was measured
LEVELS_1D = (0.05, 0.35, 0.65, 0.95)
LEVELS_RANGE = (0.06, 0.94)  # of the quantiles in more dimensions
FAILED_LEVELS = 0.34  # share of the runs of a closure that may fail
# case key: key of [uncertainty]. The first are of the material, one truth for all experiments of it
CALIBRATED = {
    "rheology.mu_1": "mu_1",
    "rheology.mu_2": "mu_2",
    "rheology.I_0": "I_0",
    "boundary.mu_bed": "mu_bed",
    "boundary.mu_back_wall": "mu_back_wall",
}
SET_UP = {  # drawn for each experiment by itself; the clock is in the covariance of the measurement
    "geometry.slope_angle_deg": "slope_angle_deg",
    "geometry.height_0": "height_0",
    "geometry.length_0": "length_0",
    "gate.speed": "speed",
}
LAWS_WITH_I = ("mu_I", "mu_I_regularised")
SLOPE_MAX = 30.0  # deg


# -- cases ---------------------------------------------------------------------------------------


def baseline_cases(experiments, case=None, cell_size=None):
    """{name: Case} of the experiments on the coarser grid, without any effect but those of `case`.

    Raises
    ------
    InputError
        Cells too large for columns that are a little smaller than stated.
    """
    cases = {}
    for experiment in experiments:
        own = experiment.case(case)
        geometry = own.geometry
        largest = min(geometry.height_0, geometry.length_0) / LEAST_CELLS
        if cell_size is not None and not 0.0 < cell_size <= largest:
            allowed = f"> 0 and <= {largest:g}, a fifth of the column of {experiment.name}"
            raise InputError("command line", "--cell-size", f"{cell_size:g}", allowed)
        size = cell_size or min(geometry.height_0 / CELLS, geometry.length_0 / CELLS_LENGTH)
        changes = {"grid.cell_size": size, "time.end": run_end(experiment)}
        if own.time.step_max is None:
            changes["time.step_max"] = LONGEST_STEP * sqrt(geometry.height_0 / GRAVITY)
        cases[experiment.name] = own.replace(**changes)
    return cases


def run_end(experiment):
    """End of the runs of an experiment [s]."""
    end = END_STEP * ceil((experiment.time_end + END_MARGIN) / END_STEP)
    return max(end, ARREST) if experiment.scalars else end


def refined(case):
    """The case on the finer grid, with steps half as long."""
    grid = case.grid
    changes = {
        "grid.cell_size": REFINEMENT * grid.cell_size,
        "time.step_max": 0.5 * case.time.step_max,
    }
    if grid.cell_size_z is not None:
        changes["grid.cell_size_z"] = REFINEMENT * grid.cell_size_z
    return case.replace(**changes)


# -- effects -------------------------------------------------------------------------------------


class Closure(NamedTuple):
    """One closure of an effect: its parameters, and the other keys of its section."""

    effect: str
    parameters: tuple
    keys: dict

    def values(self, u):
        """{parameter: value} at the quantiles u (d,)."""
        priors = CATALOGUE[self.effect].priors
        pairs = zip(self.parameters, np.atleast_1d(u), strict=True)
        return {name: float(priors[name].distribution().ppf(share)) for name, share in pairs}

    def section(self, u):
        """The keys of `[effects.<name>]` at the quantiles u."""
        return self.keys | self.values(u)

    def levels(self):
        """The quantiles (m, d) at which the effect is run."""
        return design(len(self.parameters))


def closures_of(name):
    """The closures of an effect of the catalogue."""
    effect = CATALOGUE[name]
    return tuple(
        Closure(
            name,
            tuple(key for key in effect.priors if variant.get(key, "") is not None),
            {key: value for key, value in variant.items() if value is not None},
        )
        for variant in effect.variants
    )


def design(dimension):
    """Points (m, d) that fill the unit cube: four levels, or an additive recurrence (Roberts 2018)."""
    if dimension == 1:
        return np.array(LEVELS_1D)[:, None]
    count = 2 * dimension + 3
    root = 2.0  # of root^(d + 1) = root + 1, the golden ratio for d = 1
    for _ in range(60):
        root = (1.0 + root) ** (1.0 / (dimension + 1.0))
    steps = root ** -np.arange(1.0, dimension + 1.0)
    points = (0.5 + np.outer(np.arange(count), steps)) % 1.0
    points = (points - points.min(axis=0)) / np.ptp(points, axis=0)
    low, high = LEVELS_RANGE
    return low + (high - low) * points


def applicable_effects(cases, names=None):
    """(names of the effects to compare, {name: why not} of the others).

    Parameters
    ----------
    cases : dict
        Of the experiments that are diagnosed.
    names : sequence of str, optional
        Only these.

    Raises
    ------
    InputError
        A name that is no effect of the catalogue.
    """
    known = [name for name, effect in CATALOGUE.items() if effect.kind != NUISANCE]
    for name in names or ():
        if name not in known:
            raise InputError("command line", "--effects", repr(name), ", ".join(known))
    chosen, left_out = [], {}
    for name in known:
        if names and name not in names:
            continue
        if any(getattr(case.effects, name) is not None for case in cases.values()):
            left_out[name] = "the baseline has it already"
        elif not any(acts_in(name, case) for case in cases.values()):
            left_out[name] = "no experiment states a channel width"
        else:
            chosen.append(name)
    return chosen, left_out


def acts_in(name, case):
    """Whether an effect can act in the set-up of a case."""
    return not CATALOGUE[name].needs_walls or case.geometry.channel_width < inf


# -- calibrated parameters and set-up ------------------------------------------------------------


class Nuisance(NamedTuple):
    """A quantity that is known within a standard deviation.

    `experiments` are the names of those whose runs it enters, `design` tells their set-up; `mean` and
    `sd` are in the unit of the key.
    """

    key: str
    experiments: tuple
    mean: float
    sd: float
    design: str = ""

    def value(self, z):
        """Value at z standard deviations; positive quantities are lognormal."""
        if self.key == "geometry.slope_angle_deg":
            return min(abs(self.mean + z * self.sd), SLOPE_MAX)
        return self.mean * float(np.exp(z * self.sd / self.mean))

    def realised(self, z):
        """The z that the value stands for: a slope is never negative."""
        if self.key == "geometry.slope_angle_deg":
            return (self.value(z) - self.mean) / self.sd
        return z


def nuisances(experiments, cases):
    """All `Nuisance`s of the experiments: those of the material are shared where they agree."""
    shared, own = {}, []
    for experiment in experiments:
        case = cases[experiment.name]
        for key, quantity in (CALIBRATED | SET_UP).items():
            mean = value_of(case, key)
            if mean is None:
                continue
            sd = experiment.standard_deviation(quantity, mean)
            if sd > 0.0 and key in CALIBRATED:
                shared.setdefault((key, mean, sd), []).append(experiment.name)
            elif sd > 0.0:
                own.append(Nuisance(key, (experiment.name,), mean, sd, design_text(case)))
    material = [Nuisance(key, tuple(names), *about) for (key, *about), names in shared.items()]
    return (*material, *own)


def design_text(case):
    """The set-up in a few numbers."""
    geometry = case.geometry
    numbers = (geometry.slope_angle_deg, geometry.height_0, geometry.length_0)
    return " ".join(f"{number:g}" for number in (*numbers, geometry.channel_width, case.gate.speed))


def value_of(case, key):
    """Value of a key that can be drawn; None where it is infinite, zero (but a slope) or has no effect."""
    section, _, name = key.partition(".")
    value = getattr(getattr(case, section), name)
    if name in ("mu_2", "I_0") and case.rheology.law not in LAWS_WITH_I:
        return None
    return value if value < inf and (value > 0.0 or name == "slope_angle_deg") else None


def draw(quantities, count, seed=0):
    """Standard normal draws (count, n), a Latin hypercube.

    A column depends on its quantity and not on its neighbours: an experiment has the same runs alone and
    in company. Two of the same design have different errors.
    """
    columns, seen = [], {}
    for quantity in quantities:
        label = f"{quantity.key} {quantity.design}"
        number = seen[label] = seen.get(label, 0) + 1
        generator = np.random.default_rng([seed, zlib.crc32(label.encode()), number])
        columns.append(norm.ppf((generator.permutation(count) + 0.5) / count))
    return np.column_stack(columns)


def with_nuisances(case, name, quantities, z):
    """The case of an experiment with quantities z (n,) standard deviations off.

    A column of another size keeps its number of cells, so that the response is smooth.
    """
    changes = {
        quantity.key: quantity.value(shift)
        for quantity, shift in zip(quantities, z, strict=True)
        if name in quantity.experiments
    }
    geometry, grid = case.geometry, case.grid
    if "rheology.mu_2" in changes or "rheology.mu_1" in changes:
        mu_1 = changes.get("rheology.mu_1", case.rheology.mu_1)
        changes["rheology.mu_2"] = max(changes.get("rheology.mu_2", case.rheology.mu_2), mu_1)
    length = changes.get("geometry.length_0", geometry.length_0) / geometry.length_0
    height = changes.get("geometry.height_0", geometry.height_0) / geometry.height_0
    if length != 1.0 or height != 1.0:
        changes["grid.cell_size"] = grid.cell_size * length
        changes["grid.cell_size_z"] = (grid.cell_size_z or grid.cell_size) * height
    return case.replace(**changes)


# -- the runs ------------------------------------------------------------------------------------


class Runner:
    """Runs cases through the cache and reads them as an experiment would; counts what it took.

    Parameters
    ----------
    folder : Path, optional
        Of the cache of runs; default that of the user.
    workers, scheduler, quiet
        See `workers.run_all`.
    """

    def __init__(self, folder=None, workers=1, scheduler=None, quiet=True):
        self.cache = RunCache(folder or default_folder())
        self.workers, self.scheduler, self.quiet = workers, scheduler, quiet
        self.asked, self.computed = set(), set()

    def observations(self, wanted):
        """({label: Observations}, {label: NumericalError}) of {label: (experiment, case)}.

        The costly ones first.
        """
        flows = {label: flow_case(case) for label, (_, case) in wanted.items()}
        places = {label: self.cache.place(case) for label, case in flows.items()}
        missing = {place for place in places.values() if not (place / EXTRACT).exists()}
        self.asked |= set(places.values())
        self.computed |= missing
        runs = self.cache.run_all(flows, self.workers, self.scheduler, self.quiet)
        seen, failures = {}, dict(runs.failures)
        for label, result in runs.results.items():
            experiment, case = wanted[label]
            view = copy(result)
            view.case = case.replace(**{"time.end": result.case.time.end})
            try:
                with failures_named():
                    seen[label] = observe(view, experiment)
            except NumericalError as error:
                failures[label] = error
        return seen, failures


@dataclass(frozen=True)
class Library:
    """What the runs say on N points of comparison; SI units.

    Attributes
    ----------
    points : Points
        Of the experiments that are diagnosed, then of the controls.
    experiments : tuple of Experiment
        Those that are diagnosed.
    cases : dict
        Experiment -> `Case` on the coarser grid.
    coarse, fine : (N,) arrays
        Baseline on the two grids.
    seen : dict
        Experiment -> `Observations` of the baseline on the finer grid.
    quantities : tuple of Nuisance
    draws : (m, n) array
        Of the quantities, in standard deviations.
    samples : (m, N) array
        The ensemble, on the coarser grid.
    closures : dict
        Effect -> tuple of `Closure`.
    responses : dict
        Effect -> list of `Response`, one for each closure.
    corrections : dict
        (effect, number of the closure) -> `GridCorrection`, where the run on the finer grid did not fail.
    left_out : dict
        Effect -> why it is not compared.
    """

    points: object
    experiments: tuple
    cases: dict
    coarse: np.ndarray
    fine: np.ndarray
    seen: dict
    quantities: tuple
    draws: np.ndarray
    samples: np.ndarray
    closures: dict
    responses: dict
    corrections: dict
    left_out: dict


def build_library(experiments, cases, runner, effects=None, controls=(), draws=DRAWS, seed=0):
    """Run what is missing and read everything on the points.

    Parameters
    ----------
    experiments, controls : sequences of Experiment
        Effects act in the first only.
    cases : dict
        As `baseline_cases` gives them, of both.
    runner : Runner
    effects : sequence of str, optional
        Only these effects of the catalogue.
    draws : int
        Size of the ensemble.
    seed : int

    Raises
    ------
    NumericalError
        A baseline fails, or too much of the ensemble. An effect whose runs fail is left out.
    """
    everyone = (*experiments, *controls)
    chosen, left_out = applicable_effects(
        {one.name: cases[one.name] for one in experiments}, effects
    )
    closures = {name: closures_of(name) for name in chosen}
    quantities = nuisances(everyone, cases)
    z = draw(quantities, draws, seed)
    drawn, refused = ensemble_runs(everyone, cases, quantities, z)
    wanted = baseline_runs(everyone, cases) | drawn
    wanted |= effect_runs(closures, experiments, cases, left_out)
    seen, failures = runner.observations(wanted)
    reading = Reading(choose_points(everyone), seen, failures | refused)
    samples, kept = reading.ensemble(draws)
    responses = measured_responses(reading, closures, left_out)
    return Library(
        points=reading.points,
        experiments=tuple(experiments),
        cases=cases,
        coarse=reading.coarse,
        fine=reading.fine,
        seen={one.name: reading.seen["fine", None, one.name] for one in everyone},
        quantities=quantities,
        draws=realised(quantities, z[kept]),
        samples=samples,
        closures={name: closures[name] for name in responses},
        responses=responses,
        corrections=reading.corrections,
        left_out=left_out,
    )


def baseline_runs(experiments, cases):
    """{label: (experiment, case)} of the baseline on both grids, the finer first."""
    fine = {("fine", None, one.name): (one, refined(cases[one.name])) for one in experiments}
    return fine | {("coarse", None, one.name): (one, cases[one.name]) for one in experiments}


def ensemble_runs(experiments, cases, quantities, z):
    """Runs of the draws z (m, n) of the quantities, and why the others cannot be.

    Returns
    -------
    (dict, dict)
        {label: (experiment, case)}, and {label: NumericalError} of draws that are no legal case.
    """
    wanted, refused = {}, {}
    for n, row in enumerate(z):
        for one in experiments:
            label = "draw", n, one.name
            try:
                wanted[label] = one, with_nuisances(cases[one.name], one.name, quantities, row)
            except CaseError as error:
                refused[label] = NumericalError(f"{error.key} cannot be {error.found}")
    return wanted, refused


def effect_runs(closures, experiments, cases, left_out):
    """{label: (experiment, case)} of all levels; an effect that a case cannot have goes to `left_out`."""
    wanted = {}
    for name, own in closures.items():
        levels = {}
        try:
            for one in experiments:
                if acts_in(name, cases[one.name]):
                    levels |= level_cases(own, one, cases[one.name])
        except CaseError as error:
            left_out[name] = f"{error.key} cannot be {error.found} in this case"
            continue
        wanted |= levels
    return wanted


def measured_responses(reading, closures, left_out):
    """{effect: [Response]} of what changes anything measured; why the others do not is put in `left_out`."""
    found = {}
    for name in (name for name in closures if name not in left_out):
        try:
            found[name] = [reading.response(n, each) for n, each in enumerate(closures[name])]
        except NumericalError as error:
            left_out[name] = str(error)
    silent = [name for name, own in found.items() if not any(map(changes_something, own))]
    left_out |= dict.fromkeys(silent, "it changes nothing that was measured")
    return {name: own for name, own in found.items() if name not in left_out}


def changes_something(response):
    """Whether a response differs from zero anywhere."""
    return np.abs(response.differences).max() > 0.0


def realised(quantities, z):
    """The draws (m, n) that the values stand for; see `Nuisance.realised`."""
    return np.array(
        [[one.realised(shift) for one, shift in zip(quantities, row, strict=True)] for row in z]
    )


def level_cases(closures, experiment, case):
    """{label: (experiment, case)} of an effect at all levels of its closures, and at one on the finer grid."""
    found = {}
    for number, closure in enumerate(closures):
        key = closure.effect, number
        levels = [
            case.replace(**{f"effects.{closure.effect}": closure.section(u)})
            for u in closure.levels()
        ]
        for level, each in enumerate(levels):
            found[key, level, experiment.name] = (experiment, each)
        fine = refined(levels[reference_level(closure.levels())])
        found[key, "fine", experiment.name] = (experiment, fine)
    return found


def add_levels(library, wanted, runner):
    """The library with further levels of some closures; one whose run fails stays as it is.

    Parameters
    ----------
    library : Library
    wanted : list of (str, int, (d,) array)
        Effect, number of the closure, and quantiles of its parameters.
    runner : Runner
    """
    names = [one.name for one in library.experiments]
    cases = {}
    for effect, number, u in wanted:
        section = library.closures[effect][number].section(u)
        for one in library.experiments:
            if acts_in(effect, library.cases[one.name]):
                case = library.cases[one.name].replace(**{f"effects.{effect}": section})
                cases[(effect, number), 0, one.name] = (one, case)
    reading = Reading(library.points, *runner.observations(cases))
    responses = dict(library.responses)
    for effect, number, u in wanted:
        if any(((effect, number), 0, name) in reading.failures for name in names):
            continue
        difference = reading.vector((effect, number), 0, library.coarse) - library.coarse
        if (effect, number) in library.corrections:
            difference = library.corrections[effect, number](difference)
        before = responses[effect][number]
        after = Response.fit(
            np.vstack([before.levels, u]), np.vstack([before.differences, difference])
        )
        responses[effect] = [*responses[effect]]
        responses[effect][number] = after
    return replace(library, responses=responses)


class Reading:
    """Observations of labelled runs (what, number, experiment) as vectors over the points."""

    def __init__(self, points, seen, failures):
        self.points, self.seen, self.failures = points, seen, failures
        self.parts = {one.name: choose_points((one,)) for one in points.experiments}
        self.corrections = {}

    @cached_property
    def coarse(self):
        """Baseline on the coarser grid, (N,)."""
        return self.vector("coarse", None)

    @cached_property
    def fine(self):
        """Baseline on the finer grid, (N,)."""
        return self.vector("fine", None)

    def vector(self, what, number, base=None):
        """(N,) of the runs of one label; where it was not run for an experiment, `base` there.

        Raises
        ------
        NumericalError
            One of the runs failed.
        """
        parts = []
        for name, part in self.parts.items():
            label = (what, number, name)
            if label in self.failures:
                raise self.failures[label]
            if label in self.seen:
                parts.append(part.simulated({name: self.seen[label]}))
            else:
                parts.append(base[self.points.of(name)])
        return np.concatenate(parts)

    def ensemble(self, count):
        """(samples (m, N), indices of the draws) of the draws that no experiment failed in."""
        samples, kept, failure = [], [], None
        for n in range(count):
            try:
                samples.append(self.vector("draw", n))
                kept.append(n)
            except NumericalError as error:
                failure = error
        if len(kept) < max(4, count // 2):
            what = f"{count - len(kept)} of {count} draws of the calibrated parameters fail"
            raise NumericalError(f"{what}, the last: {failure}")
        return np.array(samples), kept

    def correction(self, key, reference):
        """The `GridCorrection` of a closure whose response at the level of reference is known on the coarser grid.

        Raises
        ------
        NumericalError
            Its run on the finer grid failed.
        """
        change = self.vector(key, "fine", self.fine) - self.fine - reference
        return GridCorrection(reference, change, 1.0 / self.points.sigma)

    def response(self, number, closure):
        """The `Response` of a closure.

        Raises
        ------
        NumericalError
            Too many of its runs failed.
        """
        key, levels = (closure.effect, number), closure.levels()
        differences, failure = {}, None
        for n in range(len(levels)):
            try:
                differences[n] = self.vector(key, n, self.coarse) - self.coarse
            except NumericalError as error:
                failure = error
        if len(differences) < max(2, (1.0 - FAILED_LEVELS) * len(levels)):
            failed = len(levels) - len(differences)
            raise NumericalError(f"{failed} of its {len(levels)} runs fail: {failure}")
        correct = np.asarray  # as they are, unless one level ran on both grids
        if (reference := differences.get(reference_level(levels))) is not None:
            with suppress(NumericalError):
                correct = self.corrections[key] = self.correction(key, reference)
        return Response.fit(
            levels[list(differences)], np.array([*map(correct, differences.values())])
        )
