"""The constants of a run, for the kernels: read off the case once."""

import math

from fvcollapse.case.case import GRAVITY

from .acceptance import slow_speed
from .balance import balance_at_rest, soft_rate
from .dilatancy import initial_fraction
from .domain import RIGHT_ENDS
from .erodible_bed import layer_thickness
from .flow import Constants
from .gate import gate_lift
from .grain_response import response_of
from .grid import gate_column, spacing
from .rheology import material
from .transverse_profile import shape_factor_of

GROWTH_OF_STEP = 1.5  # of a step over the one before
MIDDLE = 0.5  # of the step


def constants_of(case):
    """The `Constants` of a resolved case (`Case.resolved`)."""
    dx, dz = spacing(case)
    slope = math.radians(case.geometry.slope_angle_deg)
    gravity = GRAVITY * math.sin(slope), -GRAVITY * math.cos(slope)
    response, walls = response_of(case), case.effects.lateral_friction
    column = -1 if case.boundary.ends == "periodic" else gate_column(case)
    bulk = response.dilatancy.fraction_bulk
    return Constants(
        dx=dx,
        dz=dz,
        gate_column=column,
        lift=gate_lift(case),
        shape_factor=float(shape_factor_of(case)),
        packing_0=initial_fraction(case) / bulk,
        fraction_bulk=bulk,
        layer=float(layer_thickness(case)),
        right_end=RIGHT_ENDS.index(case.boundary.right_end),
        film_thickness=float(case.numerics.film_thickness),
        cfl=float(case.time.cfl),
        longest_step=float(case.longest_step),
        growth=GROWTH_OF_STEP,
        ahead=MIDDLE,
        slow=slow_speed(case),
        check_residual=case.numerics.method == "coupled",
        split_walls=walls is not None and walls.scheme == "split",
        soft_rate=soft_rate(case),
        material=material(case),
        balance=balance_at_rest(case, gravity, column, response if response.active else None),
    )
