"""Operations on whole arrays (n, m), as loops: slices that are assigned take the compiler ten times as long."""

from numba import njit


@njit(cache=True)
def copy(target, source):
    """Copy an array into another one."""
    for i in range(target.shape[0]):
        for k in range(target.shape[1]):
            target[i, k] = source[i, k]


@njit(cache=True)
def scale(target, factor):
    """Multiply an array by another one, in place."""
    for i in range(target.shape[0]):
        for k in range(target.shape[1]):
            target[i, k] *= factor[i, k]


@njit(cache=True)
def largest(values):
    """Largest magnitude."""
    most = 0.0
    for i in range(values.shape[0]):
        for k in range(values.shape[1]):
            most = max(most, abs(values[i, k]))
    return most


@njit(cache=True)
def average(target, other):
    """Mean of two arrays, into the first."""
    for i in range(target.shape[0]):
        for k in range(target.shape[1]):
            target[i, k] = 0.5 * (target[i, k] + other[i, k])
