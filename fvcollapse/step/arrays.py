"""Operations on whole arrays, (n, m) unless said otherwise, as loops: Numba compiles its own much longer."""

from .compiled import inner_jit, kernel_jit


@inner_jit()
def copy(target, source):
    """Copy an array into another one."""
    for i in range(target.shape[0]):
        for k in range(target.shape[1]):
            target[i, k] = source[i, k]


@inner_jit()
def scale(target, factor):
    """Multiply an array by another one, in place."""
    for i in range(target.shape[0]):
        for k in range(target.shape[1]):
            target[i, k] *= factor[i, k]


@inner_jit()
def larger(a, b):
    """Maximum of a and b; NaN if one of them is, which `max` may drop."""
    return a if b <= a or a != a else b


@kernel_jit()
def largest(values):
    """Largest magnitude; NaN if there is one."""
    most = 0.0
    for i in range(values.shape[0]):
        for k in range(values.shape[1]):
            most = larger(most, abs(values[i, k]))
    return most


@kernel_jit()
def average(target, other):
    """Mean of two arrays, into the first."""
    for i in range(target.shape[0]):
        for k in range(target.shape[1]):
            target[i, k] = 0.5 * (target[i, k] + other[i, k])


@inner_jit()
def add(target, other):
    """Add an array to another one, in place."""
    for i in range(target.shape[0]):
        for k in range(target.shape[1]):
            target[i, k] += other[i, k]


@inner_jit()
def subtract(target, other):
    """Subtract an array from another one, in place."""
    for i in range(target.shape[0]):
        for k in range(target.shape[1]):
            target[i, k] -= other[i, k]


@inner_jit()
def total(values):
    """Sum of the values (n,), one after the other; the method `sum` makes every start import half of scipy."""
    found = 0.0
    for n in range(values.size):
        found += values[n]
    return found
