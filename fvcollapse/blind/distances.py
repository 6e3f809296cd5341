"""How far each true cause is from its nearest rival: computed after the seal is opened."""

from pathlib import Path

import numpy as np

from fvcollapse.blind.case_evidence import (
    analysis_of,
    design_of,
    each_batch,
    in_batches,
    runner_of,
)
from fvcollapse.blind.labels import read_labels
from fvcollapse.diagnosis.separability import separability
from fvcollapse.errors import NumericalError
from fvcollapse.studies.workers import Resources


def distances(folder, labels, workers=1, scheduler=None, quiet=True, **options):
    """{case: d} of every case with a single effect: its distance to the nearest other hypothesis.

    d^2 is that of `diagnosis.separability`, at the strength and closure that were hidden, against every
    other effect at its median and a free amplitude, and against none. A case that cannot be compared is
    left out.

    Parameters
    ----------
    folder, labels : str or Path
        Cases and their labels.
    workers, scheduler, quiet
        See `workers.run_all`.
    **options
        As for `case_evidence.study`, with which the library has been computed.
    """
    designs, effects = {}, {}
    for name, entry in read_labels(labels)["cases"].items():
        if len(entry["label"]["effects"]) == 1:
            case = Path(folder).absolute() / name
            effects[name] = next(iter(entry["label"]["effects"].items()))
            designs.setdefault(design_of(case), []).append(case)
    batches = [batch for cases in designs.values() for batch in in_batches(cases)]
    calls = {batch: (batch, [effects[case.name] for case in batch], options) for batch in batches}
    outcomes = each_batch(distances_of_batch, calls, Resources(workers, scheduler, quiet))
    numbers = {name: d for name, d in outcomes.items() if not isinstance(d, NumericalError)}
    return dict(sorted(numbers.items()))


def distances_of_batch(cases, effects, options):
    """{case: d} of cases of one design; those that cannot be compared are left out.

    Parameters
    ----------
    cases : sequence of Path
    effects : sequence of (str, dict)
        The effect of each case, and what was drawn of it.
    options : dict
    """
    runner, table = runner_of(options), {}
    for case, (effect, drawn) in zip(cases, effects, strict=True):
        try:
            table[case.name] = distance(analysis_of(case, runner, options), effect, drawn)
        except (
            NumericalError
        ):  # the evidence of this case has failed as well, and `study` reports it
            continue
    return table


def distance(analysis, effect, drawn):
    """D of one case; 0 where the effect changes nothing that was measured."""
    if effect not in analysis.responses:
        return 0.0
    closure = analysis.library.closures[effect][drawn["closure"]]
    responses = analysis.responses | {effect: analysis.responses[effect][drawn["closure"]]}
    at = {effect: np.array([drawn["quantiles"][name] for name in closure.parameters])}
    separated = separability(analysis.covariance, analysis.kernel, responses, at)
    truth = separated.names.index(effect)
    rivals = np.delete(separated.distance[truth], truth)
    return float(np.sqrt(min([separated.snr[truth] ** 2, *rivals])))
