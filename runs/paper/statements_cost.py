"""What the paper says of its cost, and of experiments that are not supplied."""

from runs.measured import Measured
from runs.paper.statement_terms import muI
from runs.paper.verdicts import Clause, claims
from runs.table import REFINEMENTS

BY_ROUND_OFF = 0.05  # of a number of solves; another processor needs as many more or less
CLAIMS, claim = claims()


@claim(
    "V",
    "a time step costs a few seconds to a few minutes",
    "of that code",
    on_beds=False,
)
def step_cost(t):
    rows = [t.row(name) for name in (muI(22, "w10"), muI(22, "winf"), "eta0.4_a22_w10")]
    steps = ", ".join(f"{1e3 * row['cpu_s'] / row['steps']:.1f}" for row in rows)
    spent = ", ".join(f"{row['cpu_s']:.0f}" for row in rows)
    return [], f"here {steps} ms a step, {spent} CPU s a run (22°, the paper's cell size)"


@claim(
    "V",
    "η_I costs more than η_c, up to twice",
    "linear solves, and CPU time, of the runs at 10, 16 and 22°, w = 10 cm, with η_I over those with η_c = 0.4 Pa s "
    "between 1 and 2, on every grid",
)
def law_cost(t):
    ours, theirs = ([f"{law}_a{a}_w10" for a in (10, 16, 22)] for law in ("muI", "eta0.4"))
    return [
        Clause(
            f"{size:g} mm",
            solves,
            "within",
            (1.0, 2.0),
            of_paper=True,
            windows=(("CPU time", spent),),
        )
        for (size, solves), (_, spent) in zip(
            ratios(t, ours, theirs, "sweeps"), ratios(t, ours, theirs, "cpu_s"), strict=True
        )
    ]


def ratios(t, cases, others, column):
    """(cell size in mm, cost of some cases over that of others) on each grid that all were run on.

    A count has no limit on fine grids, so that each grid counts by itself; what is uncertain of it is what round-off
    changes, and of a time at least as much.
    """
    every = (*cases, *others)
    for r in REFINEMENTS:
        if all((name, r) in t.scalars for name in every):
            ours, theirs = (
                sum(t.row(name, r)[column] for name in names) for names in (cases, others)
            )
            ratio = Measured(ours / theirs, BY_ROUND_OFF * ours / theirs, frozenset(every))
            yield t.cell_size(cases[0], r), ratio


UNSUPPLIED = (
    ("3, 4", "with lateral friction profiles and runouts are closer to the experiment"),
    ("5, 6", "the experiments dilate: +3 % (w = 10 cm), up to +10 % (20 cm, 22°), and back"),
    ("7, 8", "with lateral friction the front velocities are closer to the experiment"),
    ("12, 13", "η_c = 1 Pa s fits the measured front velocities best"),
    ("14, 15", "the measured slow phase is better reproduced by 1 than by 2 Pa s"),
    ("16", "one cannot tell which viscosity is closest to the measured deposit"),
)
for _place, _words in UNSUPPLIED:
    claim(_place, _words, "the measured curves are not supplied", on_beds=False)(lambda t: [])
