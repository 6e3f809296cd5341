"""Beads that detach ahead of the front and are taken for it: an effect of the observation.

    seen front = front + progress (bias + spread s(t)),   progress = (front - length_0) / height_0, from 0 to 1

s(t) is a scatter of unit variance that lasts as long as the flight of a bead. Bias and scatter set in as the front
travels the first height of the column, for before it moves no bead can detach; when it has stopped, the last beads
lie where they fell.

Limits: profiles and volume are seen without the beads.

References
----------
Shinozuka & Deodatis (1991), Appl. Mech. Rev. 44, 191, for the scatter.
"""

from typing import TYPE_CHECKING, Annotated

import numpy as np

from fvcollapse.case.grammar import Section, key
from fvcollapse.effects.effect import OBSERVATION, Effect, Prior, Seeing

if TYPE_CHECKING:
    from fvcollapse.case.case import Case

AT_REST = 1.0e-3  # m; a front so near to its last place has stopped
TONES = 256  # of the scatter; its correlation is exact to 1/sqrt(2 TONES) for each seed


class FrontSaltation(Section):
    """Beads that detach ahead of the front and are taken for it: an effect of the observation."""

    bias: Annotated[float, key("m", "how far ahead the front is seen", ge=-1, le=1)] = 0.0
    spread: Annotated[float, key("m", "standard deviation of its scatter", ge=0, le=1)] = 0.0
    correlation_time: Annotated[
        float, key("s", "how long a bead is ahead: correlation of the scatter", gt=0, le=1000)
    ] = 0.05
    seed: Annotated[int, key("-", "which realisation of the scatter", ge=0)] = 0


def seen_with_beads(
    section: FrontSaltation, case: "Case", time: np.ndarray, front: np.ndarray
) -> np.ndarray:
    """Front (n,) that is measured of a front (n,) at the times (n,); m, s."""
    geometry = case.geometry
    progress = np.clip((front - geometry.length_0) / geometry.height_0, 0.0, 1.0)
    stop = time[np.argmax(front > front.max() - AT_REST)]
    scatter = correlated_scatter(np.minimum(time, stop), section.correlation_time, section.seed)
    return front + progress * (section.bias + section.spread * scatter)


def scatter_covariance(
    section: FrontSaltation, case: "Case", time: np.ndarray, front: np.ndarray, at: np.ndarray
) -> np.ndarray:
    """Covariance (m, m) over spread^2 of what is seen at the times `at` (m,) of a front (n,) at `time` (n,); m, s."""
    geometry = case.geometry
    progress = np.clip((front - geometry.length_0) / geometry.height_0, 0.0, 1.0)
    stop = time[np.argmax(front > front.max() - AT_REST)]
    size, moment = np.interp(at, time, progress), np.minimum(at, stop)
    apart = np.abs(moment[:, None] - moment)
    return np.outer(size, size) * np.exp(-apart / section.correlation_time)


def correlated_scatter(time: np.ndarray, correlation_time: float, seed: int) -> np.ndarray:
    """Gaussian scatter (n,) of unit variance whose correlation falls as exp(-t/correlation_time).

    A function of time and seed alone, so that it does not depend on the time steps of a run: tones
    whose frequencies are drawn from the spectrum of that correlation, a Lorentzian, with random
    phases (Shinozuka & Deodatis 1991).
    """
    draws = np.random.default_rng(seed)
    frequency = draws.standard_cauchy(TONES) / correlation_time
    phase = draws.uniform(0.0, 2.0 * np.pi, TONES)
    return np.sqrt(2.0 / TONES) * np.cos(np.multiply.outer(time, frequency) + phase).sum(axis=1)


EFFECT = Effect(
    "front_saltation",
    OBSERVATION,
    FrontSaltation,
    priors={
        "bias": Prior("normal", 0.0, 0.02, "A", "error of the runout by saltation, +-2 cm"),
        "spread": Prior("halfnormal", 0.0, 0.01, "C", "half of that error, frame to frame"),
    },
    see=Seeing(front=seen_with_beads),
    seen_keys=("bias", "spread", "correlation_time", "seed"),
)
