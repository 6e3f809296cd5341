"""The terms of the equations that the problems verify, and the file of each term."""

from typing import NamedTuple


class Term(NamedTuple):
    """Name of a term in the table, and its file inside the package."""

    words: str
    file: str


MU_I = Term("µ(I), equations 3–7", "step/rheology.py")
DRUCKER_PRAGER = Term("Drucker–Prager, equation 8", "step/rheology.py")
YIELD_STRESS = Term("yield stress", "step/rheology.py")
YIELD_IN_TIME = Term("yield in time, static–flowing interface", "step/coupled.py")
REGULARISATION = Term("regularisation", "step/rheology.py")
VISCOUS = Term("div(2ηD)", "step/viscous.py")
INERTIA = Term("ρ ∂u/∂t", "step/assembly.py")
ADVECTION = Term("ρ u·∇u", "step/momentum.py")
PRESSURE = Term("∇p, div u = 0", "step/coupled.py")
CUT_CELLS = Term("cut cells, hydrostatic balance", "step/geometry.py")
BED = Term("bed and back wall, equations 12–14", "step/coulomb_walls.py")
LATERAL_WALLS = Term("lateral walls, equation 19", "step/lateral_friction.py")
THIN_LAYER = Term("thin layers", "step/thin_layer.py")
ADHESION = Term("adhesion and tension", "step/adhesion.py")
FLUIDITY = Term("nonlocal fluidity, rough bed", "step/fluidity_relaxation.py")
SURFACE = Term("free surface, equation 10", "step/level_set.py")
COLLAPSE = Term("a whole collapse", "simulation.py")
ILL_POSEDNESS = Term("ill-posedness of the model", "step/ill_posedness.py")
TERMS = (  # in the order of the table
    MU_I,
    DRUCKER_PRAGER,
    YIELD_STRESS,
    YIELD_IN_TIME,
    REGULARISATION,
    VISCOUS,
    INERTIA,
    ADVECTION,
    PRESSURE,
    CUT_CELLS,
    BED,
    LATERAL_WALLS,
    THIN_LAYER,
    ADHESION,
    FLUIDITY,
    SURFACE,
    COLLAPSE,
    ILL_POSEDNESS,
)
