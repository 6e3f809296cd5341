"""The stored convergence studies: one figure per study, from its JSON; nothing is run.

    python -m plots.convergence

Reads runs/convergence/<study>.json and writes plots/figures/convergence_<study>.png.
"""

import json
from pathlib import Path

from fvcollapse.case.case import load_case
from fvcollapse.studies.refinement import AXES
from fvcollapse.studies.refinement_figure import draw_png
from fvcollapse.studies.refinement_report import label

ROOT = Path(__file__).parents[1]
STUDIES = ROOT / "runs/convergence"
REFERENCE = (
    "collapse_22deg_w10cm"  # the case of the studies that vary something else than the cells
)


def main():
    """Draw every study that is there."""
    for path in sorted(STUDIES.glob("*.json")):
        records = json.loads(path.read_text())
        axis = next(name for name in AXES if name in next(iter(records.values())))
        case_file = path.with_suffix(".toml")
        case = load_case(case_file if case_file.exists() else STUDIES / f"{REFERENCE}.toml")
        target = ROOT / "plots/figures" / f"convergence_{path.stem.removeprefix('collapse_')}.png"
        target.write_bytes(draw_png(records, axis, {name: label(name, case) for name in records}))
        print(target)


if __name__ == "__main__":
    main()
