"""What experiments in which nothing is hidden teach about the model: its discrepancy, not its rheology.

The gaps of the controls are explained by U, the covariance of everything that is known to be uncertain,
and a discrepancy S K S: K is the kernel of `covariance.discrepancy_kernel` with a correlation rho^D
between runs whose set-ups are D apart, S one factor for each observable. What a model leaves out depends on
the set-up: the same column on the same slope is missed by the same amount, however badly. The factors and
rho are those that make the gaps of the controls most probable. What an effect of the catalogue explains of them is
carried over by its response (`shared_physics`). Given these gaps, the discrepancy of
another run has a mean and a covariance (Gaussian conditioning): with them it is judged.

References
----------
Kennedy & O'Hagan (2001), J. R. Stat. Soc. B 63, 425.
"""

from collections.abc import Mapping, Sequence
from math import inf, sqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve
from scipy.optimize import minimize
from scipy.spatial.distance import cdist

from fvcollapse.case.case import GRAVITY
from fvcollapse.case.grammar import as_table
from fvcollapse.diagnosis.covariance import BETWEEN_RUNS
from fvcollapse.diagnosis.points import Points
from fvcollapse.diagnosis.shared_physics import covariance_of, shared_physics

if TYPE_CHECKING:
    from fvcollapse.measure.experiment import Experiment

# logarithm of a factor before the controls are seen: a model may leave out a mechanism, such as the
# change of volume, of which its parameters know nothing
FACTOR_MEDIAN, FACTOR_SPREAD = 0.3, 3.0
SLOPE_APART = 6.0  # degrees that are one unit of D
SIZE_APART = 0.5  # one unit, of ln height, ln length, height / width and of the gate
FRICTION_APART = 0.1  # one unit, of the friction of grains, bed and back wall
SLOWEST_GATE = 5.0  # sqrt(g height) over its speed, as far as that counts
# (the units are chosen, not learned: two controls tell one distance)
IN_NUMBERS = (
    "slope_angle_deg",
    "height_0",
    "length_0",
    "channel_width",
)  # the rest is alike or not
REPEATED = 0.98  # correlation of two runs of the same set-up: the packing is never the same
CORRELATIONS = (0.02, 0.98)  # range of rho
CORRELATION_SPREAD = 1.5  # of its logit
FIRST_STEP = 0.7  # of the search
MOST_POINTS = 300  # from which factors and rho are learned; of more, which are close together, every second, third, …


class Discrepancy(NamedTuple):
    """What was learned of the model.

    Attributes
    ----------
    factors : dict
        Observable -> factor of its discrepancy.
    correlation : float
        rho of runs one unit apart.
    covariance : (N, N) array
        S K S, and that of the effects.
    effects : dict
        Effect that the controls show in all runs -> its share; see `shared_physics`.
    """

    factors: dict[str, float]
    correlation: float
    covariance: np.ndarray
    effects: dict[str, float] = {}  # noqa: RUF012


class Shown(NamedTuple):
    """What the controls show.

    Attributes
    ----------
    points : Points
        Of experiments and controls, N of them.
    given : (N,) bool array
        Points of the controls whose gap is known (a bound is no gap).
    gap : (N,) array
        Simulated - measured.
    """

    points: Points
    given: np.ndarray
    gap: np.ndarray


class Conditioned(NamedTuple):
    """Mean (n,) and covariance (n, n) of the gap of some points, given that of others."""

    mean: np.ndarray
    covariance: np.ndarray


def set_ups_apart(experiments: "Sequence[Experiment]") -> np.ndarray:
    """Distance D of the set-ups of experiments as they are stated: (n, n) array, 1 for 6 degrees of slope."""
    places, others = [], []
    for experiment in experiments:
        case = experiment.case()
        geometry, law, bed = case.geometry, case.rheology, case.boundary
        gate = sqrt(GRAVITY * geometry.height_0) / case.gate.speed if case.gate.speed else inf
        sizes = [
            np.log(geometry.height_0),
            np.log(geometry.length_0),
            geometry.height_0 / geometry.channel_width,  # 0 without lateral walls
            min(gate, SLOWEST_GATE),  # 0 where it is removed at once
        ]
        friction = [law.mu_1, max(law.mu_1 - bed.mu_bed, 0.0), bed.mu_back_wall]
        places.append(
            [
                geometry.slope_angle_deg / SLOPE_APART,
                *(np.array(sizes) / SIZE_APART),
                *(np.array(friction) / FRICTION_APART),
            ]
        )
        table = as_table(case)["geometry"]
        others.append({key: value for key, value in table.items() if key not in IN_NUMBERS})
    shaped = np.array([[float(a != b) for b in others] for a in others])
    return cdist(places, places) + shaped


def learn(
    shown: Shown,
    covariance: np.ndarray,
    kernel: np.ndarray,
    apart: np.ndarray,
    columns: Mapping[str, np.ndarray] | None = None,
) -> Discrepancy:
    """The `Discrepancy` that the controls show, with the effects of the catalogue that explain it best.

    Parameters
    ----------
    shown : Shown
    covariance, kernel, apart
        See `learn_smooth`.
    columns : dict, optional
        Effect -> its changes of all runs; see `shared_physics`.
    """
    smooth = learn_smooth(shown, covariance, kernel, apart)
    columns = columns or {}
    effects = shared_physics(columns, shown.given, shown.gap, covariance, smooth.covariance)
    if not effects:
        return smooth
    physics = covariance_of(columns, effects, len(shown.points))
    rest = learn_smooth(shown, covariance + physics, kernel, apart)
    return rest._replace(covariance=rest.covariance + physics, effects=effects)


def learn_smooth(
    shown: Shown, covariance: np.ndarray, kernel: np.ndarray, apart: np.ndarray
) -> Discrepancy:
    """The `Discrepancy` without an effect of the catalogue.

    Parameters
    ----------
    shown : Shown
    covariance, kernel : (N, N) arrays
        U and K_delta.
    apart : (N, N) array
        Distance D of the runs of two points.
    """
    smooth, given = Smooth(shown, apart), np.flatnonzero(shown.given)
    given = given[:: -(-len(given) // MOST_POINTS)]
    own = np.ix_(given, given)
    seen, known = shown.gap[given], covariance[own]

    def cost(parameters: np.ndarray) -> float:
        """Minus the logarithm of likelihood and prior."""
        total = known + smooth.covariance(parameters, given, kernel[own])
        try:
            factor = cho_factor(total, lower=True, check_finite=False)
        except LinAlgError:
            return 1.0e10
        log_determinant = 2.0 * np.log(np.diag(factor[0])).sum()
        fit = 0.5 * (seen @ cho_solve(factor, seen, check_finite=False) + log_determinant)
        return fit + smooth.penalty(parameters)

    first = first_factors(smooth.names, smooth.observable[given], seen, kernel[own])
    start = np.append(np.log(first), 0.0)
    simplex = np.vstack([start, start + FIRST_STEP * np.eye(len(start))])
    options = {"initial_simplex": simplex, "xatol": 0.02, "fatol": 0.02}
    best = minimize(cost, start, method="Nelder-Mead", options=options).x
    return Discrepancy(
        smooth.factors(best), smooth.correlation(best), smooth.covariance(best, slice(None), kernel)
    )


class Smooth:
    """S K S for given parameters: logarithms of the factors of the observables `names`, and the logit of rho."""

    def __init__(self, shown: Shown, apart: np.ndarray) -> None:
        self.observable = shown.points.observable
        self.names = np.unique(self.observable[shown.given]).tolist()
        _, first, self.run = np.unique(shown.points.experiment, True, True)
        self.between_runs = apart[np.ix_(first, first)]

    def factors(self, parameters: np.ndarray) -> dict[str, float]:
        """{observable: factor}."""
        return dict(zip(self.names, np.exp(parameters[:-1]).tolist(), strict=True))

    def correlation(self, parameters: np.ndarray) -> float:
        """Correlation rho of runs one unit apart."""
        low, high = CORRELATIONS
        return float(low + (high - low) / (1.0 + np.exp(-parameters[-1])))

    def covariance(
        self, parameters: np.ndarray, rows: np.ndarray | slice, kernel: np.ndarray
    ) -> np.ndarray:
        """S K S of some points, whose `kernel` is given."""
        factors = self.factors(parameters)
        factor = np.array([factors.get(name, FACTOR_MEDIAN) for name in self.observable[rows]])
        shared = REPEATED * self.correlation(parameters) ** self.between_runs / BETWEEN_RUNS
        np.fill_diagonal(shared, 1.0)
        between = shared[np.ix_(self.run[rows], self.run[rows])]
        return between * kernel * np.outer(factor, factor)

    def penalty(self, parameters: np.ndarray) -> float:
        """Minus the logarithm of the prior."""
        shifts = (parameters[:-1] - np.log(FACTOR_MEDIAN)) / FACTOR_SPREAD
        return 0.5 * (shifts @ shifts) + 0.5 * (parameters[-1] / CORRELATION_SPREAD) ** 2


def first_factors(
    names: Sequence[str], observable: np.ndarray, gap: np.ndarray, kernel: np.ndarray
) -> np.ndarray:
    """Factors (n,) that give each observable the root mean square of its gap."""
    mean = {name: np.mean(gap[observable == name] ** 2) for name in names}
    own = {name: np.mean(np.diag(kernel)[observable == name]) for name in names}
    return np.array([np.sqrt(max(mean[name] / own[name], 1.0e-4)) for name in names])


def condition(
    given: np.ndarray, wanted: np.ndarray, gap: np.ndarray, covariance: np.ndarray
) -> Conditioned:
    """The `Conditioned` gap of some points, given that of others.

    Parameters
    ----------
    given, wanted : (N,) bool arrays
    gap : (N,) array
        Known where `given`.
    covariance : (N, N) array
        Of all gaps, the learned discrepancy included.
    """
    across = covariance[np.ix_(wanted, given)]
    factor = cho_factor(covariance[np.ix_(given, given)], lower=True, check_finite=False)
    mean = across @ cho_solve(factor, gap[given], check_finite=False)
    spread = across @ cho_solve(factor, across.T, check_finite=False)
    own = covariance[np.ix_(wanted, wanted)] - spread
    return Conditioned(mean, 0.5 * (own + own.T))
