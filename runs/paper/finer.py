"""Which cases ask for a finer grid: those behind a statement that cannot be told for want of accuracy.

A clause needs an uncertainty smaller than its distance to the limit. Where it has a larger one, the cases that it is
made of are run on the next grid, 6 -> 4 -> 3 -> 2 -> 1.5 mm, until it is decided or there is none. A clause on its
limit, whose uncertainty is many times what it needs, is left: no grid would decide it. Only the reading of the paper
asks: what others say can contradict it, and cannot decide in its place.
"""

import math

from runs.paper.beds import SLIDES
from runs.paper.verdicts import OPEN
from runs.table import REFINEMENTS

HOPELESS = 30.0  # of the uncertainty needed; the grids beyond the first two gain about ten


def finer(settled, tables, finest):
    """Grids that are still asked for, those first that are nearest to a decision.

    Parameters
    ----------
    settled : list of Settled
    tables : dict
        {bed: Tables}
    finest : float
        The largest refinement that may be chosen.

    Returns
    -------
    list of (str, str, float)
        Bed, case, refinement.
    """
    wanted = {}
    for of in settled:
        for clause in of.paper.clauses if of.verdict == OPEN else ():
            lacking = shortage(clause)
            for case in clause.measured.cases if 1.0 <= lacking <= HOPELESS else ():
                refinement = next_grid(tables[SLIDES], case)
                if refinement <= finest:
                    key = SLIDES, case, refinement
                    wanted[key] = min(lacking, wanted.get(key, math.inf))
    return sorted(wanted, key=lambda key: (wanted[key], key))


def shortage(clause):
    """Uncertainty that a clause has over the one it needs; 0 where it is decided or nothing is known."""
    if clause.verdict != OPEN or math.isnan(clause.value) or math.isnan(clause.uncertainty):
        return 0.0
    return clause.uncertainty / clause.needed if clause.needed > 0.0 else math.inf


def next_grid(tables, case):
    """The first refinement that a case was not run on; infinity where it was run on all."""
    done = {refinement for name, refinement in tables.scalars if name == case}
    return next((r for r in REFINEMENTS if r not in done), math.inf)
