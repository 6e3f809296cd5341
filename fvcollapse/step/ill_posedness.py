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


def criterion_mu_I(inertial, mu_1, mu_2, I_0):
    """C of the mu(I) law at inertial number `inertial`."""
    mu = mu_1 + (mu_2 - mu_1) * inertial / (inertial + I_0)
    exponent = inertial * (mu_2 - mu_1) * I_0 / (inertial + I_0) ** 2 / mu
    return criterion(exponent, mu * (1.0 - 0.5 * exponent))


def lower_well_posed_limit(mu_1, mu_2, I_0):
    """Smallest inertial number at which mu(I) is well-posed.

    Raises
    ------
    ValueError
        If the law is ill-posed for every inertial number.
    """
    from scipy.optimize import brentq  # 0.3 s that only the regularised law needs

    candidates = [I_0 * 10.0 ** (0.02 * j - 4.0) for j in range(300)]
    for low, high in zip(candidates, candidates[1:], strict=False):
        if criterion_mu_I(high, mu_1, mu_2, I_0) <= 0.0:
            return brentq(criterion_mu_I, low, high, args=(mu_1, mu_2, I_0), xtol=1e-12)
    raise ValueError(
        f"mu(I) with mu_1 = {mu_1}, mu_2 = {mu_2}, I_0 = {I_0} is ill-posed for every I"
    )
