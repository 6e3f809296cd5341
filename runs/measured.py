"""A measured number and its grid uncertainty, from the values on one grid or more.

| grids | uncertainty of the value on the finest |
|---|---|
| 1 | unknown, NaN |
| 2 | three times their difference (Roache 1994) |
| 3 | grid convergence index, absolute (`fvcollapse.studies.convergence`) |
| 4 or more | that of the trend fitted to all (`fvcollapse.studies.least_squares`: Eca & Hoekstra 2014) |

The trend counts where the values scatter about it by less than they differ; else the index of the finest three does.
"""

import math
from typing import NamedTuple

from fvcollapse.studies.convergence import ROUND_OFF, judged
from fvcollapse.studies.least_squares import LEAST_VALUES, fit

SAFETY = 3.0  # of the difference of two grids
FORMAL_ORDER = 1.0  # of the free surface


class Measured(NamedTuple):
    """A value, its grid uncertainty (NaN: unknown), and the names of the cases that it is made of."""

    value: float
    uncertainty: float = math.nan
    cases: frozenset = frozenset()

    def __abs__(self):
        """The modulus, as uncertain."""
        return self._replace(value=abs(self.value))

    def scaled(self, factor):
        """The number in another unit."""
        return self._replace(value=factor * self.value, uncertainty=factor * self.uncertainty)


def from_grids(sizes, values, cases=frozenset()):
    """The `Measured` of values on grids from coarse to fine; sizes in any unit.

    A value that does not exist (NaN) on one grid makes the uncertainty NaN.
    """
    return Measured(values[-1], uncertainty(sizes, values), cases)


def uncertainty(sizes, values):
    """The uncertainty of the last value, by the table of this module's docstring."""
    if len(values) == 1 or any(math.isnan(value) for value in values):
        return math.nan
    if len(values) == 2:
        return SAFETY * abs(values[1] - values[0])
    if len(values) >= LEAST_VALUES:
        found = of_trend(sizes, values)
        if found is not None:
            return found
    return of_triplet(sizes[-3:], values[-3:])


def of_trend(sizes, values):
    """Uncertainty of the fitted trend, None where the values scatter about it by more than they differ."""
    # an uncertainty does not depend on the zero of the scale, which `fit` needs away from the values
    shift = 1.0 + max(abs(value) for value in values)
    shifted = [float(value + shift) for value in values]
    found = fit(sizes, shifted)
    if found is None:
        return None
    scatter = found.deviation * shifted[-1]
    mean_step = (max(values) - min(values)) / (len(values) - 1)
    return found.uncertainty * shifted[-1] if scatter < mean_step else None


def of_triplet(sizes, values):
    """Absolute grid convergence index of three values."""
    coarse, medium, fine = values
    none = ROUND_OFF * max(abs(value) for value in values)
    width = max(values) - min(values)
    return judged(sizes, coarse - medium, medium - fine, width, none, FORMAL_ORDER).bound
