"""Effects that act by another closure than those of the catalogue, as the effects of real grains do.

No closure of the catalogue is that of real grains: adhesion of wet grains, a dense packing or rubbing walls change a
collapse where the closure says, and by more here and less there. In a part of the cases a run with hidden effects is
therefore read with a smooth error (`outside.smooth_error`) in proportion to its response to them, the difference to
the same run without them. (The closures that come closest leave 27 and 70 % of the change of the thickness of particle
columns by adhesion and by a dense packing, and make two other columns worse: runs/particle_laboratory/closures.csv.)
A diagnosis that takes what is left for a cause outside the catalogue is wrong.

Limits. The size of the error is one number for all profiles of a run and one for its front, wherever and whenever the
response is large. The error goes on varying after the grains have come to rest, as that of a world does. What acts on
the front alone (`front_saltation`) changes the profiles a little as well, since both are stretched. Unknown causes have
no form, so that a large smooth error speaks for effects of the catalogue.
"""

from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.blind.outside import smooth_error
from fvcollapse.blind.plain_values import Form

if TYPE_CHECKING:
    from fvcollapse.blind.truth import View

SHARES = (0.2, 0.7)  # of the response that another closure leaves
HEIGHT_MOST, REACH_MOST = 0.25, 0.1  # largest relative standard deviations of thickness and reach
FEW, MANY = 1, 8  # waves of the patterns of blind suites and of training


def draw_form(rng: np.random.Generator, waves: int, lengths: tuple[float, float]) -> Form:
    """A form of the response to hidden effects.

    Parameters
    ----------
    rng : numpy.random.Generator
    waves : int
        Number of waves that make the pattern.
    lengths : (float, float)
        Length [m] and time [s] over which it varies.

    Returns
    -------
    dict
        `share` of the response that is changed, `waves` (n, 2) [1/m, 1/s] and `phases` (n,) of the pattern.
    """
    return {
        "share": float(rng.uniform(*SHARES)),
        "waves": (rng.standard_normal((waves, 2)) / lengths).tolist(),
        "phases": rng.uniform(0.0, 2.0 * np.pi, waves).tolist(),
    }


def reformed(view: "View", without: "View", form: Form, threshold: float) -> "View":
    """What is seen where the response to the effects has another form.

    Parameters
    ----------
    view, without : View
        Of the run with the effects by their closures of the catalogue, and of the same run without them.
    form : dict
        See `draw_form`.
    threshold : float
        Thickness of the front [m].
    """
    height, reach = relative_response(view, without)
    reading = {
        "height": min(form["share"] * height, HEIGHT_MOST),
        "reach": min(form["share"] * reach, REACH_MOST),
        "waves": form["waves"],
        "phases": form["phases"],
    }
    return smooth_error(reading, threshold, view)


def relative_response(view: "View", without: "View") -> tuple[float, float]:
    """Root mean squares of the change of thickness and of front by the effects, over those of the run with them."""
    along = np.array([np.interp(view.x, without.x, row, right=0.0) for row in without.thickness])
    plain = np.array([np.interp(view.time, without.time, column) for column in along.T]).T
    time, front = view.front.T
    front_without = np.interp(time, *without.front.T)
    height = root_mean_square(view.thickness - plain) / root_mean_square(view.thickness)
    return height, root_mean_square(front - front_without) / root_mean_square(front)


def root_mean_square(values: np.ndarray) -> float:
    """Of all values."""
    return float(np.sqrt(np.mean(values**2)))
