"""A report of probabilities, rungs of the ladder and an outcome of the runs, as they are given, and nothing else."""

from functools import cache

from msgspec.structs import replace
from report_example import example

from fvcollapse.diagnosis.names import BASELINE, NONE
from fvcollapse.diagnosis.report.schema import (
    Confirmation,
    Details,
    HypothesisSummary,
    Misfit,
    Rung,
    Verdict,
)


@cache
def bare():
    """A report without regions, ladder and details."""
    report = example("none")
    return replace(
        report, where=[], by_observable={}, reduction=None, held_out=[], details=Details()
    )


@cache
def a_region():
    """A region of a gap."""
    return example("effect").where[0]


def report_with(probability, ladder=(), where=False, wording=None, p_value=None):
    """A report with these probabilities, rungs {model: (effects, fraction)}, and a region or none."""
    verdict_effects = next(iter(ladder.values()))[0] if ladder and wording else ()
    kind = "none" if not verdict_effects else "effect" if len(verdict_effects) == 1 else "several"
    rungs = [Rung(BASELINE, [], Misfit(2.0, None), None)]
    rungs += [
        Rung(model, list(effects), Misfit(1.0, fraction), None)
        for model, (effects, fraction) in dict(ladder).items()
    ]
    return replace(
        bare(),
        where=[a_region()] if where else [],
        verdict=Verdict(kind, list(verdict_effects), [], probability, []),
        details=Details(
            ladder=rungs if ladder else [],
            hypotheses={NONE: HypothesisSummary(0.0, predictive_p=p_value)},
            confirmation=Confirmation(wording, ["a reason"]) if wording else None,
        ),
    )
