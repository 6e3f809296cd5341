"""The sections under `[effects]`: what is added to the physics that the user believes.

A section that is absent is off. Every default is zero strength (`mu_wall` apart): what is to act
must be given.
"""

from typing import Annotated, Literal

from fvcollapse.case.grammar import Section, key


class Gate(Section):
    """A gate that is slow, late, or rubs against the grains."""

    speed: (
        Annotated[
            float,
            key(
                "m/s",
                "lifting speed instead of gate.speed; absent = that one",
                ge=0,
                inf=True,
                most=1e6,
            ),
        ]
        | None
    ) = None
    time_constant: (
        Annotated[
            float,
            key("s", "tau of its law instead of gate.time_constant; absent = that", ge=0, le=1000),
        ]
        | None
    ) = None
    mu_gate: Annotated[float, key("-", "friction of the grains on the gate", ge=0, le=10)] = 0.0
    delay: Annotated[float, key("s", "time from t = 0 to the start of the gate", ge=0, le=1000)] = (
        0.0
    )


class ErodibleBed(Section):
    """A layer of the same grains, at rest on the bed under the column and down the slope."""

    thickness: Annotated[float, key("m", "thickness of the layer", ge=0, le=1000)] = 0.0


class TransverseProfile(Section):
    """A flow that is faster in the middle of the channel than at its lateral walls."""

    velocity_ratio: Annotated[
        float, key("-", "velocity in the middle over that at the walls", ge=1, inf=True, most=1e6)
    ] = 1.0
    view: Annotated[
        Literal["average", "wall", "centre"],
        key("-", "what the measurement sees: the mean of the width, the wall, the middle"),
    ] = "average"


class Viscosity(Section):
    """Level or law of the viscosity: eta_I scaled, or a constant instead of it."""

    factor: Annotated[
        float, key("-", "factor on eta_I, or on rheology.viscosity", ge=0, le=1000)
    ] = 1.0
    eta_constant: (
        Annotated[
            float, key("Pa s", "constant viscosity in place of eta_I; absent = none", ge=0, le=1e6)
        ]
        | None
    ) = None


class BedFriction(Section):
    """A bed weaker than the user believes: grains slide on it, or it is a smooth plate."""

    mu_bed: (
        Annotated[
            float,
            key("-", "friction on the bed instead of boundary.mu_bed; 0 = free slip", ge=0, le=10),
        ]
        | None
    ) = None


class Dilatancy(Section):
    """Sheared grains expand or contract towards nu_eq(I) and rub more or less; mass is conserved."""

    dilatancy_factor: Annotated[
        float, key("-", "K of tan(psi) = K (nu - nu_eq); 0 = incompressible", ge=0, le=20)
    ] = 0.0
    solid_fraction_critical: Annotated[
        float, key("-", "nu_eq of slow shear, I = 0", ge=0.3, le=0.74)
    ] = 0.60
    solid_fraction_slope: Annotated[
        float, key("-", "decrease of nu_eq from I = 0 to I = 1, and no further", ge=0, le=0.25)
    ] = 0.15
    solid_fraction_0: (
        Annotated[
            float,
            key(
                "-",
                "solid fraction at the start; absent = density_bulk / density_grain",
                ge=0.3,
                le=0.74,
            ),
        ]
        | None
    ) = None


class FrictionHysteresis(Section):
    """Grains that have settled need more than mu(I) to start; once they flow mu(I) holds."""

    delta_mu: Annotated[float, key("-", "static friction above mu(I)", ge=0, le=1)] = 0.0
    I_start: Annotated[
        float, key("-", "inertial number above which contacts break", gt=0, le=1)
    ] = 0.01
    strain: Annotated[
        float, key("-", "shear strain that breaks them, by a factor 1/e", gt=0, le=10)
    ] = 0.05


class Nonlocal(Section):
    """Granular fluidity: grains beside a flow creep below their yield stress, grains beside rest are held."""

    A: Annotated[
        float, key("-", "nonlocal amplitude; A grain_diameter is the length", ge=0, le=10)
    ] = 0.0


class Cohesion(Section):
    """Cohesion between the grains: a yield stress without pressure.

    The walls stay cohesionless, and no cell pulls: the pressure remains >= 0.
    """

    kappa_0: Annotated[
        float, key("Pa", "cohesion added to rheology.cohesion in the yield stress", ge=0, le=1e5)
    ] = 0.0


class FrontSaltation(Section):
    """Beads that detach ahead of the front and are taken for it: an effect of the observation."""

    bias: Annotated[float, key("m", "how far ahead the front is seen", ge=-1, le=1)] = 0.0
    spread: Annotated[float, key("m", "standard deviation of its scatter", ge=0, le=1)] = 0.0
    correlation_time: Annotated[
        float, key("s", "how long a bead is ahead: correlation of the scatter", gt=0, le=1000)
    ] = 0.05
    seed: Annotated[int, key("-", "which realisation of the scatter", ge=0)] = 0


class Tilt(Section):
    """Error of the slope: the bed of the laboratory is not inclined as stated."""

    angle_deg: Annotated[float, key("deg", "added to geometry.slope_angle_deg", ge=-3, le=3)] = 0.0


class ColumnSize(Section):
    """Error of the size of the column; the gate stands at its end."""

    height: Annotated[float, key("m", "added to geometry.height_0", ge=-1000, le=1000)] = 0.0
    length: Annotated[float, key("m", "added to geometry.length_0", ge=-1000, le=1000)] = 0.0


class TimeOrigin(Section):
    """Error of the clock of the measurement."""

    offset: Annotated[
        float, key("s", "simulated time at which the clock shows zero", ge=-1000, le=1000)
    ] = 0.0
