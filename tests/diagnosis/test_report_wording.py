"""Numbers, regions and causes are worded as the page words them: rounded, in its units, and with what limits them."""

import pytest
from msgspec.structs import replace
from report_example import EFFECTS, FITTED

from fvcollapse.diagnosis.names import BASELINE, WINNER
from fvcollapse.diagnosis.report import sentences, words
from fvcollapse.diagnosis.report.bars import ranking_note
from fvcollapse.diagnosis.report.regions import region_words
from fvcollapse.diagnosis.report.schema_cause import Parameter, PriorRange
from fvcollapse.diagnosis.report.schema_gap import Region
from fvcollapse.diagnosis.report.tables import shown_parameter

# -- numbers -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("share", "text"),
    [
        (0.0, "0 %"),
        (0.001, "<1 %"),
        (0.126, "13 %"),
        (0.999, ">99 %"),
        (1.0, "100 %"),
        (-0.2, "−20 %"),
    ],
)
def test_percent(share, text):
    assert words.percent(share) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.48, "0.48"), (-3.0, "−3"), (412345.0, "412345"), (0.000212, "0.000212"), (None, "–")],
)
def test_number(value, text):
    assert words.number(value) == text


def test_span_writes_a_shared_unit_once():
    assert words.span((0.44, 0.59), words.percent) == "44 to 59 %"
    assert words.span(None) == ""


def test_lengths_of_a_parameter_are_in_centimetres():
    prior = PriorRange(kind="uniform", first=0.005, second=0.05)
    shown = shown_parameter(Parameter(0.0355, 0.0064, 0.0498, "m", prior))
    assert shown == ("3.55", "cm", "0.64 to 4.98", "0.5 to 5 cm")
    assert shown_parameter(Parameter(0.24, None, None, "-", None)) == ("0.24", "", "", "")


def test_region_in_words(report):
    """In the units of the page, whatever the line of the file says; "on" up to the last time that was measured."""
    name = FITTED[2]
    stored = "front position 80 mm too far; nothing significant before 0.60 s"
    region = Region(name, "front", (0.6, 1.4), None, 0.08, "m", 5.3, gap_sd=0.015, words=stored)
    told = "front position 8.0 ± 1.5 cm too far from 0.60 s on; nothing significant before 0.60 s"
    assert region_words(region, report) == told
    low = Region(name, "profiles", None, (0.1, 0.3), -0.004, "m", 3.0)
    assert region_words(low, report) == "thickness 0.4 cm too small, X = 10 to 30 cm"
    narrow = replace(low, x_range=(0.101, 0.104))
    assert region_words(narrow, report) == "thickness 0.4 cm too small, X = 10 cm"


# -- causes --------------------------------------------------------------------------------------


def test_every_effect_of_the_catalogue_has_a_meaning():
    for name in EFFECTS:
        assert words.effect_meaning(name)
        assert "_" not in words.hypothesis_name(name)


def test_after_is_the_best_model_that_was_run(report):
    assert words.after_model(report) == WINNER
    bare = [
        replace(one, simulated={BASELINE: one.simulated[BASELINE]}, z={BASELINE: one.z[BASELINE]})
        for one in report.details.comparisons
    ]
    assert (
        words.after_model(replace(report, details=replace(report.details, comparisons=bare)))
        == BASELINE
    )


def test_a_second_effect_that_is_left_open_is_told(report):
    """One effect named and a pair with it in the set: the one is not the whole story."""
    verdict = report.verdict
    (first, *_) = verdict.effects
    pair = "+".join(sorted((first, "cohesion")))
    alone = replace(verdict, set=[first])
    open_pair = replace(alone, set=[first, pair, "dilatancy+gate"])
    told = [sentences.additions(replace(report, verdict=v), (first,)) for v in (alone, open_pair)]
    assert told == [[], ["The data do not exclude cohesion beside it."]]


def test_what_the_grains_in_view_say_is_in_the_answer(report):
    told = "By their own balance, the profiles hold too much."
    details = replace(report.details, grains=[told])
    assert told in sentences.parts_of(replace(report, details=details)).where


def test_evidence_that_ranks_otherwise_is_explained(report):
    """The page ranks by probability; where the evidence would rank otherwise it says why."""
    first = next(iter(report.verdict.probability))
    assert ranking_note(report) == ""
    hypotheses = report.details.hypotheses
    ahead = hypotheses[first].log_evidence + 115.0
    other = hypotheses | {"cohesion": replace(hypotheses["cohesion"], log_evidence=ahead)}
    note = ranking_note(replace(report, details=replace(report.details, hypotheses=other)))
    assert note.startswith(
        "By its evidence alone cohesion would be first, by 115.0 in the logarithm."
    )


@pytest.mark.parametrize(("divisor", "words"), [(10.0, "divided by 10"), (2.0, "divided by 2")])
def test_the_note_says_by_how_much_evidences_were_tempered(report, divisor, words):
    hypotheses = {
        name: replace(one, conformal_p=None) for name, one in report.details.hypotheses.items()
    }
    first = next(iter(report.verdict.probability))
    ahead = hypotheses[first].log_evidence + 1.0
    hypotheses["cohesion"] = replace(hypotheses["cohesion"], log_evidence=ahead)
    details = replace(report.details, hypotheses=hypotheses, temperature=divisor)
    assert f"its logarithm is {words} here" in ranking_note(replace(report, details=details))
    untempered = ranking_note(replace(report, details=replace(details, temperature=1.0)))
    assert "evidence is" not in untempered
