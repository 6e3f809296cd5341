"""Opening the seal: answers against labels, beside answers that need no thought.

Nothing is scored unless every label, and every case that is still there, is what the seal says.
"""

import json
import math
from collections import Counter
from hashlib import sha256
from pathlib import Path

from fvcollapse.blind.make import (
    SEAL,
    SEAL_FORMAT,
    canonical,
    data_digest,
    label_digest,
    read_json,
    read_labels,
)
from fvcollapse.blind.metrics import (
    Outcome,
    all_scores,
    class_of,
    mcnemar,
    parameter_scores,
    ranking,
    reduction_scores,
)
from fvcollapse.case.grammar import closest_name, read_text
from fvcollapse.diagnosis.names import EFFECT, NAMED, NONE, SEVERAL, UNKNOWN
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import NUISANCE
from fvcollapse.errors import InputError
from fvcollapse.files.storage import write_atomic

VERDICTS = (*NAMED, NONE, UNKNOWN)
SUM_TOLERANCE = 1.0e-3
SEPARABLE = 3.0  # d of diagnosis: distance to the nearest other hypothesis in standard deviations
ALWAYS = "lateral_friction"  # the guess that explains a channel best on the average


def score(folder, answers, labels, against=(), separability=None):
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

    Raises
    ------
    InputError
        A broken seal, or answers that are not to these cases.
    """
    folder, plan = Path(folder), read_labels(labels)
    seal, checked = check_seal(folder, plan, labels)
    given = read_answers(answers, plan["cases"])
    outcomes = outcomes_of(plan["cases"], given)
    table = {"seal": seal, "data_checked": checked} | all_scores(outcomes)
    table["parameters"] = parameter_scores(parameter_rows(plan["cases"], given))
    named = [one for one in given.values() if one["verdict"] in NAMED and "reduction" in one]
    table["reduction"] = reduction_scores([one["reduction"] for one in named])
    if separability is not None:
        distances = read_distances(separability, plan["cases"])
        table["by_separability"] = by_separability(plan["cases"], outcomes, distances)
    table["baselines"] = baselines(plan["cases"], outcomes)
    for path in against:
        other = outcomes_of(plan["cases"], read_answers(path, plan["cases"]))
        table["baselines"][Path(path).stem] = summary(outcomes, other)
    return table


def write_scores(path, table):
    """Write the scores as JSON."""
    write_atomic(path, scores_text(table).encode(), running=False)


def scores_text(table):
    """The scores as JSON text."""
    return json.dumps(table, indent=1) + "\n"


# -- what is read ------------------------------------------------------------------------------------------


def check_seal(folder, plan, labels):
    """(overall hash, number of cases whose data were compared with the seal).

    Raises
    ------
    InputError
        Labels or data are not those that were sealed.
    """
    seal = read_json(folder / SEAL, SEAL_FORMAT)
    overall, cases = seal.get("seal"), seal["cases"]
    if set(cases) != set(plan["cases"]):
        raise InputError(labels, "cases", "other cases than the seal", f"those of {folder / SEAL}")
    checked = 0
    for name, entry in plan["cases"].items():
        if label_digest(entry) != cases[name]["label"]:
            broken = "a label that is not the sealed one"
            raise InputError(labels, f"cases.{name}", broken, f"the one of {folder / SEAL}")
        if (folder / name).is_dir():
            checked += 1
            if data_digest(folder / name) != cases[name]["data"]:
                raise InputError(folder / name, "folder", "other data than sealed", "as sealed")
    if seal_digest(cases) != overall:
        raise InputError(folder / SEAL, "seal", "a hash that is not of its cases", "as written")
    return overall, checked


def seal_digest(cases):
    """The overall hash of the cases of a seal."""
    return sha256(canonical(cases)).hexdigest()


def read_answers(path, cases):
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
        for key, found, allowed in problems(answer):
            raise InputError(path, f"{name}.{key}".rstrip("."), found, allowed)
    return {name: answers[name] for name in cases}


def read_object(path, what):
    """A JSON object; a defect is one InputError."""
    try:
        table = json.loads(read_text(path, "JSON"))
    except (ValueError, RecursionError) as error:
        raise InputError(path, "file", f"broken JSON: {error}", what) from None
    if not isinstance(table, dict):
        raise InputError(path, "file", f"a {type(table).__name__}", what)
    return table


def problems(answer):
    """(key, found, allowed) of what is wrong in an answer."""
    if not isinstance(answer, dict):
        yield "", f"a {type(answer).__name__}", "an object"
        return
    if answer.get("verdict") not in VERDICTS:
        yield "verdict", repr(answer.get("verdict")), " or ".join(VERDICTS)
    probability = answer.get("probability")
    if not isinstance(probability, dict) or not probability:
        yield "probability", repr(probability), "{name: probability}"
        return
    for name, value in probability.items():
        if not is_name(name):
            yield f"probability.{name}", "no such name", NAMES
        if not is_number(value) or not 0.0 <= value <= 1.0:
            yield f"probability.{name}", repr(value), "a number from 0 to 1"
    total = sum(value for value in probability.values() if is_number(value))
    if abs(total - 1.0) > SUM_TOLERANCE:
        yield "probability", f"a sum of {total:.6g}", "1"
    names = answer.get("set", [])
    if not isinstance(names, list) or not all(is_name(name) for name in names):
        yield "set", repr(names), f"a list of {NAMES}"
    yield from problems_of_extras(answer)


def problems_of_extras(answer):
    """What is wrong in the parts that an answer need not have."""
    reduction = answer.get("reduction", {})
    keys = ("predicted", "actual", "runner_up")  # and "winner", where an experiment was held out
    if not isinstance(reduction, dict) or (reduction and set(reduction) - {"winner"} != set(keys)):
        yield "reduction", repr(reduction), f"an object of {', '.join(keys)}"
    elif any(value is not None and not is_number(value) for value in reduction.values()):
        yield "reduction", repr(reduction), "numbers or null"
    parameters = answer.get("parameters", {})
    tables = parameters.values() if isinstance(parameters, dict) else [None]
    for table in tables:
        for row in table.values() if isinstance(table, dict) else [None]:
            numbers = [row.get(key) for key in ("value", "low", "high")] if row else [None]
            if not all(is_number(value) for value in numbers):
                yield "parameters", repr(row), "{effect: {parameter: {value, low, high}}}"
                return


NAMES = 'effects of the catalogue, two of them joined by "+" in alphabetical order, none, unknown'


def is_name(name):
    """Whether a name can be a cause."""
    if name in (NONE, UNKNOWN):
        return True
    parts = name.split("+") if isinstance(name, str) else []
    known = {each for each, effect in CATALOGUE.items() if effect.kind != NUISANCE}
    return 1 <= len(parts) <= 2 and set(parts) <= known and parts == sorted(set(parts))


def is_number(value):
    """Whether a value is a finite number."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def read_distances(path, cases):
    """{case: d} of a file; cases may be missing."""
    table = read_object(path, "{case: d}")
    for name, value in table.items():
        if name not in cases or not is_number(value):
            raise InputError(path, name, repr(value), "{case: d} with cases of the seal")
    return table


# -- what is compared --------------------------------------------------------------------------------------


def outcomes_of(cases, answers):
    """One `Outcome` per case."""
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


def parameter_rows(cases, answers):
    """True and found values of the parameters of every effect that acts and was answered for."""
    rows = []
    for name, entry in cases.items():
        for effect, drawn in entry["label"]["effects"].items():
            found = answers[name].get("parameters", {}).get(effect, {})
            for parameter in sorted(set(found) & set(drawn["quantiles"])):
                rows.append(found[parameter] | {"true": drawn["section"][parameter]})
    return rows


def by_separability(cases, outcomes, distances):
    """First name of single effects that the data can tell from all others, and of those they cannot."""
    single = [
        (distances[name], one)
        for name, one in zip(cases, outcomes, strict=True)
        if class_of(one.truth) == "single" and name in distances
    ]
    groups = {
        "separable": [one for d, one in single if d >= SEPARABLE],
        "not_separable": [one for d, one in single if d < SEPARABLE],
    }
    return {"d": SEPARABLE} | {name: ranking(group) for name, group in groups.items() if group}


def baselines(cases, outcomes):
    """What answers earn that do not look at the data."""
    counts = Counter(one.truth for one in outcomes)
    rates = {name: count / len(outcomes) for name, count in counts.items()}
    constant = {
        f"always_{ALWAYS}": ("effect", {ALWAYS: 1.0}),
        f"always_{NONE}": (NONE, {NONE: 1.0}),
        "base_rates": (verdict_for(max(rates, key=rates.get)), rates),
    }
    return {
        name: summary(
            outcomes,
            [
                one._replace(
                    verdict=verdict,
                    probability=probability,
                    names=(max(probability, key=probability.get),),
                )
                for one in outcomes
            ],
        )
        for name, (verdict, probability) in constant.items()
    }


def verdict_for(name):
    """The verdict that goes with a name."""
    if name in (NONE, UNKNOWN):
        return name
    return SEVERAL if "+" in name else EFFECT


def summary(outcomes, other):
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


def answer_of(report):
    """The answer that a report of the diagnosis gives."""
    verdict, rungs = report.verdict, {rung.model: rung for rung in report.details.ladder}
    answer = {
        "verdict": verdict.kind,
        "probability": verdict.probability,
        "set": list(verdict.set),
        "parameters": {
            name: {
                key: {"value": each.value, "low": each.low, "high": each.high}
                for key, each in report.candidates[name].parameters.items()
                if each.low is not None and each.high is not None
            }
            for name in verdict.effects
            if name in report.candidates
        },
    }
    if "winner" in rungs:
        fitted, second = rungs["winner"].fitted, rungs.get("runner_up")
        winner = rungs["winner"].held_out or fitted
        second = (second.held_out or second.fitted) if second else None
        answer["reduction"] = {
            "predicted": fitted.predicted,  # by the emulator, which knows the fitted experiments
            "actual": fitted.fraction_closed,
            "winner": winner.fraction_closed,
            "runner_up": second.fraction_closed if second else None,
        }
    return answer


# -- in words ----------------------------------------------------------------------------------------------


def table(scores):
    """The main scores as plain text."""
    single = scores["by_class"].get("single", {})
    separable = scores.get("by_separability", {}).get("separable", {})
    alarms, calibration = scores["alarms"], scores["calibration"]
    rows = [
        ("first name right", scores["all"]["top_1"]),
        ("among the first two", scores["all"]["top_2"]),
        ("first name right, single effects", single.get("top_1")),
        ("the same where the data can tell", separable.get("top_1")),
        ("truth in the set", scores["all"]["set_holds_truth"]),
        ("mean size of the set", scores["all"]["mean_set_size"]),
        ("false alarms where there is nothing", alarms["false_alarm_on_none"]),
        ("unknown found", alarms["unknown"]["found"]),
        *((f"  {kind}", each["found"]) for kind, each in alarms["unknown_by_kind"].items()),
        ("unknown wrongly named", alarms["unknown"]["wrongly_named"]),
        ("confident errors", calibration["confident_errors"]),
        ("Brier score", scores["sharpness"]["brier"]),
        ("skill of the Brier score", scores["sharpness"]["brier_skill"]),
        ("reduction predicted within 0.15", scores["reduction"]["within_tolerance"]),
        ("winner beats runner-up", scores["reduction"]["winner_beats_runner_up"]),
        ("90 % intervals hold the parameter", scores["parameters"]["interval_90_covers"]),
    ]
    lines = [line(name, each) for name, each in rows if each and each["value"] is not None]
    ece = calibration["ece_5_bins"]
    lines.append(
        f"{'calibration error, 5 bins':40s}{ece['value']:6.3f}  (perfect: up to {ece['perfect_95']:.3f})"
    )
    for name, each in scores["baselines"].items():
        lines.append(line(f"first name right, {name}", each["top_1"]))
    return "\n".join(lines)


def line(name, each):
    """One row of the table."""
    return (
        f"{name:40s}{each['value']:6.3f}  [{each['low']:.3f}, {each['high']:.3f}]  n = {each['n']}"
    )
