"""The ensemble of calibrated parameters: its mean, its covariance and the sensitivity to each quantity."""

from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.diagnosis.covariance import calibration_covariance

if TYPE_CHECKING:
    from fvcollapse.diagnosis.library import Library

RIDGE = 0.1  # of the regression on the draws: few draws leave some directions open


def calibration_of(library: "Library") -> tuple[np.ndarray, np.ndarray]:
    """Mean of the ensemble (N,) and Sigma_nu (N, N)."""
    linear = library.sensitivities
    drawn = library.draws - library.draws.mean(axis=0)
    residual = library.samples - library.samples.mean(axis=0) - drawn @ linear
    entering = [
        sum(name in quantity.experiments for quantity in library.quantities)
        for name in library.points.names
    ]
    spare = max(len(library.draws) - 1 - max(entering), 1)
    return calibration_covariance(library.samples, linear, residual, spare)


def sensitivities(library: "Library") -> np.ndarray:
    """Change of the simulated values per standard deviation of each quantity, (n, N).

    Least squares over the ensemble, experiment by experiment on the quantities that enter it.
    """
    slopes = np.zeros((len(library.quantities), library.samples.shape[1]))
    for name in library.points.names:
        rows = library.points.of(name)
        columns = [
            n for n, quantity in enumerate(library.quantities) if name in quantity.experiments
        ]
        z = library.draws[:, columns]
        z = z - z.mean(axis=0)
        change = library.samples[:, rows] - library.samples[:, rows].mean(axis=0)
        normal = z.T @ z + RIDGE * np.eye(len(columns))
        slopes[columns, rows] = np.linalg.solve(normal, z.T @ change)
    return slopes
