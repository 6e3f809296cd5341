"""Re-calibration on the emulator: parameters of the effects and of the material, fitted together.

Gauss-Newton with the parameters of the effects inside the central 98 % of their priors and the calibrated
parameters of the material held by their uncertainty.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import least_squares
from scipy.special import ndtri

from fvcollapse.diagnosis.baseline import refined
from fvcollapse.diagnosis.controls import condition
from fvcollapse.diagnosis.gap_map import beyond_bounds
from fvcollapse.diagnosis.names import NONE, effects_of
from fvcollapse.diagnosis.nuisances import CALIBRATED, value_of, with_nuisances

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.diagnosis.analysis import Analysis
    from fvcollapse.diagnosis.emulator import Response
    from fvcollapse.diagnosis.evidence import Hypothesis
    from fvcollapse.diagnosis.levels import Closure
    from fvcollapse.measure.experiment import Experiment

LEAST_QUANTILE = 0.01  # of the prior of a parameter of an effect, and 1 - this the largest
MOST_DEVIATIONS = 3.0  # of a calibrated parameter from its value


class Refit(NamedTuple):
    """A model re-calibrated on the emulator.

    Attributes
    ----------
    effects : dict
        Effect -> (`Closure`, quantiles u (d,)).
    z : (n,) array
        Of the calibrated parameters of the material, in standard deviations.
    """

    effects: "dict[str, tuple[Closure, np.ndarray]]"
    z: np.ndarray


class Recalibration:
    """The least-squares problem of all models, on the points of the library.

    What no parameter of the material can explain is in the covariance: measurement, discretisation,
    set-up, and the discrepancy at the size that the hypothesis found.
    """

    def __init__(self, analysis: "Analysis") -> None:
        library = analysis.library
        self.analysis, self.library = analysis, library
        rows = [n for n, quantity in enumerate(library.quantities) if quantity.key in CALIBRATED]
        self.quantities = tuple(library.quantities[n] for n in rows)
        self.slopes = library.sensitivities[rows]
        self.kind = library.points.kind

    def fit(self, name: str, rows: np.ndarray) -> Refit:
        """The `Refit` of a hypothesis ("": no effect) on some points (N,) of the library."""
        hypothesis = self.analysis.evidence.hypotheses[name or NONE]
        parts = self.parts(name, hypothesis)
        count = sum(len(u) for _, _, u in parts)
        start = np.concatenate([*(u for _, _, u in parts), np.zeros(len(self.quantities))])
        start[:count] = np.clip(start[:count], 2.0 * LEAST_QUANTILE, 1.0 - 2.0 * LEAST_QUANTILE)
        low = np.full(len(start), -MOST_DEVIATIONS)
        low[:count] = LEAST_QUANTILE
        high = np.where(np.arange(len(start)) < count, 1.0 - LEAST_QUANTILE, MOST_DEVIATIONS)
        residual = self.residual(parts, count, hypothesis.sigma, rows)
        if len(start):
            start = least_squares(residual, start, bounds=(low, high), x_scale=0.3).x
        effects, first = {}, 0
        for closure, _, u in parts:
            effects[closure.effect] = (closure, start[first : first + len(u)])
            first += len(u)
        return Refit(effects, start[count:])

    def parts(
        self, name: str, hypothesis: "Hypothesis"
    ) -> "list[tuple[Closure, Response, np.ndarray]]":
        """(closure, response, u) of each effect of a hypothesis, as the evidence has them."""
        members, first = [], 0
        for effect, variant in zip(effects_of(name or NONE), hypothesis.variant, strict=True):
            response = self.library.responses[effect][variant]
            u = hypothesis.u[first : first + response.dimension]
            first += response.dimension
            members.append((self.library.closures[effect][variant], response, u))
        return members

    def residual(
        self,
        parts: "Sequence[tuple[Closure, Response, np.ndarray]]",
        count: int,
        sigma: float,
        rows: np.ndarray,
    ) -> Callable[[np.ndarray], np.ndarray]:
        """Function of (u, z): whitened gaps, gaps beyond bounds, and the priors: z, and u as a standard normal.

        Without its prior a parameter that the data do not see would run along a ridge to its bound.
        """
        values, bounds = rows & (self.kind == "value"), rows & (self.kind != "value")
        covariance = self.analysis.everything + 0.0
        own = self.analysis.own
        covariance[own, own] += sigma**2 * self.analysis.kernel
        factor = cholesky(covariance[np.ix_(values, values)], lower=True, check_finite=False)
        deviation = np.sqrt(np.diag(covariance))[bounds]
        gap, points = self.library.fine - self.library.points.measured, self.library.points

        def evaluate(parameters: np.ndarray) -> np.ndarray:
            whole = gap + self.change(parts, parameters[:count]) + parameters[count:] @ self.slopes
            white = solve_triangular(factor, whole[values], lower=True, check_finite=False)
            beyond = beyond_bounds(points, whole)[bounds] / deviation
            normal = ndtri(parameters[:count])
            return np.concatenate([white, beyond, normal, parameters[count:]])

        return evaluate

    def change(
        self, parts: "Sequence[tuple[Closure, Response, np.ndarray]]", u: np.ndarray
    ) -> np.ndarray:
        """Response of the effects at their quantiles, (N,)."""
        total, first = np.zeros(len(self.library.points)), 0
        for _, response, u_before in parts:
            total = total + response.at(u[first : first + len(u_before)])
            first += len(u_before)
        return total

    def predicted(self, fit: Refit) -> np.ndarray:
        """Values that the emulator gives for a fit, (N,)."""
        total = self.library.fine + fit.z @ self.slopes
        for effect, (closure, u) in fit.effects.items():
            number = self.library.closures[effect].index(closure)
            total = total + self.library.responses[effect][number].at(u)
        return total

    def after_controls(self, fits: Mapping[str, Refit]) -> tuple[dict[str, np.ndarray], np.ndarray]:
        """({model: shift (n,)}, covariance (n, n)) of the gaps of the experiments, given the controls."""
        analysis, points = self.analysis, self.library.points
        if not analysis.controls:
            nothing = np.zeros(len(analysis.points))
            covariance = analysis.measurement + analysis.numerical
            return dict.fromkeys(fits, nothing), covariance
        wanted = np.arange(len(points)) < len(analysis.points)
        given = ~wanted & (self.kind == "value")
        gap, shifts = self.library.fine - points.measured, {}
        for model, fit in fits.items():
            conditioned = condition(given, wanted, gap + fit.z @ self.slopes, analysis.everything)
            shifts[model] = conditioned.mean
        return shifts, conditioned.covariance

    def case(self, fit: Refit, experiment: "Experiment", base: "Case") -> "Case":
        """The case of a fit on the finer grid, for an experiment whose coarser baseline is `base`."""
        name = experiment.name
        entering = [  # a material of the same value is the same material
            (quantity._replace(experiments=(name,)), shift)
            for quantity, shift in zip(self.quantities, fit.z, strict=True)
            if name in quantity.experiments or value_of(base, quantity.key) == quantity.mean
        ]
        case = with_nuisances(
            base, name, [quantity for quantity, _ in entering], [shift for _, shift in entering]
        )
        sections = {
            f"effects.{effect}": closure.section(u) for effect, (closure, u) in fit.effects.items()
        }
        return refined(case.replace(**sections))
