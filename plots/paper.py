"""All figures of the paper's study.

python -m plots.paper
"""

from plots import (
    paper_beds,
    paper_closure,
    paper_deposits,
    paper_domain,
    paper_double_counting,
    paper_front_bounds,
    paper_front_slow_phase,
    paper_front_viscosity,
    paper_front_walls,
    paper_pressure,
    paper_profiles,
    paper_refinement,
    paper_sensitivity,
    paper_slow_phase,
    paper_style,
    paper_verdicts,
    paper_viscosity_field,
    paper_volume,
    paper_volume_seen,
)
from plots.paper_style import PAPER

FIGURES = (
    paper_profiles,
    paper_volume,
    paper_volume_seen,
    paper_front_walls,
    paper_front_viscosity,
    paper_viscosity_field,
    paper_front_bounds,
    paper_front_slow_phase,
    paper_deposits,
    paper_domain,
    paper_pressure,
    paper_refinement,
    paper_closure,
    paper_double_counting,
    paper_sensitivity,
    paper_slow_phase,
    paper_beds,
    paper_verdicts,
)


def main(folder=PAPER):
    """Draw every figure from the tables in a folder; one that lacks a run is named and left out."""
    for figure in FIGURES:
        paper_style.main(figure.draw, folder)


if __name__ == "__main__":
    main()
