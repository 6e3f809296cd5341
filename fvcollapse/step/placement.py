"""Geometry of the present surface and gate, for the solve: everything that follows from where the grains are."""

from .arrays import copy, scale
from .compiled import kernel_jit
from .gate import fill_gate
from .geometry import fill_cells, fill_faces, fill_reach, fill_walls
from .shear_planes import fill_planes
from .side_shear import fill_cuts
from .unknowns import number_unknowns


@kernel_jit()
def fill_geometry(geometry, level_set, packing, gate_column, open_end):
    """Fill `geometry`, whose apertures are set, and number the unknowns; return `number_unknowns`' envelope.

    Parameters
    ----------
    geometry : Geometry
    level_set : (nx + 1, nz + 1) array
        m.
    packing : (nx, nz) array
        Local density over density_bulk.
    gate_column : int
        Negative without a gate.
    open_end : bool
        Whether the grains may leave through the far end.
    """
    aperture = geometry.aperture
    copy(geometry.packing, packing)
    fill_cells(geometry.filled, geometry.lever_x, geometry.lever_z, level_set, aperture)
    fill_faces(
        geometry.mass_x,
        geometry.mass_z,
        geometry.filled,
        geometry.lever_x,
        geometry.lever_z,
        packing,
    )
    scale(geometry.mass_x, aperture)  # what the gate holds back does not move with u
    fill_walls(geometry.bed_cover, geometry.wall_cover, level_set)
    fill_gate(geometry.gate_cover, level_set, aperture, gate_column)
    fill_reach(geometry.reach, geometry.filled)
    fill_planes(geometry.plane, geometry.lying, geometry.filled, level_set, geometry.reach)
    fill_cuts(geometry.cut_row, geometry.cut_part, level_set)
    return number_unknowns(geometry, open_end)
