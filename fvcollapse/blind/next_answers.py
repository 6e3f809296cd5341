"""The answers to the first and a next experiment of a case together; no label is read."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fvcollapse.blind.case_evidence import analysis_of, runner_of
from fvcollapse.blind.next_plan import first_experiment, short_answer
from fvcollapse.blind.plain_values import Added, Answer, NextAnswer, NextPlan
from fvcollapse.diagnosis.diagnose import judge
from fvcollapse.errors import NumericalError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.measure.experiment import SETTINGS


def keep_next_answers(
    cases: Sequence[Path], places: tuple[Path, Path], options: Mapping[str, Any]
) -> dict[str, NumericalError]:
    """Write the answers after every next experiment of some cases; {case: NumericalError} of those that failed.

    Parameters
    ----------
    cases : sequence of Path
        Sealed cases.
    places : (Path, Path)
        Folder of the films of `next_films`, and the folder that gets `<case>.json`: {candidate: answer}, without those
        that could not be filmed or compared.
    options : dict
        See `case_evidence.study`.
    """
    films, out = places
    runner, failed = runner_of(options), dict[str, NumericalError]()
    for case in cases:
        answers = {}
        for path in sorted((films / case.name).glob(f"*/{SETTINGS}")):
            pair = [first_experiment(case), path.parent]
            try:
                _, judged, _ = judge(analysis_of(case, runner, options, pair))
            except NumericalError as error:
                failed[f"{case.name}, {path.parent.name}"] = error
            else:
                answers[path.parent.name] = short_answer(judged)
        text = json.dumps(answers, indent=1)
        write_atomic(out / f"{case.name}.json", f"{text}\n".encode())
    return failed


def together(plan: NextPlan, answers: Mapping[str, Answer]) -> NextAnswer:
    """The entry of a case in the file of answers: its plan, without the changes as numbers, and its answers."""
    added: dict[str, Added] = {
        name: {
            "words": planned["words"],
            "expected_gain": planned["expected_gain"],
            "separates": planned["separates"],
            "answer": answers.get(name),
        }
        for name, planned in plan["candidates"].items()
    }
    return {
        "first": plan["first"],
        "leading": plan["leading"],
        "recommended": plan["recommended"],
        "random": plan["random"],
        "added": added,
    }
