"""report.html in a browser: short as it opens, no wider than the window, and to be read on a telephone."""

import pytest
from page_in_browser import BROWSER, WIDTHS, measured

needs_browser = pytest.mark.skipif(
    BROWSER is None, reason="no Chromium: the layout of the report is not tested"
)
LONGEST = {1280: 9000, 768: 11000, 390: 13500}  # pixels, as it opens
SMALLEST = 8.0  # pixels: letters in a figure on a telephone


@pytest.fixture(scope="module")
def laid_out(drawn_page, tmp_path_factory):
    """{width: what the browser measured}."""
    return measured(drawn_page.folder / "report.html", tmp_path_factory.mktemp("browser"))


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
