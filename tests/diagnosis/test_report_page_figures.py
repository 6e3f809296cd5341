"""Figures of report.html name what they show and in which unit, and are the same whoever draws them."""

import re
import xml.etree.ElementTree as ElementTree
from concurrent.futures import BrokenExecutor, Future

import numpy as np
import pytest
from msgspec.structs import replace
from report_example import EFFECTS, FITTED
from report_page import blank, slim, small, written

from fvcollapse.diagnosis.gap_map import Region as MapRegion
from fvcollapse.diagnosis.names import BASELINE
from fvcollapse.diagnosis.points import Block
from fvcollapse.diagnosis.report import figures, words
from fvcollapse.diagnosis.report.drawing import column
from fvcollapse.diagnosis.report.figures import drawable, pictures
from fvcollapse.diagnosis.report.gap_figures import cell
from fvcollapse.diagnosis.report.painter import Painter
from fvcollapse.diagnosis.report.regions import region_line
from fvcollapse.diagnosis.report.report_file import read_report
from fvcollapse.diagnosis.report.schema_gap import ObservableGap, Region
from fvcollapse.diagnosis.report.schema_reduction import Closed
from fvcollapse.measure.quantities import QUANTITIES
from fvcollapse.studies.standing import StandingWorkers


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


# -- gaps in one unit ----------------------------------------------------------------------------


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


# -- the same figures each time ------------------------------------------------------------------


def test_figures_are_the_same_each_time(drawn, folder):
    report = read_report(folder)
    one = [one for one in report.details.comparisons if one.experiment == FITTED[2]]
    details = replace(report.details, comparisons=one)
    again = figures.drawn(replace(report, details=details), slice(2))
    assert [picture.name.partition("_")[0] for picture in again] == ["front", "profiles"]
    assert all(picture == drawn[picture.name] for picture in again)


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
