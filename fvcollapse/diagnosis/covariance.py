"""Covariances of the gap."""


def measurement_covariance(points, sensitivity):
    """(N, N): diag(sigma^2) and one rank-1 term per run and run-level error."""
    raise NotImplementedError


def numerical_covariance(points, coarse, fine, ratio, order, used="fine"):
    """(N, N), one rank-1 block per run; `used`: the grid ("fine"/"coarse") of the compared values."""
    raise NotImplementedError


def ensemble_covariance(points, samples):
    """(mean (N,), covariance (N, N)) of samples (m, N), shrunk, never singular."""
    raise NotImplementedError


def discrepancy_amplitude(points, variance):
    """(N,) amplitude of the discrepancy from the variance due to calibrated parameters (N,)."""
    raise NotImplementedError


def discrepancy_kernel(points, amplitude):
    """(N, N) K_delta."""
    raise NotImplementedError
