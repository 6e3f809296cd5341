"""The sections of a case but for the effects: what the user believes of set-up and material, and how to compute it."""

from typing import Annotated, Literal

import msgspec

from fvcollapse.case.grammar import Section, key
from fvcollapse.case.rules import POLYGON_WORDS

Seconds = Annotated[float, msgspec.Meta(ge=0)]
Coordinate = Annotated[float, msgspec.Meta(ge=0, le=1000)]


class Geometry(Section):
    """The column at rest: x along the bed from the back wall, z normal to the bed."""

    slope_angle_deg: Annotated[float, key("deg", "inclination of the bed", ge=0, le=30)] = 22.0
    height_0: Annotated[
        float, key("m", "initial height of the column, normal to the bed", ge=1e-6, le=1000)
    ] = 0.14
    length_0: Annotated[
        float, key("m", "initial length of the column; the gate stands there", ge=1e-6, le=1000)
    ] = 0.20
    channel_width: Annotated[
        float, key("m", "channel width; inf = no lateral walls", ge=1e-6, inf=True, most=1e6)
    ] = 0.10
    polygon: (
        Annotated[
            tuple[tuple[Coordinate, Coordinate], ...],
            key(
                "m", "vertices of the column, instead of height_0 x length_0", allowed=POLYGON_WORDS
            ),
        ]
        | None
    ) = None
    surface: Annotated[
        Literal["parallel", "horizontal"],
        key("-", "parallel to the bed, or level with gravity at mean height height_0"),
    ] = "parallel"

    @property
    def height_max(self) -> float:
        """Greatest initial height above the bed [m] of the rectangle or the polygon."""
        return max(z for _, z in self.polygon) if self.polygon else self.height_0

    @property
    def length_max(self) -> float:
        """Greatest initial distance from the back wall [m] of the rectangle or the polygon."""
        return max(x for x, _ in self.polygon) if self.polygon else self.length_0


class Grid(Section):
    """The cells. The solver rounds the sizes a little, so that the gate is a grid line."""

    cell_size: Annotated[
        float,
        key(
            "m",
            "along the bed, adjusted to have the gate on a grid line; <= height/4",
            ge=1e-9,
            le=1000,
        ),
    ] = 0.006
    cell_size_z: (
        Annotated[
            float, key("m", "cell size normal to the bed; absent = cell_size", ge=1e-9, le=1000)
        ]
        | None
    ) = None


class Rheology(Section):
    """What the user believes of the material."""

    law: Annotated[
        Literal["mu_I", "drucker_prager", "bingham", "newtonian", "mu_I_regularised"],
        key("-", "constitutive law"),
    ] = "mu_I"
    mu_1: Annotated[
        float,
        key("-", "friction coefficient at rest (of drucker_prager: the only one)", ge=0, le=10),
    ] = 0.48
    mu_2: Annotated[
        float, key("-", "friction coefficient at high inertial number; >= mu_1", ge=0, le=10)
    ] = 0.73
    I_0: Annotated[float, key("-", "inertial-number scale of mu(I)", ge=1e-9, le=1000)] = 0.279
    viscosity: Annotated[
        float, key("Pa s", "viscosity of the constant-viscosity laws", ge=0, le=1e6)
    ] = 0.4
    cohesion: Annotated[float, key("Pa", "yield stress at zero pressure", ge=0, le=1e9)] = 0.0
    grain_diameter: Annotated[float, key("m", "grain diameter", ge=1e-9, le=1)] = 7e-4
    density_grain: Annotated[
        float, key("kg/m3", "density of the grain material", ge=0.001, le=1e5)
    ] = 2500.0
    density_bulk: Annotated[
        float, key("kg/m3", "density of the packed grains; <= density_grain", ge=0.001, le=1e5)
    ] = 1550.0
    alpha_regularised: Annotated[
        float, key("-", "alpha of the partially regularised mu(I)", ge=0.001, le=1000)
    ] = 1.9
    mu_infinity: Annotated[
        float, key("-", "growth of mu with I of the partially regularised mu(I)", ge=0, le=10)
    ] = 0.05


class Boundary(Section):
    """Bed, back wall and the far end of the channel."""

    mu_bed: Annotated[
        float,
        key("-", "friction on the bed; 0 = free slip, inf = no slip", ge=0, inf=True, most=1e6),
    ] = 0.48
    mu_back_wall: Annotated[
        float,
        key(
            "-", "friction on the back wall; 0 = free slip, inf = no slip", ge=0, inf=True, most=1e6
        ),
    ] = 0.48
    right_end: Annotated[
        Literal["grow", "open", "error", "wall"],
        key(
            "-",
            "far end: grows; lets grains out; is not to be reached; a wall without friction",
        ),
    ] = "grow"
    ends: Annotated[
        Literal["walls", "periodic"],
        key("-", "back wall and far end, or a periodic stretch length_0 of uniform flow (no gate)"),
    ] = "walls"
    domain_length: (
        Annotated[
            float,
            key(
                "m", "length of the domain at the start; absent = sized by the solver", gt=0, le=1e5
            ),
        ]
        | None
    ) = None

    domain_max: (
        Annotated[
            float,
            key(
                "m",
                "greatest length to which the domain grows; absent = 100 (height_0 + length_0)",
                gt=0,
                le=1e5,
            ),
        ]
        | None
    ) = None


class Gate(Section):
    """The gate, lifted normal to the bed."""

    speed: Annotated[
        float,
        key(
            "m/s",
            "lifting speed; 0 = stays closed, inf = removed at once",
            ge=0,
            inf=True,
            most=1e6,
        ),
    ] = 2.3
    time_constant: Annotated[
        float,
        key("s", "tau of the speed law v (1 - exp(-t/tau)); 0 = constant speed", ge=0, le=1000),
    ] = 0.0


class Front(Section):
    """How the front is read off the thickness."""

    thickness: Annotated[
        float, key("m", "the front is where the thickness falls below this", gt=0, le=1000)
    ] = 0.005


class Time(Section):
    """How long, which outputs, which steps."""

    end: Annotated[float, key("s", "end of the run", ge=0, le=1e5)] = 2.5
    output_interval: Annotated[float, key("s", "interval between profiles", gt=0, le=1e5)] = 0.02
    field_interval: Annotated[float, key("s", "interval between fields", gt=0, le=1e5)] = 0.1
    output_times: Annotated[
        tuple[Seconds, ...],
        key(
            "s", "profiles and fields at these times too", allowed="a list of numbers >= 0, finite"
        ),
    ] = ()
    step_max: (
        Annotated[
            float, key("s", "longest time step; absent = 0.02 sqrt(height_0/g)", ge=1e-7, le=0.1)
        ]
        | None
    ) = None
    stop_at_rest: Annotated[
        bool, key("-", "end before, once nothing has been faster than 1 mm/s for 0.1 s")
    ] = False
    cfl: Annotated[float, key("-", "largest Courant number", ge=0.001, le=1)] = 0.5


class Numerics(Section):
    """How the equations are solved."""

    method: Annotated[
        Literal["coupled", "projection"], key("-", "velocity and pressure in one system or in turn")
    ] = "coupled"
    unilateral: Annotated[bool, key("-", "no suction: p >= 0, and div u >= 0 where p = 0")] = True
    shear_rate_min: Annotated[
        float, key("1/s", "shear rate below which the yield stress is regularised", ge=1e-12, le=1)
    ] = 5e-4
    tolerance: Annotated[
        float, key("-", "nonlinear iteration: largest relative residual", ge=1e-14, lt=1)
    ] = 1e-3
    film_thickness: Annotated[
        float,
        key("m", "a film thinner than this at the front moves with the flow behind it", ge=0, le=1),
    ] = 1.5e-3
    max_sweeps: Annotated[int, key("-", "nonlinear iterations per step at most", ge=1, le=1000)] = (
        30
    )
