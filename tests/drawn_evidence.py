"""Evidences of made-up hypotheses, drawn for a known cause, and a verdict layer that is fitted to such cases."""

from functools import cache

import numpy as np

from fvcollapse.blind.verdict_training import fit
from fvcollapse.diagnosis.evidence import Evidence, Hypothesis
from fvcollapse.diagnosis.names import NONE, UNKNOWN

EFFECTS = ("arms", "bars", "cups", "dots")
CAUSES = (*EFFECTS, NONE, UNKNOWN, "arms+bars")


def hypothesis(name, log_evidence, p_value=0.5, sigma=0.2, outside=1.0, runs=2):
    """A hypothesis without parameters: its evidence, and how well it fits."""
    nothing = np.empty(0)
    by_run = dict.fromkeys(range(runs), p_value)
    return Hypothesis(
        *(name, log_evidence, log_evidence, -2.3 if "+" in name else 0.0, sigma, (0,)),
        *(nothing, nothing, nothing, p_value, by_run, {}, outside, nothing),
    )


def evidence_of(log_evidences, p_values=None, **keys):
    """The evidence of {hypothesis: logarithm}, the best first; the p-values of some are given."""
    p_values = p_values or {}
    found = [
        hypothesis(name, value, p_values.get(name, 0.5), **keys)
        for name, value in log_evidences.items()
    ]
    found.sort(key=lambda each: -(each.log_evidence + each.log_prior))
    return Evidence({each.name: each for each in found})


def draw(cause, rng):
    """An over-confident evidence: the truth wins by some strength, with a noise of its own."""
    strength = rng.gamma(3.0, 10.0)
    logs = {name: -strength + 4.0 * rng.standard_normal() for name in EFFECTS}
    logs[NONE], logs[UNKNOWN] = -2.0 * strength, -1.2 * strength
    p_values = {name: float(rng.uniform()) for name in (*EFFECTS, NONE, UNKNOWN)}
    if cause == NONE:
        logs = {name: rng.normal(-1.0, 2.0) for name in EFFECTS}
        logs |= {NONE: 0.0, UNKNOWN: rng.normal(-6.0, 1.0)}
    elif cause == UNKNOWN:
        logs[UNKNOWN] = rng.normal(5.0, 2.0)
        p_values |= dict.fromkeys(EFFECTS, 1e-4)
    elif "+" in cause:
        logs |= {"arms": -5.0, "bars": -6.0, "arms+bars": rng.normal(10.0, 3.0)}
        logs["bars+cups"] = rng.normal(-5.0, 3.0)
        p_values |= dict.fromkeys(EFFECTS, 1e-3)
    else:
        logs[cause] = 4.0 * rng.standard_normal()
    return evidence_of(logs, p_values)


def suite(per_class, seed):
    """(evidence, cause) of as many cases of every cause."""
    rng = np.random.default_rng(seed)
    return [(draw(cause, rng), cause) for cause in CAUSES for _ in range(per_class)]


@cache
def fitted():
    """The verdict layer of sixty cases a cause."""
    return fit(suite(60, 1), EFFECTS, {"made": "of numbers"})
