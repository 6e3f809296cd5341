"""What the recommended next experiment is worth: beside a random one, the best possible, and none at all.

A gain is the change from the answer to the first experiment to the answer to both: of the share of right first names,
of the probability of the truth, and of the entropy of all probabilities (its drop, in bit). The recommended experiment
is compared with the mean over all candidates, which is what one drawn at random gains on the average, and with the one
after which the truth is the most probable, which nobody can know beforehand and which has luck in it. Intervals are
those of 95 % of a bootstrap over worlds.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np
from scipy.stats import spearmanr

from fvcollapse.blind.forms import Answer, answer_problems
from fvcollapse.blind.outcomes import SAMPLES, Outcome, best_credit, class_of
from fvcollapse.blind.plain_values import Answer as GivenAnswer
from fvcollapse.blind.plain_values import Average, Entry, Label
from fvcollapse.blind.plain_values import NextAnswer as GivenNextAnswer
from fvcollapse.diagnosis.next_experiment import entropy
from fvcollapse.errors import InputError
from fvcollapse.output.forms import form_problems
from fvcollapse.output.json_files import read_object

MEASURES = ("right", "probability", "entropy")
CHOICES = ("recommended", "random", "drawn", "best")  # random: the mean over all candidates
AIM = 2.0  # times the gain of a random one


class Added(msgspec.Struct):
    """One next experiment; see `next_answers.together`. `answer` None: it could not be filmed or compared."""

    words: str
    expected_gain: float
    separates: list[str]
    answer: Answer | None


class NextAnswer(msgspec.Struct):
    """The entry of a case."""

    first: Answer
    leading: list[str]
    added: dict[str, Added]
    recommended: str | None
    random: str | None


class Row(NamedTuple):
    """One case with a recommendation: (3,) arrays of `MEASURES`.

    Attributes
    ----------
    world, truth : str
    before : array
        After the first experiment.
    after : dict
        Candidate -> array, after both.
    expected : dict
        Candidate -> expected drop of the entropy [bit].
    recommended, drawn : str
    is_leading : bool
        Whether the truth is among the hypotheses that were to be separated.
    """

    world: str
    truth: str
    before: np.ndarray
    after: dict[str, np.ndarray]
    expected: dict[str, float]
    recommended: str
    drawn: str
    is_leading: bool

    def gains(self) -> dict[str, np.ndarray]:
        """{choice: (3,) gains} of `CHOICES`; a drop of the entropy counts as a gain."""
        gains = {name: values - self.before for name, values in self.after.items()}
        best = max(gains, key=lambda name: tuple(gains[name][[1, 0, 2]]))
        return {
            "recommended": gains[self.recommended],
            "random": np.mean([*gains.values()], axis=0),
            "drawn": gains[self.drawn],
            "best": gains[best],
        }


def read_next_answers(path: Path, cases: Mapping[str, Entry]) -> dict[str, GivenNextAnswer]:
    """{case: entry} of a file of answers to all cases or to the first ones by number, checked.

    Raises
    ------
    InputError
    """
    answers = read_object(path, "answers: {case: {first, leading, added, recommended, random}}")
    for name in sorted(cases)[: len(answers)]:
        if name not in answers:
            raise InputError(path, name, "no answer", "answers to all cases, or to the first ones")
    for name, entry in answers.items():
        if name not in cases:
            raise InputError(path, name, "no such case", "cases of the seal")
        for key, found, allowed in next_problems(entry):
            raise InputError(path, f"{name}.{key}", found, allowed)
    return answers


def next_problems(entry: Any) -> Iterator[tuple[str, str, str]]:
    """(key, found, allowed) of what is wrong in the entry of a case."""
    wrong = list(form_problems(entry, NextAnswer))
    if wrong:
        yield from wrong
        return
    given = {"first": entry["first"]}
    given |= {f"added.{name}.answer": about["answer"] for name, about in entry["added"].items()}
    for key, answer in given.items():
        for part, found, allowed in answer_problems(answer) if answer else ():
            yield f"{key}.{part}", found, allowed
    for key in ("recommended", "random"):
        if entry[key] is None and not entry["added"]:
            continue
        if entry[key] not in entry["added"]:
            yield key, f"{entry[key]!r:.40}", "a name in added"


def next_scores(
    cases: Mapping[str, Entry], answers: Mapping[str, GivenNextAnswer]
) -> dict[str, Any]:
    """All scores of the next experiments.

    Parameters
    ----------
    cases : dict
        Name -> entry of the labels.
    answers : dict
        See `read_next_answers`.
    """
    rows = [row for name in cases if (row := row_of(cases[name]["label"], answers[name]))]
    silent = [name for name in cases if not answers[name]["added"]]
    right = [right_of(cases[name]["label"], answers[name]["first"]) for name in silent]
    return {
        "cases": len(cases),
        "worlds": len({entry["label"]["world"]["name"] for entry in cases.values()}),
        "nothing_left_to_separate": {"cases": len(silent), "right": float(sum(right))},
        "not_compared": len(cases) - len(silent) - len(rows),
        "candidates": float(np.mean([len(row.after) for row in rows])) if rows else 0.0,
        "all": compared(rows),
        "groups": {
            name: compared(group) for name, group in groups_of(rows).items() if len(group) > 1
        },
        "by_candidate": by_candidate(rows),
        "expectation": expectation(rows),
    }


def row_of(label: Label, entry: GivenNextAnswer) -> Row | None:
    """The `Row` of a case; None without a recommendation, or if what it names was not compared."""
    after = {
        name: measures(label, about["answer"])
        for name, about in entry["added"].items()
        if about["answer"]
    }
    if entry["recommended"] not in after or entry["random"] not in after:
        return None
    return Row(
        world=label["world"]["name"],
        truth=label["cause"],
        before=measures(label, entry["first"]),
        after=after,
        expected={name: entry["added"][name]["expected_gain"] for name in after},
        recommended=entry["recommended"],
        drawn=entry["random"],
        is_leading=label["cause"] in entry["leading"],
    )


def measures(label: Label, answer: GivenAnswer) -> np.ndarray:
    """(3,) of `MEASURES`, the entropy with a minus sign."""
    shares = np.array([*answer["probability"].values()])
    truth = answer["probability"].get(label["cause"], 0.0)
    return np.array([right_of(label, answer), truth, -entropy(shares / shares.sum())])


def right_of(label: Label, answer: GivenAnswer) -> float:
    """1 where the first name is the truth, 1/2 where it is one of two."""
    outcome = Outcome(
        label["cause"],
        label["unknown_kind"],
        answer["verdict"],
        answer["probability"],
        tuple(answer["set"]),
    )
    return best_credit(outcome, outcome.ranked()[:1])


def groups_of(rows: Sequence[Row]) -> dict[str, list[Row]]:
    """Rows whose truth the next experiment was to separate, those whose truth it was not, and rows by class."""
    groups = {"truth_leading": [row for row in rows if row.is_leading]}
    groups["truth_not_leading"] = [row for row in rows if not row.is_leading]
    for row in rows:
        groups.setdefault(class_of(row.truth), []).append(row)
    return groups


def compared(rows: Sequence[Row]) -> dict[str, Any]:
    """Gains of every choice, and how far the recommended one is ahead, with their intervals."""
    if not rows:
        return {"cases": 0}
    worlds = [row.world for row in rows]
    before = np.array([row.before for row in rows])
    every = [row.gains() for row in rows]
    gains = {choice: np.array([each[choice] for each in every]) for choice in CHOICES}
    parts = ("before", "gain", "ahead", "ahead_of_aim")
    table: dict[str, Any] = {"cases": len(rows)} | {part: {} for part in parts}
    for number, measure in enumerate(MEASURES):
        sign = -1.0 if measure == "entropy" else 1.0
        table["before"][measure] = over_worlds(sign * before[:, number], worlds)
        own = {choice: values[:, number] for choice, values in gains.items()}
        table["gain"][measure] = {name: over_worlds(each, worlds) for name, each in own.items()}
        table["ahead"][measure] = over_worlds(own["recommended"] - own["random"], worlds)
        aim = own["recommended"] - AIM * own["random"]
        table["ahead_of_aim"][measure] = over_worlds(aim, worlds)
    return table


def over_worlds(values: Sequence[float] | np.ndarray, worlds: Sequence[str]) -> Average:
    """{"value", "low", "high", "n"} of the mean of values (n,); whole worlds are drawn again."""
    values, rng = np.asarray(values, float), np.random.default_rng(0)
    _, group = np.unique(worlds, return_inverse=True)
    sums, counts = np.bincount(group, values), np.bincount(group)
    drawn = rng.integers(len(sums), size=(SAMPLES, len(sums)))
    means = sums[drawn].sum(axis=1) / counts[drawn].sum(axis=1)
    low, high = np.quantile(means, [0.025, 0.975])
    return {"value": float(values.mean()), "low": float(low), "high": float(high), "n": len(values)}


def by_candidate(rows: Sequence[Row]) -> dict[str, Any]:
    """{kind of change: how often it could be chosen, was recommended, was the best, and its mean gains}."""
    table: dict[str, dict[str, Any]] = {}
    for row in rows:
        best = max(row.after, key=lambda name: tuple(row.after[name][[1, 0, 2]]))
        for name, values in row.after.items():
            about = table.setdefault(name, {"gains": [], "recommended": 0, "best": 0})
            about["gains"].append(values - row.before)
            about["recommended"] += name == row.recommended
            about["best"] += name == best
    return {
        name: {
            "cases": len(about["gains"]),
            "recommended": about["recommended"],
            "best": about["best"],
            "gain": dict(zip(MEASURES, np.mean(about["gains"], axis=0).tolist(), strict=True)),
        }
        for name, about in sorted(table.items())
    }


def expectation(rows: Sequence[Row]) -> dict[str, Any]:
    """What was expected of the recommended and of a random experiment, and whether the order of the candidates holds.

    `order` is the mean over the cases of the rank correlation between expected gain and gain in the probability of the
    truth.
    """
    if not rows:
        return {}
    worlds = [row.world for row in rows]
    promised = [row.expected[row.recommended] for row in rows]
    usual = [float(np.mean([*row.expected.values()])) for row in rows]
    orders, owners = [], []
    for row in rows:
        expected = [row.expected[name] for name in row.after]
        found = [values[1] for values in row.after.values()]
        if len(set(expected)) > 1 and len(set(found)) > 1:
            orders.append(float(spearmanr(expected, found).statistic))
            owners.append(row.world)
    return {
        "expected_drop_of_entropy": over_worlds(promised, worlds),
        "expected_drop_by_a_random_one": over_worlds(usual, worlds),
        "order": over_worlds(orders, owners) if orders else None,
        "best_was_recommended": over_worlds([is_best(row) for row in rows], worlds),
    }


def is_best(row: Row) -> float:
    """Whether no candidate makes the truth more probable than the recommended one."""
    most = max(values[1] for values in row.after.values())
    return float(row.after[row.recommended][1] >= most)
