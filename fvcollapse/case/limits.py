"""How large a run may be: rules that refuse, before it begins, what would not end or not fit.

What grows while the run goes on is limited in `fvcollapse.step.guards`.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


CELLS_MAX = 4_000_000  # in the column, and of a domain that grows: more would not fit in the memory
BAND_MAX = 16e9  # bytes; 2 nx nz unknowns times a half bandwidth of 2 nz
OUTPUTS_MAX = 100_000  # profiles and fields; a shorter output interval is a slip of the pen
STORED_MAX = 16e9  # bytes of profiles and fields before compression, on the grid of the start
FIELD_BYTES, PROFILE_BYTES = 80.0, 16.0  # per cell of a field, per column of a profile
STEPS_MAX = 1_000_000  # the series of as many take 1 GB of memory
METRES = 1.0  # m; of a higher and longer column with too many cells it is asked whether it is in cm
ROUND_OFF = 1 + 1e-9  # 0.14/4 and 0.035 are the same size


def rule_cells(case: "Case") -> Iterator[tuple[str, str, str]]:
    """The column is resolved, and fits in the memory."""
    height, length = case.geometry.height_max, case.geometry.length_max
    size_x, size_z = case.grid.cell_size, case.grid.cell_size_z or case.grid.cell_size
    for name, size in (("grid.cell_size", size_x), ("grid.cell_size_z", size_z)):
        if size > 0.25 * height * ROUND_OFF:
            yield name, f"{size:g}", f"<= {height / 4:g}, a quarter of the height {height:g}"
    if size_x > case.geometry.length_0 * ROUND_OFF:
        limit = f"<= geometry.length_0 = {case.geometry.length_0:g}"
        yield "grid.cell_size", f"{size_x:g}", limit
    cells = (height / size_z) * (length / size_x)
    if cells > CELLS_MAX and height >= METRES and length >= METRES:
        found = f"{height:g} m: in cm? It makes {cells:.3g} cells of {size_x:g} m in the column"
        yield "geometry.height_0", found, f"a column of at most {CELLS_MAX:g} cells"
    elif cells > CELLS_MAX:
        found = f"{size_x:g}, which makes {cells:.3g} cells in the column"
        yield "grid.cell_size", found, f"sizes that make at most {CELLS_MAX:g} cells"
    band = matrix_bytes(length / size_x, height / size_z)
    if cells <= CELLS_MAX and band > BAND_MAX:
        found = f"{size_x:g}, which needs a matrix of {band / 1e9:.3g} GB"
        yield "grid.cell_size", found, f"sizes that need at most {BAND_MAX / 1e9:g} GB"


def matrix_bytes(columns: float, rows: float) -> float:
    """Bytes of the matrix of so many columns and rows of cells in the grains."""
    return 32.0 * columns * rows * rows


def rule_start(case: "Case") -> Iterator[tuple[str, str, str]]:
    """The domain at the start fits in the memory, with what is longer or thicker than the column."""
    layer = case.effects.erodible_bed.thickness if case.effects.erodible_bed else 0.0
    height, size_x = case.geometry.height_max, case.grid.cell_size
    rows = (height + layer) / (case.grid.cell_size_z or size_x)
    column = max(case.geometry.length_max, case.geometry.length_0)
    columns = max(column, case.boundary.domain_length or 0.0) / size_x
    key, value = "boundary.domain_length", case.boundary.domain_length
    if layer > 0.0 and (value is None or layer / height > value / column):
        key, value = "effects.erodible_bed.thickness", layer
    if value is None:
        return
    cells = columns * rows
    matrix = matrix_bytes(columns if layer > 0.0 else column / size_x, rows)
    if cells > CELLS_MAX:
        found = f"{value:g}, which makes {cells:.3g} cells in the domain"
        yield key, found, f"sizes that make at most {CELLS_MAX:g} cells"
    elif matrix > BAND_MAX:
        found = f"{value:g}, which needs a matrix of {matrix / 1e9:.3g} GB"
        yield key, found, f"sizes that need at most {BAND_MAX / 1e9:g} GB"


def rule_outputs(case: "Case") -> Iterator[tuple[str, str, str]]:
    """The outputs are as many as can be stored."""
    time, end = case.time, case.time.end
    shortest = end / OUTPUTS_MAX
    for name in ("output_interval", "field_interval"):
        interval = getattr(time, name)
        if interval < shortest:
            yield f"time.{name}", f"{interval:g}", f">= {shortest:g}, {OUTPUTS_MAX:g} outputs"
            return
    extra = sum(moment <= end for moment in time.output_times)
    if extra > OUTPUTS_MAX:
        yield "time.output_times", f"{extra} times", f"at most {OUTPUTS_MAX:g} outputs"
        return
    height, length = case.geometry.height_max, case.geometry.length_max
    columns = max(length, case.boundary.domain_length or 0.0) / case.grid.cell_size
    cells = columns * height / (case.grid.cell_size_z or case.grid.cell_size)
    for name, size in (
        ("output_interval", PROFILE_BYTES * columns),
        ("field_interval", FIELD_BYTES * cells),
    ):
        stored = size * (end / getattr(time, name) + extra)
        if stored > STORED_MAX:
            found = f"{getattr(time, name):g}, which stores {stored / 1e9:.3g} GB"
            limit = f"{STORED_MAX / 1e9:g} GB in {STORED_MAX / size:.3g} outputs at most"
            yield f"time.{name}", found, limit


def rule_steps(case: "Case") -> Iterator[tuple[str, str, str]]:
    """The run ends within the number of steps whose record fits in the memory."""
    latest = STEPS_MAX * case.longest_step
    if case.time.end > latest:
        limit = f"<= {latest:g}, which takes {STEPS_MAX:g} steps of {case.longest_step:g} s"
        yield "time.end", f"{case.time.end:g}", limit


LIMIT_RULES = (rule_cells, rule_start, rule_steps, rule_outputs)
