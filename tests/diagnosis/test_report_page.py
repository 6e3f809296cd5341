"""report.html: it stands alone, says what the report says, and no input can break out of its text."""

import re
import xml.etree.ElementTree as ElementTree
from concurrent.futures import BrokenExecutor, Future
from urllib.parse import unquote

import numpy as np
import pytest
from msgspec.structs import replace
from page_in_browser import BROWSER, WIDTHS, measured
from report_example import EFFECTS, FITTED, with_remainder
from report_page import Page, blank, small, written

from fvcollapse.diagnosis.gap_map import Region as MapRegion
from fvcollapse.diagnosis.names import BASELINE, WINNER
from fvcollapse.diagnosis.oddities import Oddity
from fvcollapse.diagnosis.points import Block
from fvcollapse.diagnosis.report import figures, sentences, words
from fvcollapse.diagnosis.report import page as page_module
from fvcollapse.diagnosis.report.bars import bars, ranking_note
from fvcollapse.diagnosis.report.drawing import column
from fvcollapse.diagnosis.report.figures import drawable, pictures
from fvcollapse.diagnosis.report.gap_figures import cell
from fvcollapse.diagnosis.report.page import write_page
from fvcollapse.diagnosis.report.painter import Painter
from fvcollapse.diagnosis.report.regions import region_line, region_words
from fvcollapse.diagnosis.report.report_file import read_report, to_json
from fvcollapse.diagnosis.report.schema_cause import Parameter, PriorRange
from fvcollapse.diagnosis.report.schema_gap import ObservableGap, Region
from fvcollapse.diagnosis.report.schema_origin import Assumption
from fvcollapse.diagnosis.report.schema_reduction import Closed
from fvcollapse.diagnosis.report.tables import shown_parameter
from fvcollapse.errors import OutputError
from fvcollapse.measure.quantities import QUANTITIES
from fvcollapse.studies.standing import StandingWorkers

needs_browser = pytest.mark.skipif(
    BROWSER is None, reason="no Chromium: the layout of the report is not tested"
)
LONGEST = {1280: 9000, 768: 11000, 390: 13500}  # pixels, as it opens
SMALLEST = 8.0  # pixels: letters in a figure on a telephone
CHAPTERS = ("which", "far", "where", "next", "overlays", "compared", "alike", "limits", "cost")


def slim(report):
    """Without the figures that depend on neither curves nor verdict, which are drawn for `page`."""
    return replace(report, details=replace(report.details, separability=None, budget={}))


@pytest.fixture(scope="module")
def report():
    return small()


@pytest.fixture(scope="module")
def folder(report, tmp_path_factory):
    """The folder of a report with its page."""
    return tmp_path_factory.mktemp("report")


@pytest.fixture(scope="module")
def chapters(report, folder):
    """The figures of all chapters, drawn from the file by this process, as they went to the page."""
    kept = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            page_module, "pictures", lambda *found: kept.append(pictures(*found)) or kept[0]
        )
        written(report, folder)
    return kept[0]


@pytest.fixture(scope="module")
def page(folder, chapters):
    return Page((folder / "report.html").read_text(encoding="utf-8"))


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


# -- figures -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def drawn(chapters):
    """The same by name."""
    return {one.name: one for chapter in chapters.values() for one in chapter}


def svg_text(picture):
    """The words in a figure."""
    return " ".join(" ".join(ElementTree.fromstring(picture.svg).itertext()).split())


def test_axes_say_what_and_in_which_unit(drawn):
    front = svg_text(drawn[f"front_{FITTED[2]}"])
    assert "front position (cm)" in front
    assert "time (s)" in front
    assert "measured (cm)" in front
    profiles = svg_text(drawn[f"profiles_{FITTED[2]}"])
    assert "thickness (cm)" in profiles
    assert "x from the back wall (cm)" in profiles
    assert "t = 0.48 s" in profiles
    assert "combined sd" in svg_text(drawn[f"gap_profiles_{FITTED[2]}"])
    assert "probability (%)" in svg_text(drawn["evidence"])
    assert "standard uncertainties" in svg_text(drawn["ladder"])


def test_evidence_names_every_hypothesis(drawn, report):
    text = svg_text(drawn["evidence"])
    for name in report.verdict.probability:
        assert words.hypothesis_name(name) in text
    assert words.percent(report.verdict.probability[EFFECTS[0]]) in text


def test_a_page_shows_a_gap_in_one_unit(tmp_path):
    """In the regions, in the table by observable and in that of the reduction."""
    report = small(experiments=(FITTED[0],), observables=())
    gaps = {name: 0.031 + 0.001 * n for n, name in enumerate(QUANTITIES)}
    regions, sizes, closed = [], {}, {}
    for name, gap in gaps.items():
        unit = QUANTITIES[name].unit
        regions.append(Region(FITTED[0], name, (0.2, 0.4), None, gap, unit, 5.0))
        sizes[name] = ObservableGap(gap, gap, 1.0, unit, 9)
        closed[name] = Closed(gap, gap, 0.0, None, unit)
    fitted = replace(report.reduction.fitted, by_observable=closed)
    reduction = replace(report.reduction, fitted=fitted, held_out=None)
    report = replace(report, where=regions, by_observable=sizes, reduction=reduction)
    page = written(report, tmp_path, blank)
    for name, gap in gaps.items():
        factor, unit = QUANTITIES[name].gap_shown
        number = re.escape(words.number(factor * gap, 2))
        units = re.findall(
            rf"(?<![\d.]){number} (% of the column|%|[cm]?m|s|m/s)(?![\w/])", page.text
        )
        assert len(units) >= 5  # in the list of regions, and twice in both tables
        assert set(units) == {unit}


def test_the_words_of_the_map_are_in_the_unit_of_the_tables():
    time = np.array([0.2, 0.3, 0.9])
    for name, quantity in QUANTITIES.items():
        block = Block("r", name, quantity.unit, time, time * np.nan, "value", 0, 3)
        gap = MapRegion("r", name, quantity.unit, (0.2, 0.3), None, 0.5, 0.1, 5.0, 0.01, time)
        size = f"{0.5 * quantity.gap_shown.factor:.{2 if quantity.gap_shown.factor == 1.0 else 0}f}"
        text = region_line(gap, block)
        assert text.startswith(f"{quantity.words} {size} ")
        assert f" {quantity.gap_shown.unit} {quantity.too_large} from" in text


def test_figures_are_the_same_each_time(drawn, folder):
    report = read_report(folder)
    one = [one for one in report.details.comparisons if one.experiment == FITTED[2]]
    details = replace(report.details, comparisons=one)
    again = figures.drawn(replace(report, details=details), slice(2))
    assert [picture.name.partition("_")[0] for picture in again] == ["front", "profiles"]
    assert all(picture == drawn[picture.name] for picture in again)


def test_cells_of_a_map_tile_each_row():
    time = np.array([0.1, 0.1, 0.1, 0.3, 0.3])
    x = np.array([0.0, 0.2, 0.3, 0.1, 0.5])
    cells = [cell(x, time, np.unique(time), n) for n in range(5)]
    rows = [
        [(one[0][0], one[1][0]) for one in cells[:3]],
        [(one[0][0], one[1][0]) for one in cells[3:]],
    ]
    np.testing.assert_allclose(rows[0], [(-0.1, 0.1), (0.1, 0.25), (0.25, 0.35)])
    np.testing.assert_allclose(rows[1], [(-0.1, 0.3), (0.3, 0.7)])
    assert [one[0][1] for one in cells] == [-0.5, -0.5, -0.5, 0.5, 0.5]


def test_gaps_in_a_column_stay_gaps(report):
    one = drawable(report)[0]
    measured = [None, *list(one.measured)[1:]]
    assert np.isnan(column(measured)[0])
    holed = replace(one, measured=measured, z={BASELINE: [None, *list(one.z[BASELINE])[1:]]})
    details = replace(report.details, comparisons=[holed])
    (overlay,) = figures.drawn(replace(report, details=details), slice(1))
    assert overlay.svg


# -- words ---------------------------------------------------------------------------------------


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


def test_lengths_of_a_parameter_are_in_centimetres():
    prior = PriorRange(kind="uniform", first=0.005, second=0.05)
    shown = shown_parameter(Parameter(0.0355, 0.0064, 0.0498, "m", prior))
    assert shown == ("3.55", "cm", "0.64 to 4.98", "0.5 to 5 cm")
    assert shown_parameter(Parameter(0.24, None, None, "-", None)) == ("0.24", "", "", "")


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


@pytest.fixture(scope="module")
def few():
    """A report of few figures, and these."""
    report = slim(small(experiments=(FITTED[0],), observables=("front",)))
    return report, pictures(report)


@pytest.mark.parametrize("workers", [pytest.param(1, marks=pytest.mark.slow), 2])
def test_figures_drawn_by_two_processes_are_the_same(few, workers):
    report, chapters = few
    assert sum(map(len, chapters.values())) > 3
    with StandingWorkers(workers) as standing:
        assert pictures(report, Painter(standing).draw) == chapters


def test_figures_of_a_process_that_dies_are_drawn_here(few):
    report, chapters = few

    class Dead:
        def submit(self, task, *arguments):
            future = Future()
            future.set_exception(BrokenExecutor("the process ended with status -9"))
            return future

    assert pictures(report, Painter(Dead()).draw) == chapters


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


# -- in a browser --------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def laid_out(page, folder, tmp_path_factory):
    """{width: what the browser measured}."""
    return measured(folder / "report.html", tmp_path_factory.mktemp("browser"))


@needs_browser
@pytest.mark.parametrize("width", WIDTHS)
def test_nothing_is_wider_than_the_window(laid_out, width):
    assert laid_out[width]["scroll"] <= laid_out[width]["width"] <= width


@needs_browser
@pytest.mark.parametrize("width", WIDTHS)
def test_the_page_is_short_as_it_opens(laid_out, width):
    """All but the first experiment are folded."""
    assert laid_out[width]["height"] <= LONGEST[width]
    opened = laid_out[width]["open"]
    assert opened == [True, False] * (len(opened) // 2)


@needs_browser
@pytest.mark.parametrize("width", WIDTHS)
def test_the_answer_is_on_the_first_screen_and_effects_follow(laid_out, width):
    ids = laid_out[width]["ids"]
    assert ids["answer"]["top"] < 300
    order = ["answer", "which", "far", "where", "next", "overlays", "compared", "limits", "words"]
    tops = [ids[name]["top"] for name in order]
    assert tops == sorted(tops)


@needs_browser
def test_bars_stand_beside_the_answer_where_there_is_room(laid_out):
    wide, narrow = (laid_out[width]["ids"] for width in (1280, 390))
    assert wide["bars"]["left"] >= wide["answer"]["right"]
    assert abs(wide["bars"]["top"] - wide["answer"]["top"]) < 5
    assert narrow["bars"]["top"] >= narrow["answer"]["bottom"]


@needs_browser
def test_letters_of_figures_can_be_read_on_a_telephone(laid_out):
    letters = laid_out[390]["letters"]
    assert len(letters) > 50
    assert min(letters) >= SMALLEST
