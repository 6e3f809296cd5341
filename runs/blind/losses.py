"""What loses right names: the same cases, with one thing after the other taken out that makes them hard.

The labels of these cases are open, so that they must not teach a verdict layer, nor be taken for a sealed suite.
"""

import hashlib
import os
from collections import Counter

import numpy as np

from fvcollapse.blind.answers import answers
from fvcollapse.blind.case_evidence import study
from fvcollapse.blind.causes import BLIND, draw_pair, known_effects
from fvcollapse.blind.distances import distances
from fvcollapse.blind.evidence_file import read_evidence
from fvcollapse.blind.labels import Draw, draw_plan, read_labels, write_labels
from fvcollapse.blind.make import make, run_truths, truths_of, work_folder
from fvcollapse.blind.outcomes import Outcome, best_credit, credit
from fvcollapse.blind.seal import SEAL, canonical
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.diagnosis.verdict_model import VerdictModel
from fvcollapse.errors import InputError
from fvcollapse.files.targets import make_folder
from fvcollapse.studies.workers import Resources
from runs.blind.options import options_of
from runs.blind.removals import LADDER
from runs.table import write_table

SEED = 41
SHARES = {NONE: 4, UNKNOWN: 4}  # cases of a class over those of an effect
PAIRS = 2
TABLE = "losses.csv"


def losses(arguments):
    """Make, answer and tabulate the cases of every rung; what is finished is not computed again."""
    folder = make_folder((arguments.out / "losses").absolute())
    model = VerdictModel.load(controls=True)
    if model is None:
        raise InputError("command line", "losses", "no fitted verdict layer", "the step fit before")
    rows = []
    for rung in LADDER:
        labels = folder / f"{rung}.labels.json"
        if not labels.exists():
            write_labels(labels, plan_of(rung, folder, arguments.cases))
        resources = Resources(arguments.workers, quiet=False)
        if not (folder / rung / SEAL).exists():
            run_shared_truths(labels, folder / "truths", resources)
        make(arguments.cases, folder / rung, labels, resources=resources)
        evidence = folder / f"{rung}.evidence"
        study(folder / rung, evidence, controls=True, **options_of(arguments))
        rows += rows_of(rung, evidence, labels, answers(evidence, model))
        print(rung, flush=True)
    write_table(arguments.tables / TABLE, paired(rows))
    print(arguments.tables / TABLE)


def causes(count, seed):
    """Causes of the cases: every effect alike, `SHARES` of it none and unknown, `PAIRS` of it two effects."""
    rng = np.random.default_rng([seed, 1])
    effects = known_effects()
    each = count / (len(effects) + sum(SHARES.values()) + PAIRS)
    names = [name for name, share in SHARES.items() for _ in range(round(share * each))]
    names += [draw_pair(rng) for _ in range(round(PAIRS * each))]
    names += [effects[number % len(effects)] for number in range(count - len(names))]
    return rng.permutation(names[:count]).tolist()


def plan_of(rung, folder, count):
    """The labels of a rung: those of the first one, with everything up to it taken out."""
    first = next(iter(LADDER))
    if rung == first:
        return draw_plan(count, Draw(BLIND, causes(count, SEED), SEED))
    plan = read_labels(folder / f"{first}.labels.json")
    removed = list(LADDER)[1 : list(LADDER).index(rung) + 1]
    for entry in plan["cases"].values():
        for name in removed:
            entry["label"] = LADDER[name](entry["label"])
        entry["salt"] = os.urandom(16).hex()
    return plan


def run_shared_truths(labels, store, resources):
    """Run the truths of a file of labels; those that another rung has run are taken from a folder.

    A case that cannot be computed is drawn again, as by `make`.
    """
    work = make_folder(work_folder(labels), mode=0o700)
    plan = read_labels(labels)
    for text, forces, path in truths_of(plan, work).values():
        link(store / truth_name(text, forces), path)
    run_truths(plan, labels, Draw(), work, resources)
    for text, forces, path in truths_of(plan, work).values():
        link(path, store / truth_name(text, forces))


def truth_name(text, forces):
    """File name of a truth among those of all rungs."""
    return f"{hashlib.sha256(canonical([text, forces])).hexdigest()[:32]}.h5"


def link(source, target):
    """Give a file that exists a second name, unless that is taken."""
    if source.exists() and not target.exists():
        target.parent.mkdir(parents=True, exist_ok=True)
        os.link(source, target)


def rows_of(rung, evidence, labels, answered):
    """One row for every case of a rung that could be compared."""
    distance = distances(evidence, labels)
    for name, entry in read_labels(labels)["cases"].items():
        if name in answered:
            label, answer = entry["label"], answered[name]
            _, compared = read_evidence(evidence / f"{name}.json")
            yield {
                "rung": rung,
                "case": name,
                "attempt": entry["attempt"],
                "world": label["world"]["name"],
                "strength": label["world"]["strength"],
                "truth": label["cause"],
                "closure": "another" if label["form"] else "catalogue",
                "d": distance.get(name),
            } | judged(label["cause"], answer, compared)


def judged(truth, answer, evidence):
    """What an answer says of a truth, and what the largest evidence alone would say."""
    outcome = Outcome(truth, None, answer["verdict"], answer["probability"], tuple(answer["set"]))
    first = outcome.ranked()[0]
    return {
        "verdict": answer["verdict"],
        "first": first,
        "right": credit(truth, first),
        "p_truth": answer["probability"].get(truth, 0.0),
        "set_holds_truth": best_credit(outcome, outcome.names or (UNKNOWN,)),
        "names": max(len(outcome.names), 1),
        "largest_evidence": evidence.best.name,
        "right_by_evidence": credit(truth, evidence.best.name),
    }


def paired(rows):
    """Rows of the cases that every rung has answered, from the same draw."""
    draws = Counter((row["case"], row["attempt"]) for row in rows)
    return [row for row in rows if draws[row["case"], row["attempt"]] == len(LADDER)]
