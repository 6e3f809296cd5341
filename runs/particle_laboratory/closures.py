"""Cohesion and dilatancy beside the opened cases that hide them: `b10`; `b05`, `b11` (dense) and `b08` (loose).

The causes of these cases were opened after their answers had been scored: they may teach, and test nothing. All have
friction of thin layers with the L of a chute. Solid fractions are those measured: 0.561 - 0.121 I in steady shear, and
of each case at the start. The gate of `b05` is as slow and rough as it was. Pressures of adhesion, the loss of solid
fraction and the friction factor are tried values. Contacts of `b10` pull off at five weights, which is 490 Pa by
Rumpf's formula; its grains ended 0.044 looser than they started.
"""

from fvcollapse import load_case, load_experiment
from runs.particle_laboratory.readings import of_grains, of_model
from runs.particle_laboratory.shape import THIN, compared, dilating
from runs.study import run_cached
from runs.table import write_table

CELL_SIZE = 0.010  # m
GATE = {"effects.gate": {"speed": 0.4, "mu_gate": 0.5}}
DENSE, LOOSE, LOSS = 0.640, 0.555, 0.044


def adhesive(adhesion, loss=0.0):
    """Settings of cohesion as adhesion (Pa) with a loss of solid fraction."""
    return {"effects.cohesion": {"adhesion": adhesion, "solid_fraction_loss": loss}}


def yielding(kappa_0):
    """Settings of cohesion as a yield stress alone, Pa."""
    return {"effects.cohesion": {"kappa_0": kappa_0}}


def rubbing(friction_factor, at_start, factor=4.0):
    """Settings of dilatancy whose friction is mu(I) + friction_factor tan(psi)."""
    section = dilating(factor, at_start)["effects.dilatancy"]
    return {"effects.dilatancy": section | {"friction_factor": friction_factor}}


def packed(at_start):
    """Variants of dilatancy: none, with the friction of its work, with more."""
    return {"without": {}} | {
        f"K = {factor:g}, F = {more:g}": rubbing(more, at_start, factor)
        for factor, more in ((4.0, 1.0), (4.0, 1.5), (4.0, 2.0))
    }


COHESIVE = (
    {"without": {}}
    | {f"kappa_0 = {kappa:g} Pa": yielding(kappa) for kappa in (50.0, 220.0)}
    | {f"p_c = {p_c:g} Pa": adhesive(p_c) for p_c in (100.0, 200.0)}
    | {
        f"p_c = {p_c:g} Pa, looser": adhesive(p_c, LOSS)
        for p_c in (70.0, 100.0, 150.0, 200.0, 490.0)
    }
)
CASES = {
    "blind/b10": ({}, COHESIVE),
    "blind/b11": ({}, packed(DENSE)),
    "blind/b05": (GATE, packed(DENSE)),
    "blind/b08": ({}, packed(LOOSE)),
}


def closures(arguments, baseline):
    """Write closures.csv: front at rest, final thickness and volume of every case and variant, less the grains.

    Parameters
    ----------
    arguments : argparse.Namespace
        Of the study.
    baseline : Path
        Case file of what is believed.
    """
    base, size = load_case(baseline), arguments.cell_size or CELL_SIZE
    experiments = {name: load_experiment(arguments.data / name) for name in CASES}
    cases = {
        (name, words): experiments[name]
        .case(base)
        .replace(**{"grid.cell_size": size}, **THIN, **given, **settings)
        for name, (given, variants) in CASES.items()
        for words, settings in variants.items()
    }
    results = run_cached(cases, arguments)
    rows = [
        {"experiment": experiments[name].name, "variant": words, "cell_size": size}
        | compared(of_model(results[name, words], experiments[name]), of_grains(experiments[name]))
        for name, words in cases
    ]
    write_table(arguments.tables / "closures.csv", rows)
    for row in rows:
        print("  ".join(f"{name} {value}" for name, value in row.items()))
