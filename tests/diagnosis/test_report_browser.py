"""The page in a headless browser at the widths of a desk, a tablet and a telephone: its structure as it is laid out.

Skipped where no Chromium is installed.
"""

import html
import json
import re
import shutil
import subprocess

import pytest
from msgspec.structs import replace
from report_example import FITTED, HELD_OUT, example

from fvcollapse.diagnosis.report.page import write_page
from fvcollapse.diagnosis.report.report_file import read_report, write_report

BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
WIDTHS = (1280, 768, 390)
LONGEST = {1280: 9000, 768: 11000, 390: 13500}  # pixels, as it opens
SMALLEST = 8.0  # pixels: letters in a figure on a telephone
SECONDS = 120
# one frame for each width; what is measured becomes the text of the page
MEASURE = """
const place = element => { const r = element.getBoundingClientRect();
  return {left: r.left, right: r.right, top: r.top, bottom: r.bottom}; };
const measured = [...document.querySelectorAll("iframe")].map(frame => {
  const page = frame.contentDocument, ids = {};
  for (const element of page.querySelectorAll("[id]"))
    if (!element.closest("svg")) ids[element.id] = place(element);
  const letters = [...page.querySelectorAll("figure svg text")].filter(text => text.checkVisibility())
    .map(text => text.getBoundingClientRect().height);
  return {width: page.documentElement.clientWidth, scroll: page.documentElement.scrollWidth,
    height: page.documentElement.scrollHeight, ids: ids, letters: letters,
    open: [...page.querySelectorAll("details.experiment")].map(one => one.open)};
});
document.body.textContent = "MEASURED" + JSON.stringify(measured) + "END";
"""

pytestmark = pytest.mark.skipif(BROWSER is None, reason="no Chromium")


def page_of(folder):
    """The page of two experiments with two curves each."""
    report = example("effect")
    kept = [
        one
        for one in report.details.comparisons
        if one.experiment in (FITTED[2], HELD_OUT[0])
        and one.observable in ("front", "profiles", "runout")
    ]
    write_report(replace(report, details=replace(report.details, comparisons=kept)), folder)
    return write_page(read_report(folder), folder)


@pytest.fixture(scope="module")
def laid_out(tmp_path_factory):
    """{width: what the browser measured}."""
    folder = tmp_path_factory.mktemp("browser")
    address = page_of(folder).as_uri()
    frames = "".join(
        f'<iframe src="{address}" style="width:{width}px;height:900px;border:0"></iframe>'
        for width in WIDTHS
    )
    wrapper = folder / "frames.html"
    script = f"<script>window.onload = () => {{ {MEASURE} }}</script>"
    wrapper.write_text(f"<!doctype html><body>{frames}{script}</body>", encoding="utf-8")
    command = [BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"]
    command += ["--allow-file-access-from-files", f"--user-data-dir={folder / 'profile'}"]
    command += ["--window-size=1400,900", wrapper.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=SECONDS, check=True)
    (text,) = re.findall("MEASURED(.*)END", done.stdout)
    return dict(zip(WIDTHS, json.loads(html.unescape(text)), strict=True))


@pytest.mark.parametrize("width", WIDTHS)
def test_nothing_is_wider_than_the_window(laid_out, width):
    assert laid_out[width]["scroll"] <= laid_out[width]["width"] <= width


@pytest.mark.parametrize("width", WIDTHS)
def test_the_page_is_short_as_it_opens(laid_out, width):
    """All but the first experiment are folded."""
    assert laid_out[width]["height"] <= LONGEST[width]
    opened = laid_out[width]["open"]
    assert opened == [True, False] * (len(opened) // 2)


@pytest.mark.parametrize("width", WIDTHS)
def test_the_answer_is_on_the_first_screen_and_effects_follow(laid_out, width):
    ids = laid_out[width]["ids"]
    assert ids["answer"]["top"] < 300
    order = ["answer", "which", "far", "where", "next", "overlays", "compared", "limits", "words"]
    tops = [ids[name]["top"] for name in order]
    assert tops == sorted(tops)


def test_bars_stand_beside_the_answer_where_there_is_room(laid_out):
    wide, narrow = (laid_out[width]["ids"] for width in (1280, 390))
    assert wide["bars"]["left"] >= wide["answer"]["right"]
    assert abs(wide["bars"]["top"] - wide["answer"]["top"]) < 5
    assert narrow["bars"]["top"] >= narrow["answer"]["bottom"]


def test_letters_of_figures_can_be_read_on_a_telephone(laid_out):
    letters = laid_out[390]["letters"]
    assert len(letters) > 50
    assert min(letters) >= SMALLEST
