"""Words and figures of a report as a new user reads them: no riddle, no raw name, no number without its unit."""

import re

import numpy as np
import pytest
from msgspec.structs import replace
from report_example import FITTED, example
from report_page import blank, small, written

from fvcollapse.commands.diagnose import print_answer
from fvcollapse.diagnosis.oddities import Oddity
from fvcollapse.diagnosis.points import Block
from fvcollapse.diagnosis.report import reduction_figures, sentences
from fvcollapse.diagnosis.report.findings import measured_points
from fvcollapse.diagnosis.report.glossary import symbols
from fvcollapse.diagnosis.report.next_words import next_words
from fvcollapse.diagnosis.report.page import coded, together
from fvcollapse.diagnosis.report.schema import Practical
from fvcollapse.diagnosis.report.schema_cause import Parameter, PriorRange
from fvcollapse.diagnosis.report.standing import UNEXPLAINED, standing
from fvcollapse.diagnosis.report.tables import measured_words, shown_parameter
from fvcollapse.diagnosis.report.where_words import where_words
from fvcollapse.diagnosis.report.words import thinned_words

NARROW = "\N{NO-BREAK SPACE}"


def unevenly_open():
    """A report in which three causes are open and the data cannot tell the first from two others."""
    report = example("unknown", probable=0.3)
    rest = {name: 0.02 for name in report.verdict.probability}
    first = dict(zip(("cohesion", "gate", "unknown"), (0.3, 0.25, 0.2), strict=True))
    probability = rest | first
    total = sum(probability.values())
    probability = {name: value / total for name, value in probability.items()}
    verdict = replace(
        report.verdict,
        probability=probability,
        indistinguishable=[["cohesion", "viscosity", "nonlocal"]],
        set=list(first),
    )
    return replace(report, verdict=verdict)


def test_open_causes_are_listed_once():
    report = unevenly_open()
    head, cause = sentences.headline(report), sentences.parts_of(report).cause
    assert head.startswith("These data cannot tell between cohesion")
    assert "cohesion" not in cause
    assert cause.endswith("Nor do they exclude viscosity or nonlocal.")


def test_where_begins_without_coordinates():
    first, second, *_ = where_words(example())
    assert re.match(r"without any effect added, the simulated front position is too far", first)
    assert not re.search(r"X = |\d s\b", first)
    assert re.search(r"from \d", second)


def test_what_is_left_is_judged_beside_an_honest_error():
    report = example()
    parts = {
        "front": Practical(0.03, 0.03, 0.5, 0.02, "m", 0.0055, None, True),
        "profiles": Practical(0.01, 0.001, 0.5, 0.02, "m", 0.0023, None, False),
    }
    text = where_words(replace(report, details=replace(report.details, practical=parts)))[-1]
    error = "above the model error that the controls leave open"
    assert (
        f"front position 3 cm, {error} (0.55 cm); thickness 0.1 cm, not {error} (0.23 cm)." in text
    )


def test_an_odd_number_is_named_in_the_answer_and_stands_above_it(tmp_path):
    odd = Oddity(
        "s16", "experiment.toml", "slope_angle_deg", "0.2793 deg", "0 or > 1", "in radians?"
    )
    report = replace(small(experiments=(FITTED[0],), observables=()), warnings=[odd])
    first = sentences.answer(report)[0]
    assert first.startswith("Check first: s16, slope_angle_deg: 0.2793 deg, in radians?.")
    page = written(report, tmp_path, blank)
    assert first in page.text
    assert page.ids.index("warnings") < page.ids.index("answer")


def test_the_terminal_prints_words(capsys):
    print_answer(example())
    table = capsys.readouterr().out.rpartition("\n\n")[2]
    assert "no missing effect" in table
    assert not re.search(r"^(none|unknown)\b|_", table, re.MULTILINE)


def test_a_thinned_curve_says_so():
    one = small().details.comparisons[0]
    count = len(one.measured)
    assert thinned_words(one) == thinned_words(replace(one, of=count)) == ""
    thinned = replace(one, of=count + 1)
    assert thinned_words(thinned) == f"{count} of {count + 1} measured points are compared"
    assert measured_words(thinned) == f"front position ({count} of {count + 1})"


def test_points_are_counted_in_the_file_of_the_curve():
    class Stub:
        name = "s16"
        curves = {"front": type("Curve", (), {"value": np.zeros(10)})}

    points = type("Points", (), {"experiments": (Stub,)})
    nothing = np.full(9, np.nan)
    blocks = [Block("s16", name, "m", nothing, nothing, "value", 0, 9) for name in ("front", "x")]
    assert [measured_points(points, block) for block in blocks] == [10, 9]


def test_no_line_break_parts_a_number_from_its_unit():
    page = "<style>a { b: 1 s }</style><p>1.3 bit, 24 %, 0.5 ± 0.1 cm in 3 steps</p><pre>2 cm</pre>"
    assert together(page) == (
        f"<style>a {{ b: 1 s }}</style><p>1.3{NARROW}bit, 24{NARROW}%, 0.5{NARROW}±{NARROW}0.1{NARROW}cm in 3 steps</p>"
        "<pre>2 cm</pre>"
    )


def test_backticks_are_code_and_nothing_else_is_markup():
    assert coded("the `keys` <b>") == "the <code>keys</code> &lt;b&gt;"


@pytest.mark.parametrize("kind", ["normal", "uniform", "loguniform", "halfnormal"])
def test_what_was_known_of_a_parameter_has_its_unit(kind):
    prior = PriorRange(kind=kind, first=0.0, second=0.02)
    assert "2 cm" in shown_parameter(Parameter(0.01, None, None, "m", prior)).prior


def test_symbols_have_the_units_of_the_page():
    units = {unit for _, unit, _ in symbols(example())}
    assert "m" not in units
    assert "cm" in units


def test_no_marker_of_the_ladder_is_cut(monkeypatch):
    kept = []
    monkeypatch.setattr(reduction_figures, "picture", lambda figure, *rest: kept.append(figure))
    report = example()
    alone = [replace(rung, held_out=None) for rung in report.details.ladder]
    for rungs in (report.details.ladder, alone):
        reduction_figures.ladder(replace(report, details=replace(report.details, ladder=rungs)))
        panel = kept[-1].axes[0]
        places = [place for line in panel.lines for place in line.get_xdata()]
        assert max(places) <= 0.95 * panel.get_xlim()[1]
    rows = {float(row) for line in panel.lines for row in line.get_ydata()}
    assert rows == set(range(len(alone)))


def test_where_nothing_in_the_catalogue_explains_the_gap_no_experiment_is_proposed(monkeypatch):
    report = replace(example(), next_experiment=None)
    assert next_words(report) == []
    stand = standing(report)._replace(state=UNEXPLAINED)
    monkeypatch.setattr("fvcollapse.diagnosis.report.next_words.standing", lambda report: stand)
    assert next_words(report)[0].startswith("no experiment is proposed")
