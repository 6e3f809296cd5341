"""Pages of reports for tests: what is on one, and a report of few comparisons, quick to draw."""

from html.parser import HTMLParser
from pathlib import Path
from typing import NamedTuple

import pytest
from msgspec.structs import replace
from report_example import FITTED, HELD_OUT, example

from fvcollapse.diagnosis.report import page as page_module
from fvcollapse.diagnosis.report.drawing import Picture
from fvcollapse.diagnosis.report.figures import pictures
from fvcollapse.diagnosis.report.page import write_page
from fvcollapse.diagnosis.report.report_file import read_report, write_report

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


def slim(report):
    """Without the figures that depend on neither curves nor verdict, which are drawn for `page`."""
    return replace(report, details=replace(report.details, separability=None, budget={}))


def written(report, folder, draw=None):
    """The page of a report that went through its file."""
    write_report(report, folder)
    return Page(write_page(read_report(folder), folder, draw).read_text(encoding="utf-8"))


def blank(report, count):
    """In the place of figures, for a page whose words are looked at."""
    return [Picture(f"blank_{n}", b"<svg></svg>", "nothing", "") for n in range(count)]


class DrawnPage(NamedTuple):
    """A report with all its figures: its folder, its page, and the figures by name as they went to the page."""

    folder: Path
    page: Page
    figures: dict


def drawn_page(report, folder):
    """The page of a report whose figures are drawn from its file by this process."""
    kept = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            page_module, "pictures", lambda *found: kept.append(pictures(*found)) or kept[0]
        )
        page = written(report, folder)
    return DrawnPage(
        folder, page, {one.name: one for chapter in kept[0].values() for one in chapter}
    )
