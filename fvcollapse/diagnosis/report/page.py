"""The report as one HTML page that needs no other file, and its figures as files of their own."""

import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from fvcollapse.diagnosis.names import RUNGS
from fvcollapse.diagnosis.report import sentences, words
from fvcollapse.diagnosis.report.bars import bars, ranking_note
from fvcollapse.diagnosis.report.certainty import wording
from fvcollapse.diagnosis.report.figures import pictures
from fvcollapse.diagnosis.report.glossary import WORDS, symbols
from fvcollapse.diagnosis.report.next_words import planned, with_case
from fvcollapse.diagnosis.report.regions import region_words
from fvcollapse.diagnosis.report.run_table import RUNS_FILE
from fvcollapse.diagnosis.report.sealed import gain_words, sealed_scores
from fvcollapse.diagnosis.report.standing import agrees
from fvcollapse.diagnosis.report.tables import (
    absorbed_rows,
    assumed_rows,
    candidate_rows,
    gap_rows,
    picture_groups,
    practical_rows,
    reduction_rows,
    rung_rows,
    scalar_rows,
    set_up_rows,
    share_table,
    shown_parameter,
)
from fvcollapse.diagnosis.report.unexplained_words import likeness_words, place_name
from fvcollapse.errors import OutputError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.measure.quantities import observable_words
from fvcollapse.version import __version__

if TYPE_CHECKING:
    from fvcollapse.diagnosis.report.drawing import Picture
    from fvcollapse.diagnosis.report.schema import Report

TEMPLATE = "report.html.j2"
PAGE, FIGURES = "report.html", "figures"
NEXT_CASE = "next_experiment.toml"
CANDIDATES_OPEN = 5  # hypotheses listed at once
REGIONS_OPEN = 8  # listed at once; the rest behind a click
# text of the page between two tags, but for what is copied or drawn
TEXT = re.compile(r"<(style|pre|svg)\b.*?</\1>|>[^<]+", re.DOTALL)


def write_page(
    report: "Report",
    folder: str | Path,
    draw: "Callable[[Report, int], list[Picture]] | None" = None,
) -> Path:
    """Put `report.html` and `figures/` into a folder; the path of the page.

    Parameters
    ----------
    report : Report
        As `read_report` gives it.
    folder : str or Path
    draw : function, optional
        See `figures.pictures`.

    Raises
    ------
    OutputError
    """
    folder = Path(folder)
    try:
        (folder / FIGURES).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(folder / FIGURES, error, running=True) from None
    chapters = pictures(report, draw)
    for picture in (picture for chapter in chapters.values() for picture in chapter):
        write_atomic(folder / FIGURES / f"{picture.name}.svg", picture.svg)
    path = folder / PAGE
    write_atomic(path, render(report, chapters).encode())
    return path


def render(report: "Report", chapters: "Mapping[str, Sequence[Picture]]") -> str:
    """The page as text; `chapters` are the `pictures` of the report."""
    pictured = [picture for chapter in chapters.values() for picture in chapter]
    return together(
        environment()
        .get_template(TEMPLATE)
        .render(
            report=report,
            details=report.details,
            figures=chapters,
            inline={picture.name: inline(picture, f"f{n}") for n, picture in enumerate(pictured)},
            overlays=picture_groups(report, chapters["overlays"]),
            maps=picture_groups(report, chapters["gap_maps"]),
            bars=bars(report),
            glossary=WORDS,
            symbols=symbols(report),
            **texts_of(report),
            **tables_of(report),
            rungs=RUNGS,
            regions_open=REGIONS_OPEN,
            candidates_open=CANDIDATES_OPEN,
            **plan_of(report),
            runs_file=RUNS_FILE,
            version=__version__,
        )
    )


def environment() -> Environment:
    """The environment of the template, with the words as filters."""
    made = Environment(
        loader=PackageLoader("fvcollapse.diagnosis.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters |= {
        "number": words.number,
        "tenths": words.tenths,
        "percent": words.percent,
        "span": words.span,
        "hypothesis": words.hypothesis_name,
        "observable": observable_words,
        "meaning": words.effect_meaning,
        "listed": words.listed,
        "hypotheses_listed": words.hypotheses_listed,
        "first_causes": words.first_causes,
        "region": region_words,
        "likeness": likeness_words,
        "place": place_name,
        "coded": coded,
        "shown": shown_parameter,
        "in_cm": words.in_cm,
        "address": address,
    }
    return made


def together(page: str) -> str:
    """The page with numbers that no line break parts from their units."""
    return TEXT.sub(lambda found: found[0] if found[1] else words.unbroken(found[0]), page)


def coded(text: str) -> Markup:
    """Text whose `words` are set as code."""
    return Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", str(escape(text))))


def plan_of(report: "Report") -> dict[str, Any]:
    """What to measure next, by the names in the template."""
    alike, less = planned(report)
    return {
        "alike": alike,
        "less": less,
        "case_of": with_case(report),
        "next_case": NEXT_CASE,
        "gain_note": gain_words(),
        "margin": sealed_scores().next.margin,
    }


def texts_of(report: "Report") -> dict[str, Any]:
    """Sentences and names of the page, by their names in the template."""
    hypotheses = report.details.hypotheses.values()
    confirmation = report.details.confirmation
    return {
        "answer": sentences.parts_of(report),
        "headline": sentences.headline(report),
        "ranking_note": ranking_note(report),
        "agrees": agrees(report),
        "expected": sentences.expected_gaps(report),
        "tested": any(summary.conformal_p is not None for summary in hypotheses),
        "after": words.after_model(report),
        "model": lambda model: words.model_name(model, report),
        "confirmed": confirmation and wording(confirmation),
        "foreseen": any(rung.fitted.predicted is not None for rung in report.details.ladder),
    }


def tables_of(report: "Report") -> dict[str, Sequence[Any]]:
    """Rows of the tables of the page, by their names in the template."""
    return {
        "set_ups": set_up_rows(report),
        "regions": sorted(report.where, key=lambda region: -region.significance),
        "gaps": gap_rows(report),
        "practical": practical_rows(report),
        "shares": share_table(report),
        "scalars": scalar_rows(report),
        "candidates": candidate_rows(report),
        "reductions": reduction_rows(report),
        "rung_values": rung_rows(report),
        "absorbed": absorbed_rows(report),
        "assumed": assumed_rows(report),
    }


def address(picture: "Picture") -> str:
    """Address of the file of a figure, relative to the page."""
    return quote(f"{FIGURES}/{picture.name}.svg")


def inline(picture: "Picture", prefix: str) -> Markup:
    """A figure as an element of the page; `prefix` keeps its identifiers apart from those of others."""
    svg = picture.svg.decode()
    svg = re.sub(r'( id="|url\(#|href="#)', rf"\g<1>{prefix}-", svg[svg.index("<svg") :])
    label = escape(picture.alt)
    return Markup(svg.replace("<svg", f'<svg role="img" aria-label="{label}"', 1))
