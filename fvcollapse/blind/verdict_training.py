"""The verdict layer of the diagnosis, fitted to the evidence and the labels of training suites."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.blind.causes import BLIND, TRAINING, draw_pair, known_effects
from fvcollapse.blind.evidence_file import read_evidence
from fvcollapse.blind.labels import Draw, read_labels
from fvcollapse.blind.make import make
from fvcollapse.blind.metrics import all_scores
from fvcollapse.blind.outcomes import Outcome
from fvcollapse.blind.plain_values import Label
from fvcollapse.blind.verdict_fit import Origin, fit, left_out
from fvcollapse.blind.worlds import GENTLE, SLIGHT
from fvcollapse.diagnosis.names import NONE, SEVERAL, UNKNOWN
from fvcollapse.diagnosis.verdict import verdict
from fvcollapse.studies.workers import HERE, Resources

if TYPE_CHECKING:
    from fvcollapse.diagnosis.evidence import Evidence
    from fvcollapse.diagnosis.verdict_model import VerdictModel

SHARES = {NONE: 4.0, UNKNOWN: 3.0, SEVERAL: 3.0}  # cases of a class over those of an effect
PER_WORLD = 5  # cases of a training world


def training_classes(per_class: int, seed: int) -> list[str]:
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


def make_training(
    classes: Sequence[str],
    folder: str | Path,
    seed: int,
    resources: Resources = HERE,
    slight_share: float = TRAINING.slight_share,
) -> Path:
    """Make a training suite of these causes; see `make`."""
    style = TRAINING._replace(slight_share=slight_share)
    draw = Draw(style, classes, seed, per_world=PER_WORLD)
    return make(len(classes), folder, None, draw, resources)


def read_suite(out: str | Path, labels: str | Path) -> dict[str, tuple["Evidence", Label]]:
    """{case: (Evidence, label)} of a suite whose labels are known."""
    cases = read_labels(labels)["cases"]
    return {
        name: (read_evidence(Path(out) / f"{name}.json")[1], entry["label"])
        for name, entry in cases.items()
        if (Path(out) / f"{name}.json").exists()
    }


def teachers(
    suites: Iterable[tuple[str | Path, str | Path]], controls: bool
) -> list[tuple["Evidence", Label]]:
    """The (Evidence, label) pairs of suites that may teach a layer.

    Kinds of unknown that blind suites hide are left out: the next blind suite hides them too. Without controls only
    `slight` worlds teach: in a `strong` one what is hidden in the world itself is a right answer too.

    Parameters
    ----------
    suites : sequence of (str or Path, str or Path)
        Folder of the evidence, and labels, of each.
    controls : bool
        Whether the evidence is one with controls.
    """
    pairs = [pair for suite in suites for pair in read_suite(*suite).values()]
    return [pair for pair in pairs if may_teach(pair[1], controls)]


def may_teach(label: Label, controls: bool) -> bool:
    """Whether a label may teach a layer; see `teachers`."""
    unseen = label["unknown_kind"] not in BLIND.unknowns
    world = label["world"]
    gentle = world["strength"] == SLIGHT and set(world.get("kinds", ())) <= set(GENTLE)
    return unseen and (controls or gentle)


def teaching_cases(labels: str | Path, controls: bool) -> set[str]:
    """Names of the cases of a file of labels that may teach a layer."""
    cases = read_labels(labels)["cases"]
    return {name for name, entry in cases.items() if may_teach(entry["label"], controls)}


def origin_of(label: Label) -> Origin:
    """The `Origin` of a label."""
    return Origin(label["world"]["name"], label["unknown_kind"])


def train(
    pairs: Sequence[tuple["Evidence", Label]], about: dict[str, Any] | None = None
) -> "VerdictModel":
    """The `VerdictModel` of (Evidence, label) pairs."""
    cases = [(evidence, label["cause"]) for evidence, label in pairs]
    return fit(cases, known_effects(), about, [origin_of(label) for _, label in pairs])


def cross_validated(pairs: Sequence[tuple["Evidence", Label]], seed: int = 0) -> dict[str, Any]:
    """All scores of pairs, each judged by a model that has seen neither its world nor its kind of unknown."""
    origins, outcomes = [origin_of(label) for _, label in pairs], []
    for judged, teaching in left_out(origins, seed):
        model = train([pairs[number] for number in teaching])
        for evidence, label in (pairs[number] for number in judged):
            answer = verdict(evidence, model)
            outcomes.append(
                Outcome(
                    label["cause"],
                    label["unknown_kind"],
                    answer.kind,
                    answer.probability,
                    answer.set,
                )
            )
    return all_scores(outcomes)
