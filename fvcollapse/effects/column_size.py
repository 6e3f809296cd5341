"""Error of the size of the column, height_0 + height by length_0 + length; the gate stands at its end.

The same number of cells covers the other length, so that the response is smooth.

Limits: the column is a rectangle of at least four cells, and at least half as long as stated.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from msgspec.structs import replace

from fvcollapse.case.grammar import Section, key
from fvcollapse.case.limits import ROUND_OFF
from fvcollapse.effects.effect import NUISANCE, Effect, Prior, with_section

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


class ColumnSize(Section):
    """Error of the size of the column; the gate stands at its end."""

    height: Annotated[float, key("m", "added to geometry.height_0", ge=-1000, le=1000)] = 0.0
    length: Annotated[float, key("m", "added to geometry.length_0", ge=-1000, le=1000)] = 0.0


def change_size(case: "Case", section: ColumnSize) -> "Case":
    """Add the errors to the sizes, and stretch the cells with the length."""
    geometry, grid = case.geometry, case.grid
    if section.length != 0.0:
        stretch = (geometry.length_0 + section.length) / geometry.length_0
        height = grid.cell_size_z or grid.cell_size
        grid = replace(grid, cell_size=stretch * grid.cell_size, cell_size_z=height)
    geometry = replace(
        geometry,
        height_0=geometry.height_0 + section.height,
        length_0=geometry.length_0 + section.length,
    )
    return with_section(replace(case, geometry=geometry, grid=grid), "column_size", None)


def without_column(case: "Case", section: ColumnSize) -> Iterator[tuple[str, str, str]]:
    """The column with its errors is a rectangle of at least four cells, its gate included."""
    geometry, grid = case.geometry, case.grid
    if geometry.polygon is not None:
        yield "effects.column_size", "a table", "absent with geometry.polygon"
    least = 4.0 * (grid.cell_size_z or grid.cell_size) / ROUND_OFF
    for name, error, size, smallest in (
        ("height", section.height, geometry.height_0, least),
        ("length", section.length, geometry.length_0, 0.5 * geometry.length_0),
    ):
        if size + error < smallest:
            allowed = f">= {smallest - size:g}, with geometry.{name}_0 = {size:g}"
            yield f"effects.column_size.{name}", f"{error:g}", allowed


EFFECT = Effect(
    "column_size",
    NUISANCE,
    ColumnSize,
    priors={
        "height": Prior("normal", 0.0, 0.002, "C", "three grain diameters"),
        "length": Prior("normal", 0.0, 0.002, "C", "three grain diameters"),
    },
    refuse=without_column,
    change=change_size,
)
