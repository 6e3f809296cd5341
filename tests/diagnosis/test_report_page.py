"""report.html: it stands alone, says what the report says, and no input can break out of its text."""

import re
from urllib.parse import unquote

import pytest
from msgspec.structs import replace
from report_example import EFFECTS, FITTED, with_remainder
from report_page import Page, blank, slim, small, written

from fvcollapse.diagnosis.oddities import Oddity
from fvcollapse.diagnosis.report import sentences, words
from fvcollapse.diagnosis.report.bars import bars
from fvcollapse.diagnosis.report.page import write_page
from fvcollapse.diagnosis.report.report_file import read_report, to_json
from fvcollapse.diagnosis.report.schema_origin import Assumption
from fvcollapse.errors import OutputError

CHAPTERS = ("which", "far", "where", "next", "overlays", "compared", "alike", "limits", "cost")


# -- the page as a whole -------------------------------------------------------------------------


def test_page_stands_alone(page, folder):
    """It fetches nothing: what it shows is inside it; links lead into it or to files beside it."""
    assert page.addresses
    inside = [address for address in page.addresses if address.startswith(("#", "data:image/png;"))]
    for address in set(page.addresses) - set(inside):
        assert (folder / unquote(address)).is_file()
    assert not {"script", "link", "iframe", "object", "img"} & set(page.tags)
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert "@import" not in text
    assert all(address.startswith("#") for address in re.findall(r"url\((.)", text))
    assert len(text) < 1_000_000


def test_every_figure_and_the_numbers_are_linked(page, drawn):
    links = {unquote(address) for address in page.addresses}
    assert {f"figures/{name}.svg" for name in drawn} <= links
    assert "report.json" in links


def test_page_is_well_formed(page):
    assert page.open == []
    chapters = [name for name in page.ids if name in CHAPTERS]
    assert chapters == list(CHAPTERS)
    targets = {address[1:] for address in page.addresses if address.startswith("#")}
    assert targets <= set(page.ids)
    assert len(page.ids) == len(set(page.ids))


def test_answer_comes_first(page, report):
    """Cause, how sure, how much closes; then where, then what next; all of it before the first chapter."""
    places = [page.text.index(line) for line in sentences.answer(report)]
    assert places == sorted(places)
    assert places[-1] < page.text.index("Which effect causes it")
    cause = sentences.parts_of(report).cause
    assert words.hypothesis_name(EFFECTS[0]) in cause
    assert not re.search(r"\d+ (s|cm)\b", cause)


def test_bars_beside_the_answer_hold_its_numbers(page, report):
    """The first five causes, the most probable first; those of the headline bold and with its numbers."""
    shown = bars(report)
    assert len(shown) == 5
    assert [bar.share for bar in shown] == sorted((bar.share for bar in shown), reverse=True)
    assert page.ids.index("bars") == page.ids.index("answer") + 1
    for bar in shown:
        assert f"{bar.name} {bar.chance}" in page.text
        if bar.is_stated:
            assert f"{bar.name} ({bar.chance})" in sentences.headline(report)


def test_numbers_of_the_report_are_on_the_page(page, report):
    fitted = words.percent(report.reduction.fitted.overall.fraction_closed)
    held_out = words.percent(report.reduction.held_out.overall.fraction_closed)
    assert f" {fitted} (" in sentences.parts_of(report).closed
    assert f" and {held_out} (" in sentences.parts_of(report).closed
    for name in report.verdict.probability:
        assert words.hypothesis_name(name) in page.text
    for text in report.details.limits:
        assert text in page.text
    for name in (*report.experiments, *report.held_out):
        assert name in page.text
    assert report.next_experiment.description in page.text
    assert "mu_1 = 0.48" in page.text


def test_every_figure_is_on_the_page_and_in_the_folder(page, folder, drawn):
    files = sorted(path.stem for path in (folder / "figures").glob("*.svg"))
    expected = sorted(drawn)
    assert files == expected
    assert page.tags.count("figure") == len(expected)
    assert page.tags.count("figcaption") == len(expected)


@pytest.mark.parametrize("kind", ["several", "none", "unknown"])
def test_other_verdicts(kind, tmp_path):
    report = slim(small(kind, experiments=(FITTED[0],), observables=("front",)))
    page = written(report, tmp_path)
    assert sentences.headline(report) in page.text
    assert all(line in page.text for line in sentences.answer(report))
    assert ("By observable, before (model as given) and after" in page.text) == (
        report.reduction is not None
    )


def test_single_numbers_alone_make_a_page(tmp_path):
    """As the paper's experiments: bounds, no curve, nothing held out, no evidence detail."""
    report = small(experiments=FITTED, observables=())
    bounds = [replace(one, kind="upper") for one in report.details.comparisons]
    bare = type(report.details)(comparisons=bounds)
    reduction = replace(report.reduction, held_out=None)
    report = replace(report, held_out=[], details=bare, reduction=reduction, where=[])
    report = replace(report, by_observable={})
    page = written(replace(report, next_experiment=None), tmp_path)
    assert "\N{LESS-THAN OR EQUAL TO}" in page.text
    assert "none held out" in page.text
    assert "the answer rests on all points taken together" in page.text


def test_no_input_breaks_out_of_its_text(tmp_path):
    evil = '<script>alert("$x_1$")</script>&amp;"\'>'
    report = slim(small(experiments=(FITTED[0],), observables=("front",)))
    name = report.experiments[0]
    set_ups = report.details.set_ups
    set_ups = set_ups | {name: replace(set_ups[name], title=evil, source=evil)}
    details = replace(report.details, set_ups=set_ups, limits=[evil])
    page = written(replace(report, details=details, baseline_case=evil), tmp_path)
    assert "script" not in page.tags
    assert page.text.count(evil) >= 3


def test_an_experiment_may_have_any_name(tmp_path):
    """A folder's name becomes the name of a file and a label of a figure."""
    report = slim(small(experiments=(FITTED[0],), observables=("front", "profiles")))
    odd = "run $1 <b>/ä"
    text = to_json(report).replace(FITTED[0], odd)
    path = tmp_path / "report.json"
    path.write_text(text, encoding="utf-8")
    page = Page(write_page(read_report(path), tmp_path).read_text(encoding="utf-8"))
    assert odd in page.text
    assert page.open == []
    assert (tmp_path / "figures" / "front_run%20%241%20%3Cb%3E%2F%C3%A4.svg").is_file()


def test_folder_that_cannot_be_written(report, tmp_path):
    (tmp_path / "figures").write_text("in the way")
    with pytest.raises(OutputError):
        write_page(report, tmp_path)


# -- what only some reports have -----------------------------------------------------------------


def test_what_was_assumed_is_on_the_page(tmp_path):
    report = small(experiments=(FITTED[0],), observables=())
    assumed = [
        Assumption(name, "rheology.mu_1", "0.48", "-", "friction at rest", "default of the program")
        for name in FITTED
    ]
    report = replace(report, details=replace(report.details, assumed=assumed))
    page = written(report, tmp_path, blank)
    told = page.text[page.text.index("What was assumed") :]
    assert f"rheology.mu_1 0.48 default of the program friction at rest {', '.join(FITTED)}" in told


def test_oddities_stand_above_what_was_compared(page, tmp_path):
    odd = Oddity("beads", "front.csv", "x_front_m", "0.185", "length_0 = 0.2 m", "X <level>?")
    report = small(experiments=(FITTED[0],), observables=())
    told = written(replace(report, warnings=[odd]), tmp_path, blank)
    assert told.ids.index("warnings") < told.ids.index("answer") < told.ids.index("which")
    assert "Check first: beads, x_front_m: 0.185, X <level>?." in told.text
    words = "beads, front.csv, x_front_m : found 0.185; expected: length_0 = 0.2 m; X <level>?"
    assert words in told.text
    assert odd.line() == words.replace(
        "beads, front.csv, x_front_m :", "beads/front.csv: x_front_m:"
    )
    assert "warnings" not in page.ids


def test_what_is_left_unexplained_is_on_the_page_and_in_the_answer(report, page, tmp_path):
    left = with_remainder(small("unknown", experiments=(FITTED[0],), observables=()))
    told = written(left, tmp_path, blank)
    place = (
        "tip of the flow only, in the thin part, from 0.62 s on: something that holds thin layers"
    )
    line = next(text for text in sentences.answer(left) if text.startswith("Unexplained: "))
    assert line.startswith(
        f"Unexplained: {place} as it comes to rest and after it has come to rest."
    )
    assert "thickness 0.43 cm (3.2 sd)" in line
    first, second = (words.hypothesis_name(name) for name in EFFECTS[:2])
    against = "2.1 times as strong as is plausible, front position would fit worse"
    alike = f"{first} (0.83, {against}) and {second} acting the other way (0.4)"
    assert f"Its form is like that of (1 is the same form) {alike}." in line
    assert place in told.text[: told.text.index("Which effect causes it")]
    chapter = told.text[told.text.index("What is left unexplained") :]
    assert "thin part deposit 60 % move too easily" in chapter
    assert "middle" not in chapter[: chapter.index("Shares of the sum")]  # 3 %
    assert "unexplained" not in page.ids
    assert not any(text.startswith("Unexplained") for text in sentences.answer(report))


def test_the_size_in_practice_stands_beside_the_statistics(tmp_path):
    left = with_remainder(small("unknown", experiments=(FITTED[0],), observables=()))
    told = written(left, tmp_path, blank).text
    row = told[told.index("How large it is in practice") :]
    assert "thickness 0.34 cm 62 % 0.26 cm \N{EN DASH} 0.2 cm yes" in row
    assert "front position 0 cm 0 % 1.8 cm \N{EN DASH} 5 cm no" in row
    where = " ".join(sentences.parts_of(left).where)
    assert (
        "Beyond noise and calibration (rms): thickness 0.34 cm, above the difference of two codes "
        "for the same equations (0.2 cm)."
    ) in where
