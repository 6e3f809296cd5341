"""The headline says where the question stands: a cause named, leaned to or open, none needed, or none that explains."""

from bare_report import report_with
from msgspec.structs import replace
from report_example import EFFECTS

from fvcollapse.diagnosis.names import NONE, UNKNOWN, WINNER
from fvcollapse.diagnosis.report import sentences
from fvcollapse.diagnosis.report import standing as module
from fvcollapse.diagnosis.report.bars import ranking_note
from fvcollapse.diagnosis.report.certainty import agreement, certainty
from fvcollapse.diagnosis.report.schema import HypothesisSummary


def spread(**given):
    """Probabilities: those that are given, the rest shared by the other effects."""
    others = [name for name in (NONE, UNKNOWN, *EFFECTS) if name not in given]
    rest = (1.0 - sum(given.values())) / len(others)
    return given | dict.fromkeys(others, rest)


def test_a_cause_whose_hypotheses_share_it_is_not_called_unknown():
    """Unknown leads every single hypothesis, but lateral friction is in hypotheses with 57 % together."""
    walls = {f"{other}+lateral_friction": 0.19 for other in ("cohesion", "gate")}
    probability = spread(unknown=0.36, lateral_friction=0.19, **walls)
    report = report_with(probability, {WINNER: (["lateral_friction"], 1.0)}, where=True)
    assert sentences.headline(report) == (
        "The data lean towards lateral friction (57 %), but it is not confirmed"
    )
    assert "lateral friction closes most: 100 %" in sentences.parts_of(report).closed
    confirmed = report_with(probability, {WINNER: (["lateral_friction"], 1.0)}, True, "confirmed")
    assert sentences.headline(confirmed) == "Most likely cause: lateral friction (57 %), confirmed"


def test_a_cause_that_closes_nothing_is_said_to_close_nothing():
    probability = spread(front_saltation=0.45)
    report = report_with(probability, {WINNER: (["front_saltation"], -0.09)}, where=True)
    told = sentences.headline(report)
    assert told.startswith("The data lean towards front saltation (45 %)")
    assert told.endswith(", but with it none of the gap closes")


def test_two_effects_close_and_one_closes():
    for effects, verb in ((["dilatancy", "gate"], "close"), (["gate"], "closes")):
        report = report_with(spread(unknown=0.84), {WINNER: (effects, 1.0)}, where=True)
        assert f" {verb} 100 % of the gap" in sentences.headline(report)


def test_nothing_is_needed_only_where_nothing_is_left():
    probability = spread(none=0.22, unknown=0.216)
    left, gone = (report_with(probability, where=where) for where in (True, False))
    assert sentences.headline(left).startswith(
        "These data cannot tell between no missing effect (22 %), a cause outside the catalogue (22 %)"
    )
    assert sentences.headline(gone) == "No missing effect is needed: no significant gap is left"
    assert module.standing(report_with(probability, p_value=0.01)).state == module.OPEN


def test_half_of_the_probability_for_none_is_explained_where_the_model_agrees():
    probability = spread(none=0.5, cohesion=0.33)
    agreeing = report_with(probability, p_value=0.4)
    controlled = replace(agreeing, details=replace(agreeing.details, expected={"front": 0.01}))
    others = {"cohesion": HypothesisSummary(9.0), NONE: HypothesisSummary(2.0, predictive_p=0.4)}
    for report, told in ((agreeing, "two codes"), (controlled, "that the controls leave open")):
        assert f"Reason: {agreement(report)}." in certainty(report)
        assert told in agreement(report)
        details = replace(report.details, hypotheses=others)
        note = ranking_note(replace(report, details=details))
        assert note.startswith("By its evidence alone cohesion would be first, by 7.0")
        assert note.endswith(f"because {agreement(report)}.")
    for otherwise in (
        report_with(spread(none=0.85), p_value=0.4),  # the layer says so
        report_with(probability, p_value=0.4, where=True),
        report_with(probability, p_value=0.04),
    ):
        assert not module.agrees(otherwise)
        assert "Reason:" not in certainty(otherwise)


def test_a_five_way_draw_names_no_cause():
    five = dict(zip(EFFECTS[:5], (0.24, 0.2, 0.19, 0.18, 0.17), strict=True))
    told = sentences.headline(report_with(spread(**five), where=True, wording=None))
    assert told.startswith("These data cannot tell between ")
    assert told.endswith(" and others") or told.count("%") >= 4


def test_unknown_does_not_deny_what_a_rung_closes():
    probability = spread(unknown=0.7)
    for fraction, state in ((0.4, module.UNEXPLAINED), (0.7, module.LEANING)):
        report = report_with(probability, {WINNER: (["cohesion"], fraction)}, where=True)
        assert module.standing(report).state == state
    assert sentences.headline(report).endswith("but cohesion closes 70 % of the gap")


def test_two_effects_that_act_together_are_both_named():
    probability = spread(**{"dilatancy+gate": 0.6, "gate": 0.25})
    report = report_with(
        probability, {WINNER: (["dilatancy", "gate"], 0.9)}, True, "consistent with"
    )
    assert sentences.headline(report).startswith("Most likely cause: gate (8")
    assert " and dilatancy (6" in sentences.headline(report)


def test_outside_of_what_was_tried():
    """Of a few effects that were tried "unknown" says nothing about the rest of the catalogue."""
    every = report_with(spread(unknown=0.8), where=True)
    few = replace(every, candidates=dict(list(every.candidates.items())[:2]))
    assert "a cause outside the catalogue (80 %)" in sentences.headline(every)
    assert "a cause outside the effects that were tried (80 %)" in sentences.headline(few)


def test_none_that_is_given_up_is_no_cause_to_name():
    """A gap that chance leaves in fewer than one case of twenty: no other cause is probable, and none is wrong."""
    given = {"none": 0.3, "cohesion": 0.27, "unknown": 0.2}
    report = report_with(spread(**given), where=True)
    kept, given_up = (
        replace(report, verdict=replace(report.verdict, set=list(names)))
        for names in (given, ("cohesion", "unknown"))
    )
    assert sentences.headline(kept).startswith(
        "These data cannot tell between no missing effect (30 %)"
    )
    assert sentences.headline(given_up).startswith(
        "These data cannot tell between cohesion (27 %), a cause outside the catalogue (20 %)"
    )
    assert "No missing effect (30 %) is given up" in certainty(given_up)
    assert "given up" not in certainty(kept)
    probable = replace(given_up.verdict, probability=spread(none=0.6, cohesion=0.2))
    assert "no missing effect (60 %)" in sentences.headline(replace(given_up, verdict=probable))


def test_coarse_cells_are_in_the_answer():
    report = report_with(spread(lateral_friction=0.6), where=True)
    budget = {"front": {"grid": 0.02, "measurement, single points": 0.01}}
    details = replace(report.details, coarse_cells={"beads": 0.0117}, budget=budget)
    told = certainty(replace(report, details=details, cost=replace(report.cost, cell_size=0.02)))
    assert "cells of 2 cm are coarser" in told
    assert "at most 1.17 cm" in told
    assert "only rank the causes" in told
    assert "The grid is 80 % of the variance of the front position: refine it." in told
    assert "coarser" not in certainty(report)
