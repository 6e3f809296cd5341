"""report.html: it stands alone, says what the report says, and no input can break out of its text."""

import re
import xml.etree.ElementTree as ElementTree
from concurrent.futures import BrokenExecutor, Future
from html.parser import HTMLParser

import numpy as np
import pytest
from msgspec.structs import replace
from report_example import EFFECTS, FITTED, HELD_OUT, example

from fvcollapse.diagnosis.gap_map import Region as MapRegion
from fvcollapse.diagnosis.names import BASELINE, WINNER
from fvcollapse.diagnosis.oddities import Oddity
from fvcollapse.diagnosis.points import Block
from fvcollapse.diagnosis.report import sentences, words
from fvcollapse.diagnosis.report.drawing import column
from fvcollapse.diagnosis.report.figures import drawable, pictures
from fvcollapse.diagnosis.report.gap_figures import cell
from fvcollapse.diagnosis.report.page import write_page
from fvcollapse.diagnosis.report.painter import Painter
from fvcollapse.diagnosis.report.regions import region_line, region_words
from fvcollapse.diagnosis.report.report_file import read_report, to_json, write_report
from fvcollapse.diagnosis.report.schema_gap import ObservableGap, Region
from fvcollapse.diagnosis.report.schema_reduction import Closed
from fvcollapse.errors import OutputError
from fvcollapse.measure.quantities import QUANTITIES
from fvcollapse.studies.standing import StandingWorkers

CHAPTERS = ("compared", "overlays", "where", "which", "alike", "far", "next", "limits", "cost")
VOID = {"meta", "br", "img", "link", "input", "hr"}


class Page(HTMLParser):
    """Tags that open and close in order, identifiers, addresses and the text."""

    def __init__(self, text):
        super().__init__()
        self.open, self.ids, self.addresses, self.text, self.tags = [], [], [], [], []
        self.feed(text)
        self.close()
        self.text = " ".join(" ".join(self.text).split())

    def handle_starttag(self, tag, attrs):
        self.handle_startendtag(tag, attrs)
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append(tag)
        for name, value in attrs:
            if name == "id":
                self.ids.append(value)
            elif name in ("src", "href", "xlink:href", "srcset", "data"):
                self.addresses.append(value)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if "style" not in self.open:
            self.text.append(data)


def small(kind="effect", experiments=(FITTED[2], HELD_OUT[0]), observables=("front", "profiles")):
    """The example with the comparisons of few experiments: quick to draw."""
    report = example(kind)
    kept = [
        one
        for one in report.details.comparisons
        if one.experiment in experiments and one.observable in (*observables, "runout")
    ]
    return replace(report, details=replace(report.details, comparisons=kept))


def written(report, folder):
    """The page of a report that went through its file."""
    write_report(report, folder)
    return Page(write_page(read_report(folder), folder).read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def report():
    return small()


@pytest.fixture(scope="module")
def folder(report, tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    written(report, folder)
    return folder


@pytest.fixture(scope="module")
def page(folder):
    return Page((folder / "report.html").read_text(encoding="utf-8"))


# -- the page as a whole -------------------------------------------------------------------------


def test_page_stands_alone(page, folder):
    """It fetches nothing: every address points into the page itself, a picture being inside it."""
    assert page.addresses
    assert all(address.startswith(("#", "data:image/png;base64,")) for address in page.addresses)
    assert not {"script", "link", "iframe", "object"} & set(page.tags)
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert "@import" not in text
    assert all(address.startswith("#") for address in re.findall(r"url\((.)", text))
    assert len(text) < 1_000_000


def test_page_is_well_formed(page):
    assert page.open == []
    chapters = [name for name in page.ids if name in CHAPTERS]
    assert chapters == list(CHAPTERS)
    targets = {address[1:] for address in page.addresses if address.startswith("#")}
    assert targets <= set(page.ids)
    assert len(page.ids) == len(set(page.ids))


def test_answer_comes_first(page, report):
    answer = " ".join(sentences.answer(report))
    assert answer in page.text
    assert page.text.index(answer) < page.text.index("What was compared")
    assert words.hypothesis_name(EFFECTS[0]) in answer


def test_numbers_of_the_report_are_on_the_page(page, report):
    fitted = words.percent(report.reduction.fitted.overall.fraction_closed)
    held_out = words.percent(report.reduction.held_out.overall.fraction_closed)
    assert f"Gap closed, fitted experiments {fitted}" in page.text
    assert f"Gap closed, held-out experiments {held_out}" in page.text
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
    report = small(kind, experiments=(FITTED[0],), observables=("front",))
    page = written(report, tmp_path)
    assert sentences.headline(report) in page.text
    assert " ".join(sentences.answer(report)) in page.text
    assert ("Gap closed, fitted experiments" in page.text) == (report.reduction is not None)


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
    assert "all points taken together do" in page.text


def test_no_input_breaks_out_of_its_text(tmp_path):
    evil = '<script>alert("$x_1$")</script>&amp;"\'>'
    report = small(experiments=(FITTED[0],), observables=("front",))
    name = report.experiments[0]
    set_ups = report.details.set_ups
    set_ups = set_ups | {name: replace(set_ups[name], title=evil, source=evil)}
    details = replace(report.details, set_ups=set_ups, limits=[evil])
    page = written(replace(report, details=details, baseline_case=evil), tmp_path)
    assert "script" not in page.tags
    assert page.text.count(evil) >= 3


def test_an_experiment_may_have_any_name(tmp_path):
    """A folder's name becomes the name of a file and a label of a figure."""
    report = small(experiments=(FITTED[0],), observables=("front", "profiles"))
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
def drawn(folder):
    """Drawn from the file, as the page is."""
    chapters = pictures(read_report(folder))
    return {one.name: one for chapter in chapters.values() for one in chapter}


def svg_text(picture):
    """The words in a figure."""
    return " ".join(ElementTree.fromstring(picture.svg).itertext())


def test_axes_say_what_and_in_which_unit(drawn):
    front = svg_text(drawn[f"front_{FITTED[2]}"])
    assert "front position (m)" in front
    assert "time (s)" in front
    assert "measured (cm)" in front
    profiles = svg_text(drawn[f"profiles_{FITTED[2]}"])
    assert "thickness (cm)" in profiles
    assert "x from the back wall (m)" in profiles
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
    page = written(
        replace(report, where=regions, by_observable=sizes, reduction=reduction), tmp_path
    )
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
    for picture in pictures(replace(report, details=details))["overlays"]:
        assert picture == drawn[picture.name]


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
    assert pictures(replace(report, details=details))["overlays"][0].svg


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


def test_region_in_words():
    region = Region("a", "front", (0.6, 1.4), None, 0.08, "m", 5.3, gap_sd=0.015)
    assert region_words(region) == (
        "simulated front position 8 ± 1.5 cm too far from 0.60 to 1.40 s"
    )
    low = Region("a", "profiles", None, (0.1, 0.3), -0.004, "m", 3.0)
    assert region_words(low) == "simulated thickness 4 mm too small, at x = 0.10 to 0.30 m"


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
    (first, *_), other = verdict.effects, "cohesion"
    pair = "+".join(sorted((first, other)))
    alone = replace(verdict, kind="effect", effects=[first], set=[first])
    open_pair = replace(alone, set=[first, pair, "dilatancy+gate"])
    told = [sentences.addition_sentences(replace(report, verdict=v)) for v in (alone, open_pair)]
    assert told == [
        [],
        [
            f"The data do not exclude that cohesion acts in addition to {words.hypothesis_name(first)}."
        ],
    ]


def test_what_the_grains_in_view_say_is_in_the_answer(report):
    told = ["By their own balance, the profiles hold too much."]
    details = replace(report.details, grains=told)
    assert told[0] in sentences.answer(replace(report, details=details))


def test_outside_of_what_was_tried(report):
    """Of a few effects that were tried "unknown" says nothing about the rest of the catalogue."""
    every = unknown_of(report)
    few = replace(every, candidates=dict(list(report.candidates.items())[:2]))
    assert sentences.headline(every).startswith("Possibly a cause outside the catalogue (")
    assert "outside the effects that were tried (" in sentences.headline(few)
    assert "lies outside the effects that were tried" in sentences.answer(few)[1]


@pytest.mark.parametrize(
    ("others", "end"), [(0, ""), (1, "; one other is"), (6, "; six others are")]
)
def test_a_headline_says_no_more_than_its_number(report, others, end):
    """It holds the probability, and how many hypotheses the data leave open in addition."""
    names = [name for name in report.verdict.probability if name != "none"]
    rest = 0.65 / len(names)
    verdict = replace(
        report.verdict,
        kind="none",
        effects=[],
        probability=dict.fromkeys(names, rest) | {"none": 0.35},
        set=["none", *names[:others]],
    )
    end = f"{end} not excluded" if end else ""
    text = sentences.headline(replace(report, verdict=verdict))
    assert text == f"No missing effect is needed (35 %){end}"


def test_a_cause_that_does_not_lead_is_only_possible(report):
    verdict = report.verdict
    first, last = verdict.effects[0], list(verdict.probability)[-1]
    swapped = verdict.probability | {
        first: verdict.probability[last],
        last: verdict.probability[first],
    }
    second = replace(report, verdict=replace(verdict, probability=swapped))
    assert sentences.headline(report).startswith("Most likely cause: ")
    assert sentences.headline(second).startswith("Possible cause: ")


@pytest.mark.parametrize("kind", ["effect", "several", "none", "unknown"])
def test_every_headline_holds_the_probability(kind):
    told = example(kind)
    name, chance = sentences.named(told)
    assert f"({words.percent(chance)})" in sentences.headline(told)


def unknown_of(report):
    """The report with another verdict."""
    return replace(report, verdict=replace(report.verdict, kind="unknown", effects=[]))


def test_oddities_stand_above_what_was_compared(page, tmp_path):
    odd = Oddity("beads", "front.csv", "x_front_m", "0.185", "length_0 = 0.2 m", "X <level>?")
    report = small(experiments=(FITTED[0],), observables=())
    told = written(replace(report, warnings=[odd]), tmp_path)
    assert told.ids.index("warnings") < told.ids.index("compared")
    words = "beads, front.csv, x_front_m : found 0.185; expected: length_0 = 0.2 m; X <level>?"
    assert words in told.text
    assert odd.line() == words.replace(
        "beads, front.csv, x_front_m :", "beads/front.csv: x_front_m:"
    )
    assert "warnings" not in page.ids


@pytest.mark.parametrize("workers", [1, 2])
def test_figures_drawn_by_two_processes_are_the_same(folder, workers):
    report = read_report(folder)
    with StandingWorkers(workers) as standing:
        chapters = pictures(report, Painter(standing).draw)
    assert chapters == pictures(report)


def test_figures_of_a_process_that_dies_are_drawn_here(folder):
    class Dead:
        def submit(self, task, *arguments):
            future = Future()
            future.set_exception(BrokenExecutor("the process ended with status -9"))
            return future

    report = read_report(folder)
    assert pictures(report, Painter(Dead()).draw) == pictures(report)
