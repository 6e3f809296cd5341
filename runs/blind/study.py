"""The blind check of the diagnosis, step by step; what is finished is not computed again.

    python -m runs.blind.study training   [--per-class 18]  training worlds, out/blind/training
    python -m runs.blind.study fit                          their evidence, and the two verdict layers fitted to it
    python -m runs.blind.study make       [--cases 240]     the sealed suite; commit runs/blind/SEAL.json
    python -m runs.blind.study answer                       its answers; commit runs/blind/answers*.json
    python -m runs.blind.study reduce     [--ladders 40]    whole diagnoses with an experiment held out
    python -m runs.blind.study score                        opens the seal; commit runs/blind/scores.json
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
from pathlib import Path

from fvcollapse.blind.answers import answer_of_report, answers, no_answer, write_answers
from fvcollapse.blind.case_evidence import case_folders, design_of, study
from fvcollapse.blind.causes import known_effects
from fvcollapse.blind.comparisons import reduction_scores
from fvcollapse.blind.distances import distances
from fvcollapse.blind.make import make
from fvcollapse.blind.score import score
from fvcollapse.blind.score_table import table, write_scores
from fvcollapse.blind.seal import SEAL, read_seal
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
from fvcollapse.diagnosis.analysis import REFINEMENTS
from fvcollapse.diagnosis.diagnose import diagnose
from fvcollapse.diagnosis.names import NAMED, NONE, UNKNOWN
from fvcollapse.diagnosis.report import FILE_NAME, read_report
from fvcollapse.diagnosis.verdict_model import SHIPPED, SHIPPED_CONTROLS, VerdictModel, solver_of
from fvcollapse.errors import InputError, NumericalError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.studies.workers import Resources
from runs.study import Study
from runs.study import main as call

REDUCTIONS = "reductions.json"
WAYS = {
    False: "",
    True: "_controls",
}  # of a diagnosis, without controls and with them: ends of file names
NAMES_OF_WAYS = {False: "alone", True: "controls"}
TRAINING_SEED = 2026
# share of worlds with slight physics, which alone teach the layer of diagnoses without controls; share of --per-class
TRAINING_SUITES = {"training": (0.5, 1.0), "training_slight": (1.0, 0.6)}
WITH_CONTROLS = ("training",)  # those that teach the layer of diagnoses with controls


def add_options(parser):
    """Options of this study."""
    parser.add_argument("--per-class", type=int, default=18, help="cases of an effect; default 18")
    parser.add_argument(
        "--taught", type=int, default=240, help="training cases with controls; default 240"
    )
    parser.add_argument(
        "--used-up",
        metavar="FOLDER",
        type=Path,
        nargs="*",
        default=[],
        help="--out of blind suites that have been scored: more cases to fit",
    )
    parser.add_argument("--cases", type=int, default=240, help="blind cases; default 240")
    parser.add_argument("--ladders", type=int, default=40, help="whole diagnoses; default 40")
    parser.add_argument("--refinements", type=int, default=REFINEMENTS, help="see analyse")
    parser.add_argument(
        "--layer",
        type=Path,
        nargs="*",
        default=[SHIPPED, SHIPPED_CONTROLS],
        help="verdict layers to restamp",
    )
    parser.add_argument("--note", help="why a restamp is right; required by it")


def make_training_suite(arguments):
    """Truths of the training worlds."""
    resources = Resources(arguments.workers, quiet=False)
    for number, (name, (slight_share, part)) in enumerate(TRAINING_SUITES.items()):
        seed = TRAINING_SEED + number
        classes = training_classes(round(part * arguments.per_class), seed)
        make_training(classes, arguments.out / name, seed, resources, slight_share)


def options_of(arguments):
    """What the diagnosis of every case shares."""
    return {
        "cache": arguments.cache,
        "cell_size": arguments.cell_size,
        "workers": arguments.workers,
        "refinements": arguments.refinements,
        "quiet": False,
    }


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
        names = WITH_CONTROLS if controls else TRAINING_SUITES
        for folder, name in [*((arguments.out, name) for name in names), *used_up]:
            labels = folder / f"{name}.labels.json"
            only = sorted(teaching_cases(labels, controls))
            only = only[: arguments.taught] if controls else only
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
    resources = Resources(arguments.workers, quiet=False)
    seal = make(arguments.cases, arguments.out / "blind", resources=resources)
    shutil.copyfile(seal, arguments.tables / SEAL)
    print(arguments.tables / SEAL)


def answer_blind_suite(arguments):
    """Answers of the diagnosis, alone and with controls, and of simple rules."""
    for controls, way in WAYS.items():
        path = arguments.tables / f"answers{way}.json"
        if path.exists():
            allowed = "no answers: a suite is answered once"
            raise InputError(path, "file", "answers that are already there", allowed)
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


def reduce_gaps(arguments):
    """Diagnose the first cases of several experiments, the last of which is held out."""
    several = [case for case in case_folders(arguments.out / "blind") if len(design_of(case)) > 1]
    answered = {}
    for case in several[: arguments.ladders]:
        report = held_out_report(case, arguments.out / "blind.reports" / case.name, arguments)
        if report is not None:
            answered[case.name] = answer_of_report(report)
    write_answers(arguments.tables / REDUCTIONS, answered)
    print(arguments.tables / REDUCTIONS)


def held_out_report(case, folder, arguments):
    """The report of a case, as it is there or new; None if a run that it needs fails."""
    if (folder / FILE_NAME).exists():
        return read_report(folder)
    *fitted, held_out = (case / name for name in design_of(case))
    options = options_of(arguments)
    del options["refinements"]
    try:
        return diagnose(fitted, hold_out=[held_out], folder=folder, **options)
    except NumericalError as error:
        print(f"{case.name}: {error}", file=sys.stderr)
        return None


def score_answers(arguments):
    """Distances of the true causes, and all scores, alone and with controls."""
    folder, labels = arguments.out / "blind", arguments.out / "blind.labels.json"
    published, present = (read_seal(place / SEAL) for place in (arguments.tables, folder))
    if published != present:
        raise InputError(folder / SEAL, "file", "another seal", f"that of {arguments.tables}")
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
        whole = json.loads((arguments.tables / REDUCTIONS).read_text(encoding="utf-8"))
        named = [answer for answer in whole.values() if answer["verdict"] in NAMED]
        rows = [answer["reduction"] for answer in named if "reduction" in answer]
        scores["alone"]["reduction"] = reduction_scores(rows)
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
    "restamp": restamp_verdict,
}


STUDY = Study("blind", __doc__, STEPS, add_options=add_options)
main = partial(call, STUDY)


if __name__ == "__main__":
    sys.exit(main())
