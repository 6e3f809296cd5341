"""Response of the observables to an effect, between a few runs."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Response:
    """Change of the simulated values with u in [0, 1]^d (quantiles of the prior).

    Response.fit(levels (m, d), differences (m, N), off=None): `off` (d,) is a coordinate, also outside
    [0, 1], at which the effect vanishes (difference 0).
    Response.of_one_level(difference (N,)): amplitude a = 0.15 + 1.85 u times one run.
    A zero-parameter response is not needed.
    """

    @property
    def dimension(self):
        raise NotImplementedError

    def at(self, u):
        """(N,) for u (d,), or (q, N) for u (q, d)."""
        raise NotImplementedError

    def covariance(self, u):
        """(N, N) for u (d,)."""
        raise NotImplementedError
