"""Where the model is ill-posed: small disturbances grow without bound as their wavelength shrinks.

For any law tau(p, shear_rate) with n = d ln tau / d ln shear_rate and t = d tau / d p, the
equations are ill-posed iff C = 4 n (n - 1) + t^2 > 0 and t < 2 (1 - n). For mu(I): n = I mu'/mu and
t = mu (1 - n/2), the criterion of Barker, Schaeffer, Bohorquez & Gray (2015), J. Fluid Mech. 779,
794-818.
"""

from .compiled import kernel_jit


@kernel_jit()
def criterion(exponent, stress_slope):
    """C = 4 n (n - 1) + t^2; positive where disturbances grow (if also t < 2 (1 - n))."""
    return 4.0 * exponent * (exponent - 1.0) + stress_slope * stress_slope


@kernel_jit()
def is_ill_posed(exponent, stress_slope):
    """Whether the state with n = `exponent` and t = `stress_slope` is ill-posed."""
    return criterion(exponent, stress_slope) > 0.0 and stress_slope < 2.0 * (1.0 - exponent)
