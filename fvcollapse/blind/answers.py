"""The answers of the diagnosis to the cases of a suite."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fvcollapse.blind.evidence_file import read_evidence
from fvcollapse.blind.plain_values import Answer, Content, Left
from fvcollapse.blind.simple_rules import SIMPLE, simple_answer
from fvcollapse.diagnosis.names import UNKNOWN
from fvcollapse.diagnosis.verdict import verdict
from fvcollapse.diagnosis.verdict_model import class_prior
from fvcollapse.errors import InputError
from fvcollapse.files.atomic import write_atomic

if TYPE_CHECKING:
    from fvcollapse.diagnosis.report.schema import Report
    from fvcollapse.diagnosis.verdict import Verdict
    from fvcollapse.diagnosis.verdict_model import VerdictModel


def answers(
    out: str | Path, model: "VerdictModel | None" = None, simple: str | None = None
) -> dict[str, Answer]:
    """{case: answer} of every file of evidence in a folder.

    Parameters
    ----------
    out : str or Path
    model : VerdictModel, optional
    simple : str, optional
        Key of `SIMPLE`: the answers of that rule instead.
    """
    answered: dict[str, Answer] = {}
    for path in sorted(Path(out).glob("*.json")):
        content, evidence = read_evidence(path)
        if simple is not None:
            answered[path.stem] = simple_answer(SIMPLE[simple](content["simple"]), evidence)
            continue
        if model is not None and not model.covers(evidence):
            allowed = "a verdict layer that was fitted with them: fit it again"
            raise InputError(path, "hypotheses", "effects that the model does not know", allowed)
        answered[path.stem] = answer_of_verdict(content, verdict(evidence, model))
    return answered


def no_answer(names: Sequence[str]) -> Answer:
    """The answer to a case that could not be compared: the prior, with every name open."""
    return {
        "verdict": UNKNOWN,
        "probability": class_prior(names),
        "set": list(names),
        "parameters": {},
    }


def answer_of_verdict(content: Content, judged: "Verdict") -> Answer:
    """A `Verdict` on the content of a file of evidence as an answer."""
    return {
        "verdict": judged.kind,
        "probability": judged.probability,
        "set": list(judged.set),
        "parameters": {
            name: content["hypotheses"][name]["parameters"]
            for name in judged.effects
            if "parameters" in content["hypotheses"].get(name, {})
        },
    }


def answer_of_report(report: "Report") -> Answer:
    """The answer that a report of the diagnosis gives."""
    verdict, rungs = report.verdict, {rung.model: rung for rung in report.details.ladder}
    answer: Answer = {
        "verdict": verdict.kind,
        "probability": verdict.probability,
        "set": list(verdict.set),
        "parameters": {
            name: {
                key: {"value": estimate.value, "low": estimate.low, "high": estimate.high}
                for key, estimate in report.candidates[name].parameters.items()
                if estimate.low is not None and estimate.high is not None
            }
            for name in verdict.effects
            if name in report.candidates
        },
    }
    if "winner" in rungs:
        fitted, other = rungs["winner"].fitted, rungs.get("runner_up")
        winner = rungs["winner"].held_out or fitted
        second = (other.held_out or other.fitted) if other else None
        answer["reduction"] = {
            "predicted": fitted.predicted,  # by the emulator, which knows the fitted experiments
            "actual": fitted.fraction_closed,
            "winner": winner.fraction_closed,
            "runner_up": second.fraction_closed if second else None,
        }
        if second is not None:
            answer["reduction"].update(left_of(report))
    return answer


def left_of(report: "Report") -> Left:
    """What winner and runner-up leave of the gap of the experiment held out; empty unless it is one."""
    confirmation = report.details.confirmation
    folds = [fold for fold in confirmation.folds if fold.held_out] if confirmation else []
    if len(folds) != 1:
        return {}
    (fold,) = folds
    return {"winner_left": fold.winner_left, "runner_up_left": fold.runner_up_left}


def write_answers(path: str | Path, answered: Mapping[str, Answer]) -> None:
    """Write answers as JSON."""
    write_atomic(path, (json.dumps(answered, indent=1) + "\n").encode(), running=False)
