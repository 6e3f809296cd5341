"""The verdict layer of the diagnosis, fitted to the evidence and the labels of training suites."""

from pathlib import Path

import numpy as np

from fvcollapse.blind.causes import BLIND, TRAINING, draw_pair, known_effects
from fvcollapse.blind.evidence_file import read_evidence
from fvcollapse.blind.labels import Draw, read_labels
from fvcollapse.blind.make import make
from fvcollapse.blind.metrics import all_scores
from fvcollapse.blind.outcomes import Outcome
from fvcollapse.blind.verdict_fit import FOLDS, fit
from fvcollapse.diagnosis.names import NONE, SEVERAL, UNKNOWN
from fvcollapse.diagnosis.verdict import verdict
from fvcollapse.diagnosis.verdict_features import class_of
from fvcollapse.studies.workers import HERE

SHARES = {NONE: 1.5, UNKNOWN: 1.5, SEVERAL: 1.0}  # cases of a class over those of an effect


def training_classes(per_class, seed):
    """Causes of a training suite in random order, so that its first cases are a smaller suite.

    Parameters
    ----------
    per_class : int
        Cases of every effect; of the other classes `SHARES` times that.
    seed : int
    """
    classes = [name for name in known_effects() for _ in range(per_class)]
    counts = {name: round(share * per_class) for name, share in SHARES.items()}
    classes += [NONE] * counts[NONE] + [UNKNOWN] * counts[UNKNOWN]
    rng = np.random.default_rng([seed, 1])
    classes += [draw_pair(rng) for _ in range(counts[SEVERAL])]
    return rng.permutation(classes).tolist()


def make_training(classes, folder, seed, resources=HERE):
    """Make a training suite of these causes; see `make`."""
    return make(len(classes), folder, None, Draw(TRAINING, classes, seed), resources)


def read_suite(out, labels):
    """{case: (Evidence, entry of the labels)} of a suite whose labels are known."""
    cases = read_labels(labels)["cases"]
    return {
        name: (read_evidence(Path(out) / f"{name}.json")[1], entry)
        for name, entry in cases.items()
        if (Path(out) / f"{name}.json").exists()
    }


def train(suites, about=None):
    """The `VerdictModel` of one or more suites.

    Kinds of unknown that blind suites hide are left out: the next blind suite hides them too.

    Parameters
    ----------
    suites : sequence of (str or Path, str or Path)
        Folder of the evidence, and labels, of each.
    """
    return fit_to([pair for suite in suites for pair in read_suite(*suite).values()], about)


def may_teach(pair):
    """Whether an (Evidence, entry of the labels) hides no kind of unknown that is kept for blind suites."""
    return pair[1]["label"]["unknown_kind"] not in BLIND.unknowns


def fit_to(pairs, about=None):
    """The `VerdictModel` of (Evidence, entry of the labels) pairs, of those that may teach."""
    pairs = [pair for pair in pairs if may_teach(pair)]
    cases = [(evidence, entry["label"]["cause"]) for evidence, entry in pairs]
    kinds = [entry["label"]["unknown_kind"] for _, entry in pairs]
    return fit(cases, known_effects(), about, kinds)


def cross_validated(suites, folds=FOLDS, leave_kind_out=True, seed=0):
    """All scores of suites whose every case is judged by a model that was fitted without it.

    Parameters
    ----------
    suites : sequence of (str or Path, str or Path)
        See `train`.
    leave_kind_out : bool
        A model that judges a kind of unknown is fitted without that kind.
    """
    cases = [pair for suite in suites for pair in read_suite(*suite).values()]
    part = parts_of([entry["label"] for _, entry in cases], folds, leave_kind_out, seed)
    outcomes = []
    for number in np.unique(part):
        model = fit_to([case for case, of in zip(cases, part, strict=True) if of != number])
        for (evidence, entry), of in zip(cases, part, strict=True):
            if of == number:
                judged, label = verdict(evidence, model), entry["label"]
                answer = judged.kind, judged.probability, judged.set
                outcomes.append(Outcome(label["cause"], label["unknown_kind"], *answer))
    return all_scores(outcomes)


def parts_of(labels, folds, leave_kind_out, seed):
    """Number of the part that each case is left out with: its fold, or its kind of unknown.

    The cases of a class are spread evenly over the folds, at random.
    """
    rng, groups = np.random.default_rng(seed), {}
    for number, label in enumerate(labels):
        kind = label["unknown_kind"] if leave_kind_out else None
        groups.setdefault((class_of(label["cause"]), kind), []).append(number)
    kinds = sorted({kind for _, kind in groups if kind})
    part = np.empty(len(labels), int)
    for (_, kind), members in groups.items():
        if kind is None:
            part[rng.permutation(members)] = np.arange(len(members)) % folds
        else:
            part[members] = folds + kinds.index(kind)
    return part
