"""The question of a diagnosis as its folder records it; see `fvcollapse.output.question`."""

from collections.abc import Sequence
from hashlib import sha256
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.diagnosis.levels import applicable_effects
from fvcollapse.output.question import case_question

if TYPE_CHECKING:
    from fvcollapse.diagnosis.question import Question
    from fvcollapse.measure.experiment import Experiment


def recorded(question: "Question", effects: Sequence[str] | None, draws: int) -> dict[str, Any]:
    """All that the answer depends on, as {name: number, text or list}.

    Parameters
    ----------
    question : Question
    effects : sequence of str, optional
        Effects that are tried; None stands for all.
    draws : int
        Size of the ensemble.

    Raises
    ------
    InputError
        There is no effect of this name, or none that can act.
    """
    applicable_effects(
        {one.name: question.cases[one.name] for one in question.experiments}, effects
    )
    groups = {
        "experiments": question.experiments,
        "hold_out": question.held_out,
        "controls": question.controls,
    }
    record: dict[str, Any] = {
        name: [[experiment.name, digest(experiment)] for experiment in group]
        for name, group in groups.items()
    }
    record |= {
        "effects": effects and list(effects),
        "cell_size": question.cell_size,
        "seed": question.seed,
        "draws": draws,
    }
    return record | ({} if question.believed is None else case_question(question.believed))


def digest(experiment: "Experiment") -> str:
    """Digest of all that an experiment states and measured."""
    contents = sha256(repr((experiment.settings, experiment.scalars)).encode())
    for name, curve in sorted(experiment.curves.items()):
        contents.update(name.encode())
        for column in curve:
            contents.update(b"" if column is None else np.ascontiguousarray(column).tobytes())
    return contents.hexdigest()[:16]
