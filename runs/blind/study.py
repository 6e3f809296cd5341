"""The blind check of the diagnosis, step by step; what is finished is not computed again.

    python -m runs.blind.study training   [--per-class 18]  training worlds, out/blind/training
    python -m runs.blind.study fit                          their evidence, and the two verdict layers fitted to it
    python -m runs.blind.study make       [--cases 240]     the sealed suite; commit runs/blind/SEAL.json
    python -m runs.blind.study answer                       its answers; commit runs/blind/answers*.json
    python -m runs.blind.study reduce     [--ladders 40]    whole diagnoses with an experiment held out
    python -m runs.blind.study score                        opens the seal; commit runs/blind/scores.json
    python -m runs.blind.study next                         answers to a first and a next experiment of every case
    python -m runs.blind.study score_next                   opens the seal; the value of the next experiment
    python -m runs.blind.study losses     [--cases 120]     what loses right names: open cases, made easier step by step
    python -m runs.blind.study restamp    --note "REASON"   the shipped layers, as of the present solver

Every case belongs to a world, a laboratory with hidden physics and controls of its own. It is diagnosed twice, alone
and with the controls; without them only worlds whose own physics is slight are scored. The labels stay in out/blind
until the seal is opened. `answer` and `reduce` read no label; `score` does, and also computes how far every true
cause is from its nearest rival. A suite that has been scored is used up: after a change of the diagnosis make another
one (--out), and let the old one teach (fit --used-up).

`restamp` marks the verdict layers as of the present solver without fitting them again. It is right only if the
present solver gives the same numbers, bit by bit, as the one of the training suite; the note says how
that was shown, and stays in the files with the earlier version.
"""

import json
import shutil
import sys
from dataclasses import replace
from functools import partial

from fvcollapse.blind.answers import answers, no_answer, write_answers
from fvcollapse.blind.case_evidence import case_folders, study
from fvcollapse.blind.causes import BLIND, known_effects
from fvcollapse.blind.distances import distances
from fvcollapse.blind.labels import Draw
from fvcollapse.blind.make import make
from fvcollapse.blind.score import score
from fvcollapse.blind.score_table import table, write_scores
from fvcollapse.blind.seal import SEAL
from fvcollapse.blind.set_ups import BLIND_DESIGNS
from fvcollapse.blind.simple_rules import SIMPLE
from fvcollapse.blind.verdict_training import (
    cross_validated,
    make_training,
    teachers,
    teaching_cases,
    train,
    training_classes,
)
from fvcollapse.blind.worlds import SLIGHT
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.diagnosis.verdict_model import SHIPPED, SHIPPED_CONTROLS, VerdictModel, solver_of
from fvcollapse.errors import InputError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.files.targets import make_folder
from fvcollapse.studies.workers import Resources
from runs.blind.held_out import REDUCTIONS, reduce_gaps, scores_of_reductions
from runs.blind.losses import losses
from runs.blind.next_value import answer_next, score_next
from runs.blind.options import add_options, options_of, refuse_again, refuse_other_seal
from runs.study import Study
from runs.study import main as call

WAYS = {
    False: "",
    True: "_controls",
}  # of a diagnosis, without controls and with them: ends of file names
NAMES_OF_WAYS = {False: "alone", True: "controls"}
TRAINING_SEED = 2026
# share of worlds with slight physics, which alone teach the layer of diagnoses without controls; share of --per-class
TRAINING_SUITES = {"training": (0.5, 1.0), "training_slight": (1.0, 1.2)}


def make_training_suite(arguments):
    """Truths of the training worlds."""
    resources = Resources(arguments.workers, quiet=False)
    for number, (name, (slight_share, part)) in enumerate(TRAINING_SUITES.items()):
        seed = TRAINING_SEED + number
        classes = training_classes(round(part * arguments.per_class), seed)
        make_training(classes, arguments.out / name, seed, resources, slight_share)


def compare(arguments, folder, suite, controls, only=None):
    """Folder of the evidence of a suite; cases that could not be compared are reported on stderr."""
    out = folder / f"{suite}.evidence{WAYS[controls]}"
    options = options_of(arguments) | {"controls": controls, "only": only}
    failed = study(folder / suite, out, **options)
    for name, error in failed.items():
        print(f"{name}: {error}", file=sys.stderr)
    return out


def fit_verdict(arguments):
    """Evidence of the training worlds, the verdict layers, and their scores on worlds left out."""
    used_up, scores = [(folder, "blind") for folder in arguments.used_up], {}
    for controls, way in WAYS.items():
        suites = []
        for folder, name in [*((arguments.out, name) for name in TRAINING_SUITES), *used_up]:
            labels = folder / f"{name}.labels.json"
            only = sorted(teaching_cases(labels, controls))[: arguments.taught]
            suites.append((compare(arguments, folder, name, controls, only), labels))
        pairs = teachers(suites, controls)
        about = {"seed": TRAINING_SEED, "per_class": arguments.per_class}
        about |= {"controls": controls, "used_up": len(arguments.used_up)}
        train(pairs, about).save(SHIPPED_CONTROLS if controls else SHIPPED)
        scores[NAMES_OF_WAYS[controls]] = cross_validated(pairs)
        print(f"scores{way}", table_of(scores[NAMES_OF_WAYS[controls]]))
    write_scores(arguments.tables / "training_scores.json", scores)


def table_of(scores):
    """The main numbers of a fit as JSON."""
    return json.dumps({name: scores[name] for name in ("all", "alarms", "calibration")}, indent=1)


def make_blind_suite(arguments):
    """The blind suite, and a copy of its seal."""
    if arguments.per_world < 1:
        raise InputError("command line", "--per-world", f"{arguments.per_world}", "1, 2, 3, …")
    resources = Resources(arguments.workers, quiet=False)
    designs = tuple(design for design in BLIND_DESIGNS if min(design) in arguments.first)
    draw = Draw(BLIND._replace(designs=designs), per_world=arguments.per_world)
    seal = make(arguments.cases, arguments.out / "blind", draw=draw, resources=resources)
    make_folder(arguments.tables.absolute())
    shutil.copyfile(seal, arguments.tables / SEAL)
    print(arguments.tables / SEAL)


def answer_blind_suite(arguments):
    """Answers of the diagnosis, alone and with controls, and of simple rules."""
    for controls, way in WAYS.items():
        path = arguments.tables / f"answers{way}.json"
        refuse_again(path)
        evidence = compare(arguments, arguments.out, "blind", controls)
        model = VerdictModel.load(controls=controls)
        if model is None:
            raise InputError(path, "verdict", "no fitted verdict layer", "the step fit before")
        cases = [case.name for case in case_folders(arguments.out / "blind")]
        for name in () if controls else SIMPLE:
            answered = answers(evidence, simple=name)
            write_answers(arguments.tables / f"answers_{name}.json", completed(answered, cases))
        write_answers(path, completed(answers(evidence, model), cases))
        print(path)


def completed(answered, cases):
    """Answers to all cases: one that could not be compared is answered without the data."""
    names = (*known_effects(), NONE, UNKNOWN)
    return {case: answered.get(case) or no_answer(names) for case in cases}


def score_answers(arguments):
    """Distances of the true causes, and all scores, alone and with controls."""
    folder, labels = arguments.out / "blind", arguments.out / "blind.labels.json"
    refuse_other_seal(arguments)
    scores = {}
    for controls, way in WAYS.items():
        path = arguments.tables / f"distances{way}.json"
        if not path.exists():
            numbers = distances(arguments.out / f"blind.evidence{way}", labels)
            write_atomic(path, (json.dumps(numbers, indent=1) + "\n").encode(), running=False)
        against = [] if controls else [arguments.tables / f"answers_{name}.json" for name in SIMPLE]
        answered = arguments.tables / f"answers{way}.json"
        strengths = None if controls else (SLIGHT,)
        scores[NAMES_OF_WAYS[controls]] = score(folder, answered, labels, against, path, strengths)
    if (arguments.tables / REDUCTIONS).exists():
        scores["controls"]["reduction"] = scores_of_reductions(arguments.tables / REDUCTIONS)
    write_scores(arguments.tables / "scores.json", scores)
    for name, each in scores.items():
        print(name, table(each), sep="\n")


def restamp_verdict(arguments):
    """Mark the verdict layers as of the present solver, with the reason."""
    note = (arguments.note or "").strip()
    if not note:
        raise InputError("command line", "--note", "none", "why both solvers give the same numbers")
    for path in arguments.layer:
        restamped(VerdictModel.load(path), note).save(path)
        print(path)


def restamped(model, note):
    """The `VerdictModel` with the version of the present solver, and a note beside the earlier one."""
    notes = [*model.about.get("restamped", []), {"from": model.solver, "note": note}]
    return replace(model, solver=solver_of(model.effects), about=model.about | {"restamped": notes})


STEPS = {
    "training": make_training_suite,
    "fit": fit_verdict,
    "make": make_blind_suite,
    "answer": answer_blind_suite,
    "reduce": reduce_gaps,
    "score": score_answers,
    "next": answer_next,
    "score_next": score_next,
    "losses": losses,
    "restamp": restamp_verdict,
}


STUDY = Study("blind", __doc__, STEPS, add_options=add_options)
main = partial(call, STUDY)


if __name__ == "__main__":
    sys.exit(main())
