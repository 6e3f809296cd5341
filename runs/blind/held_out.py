"""Whole diagnoses of cases of several experiments, with the controls of their world; the last one is held out."""

import json
import sys

from fvcollapse.blind.answers import answer_of_report, write_answers
from fvcollapse.blind.case_evidence import case_folders, controls_of, design_of
from fvcollapse.blind.comparisons import reduction_scores
from fvcollapse.diagnosis.diagnose import diagnose
from fvcollapse.diagnosis.names import NAMED
from fvcollapse.errors import NumericalError
from fvcollapse.files.targets import make_folder
from fvcollapse.output.json_files import read_object
from runs.blind.options import options_of

REDUCTIONS = "reductions.json"


def reduce_gaps(arguments):
    """Diagnose the first cases of several experiments, the last of which is held out."""
    several = [case for case in case_folders(arguments.out / "blind") if len(design_of(case)) > 1]
    kept = make_folder((arguments.out / "blind.reductions").absolute())
    answered = {}
    for case in several[: arguments.ladders]:
        path = kept / f"{case.name}.json"
        if not path.exists():
            answer = held_out_answer(case, arguments)
            if answer is None:
                continue
            write_answers(path, answer)
        answered[case.name] = json.loads(path.read_text(encoding="utf-8"))
    write_answers(arguments.tables / REDUCTIONS, answered)
    print(arguments.tables / REDUCTIONS)


def held_out_answer(case, arguments):
    """The answer to a case whose last experiment is held out; None if a run that it needs fails."""
    *fitted, held_out = (case / name for name in design_of(case))
    options = options_of(arguments)
    del options["refinements"]
    try:
        report = diagnose(fitted, hold_out=[held_out], controls=controls_of(case), **options)
    except NumericalError as error:
        print(f"{case.name}: {error}", file=sys.stderr)
        return None
    return answer_of_report(report)


def scores_of_reductions(path, only=None):
    """Scores of a file of whole diagnoses, of those that name an effect; `only` of some cases.

    Raises
    ------
    InputError
    """
    whole = read_object(path, "answers with reductions")
    asked = whole if only is None else {name: whole[name] for name in only}
    named = [answer for answer in asked.values() if answer["verdict"] in NAMED]
    rows = [answer["reduction"] for answer in named if "reduction" in answer]
    return {"diagnoses": len(asked), "named": len(rows)} | reduction_scores(rows)
