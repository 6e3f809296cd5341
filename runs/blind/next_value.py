"""What the recommended next experiment is worth: planned, measured by the sealed worlds, answered, scored."""

import json
import sys
from functools import partial

from fvcollapse.blind.answers import no_answer, write_answers
from fvcollapse.blind.case_evidence import case_folders, each_batch, in_batches
from fvcollapse.blind.causes import known_effects
from fvcollapse.blind.labels import read_labels
from fvcollapse.blind.next_answers import keep_next_answers, together
from fvcollapse.blind.next_films import film_next
from fvcollapse.blind.next_plan import keep_plans
from fvcollapse.blind.next_scores import next_scores, read_next_answers, right_of
from fvcollapse.blind.score_table import write_scores
from fvcollapse.blind.seal import check_seal
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.files.targets import make_folder
from fvcollapse.output.json_files import read_object
from fvcollapse.studies.workers import Resources
from runs.blind.held_out import REDUCTIONS, scores_of_reductions
from runs.blind.options import options_of, refuse_again, refuse_other_seal

ANSWERS, SCORES = "next_answers.json", "next_scores.json"


def answer_next(arguments):
    """Answers to the first experiment of the cases, and to it and each next one; the labels are the world's alone."""
    refuse_again(arguments.tables / ANSWERS)
    folder, labels = arguments.out / "blind", arguments.out / "blind.labels.json"
    cases = case_folders(folder)[: arguments.asked]
    plans, films, answers = (
        make_folder((arguments.out / "blind.next" / name).absolute())
        for name in ("plans", "films", "answers")
    )
    resources = Resources(arguments.workers, quiet=False)
    options = options_of(arguments) | {"controls": True}
    options = {name: options[name] for name in ("cache", "cell_size", "refinements", "controls")}
    each_missing(keep_plans, cases, plans, options, resources)
    planned = [case for case in cases if (plans / f"{case.name}.json").exists()]
    tell(film_next(folder.absolute(), labels.absolute(), plans, films, resources))
    each_missing(partial(answer_batch, films), planned, answers, options, resources)
    answered = {case.name: entry_of(case.name, plans, answers) for case in cases}
    write_answers(arguments.tables / ANSWERS, answered)
    print(arguments.tables / ANSWERS)


def answer_batch(films, cases, out, options):
    """See `next_answers.keep_next_answers`."""
    return keep_next_answers(cases, (films, out), options)


def each_missing(task, cases, out, options, resources):
    """Do a task for the cases that have no file in a folder yet, and tell what failed."""
    missing = [case for case in cases if not (out / f"{case.name}.json").exists()]
    calls = {batch: (batch, out, options) for batch in in_batches(missing)}
    tell(each_batch(task, calls, resources))


def tell(failed):
    """Say what could not be computed."""
    for name, error in failed.items():
        print(f"{name}: {error}", file=sys.stderr)


def entry_of(case, plans, answers):
    """The entry of a case in the answers: without the data where it could not be compared."""
    if not (plans / f"{case}.json").exists():
        first = no_answer((*known_effects(), NONE, UNKNOWN))
        return {"first": first, "leading": [], "recommended": None, "random": None, "added": {}}
    plan, answered = (
        json.loads((folder / f"{case}.json").read_text(encoding="utf-8"))
        for folder in (plans, answers)
    )
    return together(plan, answered)


def right_names(answered, cases):
    """Names of the cases whose first name is the truth alone."""
    return [name for name in answered if right_of(cases[name]["label"], answered[name]) == 1.0]


def score_next(arguments):
    """Opens the labels: the value of the next experiments, and of the whole diagnoses that are there."""
    refuse_other_seal(arguments)
    folder, labels = arguments.out / "blind", arguments.out / "blind.labels.json"
    plan = read_labels(labels)
    seal, checked = check_seal(folder, plan, labels)
    answered = read_next_answers(arguments.tables / ANSWERS, plan["cases"])
    cases = {name: plan["cases"][name] for name in answered}
    about = {"seal": seal, "data_checked": checked, "sealed_cases": len(plan["cases"])}
    scores = about | next_scores(cases, answered)
    if (arguments.tables / REDUCTIONS).exists():
        path = arguments.tables / REDUCTIONS
        scores["reduction"] = scores_of_reductions(path)
        right = right_names(read_object(path, "answers with reductions"), plan["cases"])
        scores["reduction"]["right_name"] = scores_of_reductions(path, only=right)
    write_scores(arguments.tables / SCORES, scores)
    print(arguments.tables / SCORES)
