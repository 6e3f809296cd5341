"""Exact solutions of the model, each with its derivation or its source; `exact.bagnold` and so on.

Every function takes the case that the solver runs. One module per subject: `layer` holds what the
uniform flows share.
"""

# ruff: noqa: F401
from fvcollapse.verification.exact.adhesion import (
    adhesive_layer,
    adhesive_thickness,
    cut_height,
    hanging_acceleration,
)
from fvcollapse.verification.exact.enclosed import (
    GHIA_U,
    GHIA_V,
    MARCHI_U,
    MARCHI_V,
    couette_start_up,
    poiseuille,
    taylor_green,
    taylor_green_pressure,
)
from fvcollapse.verification.exact.growth import growth_rate, growth_rate_bagnold
from fvcollapse.verification.exact.lateral_walls import (
    chute_drucker_prager,
    chute_mu_I,
    flowing_depth,
)
from fvcollapse.verification.exact.layer import (
    gravity_normal,
    pressure_hydrostatic,
    pressure_tilted_box,
    slope_ratio,
    wall_ratio,
)
from fvcollapse.verification.exact.long_flows import (
    dam_break_depth,
    huppert_depth,
    huppert_front,
)
from fvcollapse.verification.exact.manufactured import (
    manufactured_below_surface,
    manufactured_box,
    manufactured_force,
    manufactured_gyres,
    manufactured_surface,
)
from fvcollapse.verification.exact.regularised import chute_regularised
from fvcollapse.verification.exact.steady import (
    bagnold,
    creep,
    film_bingham,
    film_imposed_bed_stress,
    film_newtonian,
    incline_drucker_prager,
)
from fvcollapse.verification.exact.surfaces import disc, rotation, single_vortex, slotted_disc
from fvcollapse.verification.exact.thin_layers import stopping_thickness
from fvcollapse.verification.exact.unsteady import (
    block_acceleration,
    block_speed,
    incline_start_up,
    stopping_inviscid,
    stopping_viscous,
)
