"""Covariance of the gap: measurement, discretisation, calibrated parameters, and the model itself.

    U = Sigma_D + Sigma_num + Sigma_nu,        C(s) = U + s^2 K_delta.

Sigma_D holds the scatter of single points and what a whole run shares: the scale of its thicknesses,
the origin of X and the clock. Sigma_num is what two grids differ by, fully correlated inside a run.
Sigma_nu is the covariance of an ensemble of runs with calibrated parameters and set-up drawn from their
uncertainty (the clock excepted: it is in Sigma_D): that of its regression on what was drawn, and of the
rest. K_delta is the discrepancy that remains when every parameter is right.

References
----------
ASME V&V 20 (2009); Kennedy & O'Hagan (2001), J. R. Stat. Soc. B 63, 425; Schaefer & Strimmer (2005),
Stat. Appl. Genet. Mol. Biol. 4, 32 (shrinkage of the correlation).
"""

from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.measure.quantities import HEIGHTS, QUANTITIES

if TYPE_CHECKING:
    from fvcollapse.diagnosis.points import Points, Sensitivity

SMALLEST = (
    1.0e-3  # a standard deviation of 0 is read as this part of the largest value of the curve
)
SMALLEST_SHRINKAGE = 1.0e-3
SENSITIVE = 0.3  # amplitude where the parameters do nothing, relative to its rms over the curve
# and the least one, in standard deviations of the measurement: on the labelled cases of a particle
# simulation (walls, slow gate) 1 has a larger evidence than 0.1, by 56 and 110 for the true cause
INSENSITIVE = 1.0
LENGTH_X, LENGTH_T = 0.15, 0.30  # correlation lengths of the discrepancy in lengths and durations
AT_REST = 1.2  # durations after which nothing changes any more
BETWEEN_RUNS = 0.5  # correlation of the discrepancies of two runs
COMMON = None  # in place of the name of one experiment: the error is that of the laboratory


def measurement_covariance(points: "Points", sensitivity: "Sensitivity") -> np.ndarray:
    """Sigma_D, (N, N), symmetric positive definite.

    Run-level errors, each one standard deviation of one shape: thicknesses, interface and final height
    in proportion, by sigma(height_0) / height_0 (the scale of the picture is known as well as the column);
    all X by sigma(length_0) (the place of the back wall in the picture); the clock by sigma(time). The
    standard deviations are those of `[uncertainty]`, else the defaults of `fvcollapse.measure.uncertainty`. An error
    that experiments have in `[common]` is one error of all of them.

    Parameters
    ----------
    points : Points
    sensitivity : Sensitivity
        Of a simulation on these points (`Points.sensitivity`).
    """
    shapes, heights = {}, np.isin(points.observable, HEIGHTS)  # type: ignore[var-annotated]
    for experiment in points.experiments:
        own = points.of(experiment)
        geometry = experiment.settings.geometry
        ruler = experiment.standard_deviation("height_0", geometry.height_0) / geometry.height_0  # type: ignore[arg-type, operator]
        offset = experiment.standard_deviation("length_0", geometry.length_0)  # type: ignore[arg-type]
        errors = {
            "height_0": ruler * np.where(heights, points.measured, 0.0)[own],
            "length_0": offset * sensitivity.origin[own],
            "time": experiment.standard_deviation("time") * sensitivity.clock[own],
        }
        for name, error in errors.items():
            laboratory = COMMON if experiment.has_common(name) else experiment.name
            shapes.setdefault((name, laboratory), np.zeros(len(points)))[own] = error
    shapes = np.array([*shapes.values()])  # type: ignore[assignment]
    covariance = shapes.T @ shapes  # type: ignore[attr-defined]
    covariance[np.diag_indices(len(points))] += floored(points) ** 2
    return covariance


def floored(points: "Points") -> np.ndarray:
    """Standard deviations of the measurement, none of them zero, (N,)."""
    sigma = points.sigma.copy()
    for block in points.blocks:
        own = slice(block.start, block.stop)
        least = max(SMALLEST * np.abs(points.measured[own]).max(), 1.0e-6)
        sigma[own] = np.where(sigma[own] > 0.0, sigma[own], least)
    return sigma


def numerical_covariance(
    points: "Points",
    coarse: np.ndarray,
    fine: np.ndarray,
    ratio: float,
    order: float,
    used: str = "fine",
) -> np.ndarray:
    """Sigma_num, (N, N), positive semi-definite: one rank-1 block for each run.

    The error of the finer grid is taken as (coarse - fine) / (ratio^order - 1), the one of the coarser
    grid as ratio^order times that (Richardson).

    Parameters
    ----------
    points : Points
    coarse, fine : (N,) arrays
        The same runs on two grids.
    ratio : float
        Coarse cell size / fine cell size, > 1.
    order : float
        Observed or expected order of convergence.
    used : str
        "fine" or "coarse": the grid of the values that are compared.
    """
    error = (coarse - fine) / (ratio**order - 1.0)
    if used == "coarse":
        error = error * ratio**order
    covariance = np.zeros((len(points), len(points)))
    for name in points.names:
        own = points.of(name)
        covariance[own, own] = np.outer(error[own], error[own])
    return covariance


def ensemble_covariance(samples: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean (N,) and covariance (N, N) of an ensemble, symmetric positive definite.

    The sample correlation is shrunk towards none by the amount that minimises its expected square error
    (Schaefer & Strimmer 2005): far fewer samples than points otherwise leave it singular. The covariance
    is that of a further draw about the mean of these, so the factor 1 + 1/m.

    Parameters
    ----------
    samples : (m, N) array
        m >= 2 runs.
    """
    samples = np.asarray(samples, float)
    m = len(samples)
    mean = samples.mean(axis=0)
    variance = samples.var(axis=0, ddof=1)
    variance = np.maximum(variance, max(1.0e-6 * variance.max(), 1.0e-18))
    scaled = (samples - mean) / np.sqrt(variance)
    correlation = scaled.T @ scaled / (m - 1.0)
    shrinkage = correlation_shrinkage(scaled, correlation)
    correlation *= 1.0 - shrinkage
    np.fill_diagonal(correlation, 1.0)
    scale = np.sqrt((1.0 + 1.0 / m) * variance)
    return mean, correlation * np.outer(scale, scale)


def calibration_covariance(
    samples: np.ndarray, linear: np.ndarray, rest: np.ndarray, spare: int
) -> tuple[np.ndarray, np.ndarray]:
    """Mean (N,) of an ensemble and Sigma_nu (N, N), symmetric positive definite.

    Twenty runs drawn in a dozen directions say little about any one direction: their plain covariance has
    far too little variance in most (the fitted amplitude of a smooth effect is off by up to twice its
    standard deviation where nothing acts). Their regression knows every direction; only what it leaves
    is described by the covariance of the samples.

    Parameters
    ----------
    samples : (m, N) array
        Runs.
    linear : (n, N) array
        Change per standard deviation of each quantity.
    rest : (m, N) array
        Samples - mean - what the regression gives.
    spare : int
        m - 1 - number of quantities that enter one run, >= 1.
    """
    m = len(samples)
    _, left = ensemble_covariance(rest)
    return samples.mean(axis=0), (1.0 + 1.0 / m) * linear.T @ linear + (m - 1.0) / spare * left


def correlation_shrinkage(scaled: np.ndarray, correlation: np.ndarray) -> float:
    """Estimated variances of all correlations over their squares, in [`SMALLEST_SHRINKAGE`, 1]."""
    m = len(scaled)
    squares = scaled**2
    # sum over i, j of sum_k (w_kij - mean w_ij)^2 with w_kij = scaled_ki scaled_kj
    mean_product = correlation * ((m - 1.0) / m)
    spread = squares.sum(axis=1) @ squares.sum(axis=1) - m * (mean_product**2).sum()
    own = (squares**2).sum() - m * (np.diag(mean_product) ** 2).sum()
    variance = m / (m - 1.0) ** 3 * (spread - own)
    square = (correlation**2).sum() - (np.diag(correlation) ** 2).sum()
    return float(np.clip(variance / square if square > 0.0 else 1.0, SMALLEST_SHRINKAGE, 1.0))


def discrepancy_amplitude(points: "Points", variance: np.ndarray) -> np.ndarray:
    """Standard deviation of K_delta, (N,): a model errs where its parameters matter.

    Parameters
    ----------
    points : Points
    variance : (N,) array
        Diagonal of Sigma_nu.
    """
    floor = np.empty(len(points))
    for block in points.blocks:
        own = slice(block.start, block.stop)
        floor[own] = SENSITIVE * np.sqrt(np.mean(variance[own]))
    return np.sqrt(variance + floor**2 + (INSENSITIVE * floored(points)) ** 2)


def discrepancy_kernel(points: "Points", amplitude: np.ndarray) -> np.ndarray:
    """K_delta, (N, N), positive semi-definite.

    Matern-3/2 in X / 0.15 length and t / 0.3 duration of each run, for each observable by itself (runout
    is the front at rest, final height the thickness at the wall at rest); runs correlate by 0.5. What
    is at rest stays as it is: later times are all one time.

    Parameters
    ----------
    points : Points
    amplitude : (N,) array
        As `discrepancy_amplitude` gives it.
    """
    place, moment = np.zeros(len(points)), np.full(len(points), AT_REST / LENGTH_T)
    for block in points.blocks:
        own, run = slice(block.start, block.stop), points.run(block)
        if not np.isnan(block.x).all():
            place[own] = block.x / (LENGTH_X * run.length)
        if not np.isnan(block.time).all():
            moment[own] = np.minimum(block.time / run.duration, AT_REST) / LENGTH_T
    distance = np.hypot(place[:, None] - place, moment[:, None] - moment)
    matern = (1.0 + np.sqrt(3.0) * distance) * np.exp(-np.sqrt(3.0) * distance)
    curve = points.per_point(lambda block: discrepancy_of(block.observable))
    run = points.experiment  # type: ignore[assignment]
    between = np.where(run[:, None] == run, 1.0, BETWEEN_RUNS)  # type: ignore[call-overload]
    return (curve[:, None] == curve) * between * matern * np.outer(amplitude, amplitude)


def discrepancy_of(observable: str) -> str:
    """The observable whose model error this one shares: itself, or the curve that a number belongs to."""
    quantity = QUANTITIES.get(observable)
    return quantity.discrepancy if quantity is not None and quantity.discrepancy else observable
