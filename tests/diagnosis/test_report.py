"""report.json: the keys that stay stable, a round trip without loss, and no report that contradicts itself."""

import json
import math

import msgspec
import numpy as np
import pytest
from msgspec.structs import replace
from report_example import EFFECTS, FITTED, HELD_OUT, example, with_remainder

from fvcollapse.diagnosis.names import BASELINE
from fvcollapse.diagnosis.report.report_file import (
    FILE_NAME,
    ReportError,
    read_report,
    to_json,
    write_report,
)
from fvcollapse.diagnosis.report.schema import Report
from fvcollapse.diagnosis.report.schema_reduction import Closed
from fvcollapse.errors import InputError

KEYS = {
    "format",
    "format_version",
    "experiments",
    "held_out",
    "baseline_case",
    "where",
    "by_observable",
    "verdict",
    "candidates",
    "reduction",
    "next_experiment",
    "cost",
    "warnings",
}


@pytest.fixture(scope="module")
def report():
    return example()


@pytest.fixture(scope="module")
def tree(report):
    return json.loads(to_json(report), parse_constant=refuse)


def refuse(constant):
    raise AssertionError(f"{constant} is no JSON")


def with_details(report, **changes):
    return replace(report, details=replace(report.details, **changes))


def with_verdict(report, **changes):
    return replace(report, verdict=replace(report.verdict, **changes))


# -- the stable keys -----------------------------------------------------------------------------


def test_keys_are_those_of_the_interface(tree):
    assert set(tree) == KEYS | {"details"}
    assert tree["format"] == "fvcollapse-report"
    assert tree["experiments"] == list(FITTED)
    assert tree["held_out"] == list(HELD_OUT)
    region = tree["where"][0]
    stable = {"experiment", "observable", "t_range", "x_range", "gap", "units", "significance"}
    assert stable <= set(region)
    for gap in tree["by_observable"].values():
        assert {"rms_gap", "combined_uncertainty", "ratio"} <= set(gap)
    assert {"kind", "effects", "indistinguishable", "probability"} <= set(tree["verdict"])
    for candidate in tree["candidates"].values():
        assert {"probability", "log_evidence", "parameters", "plausible"} == set(candidate)
        for parameter in candidate["parameters"].values():
            assert {"value", "low", "high", "units", "prior"} == set(parameter)
    for group in ("fitted", "held_out"):
        parts = [tree["reduction"][group]["overall"]]
        parts += tree["reduction"][group]["by_observable"].values()
        for part in parts:
            assert {"before", "after", "fraction_closed", "interval"} <= set(part)
    assert {"solver_runs", "wall_time_s", "cell_size"} <= set(tree["cost"])
    assert math.fsum(tree["verdict"]["probability"].values()) == pytest.approx(1.0, abs=1e-6)
    assert {"none", "unknown"} <= set(tree["verdict"]["probability"])


@pytest.mark.parametrize("kind", ["effect", "several", "none", "unknown"])
def test_round_trip(kind, tmp_path):
    path = write_report(example(kind), tmp_path)
    assert path == tmp_path / FILE_NAME
    first = read_report(tmp_path)
    assert first == read_report(path)
    assert first.verdict.kind == kind
    write_report(first, tmp_path)
    assert read_report(path) == first


def test_round_trip_keeps_every_single_number(report, tmp_path):
    """Only columns are rounded: to six digits."""
    again = read_report(write_report(report, tmp_path))
    assert again.reduction == report.reduction
    assert again.candidates == report.candidates
    assert again.verdict == report.verdict
    for before, after in zip(report.details.comparisons, again.details.comparisons, strict=True):
        np.testing.assert_allclose(after.measured, before.measured, rtol=1e-5)
        np.testing.assert_allclose(after.z[BASELINE], before.z[BASELINE], rtol=1e-5)


# -- what JSON has not ---------------------------------------------------------------------------


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, np.float64("nan")])
def test_a_column_may_have_gaps(report, bad, tmp_path):
    one = report.details.comparisons[0]
    measured = np.array(one.measured)
    measured[3] = bad
    changed = with_details(report, comparisons=[replace(one, measured=measured)])
    text = to_json(changed)
    json.loads(text, parse_constant=refuse)
    again = read_report(write_report(changed, tmp_path)).details.comparisons[0]
    assert again.measured[3] is None
    assert None not in again.measured[:3]


@pytest.mark.parametrize("bad", [math.nan, math.inf, np.float64("nan")])
def test_a_single_number_must_be_finite(report, bad):
    cost = replace(report.cost, wall_time_s=bad)
    with pytest.raises(ReportError, match=r"cost\.wall_time_s: .* is no finite number"):
        to_json(replace(report, cost=cost))
    overall = Closed(1.0, bad, 0.1, None, "m")
    fitted = replace(report.reduction.fitted, overall=overall)
    with pytest.raises(ReportError, match=r"reduction\.fitted\.overall\.after"):
        to_json(replace(report, reduction=replace(report.reduction, fitted=fitted)))


def test_numbers_of_numpy_are_numbers(report):
    cost = replace(report.cost, solver_runs=np.int64(7), wall_time_s=np.float64(2.5))
    again = msgspec.json.decode(to_json(replace(report, cost=cost)), type=Report)
    assert (again.cost.solver_runs, again.cost.wall_time_s) == (7, 2.5)


def test_an_interval_needs_both_ends(report):
    overall = replace(report.reduction.fitted.overall, interval=(0.1, math.nan))
    fitted = replace(report.reduction.fitted, overall=overall)
    with pytest.raises(ReportError, match="interval"):
        to_json(replace(report, reduction=replace(report.reduction, fitted=fitted)))


# -- contradictions ------------------------------------------------------------------------------


def test_probabilities_sum_to_one(report):
    probability = report.verdict.probability | {"none": 0.5}
    with pytest.raises(ReportError, match=r"verdict\.probability: a sum of 1\.4"):
        to_json(with_verdict(report, probability=probability))


def test_none_and_unknown_have_a_probability(report):
    probability = dict(report.verdict.probability)
    probability[EFFECTS[0]] += probability.pop("unknown")
    with pytest.raises(ReportError, match="no 'unknown'"):
        to_json(with_verdict(report, probability=probability))


def test_probability_is_stated_once(report):
    first = EFFECTS[0]
    candidates = report.candidates | {first: replace(report.candidates[first], probability=0.4)}
    with pytest.raises(ReportError, match=f"candidates.{first}.probability"):
        to_json(replace(report, candidates=candidates))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"effects": []}, "for the verdict 'effect'"),
        ({"kind": "none"}, "for the verdict 'none'"),
        ({"effects": ["magnetism"]}, "'magnetism', which has no probability"),
        ({"set": ["magnetism"]}, "'magnetism', which has no probability"),
        ({"kind": "perhaps"}, "perhaps"),
    ],
)
def test_verdict_agrees_with_itself(report, changes, words):
    with pytest.raises(ReportError, match=words):
        to_json(with_verdict(report, **changes))


def test_a_pair_is_a_hypothesis(report, tmp_path):
    first, second = sorted(EFFECTS[:2])
    pair = f"{first}+{second}"
    probability = report.verdict.probability | {pair: report.verdict.probability["none"], "none": 0}
    changed = with_verdict(report, probability=probability, effects=[first, second], set=[pair])
    assert pair in read_report(write_report(changed, tmp_path)).verdict.probability


def test_columns_are_of_one_length(report):
    one = report.details.comparisons[0]
    short = replace(one, sigma=one.sigma[:-1])
    with pytest.raises(ReportError, match="columns of unequal length"):
        to_json(with_details(report, comparisons=[short]))


def test_models_are_those_of_the_ladder(report):
    one = report.details.comparisons[0]
    strange = replace(one, z=one.z | {"guess": one.z[BASELINE]})
    with pytest.raises(ReportError, match="the model 'guess'"):
        to_json(with_details(report, comparisons=[strange]))


def test_classes_hold_every_effect_once(report):
    classes = report.details.separability.classes[1:]
    broken = replace(report.details.separability, classes=classes)
    with pytest.raises(ReportError, match=r"separability\.classes"):
        to_json(with_details(report, separability=broken))


def test_held_out_values_need_a_held_out_experiment(report):
    alone = replace(report, held_out=[], details=replace(report.details, comparisons=[], ladder=[]))
    with pytest.raises(ReportError, match=r"reduction\.held_out"):
        to_json(alone)
    reduction = replace(report.reduction, held_out=None)
    confirmed = replace(report.details.confirmation, wording="confirmed")
    details = replace(alone.details, confirmation=confirmed)
    with pytest.raises(ReportError, match="'confirmed' although no experiment was held out"):
        to_json(replace(alone, reduction=reduction, details=details))


# -- bad files -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("{", "truncated"),
        ("[]", "Expected `object`"),
        ('{"format": "something"}', "format"),
        ('{"format": "fvcollapse-report", "format_version": 9}', "format_version"),
    ],
)
def test_what_is_no_report_is_refused_in_one_line(content, words, tmp_path):
    path = tmp_path / FILE_NAME
    path.write_text(content)
    with pytest.raises(InputError, match=words) as error:
        read_report(path)
    assert "\n" not in str(error.value)
    assert error.value.exit_status == 2


def test_a_report_that_was_edited_is_checked(tree, tmp_path):
    path = tmp_path / FILE_NAME
    tree = json.loads(json.dumps(tree))
    tree["verdict"]["probability"]["none"] += 0.2
    path.write_text(json.dumps(tree))
    with pytest.raises(InputError, match=r"verdict\.probability: found a sum of 1\.2"):
        read_report(path)


def test_a_missing_report(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_report(tmp_path / "nothing" / FILE_NAME)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"shares": []}, "0 beside 1 regions"),
        ({"experiment": HELD_OUT[0]}, "not fitted"),
        ({"beside": "magnetism"}, "'magnetism', which has no probability"),
    ],
)
def test_a_remainder_belongs_to_its_report(changes, words):
    whole = with_remainder(example("unknown"))
    assert json.loads(to_json(whole))["details"]["unexplained"]["direction"] == 1.0
    part = replace(whole.details.unexplained, **changes)
    with pytest.raises(ReportError, match=words):
        to_json(with_details(whole, unexplained=part))


def test_sizes_in_practice_are_of_what_was_compared():
    whole = with_remainder(example("unknown"))
    practical = {"porosity": whole.details.practical["front"]}
    with pytest.raises(ReportError, match="'porosity', which was not compared"):
        to_json(with_details(whole, practical=practical))
