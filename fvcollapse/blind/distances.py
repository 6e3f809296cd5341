"""How far each true cause is from its nearest rival: computed after the seal is opened."""

from pathlib import Path

import numpy as np

from fvcollapse.blind.case_evidence import (
    analysis_of,
    each_batch,
    in_batches,
    runner_of,
)
from fvcollapse.blind.labels import read_labels
from fvcollapse.diagnosis.separability import separability
from fvcollapse.errors import NumericalError
from fvcollapse.studies.workers import Resources


def distances(folder, labels, workers=1, scheduler=None, quiet=True, **options):
    """{case: d} of every case with one effect or two: its distance to the nearest other hypothesis.

    d^2 is that of `diagnosis.separability`, at the strength and closure that were hidden, against every
    other effect at its median and a free amplitude, and against none. Of two effects it is the smaller of those of
    each against the other alone. A case that cannot be compared is left out.

    Parameters
    ----------
    folder, labels : str or Path
        Cases and their labels.
    workers, scheduler, quiet
        See `workers.run_all`.
    **options
        As for `case_evidence.study`, with which the library has been computed.
    """
    cases, effects = [], {}
    for name, entry in read_labels(labels)["cases"].items():
        if entry["label"]["effects"]:
            cases.append(Path(folder).absolute() / name)
            effects[name] = entry["label"]["effects"]
    calls = {
        batch: (batch, [effects[case.name] for case in batch], options)
        for batch in in_batches(cases)
    }
    outcomes = each_batch(distances_of_batch, calls, Resources(workers, scheduler, quiet))
    numbers = {name: d for name, d in outcomes.items() if not isinstance(d, NumericalError)}
    return dict(sorted(numbers.items()))


def distances_of_batch(cases, effects, options):
    """{case: d} of some cases; those that cannot be compared are left out.

    Parameters
    ----------
    cases : sequence of Path
    effects : sequence of dict
        Effect -> what was drawn of it, of each case.
    options : dict
    """
    runner, table = runner_of(options), {}
    for case, drawn in zip(cases, effects, strict=True):
        try:
            table[case.name] = distance(analysis_of(case, runner, options), drawn)
        except (
            NumericalError
        ):  # the evidence of this case has failed as well, and `study` reports it
            continue
    return table


def distance(analysis, effects):
    """D of one case; 0 where an effect changes nothing that was measured.

    Parameters
    ----------
    analysis : Analysis
    effects : dict
        Effect -> what was drawn of it, one or two.
    """
    if not set(effects) <= set(analysis.responses):
        return 0.0
    responses, at = dict(analysis.responses), {}
    for effect, drawn in effects.items():
        closure = analysis.library.closures[effect][drawn["closure"]]
        responses[effect] = analysis.responses[effect][drawn["closure"]]
        at[effect] = np.array([drawn["quantiles"][name] for name in closure.parameters])
    if len(effects) > 1:
        responses = {name: responses[name] for name in effects}
    separated = separability(analysis.covariance, analysis.kernel, responses, at)
    if len(effects) > 1:
        return float(np.sqrt(min(separated.distance[0, 1], separated.distance[1, 0])))
    truth = separated.names.index(*effects)
    rivals = np.delete(separated.distance[truth], truth)
    return float(np.sqrt(min([separated.snr[truth] ** 2, *rivals])))
