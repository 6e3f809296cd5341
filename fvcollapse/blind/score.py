"""Answers against labels, beside answers that ignore the data."""

import math
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from fvcollapse.blind.comparisons import mcnemar, parameter_scores, reduction_scores
from fvcollapse.blind.forms import answer_problems
from fvcollapse.blind.labels import read_labels
from fvcollapse.blind.metrics import all_scores, ranking
from fvcollapse.blind.outcomes import Outcome, class_of
from fvcollapse.blind.plain_values import Answer, Average, Entry, Label
from fvcollapse.blind.seal import check_seal
from fvcollapse.case.grammar import closest_name
from fvcollapse.diagnosis.names import EFFECT, NAMED, NONE, SEVERAL, UNKNOWN
from fvcollapse.errors import InputError
from fvcollapse.output.json_files import read_object

SEPARABLE = 3.0  # d of diagnosis: distance to the nearest other hypothesis in standard deviations
ALWAYS = "lateral_friction"  # the guess that explains a channel best on the average


def score(
    folder: str | Path,
    answers: str | Path,
    labels: str | Path,
    against: Iterable[str | Path] = (),
    separability: str | Path | None = None,
    strengths: Collection[str] | None = None,
) -> dict[str, Any]:
    """All scores of some answers.

    Parameters
    ----------
    folder : str or Path
        With the seal, and the cases if they are still there.
    answers : str or Path
        JSON: {case: {"verdict", "probability", "set"}}, and where there are "parameters" {effect:
        {parameter: {"value", "low", "high"}}} (90 %) and "reduction" {"predicted", "actual",
        "runner_up"}.
    labels : str or Path
    against : sequence of str or Path
        Other answers to the same cases.
    separability : str or Path, optional
        JSON {case: d}: distance of the true cause to the nearest other hypothesis, at its true strength.
    strengths : sequence of str, optional
        Only cases of worlds of these strengths count; see `worlds`.

    Raises
    ------
    InputError
        A broken seal, or answers that are not to these cases.
    """
    folder, plan = Path(folder), read_labels(labels)
    seal, checked = check_seal(folder, plan, labels)
    every = read_answers(answers, plan["cases"])
    cases = {
        name: entry
        for name, entry in plan["cases"].items()
        if strengths is None or entry["label"]["world"]["strength"] in strengths
    }
    given = {name: every[name] for name in cases}
    outcomes = outcomes_of(cases, given)
    table: dict[str, Any] = {"seal": seal, "data_checked": checked} | all_scores(outcomes)
    table["worlds"] = len({entry["label"]["world"]["name"] for entry in cases.values()})
    table["by_laboratory"] = by_laboratory(cases, outcomes)
    table["parameters"] = parameter_scores(parameter_rows(cases, given))
    named = [
        answer for answer in given.values() if answer["verdict"] in NAMED and "reduction" in answer
    ]
    table["reduction"] = reduction_scores([answer["reduction"] for answer in named])
    if separability is not None:
        distances = read_distances(separability, plan["cases"])
        table["by_separability"] = by_separability(cases, outcomes, distances)
    table["baselines"] = baselines(cases, outcomes)
    for path in against:
        other = read_answers(path, plan["cases"])
        table["baselines"][Path(path).stem] = summary(outcomes, outcomes_of(cases, other))
    return table


def by_laboratory(
    cases: Mapping[str, Entry], outcomes: Sequence[Outcome]
) -> dict[str, dict[str, dict[str, Average]]]:
    """`ranking` by strength and statement of the world, its controls, number of experiments, closure of the effects."""
    keys: dict[str, Callable[[Label], str]] = {
        "strength": lambda label: label["world"]["strength"],
        "statement": lambda label: label["world"]["statement"],
        "controls": lambda label: str(len(label["world"]["controls"])),
        "experiments": lambda label: str(len(label["experiments"])),
        "closure": closure_of,
    }
    table = {}
    for axis, key in keys.items():
        groups: dict[str, list[Outcome]] = {}
        for entry, outcome in zip(cases.values(), outcomes, strict=True):
            groups.setdefault(key(entry["label"]), []).append(outcome)
        table[axis] = {value: ranking(group) for value, group in sorted(groups.items())}
    return table


def closure_of(label: Label) -> str:
    """Whether the effects of a case act by a closure of the catalogue, by another one, or there are none."""
    if not label["effects"]:
        return "no effect"
    return "catalogue" if label["form"] is None else "another"


def read_answers(path: str | Path, cases: Mapping[str, Entry]) -> dict[str, Answer]:
    """{case: answer} of a file, checked.

    Raises
    ------
    InputError
    """
    answers = read_object(path, "answers: {case: {verdict, probability, set}}")
    for name in cases:
        if name not in answers:
            raise InputError(path, name, "no answer", "an answer to every case")
    for name, answer in answers.items():
        if name not in cases:
            nearest = f"the closest case is {closest_name(name, list(cases))}"
            raise InputError(path, name, "no such case", nearest)
        for key, found, allowed in answer_problems(answer):
            raise InputError(path, f"{name}.{key}".rstrip("."), found, allowed)
    return {name: answers[name] for name in cases}


def is_number(value: object) -> bool:
    """Whether a value is a finite number."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def read_distances(path: str | Path, cases: Mapping[str, Entry]) -> dict[str, float]:
    """{case: d} of a file; cases may be missing."""
    table = read_object(path, "{case: d}")
    for name, value in table.items():
        if name not in cases or not is_number(value) or value < 0.0:
            raise InputError(path, name, repr(value), "{case: d} with cases of the seal")
    return table


def outcomes_of(cases: Mapping[str, Entry], answers: Mapping[str, Answer]) -> list[Outcome]:
    """The `Outcome` of every case."""
    return [
        Outcome(
            entry["label"]["cause"],
            entry["label"]["unknown_kind"],
            answers[name]["verdict"],
            answers[name]["probability"],
            tuple(answers[name].get("set", ())),
        )
        for name, entry in cases.items()
    ]


def parameter_rows(
    cases: Mapping[str, Entry], answers: Mapping[str, Answer]
) -> list[dict[str, Any]]:
    """True and estimated values of the parameters of every effect that acts and was answered for."""
    rows = []
    for name, entry in cases.items():
        for effect, drawn in entry["label"]["effects"].items():
            estimates = answers[name].get("parameters", {}).get(effect, {})
            for parameter in sorted(set(estimates) & set(drawn["quantiles"])):
                rows.append(estimates[parameter] | {"true": drawn["section"][parameter]})
    return rows


def by_separability(
    cases: Mapping[str, Entry], outcomes: Sequence[Outcome], distances: Mapping[str, float]
) -> dict[str, Any]:
    """`ranking` of single effects, and of pairs, that the data can separate from all others, and of the other ones."""
    groups: dict[str, list[Outcome]] = {}
    for name, outcome in zip(cases, outcomes, strict=True):
        if class_of(outcome.truth) in ("single", "pair") and name in distances:
            part = "separable" if distances[name] >= SEPARABLE else "not_separable"
            pair = "_pairs" if class_of(outcome.truth) == "pair" else ""
            groups.setdefault(part + pair, []).append(outcome)
    return {"d": SEPARABLE} | {name: ranking(group) for name, group in sorted(groups.items())}


def baselines(cases: Mapping[str, Entry], outcomes: Sequence[Outcome]) -> dict[str, dict[str, Any]]:
    """Scores of answers that ignore the data."""
    counts = Counter(outcome.truth for outcome in outcomes)
    rates = {name: count / len(outcomes) for name, count in counts.items()}
    constant = {
        f"always_{ALWAYS}": ("effect", {ALWAYS: 1.0}),
        f"always_{NONE}": (NONE, {NONE: 1.0}),
        "base_rates": (verdict_for(max(rates, key=lambda name: rates[name])), rates),
    }
    return {
        name: summary(
            outcomes,
            [
                outcome._replace(
                    verdict=verdict,
                    probability=probability,
                    names=(max(probability, key=lambda name: probability[name]),),
                )
                for outcome in outcomes
            ],
        )
        for name, (verdict, probability) in constant.items()
    }


def verdict_for(name: str) -> str:
    """The verdict that goes with a name."""
    if name in (NONE, UNKNOWN):
        return name
    return SEVERAL if "+" in name else EFFECT


def summary(outcomes: Sequence[Outcome], other: Sequence[Outcome]) -> dict[str, Any]:
    """The main scores of other answers, and whether the answers at hand differ from them."""
    scores = all_scores(other)
    return {
        "top_1": scores["all"]["top_1"],
        "top_2": scores["all"]["top_2"],
        "top_1_single": scores["by_class"].get("single", {}).get("top_1"),
        "set_holds_truth": scores["all"]["set_holds_truth"],
        "mean_set_size": scores["all"]["mean_set_size"],
        "false_alarm_on_none": scores["alarms"]["false_alarm_on_none"],
        "unknown_found": scores["alarms"]["unknown"]["found"],
        "brier": scores["sharpness"]["brier"],
        "confident_errors": scores["calibration"]["confident_errors"],
        "mcnemar": mcnemar(outcomes, other),
    }
