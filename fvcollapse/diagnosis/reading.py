"""Observations of labelled runs as vectors over the points of comparison, and the responses in them."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fvcollapse.diagnosis.emulator import Response
from fvcollapse.diagnosis.grid_correction import GridCorrection, reference_level
from fvcollapse.diagnosis.scatter import SCATTERS, labels, scattered
from fvcollapse.errors import NumericalError

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.diagnosis.levels import Closure
    from fvcollapse.diagnosis.points import Points
    from fvcollapse.diagnosis.runner import Failures, Label, Number, What
    from fvcollapse.measure.observables import Observations

FAILED_LEVELS = 0.34  # share of the runs of a closure that may fail


class Responses(NamedTuple):
    """Responses of the effects.

    Attributes
    ----------
    responses : dict
        Effect -> list of `Response`, one for each closure.
    corrections : dict
        (effect, number of the closure) -> `GridCorrection`, where the run on the finer grid did not fail.
    left_out : dict
        Effect -> why it has no response.
    """

    responses: dict[str, list[Response]]
    corrections: dict[tuple[str, int], GridCorrection]
    left_out: dict[str, str]


def measured_responses(
    reading: "Reading", closures: "Mapping[str, Sequence[Closure]]"
) -> Responses:
    """The `Responses` of effects: of those that change a measured value.

    Parameters
    ----------
    reading : Reading
    closures : dict
        Effect -> its `Closure`s.
    """
    responses, corrections, left_out = {}, {}, {}  # type: ignore[var-annotated]
    for name, variants in closures.items():
        try:
            pairs = [reading.response(n, closure) for n, closure in enumerate(variants)]
        except NumericalError as error:
            left_out[name] = str(error)
            continue
        if not any(changes_something(response) for response, _ in pairs):
            left_out[name] = "it changes nothing that was measured"
            continue
        responses[name] = [response for response, _ in pairs]
        corrections |= {
            (name, n): correction for n, (_, correction) in enumerate(pairs) if correction
        }
    return Responses(responses, corrections, left_out)


def changes_something(response: Response) -> bool:
    """Whether a response differs from zero anywhere."""
    return np.abs(response.differences).max() > 0.0


class Reading:
    """Observations of labelled runs (what, number, experiment) as vectors over the points.

    `cases` {experiment: Case} are those of the baseline; only effects that scatter need them.
    """

    def __init__(
        self,
        points: "Points",
        seen: "Mapping[Label, Observations]",
        failures: "Failures",
        cases: "Mapping[str, Case] | None" = None,
    ) -> None:
        self.points, self.seen, self.failures, self.cases = points, seen, failures, cases
        self.parts = points.parts

    @cached_property
    def coarse(self) -> np.ndarray:
        """Baseline on the coarser grid, (N,)."""
        return self.vector("coarse", None)

    @cached_property
    def fine(self) -> np.ndarray:
        """Baseline on the finer grid, (N,)."""
        return self.vector("fine", None)

    def vector(self, what: "What", number: "Number", base: np.ndarray | None = None) -> np.ndarray:
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
                parts.append(base[self.points.of(name)])  # type: ignore[index]
        return np.concatenate(parts)

    def realised(
        self, closure: "Closure", key: tuple[str, int], level: int | str, base: np.ndarray
    ) -> np.ndarray:
        """Differences (m, N) to a baseline of the realisations of a level: one if the effect does not scatter."""
        numbers = labels(closure.effect, level)
        return np.array([self.vector(key, number, base) - base for number in numbers])

    def ensemble(self, count: int) -> tuple[np.ndarray, list[int]]:
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

    def correction(
        self, closure: "Closure", key: tuple[str, int], reference: np.ndarray
    ) -> GridCorrection:
        """The `GridCorrection` of a closure whose response at the level of reference is known on the coarser grid.

        Raises
        ------
        NumericalError
            Its run on the finer grid failed.
        """
        change = self.realised(closure, key, "fine", self.fine).mean(axis=0) - reference
        return GridCorrection(reference, change, 1.0 / self.points.sigma)

    def response(self, number: int, closure: "Closure") -> tuple[Response, GridCorrection | None]:
        """The `Response` of a closure, and its `GridCorrection`; None where the finer run failed.

        Raises
        ------
        NumericalError
            Too many of its runs failed.
        """
        key, levels = (closure.effect, number), closure.levels()
        realised, failure = {}, None
        for n in range(len(levels)):
            try:
                realised[n] = self.realised(closure, key, n, self.coarse)
            except NumericalError as error:
                failure = error
        if len(realised) < max(2, (1.0 - FAILED_LEVELS) * len(levels)):
            failed = len(levels) - len(realised)
            raise NumericalError(f"{failed} of its {len(levels)} runs fail: {failure}")
        differences = {n: each.mean(axis=0) for n, each in realised.items()}
        correction = None
        if (reference := differences.get(reference_level(levels))) is not None:
            with suppress(NumericalError):
                correction = self.correction(closure, key, reference)
        changes = np.array([*map(correction or np.asarray, differences.values())])  # type: ignore[arg-type]
        response = Response.fit(levels[list(differences)], changes)
        if closure.effect in SCATTERS:
            departures = np.array([each - each.mean(axis=0) for each in realised.values()])
            response = scattered(response, closure, departures, self.curves())
        return response, correction

    def curves(self) -> "list[tuple[Points, Observations, Case]]":
        """(Points, Observations of the baseline, Case) of each experiment."""
        return [
            (part, self.seen["coarse", None, name], self.cases[name])  # type: ignore[index]
            for name, part in self.parts.items()
        ]
