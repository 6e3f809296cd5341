"""Whether an experiment can be what it says, before anything is computed.

A slip of a unit, of an origin or of a column leaves every number legal, and a diagnosis would blame an
effect for it. Each check compares numbers that must agree and names the convention that explains the
disagreement. What no collapse can do is an error; what is merely odd is a warning in the report.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.errors import InputError
from fvcollapse.measure.plausibility import column, scalars, set_up, values
from fvcollapse.measure.plausibility.finding import ERROR, WARNING

if TYPE_CHECKING:
    from fvcollapse.measure.experiment import Experiment
    from fvcollapse.measure.plausibility.finding import Finding


CHECKS = (*set_up.CHECKS, *values.CHECKS, *scalars.CHECKS, *column.CHECKS)


def findings(experiment: "Experiment") -> "Iterator[Finding]":
    """Everything impossible or odd about an experiment, in the order of the checks.

    Parameters
    ----------
    experiment : Experiment

    Yields
    ------
    Finding
    """
    for check in CHECKS:
        with np.errstate(over="ignore"):  # of absurd numbers, which are findings
            found = tuple(check(experiment))
        yield from found


def refuse_impossible(experiment: "Experiment") -> None:
    """Raise InputError at the first thing about an experiment that no collapse can do."""
    for finding in findings(experiment):
        if finding.severity == ERROR:
            path = experiment.folder / finding.file
            raise InputError(path, finding.key, finding.found, finding.expected)


def oddities(experiment: "Experiment") -> "list[Finding]":
    """The warnings about an experiment, a list of `Finding`."""
    return [finding for finding in findings(experiment) if finding.severity == WARNING]
