"""What a response owes to the coarse grid on which most of its levels are run.

An effect that acts in layers thinner than a cell is weaker there: an erodible layer of 4 mm at 16 degrees
shortens the run by 65 mm on cells of a twelfth of the height (12 mm) and by 102 and 119 mm on 8 and 6 mm
cells. One level is therefore run on the finer grid too, and the change of the response there is added
to all levels, in proportion to their own response.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

REFERENCE = 0.65  # quantile of all parameters, near which the level that is run on both grids lies


class GridCorrection(NamedTuple):
    """Response at the level of reference on the coarser grid, and what it changes by on the finer one, (N,).

    `weight` (N,) is one over the standard deviation of the measurement.
    """

    reference: np.ndarray
    change: np.ndarray
    weight: np.ndarray

    def __call__(self, difference: np.ndarray) -> np.ndarray:
        """Response (N,) as the finer grid would have it: d + a change, a the part of the reference in d."""
        reference = self.weight * self.reference
        size = reference @ reference
        if size == 0.0:
            return difference
        return difference + (self.weight * difference) @ reference / size * self.change


def reference_level(levels: "ArrayLike") -> int:
    """Index of the level (of m, in d parameters) that is run on both grids."""
    distance = np.linalg.norm(np.asarray(levels) - REFERENCE, axis=1)
    return int(np.argmin(distance))
