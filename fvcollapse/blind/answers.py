"""The answers of the diagnosis to the cases of a suite."""

import json
from pathlib import Path

from fvcollapse.blind.evidence_file import read_evidence
from fvcollapse.blind.simple_rules import SIMPLE, simple_answer
from fvcollapse.diagnosis.names import UNKNOWN
from fvcollapse.diagnosis.verdict import verdict
from fvcollapse.diagnosis.verdict_model import class_prior
from fvcollapse.errors import InputError
from fvcollapse.files.atomic import write_atomic


def answers(out, model=None, simple=None):
    """{case: answer} of every file of evidence in a folder.

    Parameters
    ----------
    out : str or Path
    model : VerdictModel, optional
    simple : str, optional
        Key of `SIMPLE`: the answers of that rule instead.
    """
    answered = {}
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


def no_answer(names):
    """The answer to a case that could not be compared: the prior, with every name open."""
    return {
        "verdict": UNKNOWN,
        "probability": class_prior(names),
        "set": list(names),
        "parameters": {},
    }


def answer_of_verdict(content, judged):
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


def answer_of_report(report):
    """The answer that a report of the diagnosis gives."""
    verdict, rungs = report.verdict, {rung.model: rung for rung in report.details.ladder}
    answer = {
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
        fitted, second = rungs["winner"].fitted, rungs.get("runner_up")
        winner = rungs["winner"].held_out or fitted
        second = (second.held_out or second.fitted) if second else None
        answer["reduction"] = {
            "predicted": fitted.predicted,  # by the emulator, which knows the fitted experiments
            "actual": fitted.fraction_closed,
            "winner": winner.fraction_closed,
            "runner_up": second.fraction_closed if second else None,
        }
    return answer


def write_answers(path, answered):
    """Write answers as JSON."""
    write_atomic(path, (json.dumps(answered, indent=1) + "\n").encode(), running=False)
