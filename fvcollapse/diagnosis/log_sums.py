"""Sums of exponentials by their logarithms, without the overhead of checks: they are taken by the ten thousand."""

import numpy as np


def log_sum_exp(values: np.ndarray, axis: int | None = None) -> np.ndarray | float:
    """Logarithm of the sum of exp(values) along an axis (None: of all), without overflow.

    Parameters
    ----------
    values : array
        -inf counts as nothing; +inf and NaN are not expected.
    axis : int, optional

    Returns
    -------
    array or float
        -inf where all values are.
    """
    top = np.max(values, axis=axis, keepdims=True)
    top = np.where(np.isfinite(top), top, 0.0)
    with np.errstate(divide="ignore"):
        total = np.log(np.exp(values - top).sum(axis=axis))
    return total + (top.item() if axis is None else top.squeeze(axis))
