"""An `experiment.toml` to fill in, with the CSV files that belong beside it."""

from fvcollapse.measure.curves import CSV_FILES, KINDS, SCALAR_COLUMNS, SCALARS
from fvcollapse.measure.experiment import SETTINGS
from fvcollapse.measure.quantities import CURVES, SCALAR_UNITS
from fvcollapse.measure.settings_text import settings_text


def experiment_template() -> str:
    """The text of an `experiment.toml` in which every key is a comment (TOML)."""
    return f"{csv_comments()}\n{settings_text((), SETTINGS)}"


def csv_comments() -> str:
    """Comments on the CSV files: one or more of them hold what was measured."""
    lines = [
        "# An experiment: the set-up below, and what was measured in one or more CSV files in this folder, each with a",
        "# header line of its columns. A file that is absent was not measured. SI units; X from the back wall.",
        "#",
    ]
    for name in CSV_FILES:
        if name != SCALARS:
            quantity = CURVES[name]
            columns = ", ".join(quantity.columns)
            lines.append(
                f"#   {name}.csv: {columns} (optional {quantity.sigma_column}): {quantity.words}"
            )
    numbers = ", ".join(f"{name} [{unit}]" for name, unit in SCALAR_UNITS.items())
    lines.append(f"#   {SCALARS}.csv: {', '.join(SCALAR_COLUMNS)}; kind is {', '.join(KINDS)};")
    lines.append(f"#     names: {numbers}")
    lines.append("#")
    return "\n".join(lines)
