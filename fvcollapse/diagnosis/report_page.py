"""The report as one HTML page that needs no other file, and its figures as files of their own."""

import re
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from fvcollapse.diagnosis import report_words as words
from fvcollapse.diagnosis.points import PHASES
from fvcollapse.diagnosis.report import BASELINE, RUNGS
from fvcollapse.diagnosis.report_figures import pictures
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.errors import OutputError
from fvcollapse.files.storage import write_atomic
from fvcollapse.measure.quantities import observable_words, shown_gap, shown_value
from fvcollapse.version import __version__

TEMPLATE = "report.html.j2"
PAGE, FIGURES = "report.html", "figures"
SHARE_LEAST = 0.005  # of the squared gap: what is less is not listed
GROUPS_OPEN = 4  # experiments whose overlays are shown at once
REGIONS_OPEN = 8  # listed at once; the rest behind a click
PRIORS = {
    "uniform": "{0} to {1}",
    "loguniform": "{0} to {1}, logarithmic",
    "normal": "{0} \N{PLUS-MINUS SIGN} {1}",
    "halfnormal": "from {0} upwards, scale {1}",
}


def write_page(report, folder):
    """Put `report.html` and `figures/` into a folder; the path of the page.

    Parameters
    ----------
    report : Report
        As `read_report` gives it.
    folder : str or Path

    Raises
    ------
    OutputError
    """
    folder = Path(folder)
    try:
        (folder / FIGURES).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(folder / FIGURES, error, running=True) from None
    chapters = pictures(report)
    for picture in (picture for chapter in chapters.values() for picture in chapter):
        write_atomic(folder / FIGURES / f"{picture.name}.svg", picture.svg)
    path = folder / PAGE
    write_atomic(path, render(report, chapters).encode())
    return path


def render(report, chapters):
    """The page as text; `chapters` are the `pictures` of the report."""
    environment = Environment(
        loader=PackageLoader("fvcollapse.diagnosis"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "number": words.number,
        "tenths": words.tenths,
        "percent": words.percent,
        "span": words.span,
        "hypothesis": words.hypothesis_name,
        "observable": observable_words,
        "meaning": words.effect_meaning,
        "listed": words.listed,
        "region": words.region_words,
        "prior": prior_words,
    }
    every = [picture for chapter in chapters.values() for picture in chapter]
    return environment.get_template(TEMPLATE).render(
        report=report,
        details=report.details,
        figures=chapters,
        inline={p.name: inline(p, f"f{n}") for n, p in enumerate(every)},
        overlays=overlay_groups(report, chapters["overlays"]),
        answer=words.answer(report),
        headline=words.headline(report),
        named=words.named(report),
        expected=words.expected_gaps(report),
        tested=any(one.conformal_p is not None for one in report.details.hypotheses.values()),
        after=words.after_model(report),
        model=lambda model: words.model_name(model, report),
        confirmed=report.details.confirmation and words.wording(report.details.confirmation),
        rungs=RUNGS,
        set_ups=set_up_rows(report),
        regions=sorted(report.where, key=lambda region: -region.significance),
        regions_open=REGIONS_OPEN,
        groups_open=GROUPS_OPEN,
        gaps=gap_rows(report),
        shares=share_table(report),
        scalars=scalar_rows(report),
        candidates=candidate_rows(report),
        reductions=reduction_rows(report),
        rung_values=rung_rows(report),
        absorbed=absorbed_rows(report),
        version=__version__,
    )


def inline(picture, prefix):
    """A figure as an element of the page; `prefix` keeps its identifiers apart from those of others."""
    svg = picture.svg.decode()
    svg = re.sub(r'( id="|url\(#|href="#)', rf"\g<1>{prefix}-", svg[svg.index("<svg") :])
    label = escape(picture.alt)
    return Markup(svg.replace("<svg", f'<svg role="img" aria-label="{label}"', 1))


# -- tables --------------------------------------------------------------------------------------


def set_up_rows(report):
    """(name, `SetUp`, fitted or held out, measured observables) of each experiment."""
    rows = []
    for name in (*report.experiments, *report.held_out):
        observables = [o.observable for o in report.details.comparisons if o.experiment == name]
        role = "held out" if name in report.held_out else "fitted"
        rows.append((name, report.details.set_ups.get(name), role, observables))
    return rows


def overlay_groups(report, overlays):
    """(experiment, title, fitted or held out, its pictures), the fitted first."""
    groups = []
    for name, set_up, role, _ in set_up_rows(report):
        mine = [picture for picture in overlays if picture.experiment == name]
        if mine:
            groups.append((name, set_up.title if set_up else "", role, mine))
    return groups


def gap_rows(report):
    """(observable, rms gap, combined uncertainty, unit, ratio, points) as shown."""
    rows = []
    for name, gap in report.by_observable.items():
        factor, unit = shown_gap(name, gap.units)
        rms, combined = (
            words.number(factor * part, 2) for part in (gap.rms_gap, gap.combined_uncertainty)
        )
        rows.append((name, rms, combined, unit, gap.ratio, gap.points))
    return rows


def share_table(report):
    """Rows (observable, phase, [(share, sign) or None for each experiment]), what is tiny left out."""
    found = {
        (one.observable, one.phase, one.experiment): (one.share, one.sign)
        for one in report.details.shares
    }
    rows = []
    for observable in dict.fromkeys(one.observable for one in report.details.shares):
        for phase in PHASES:
            cells = [found.get((observable, phase, name)) for name in report.experiments]
            if any(cell is not None and cell[0] >= SHARE_LEAST for cell in cells):
                rows.append((observable, phase, cells))
    return rows


def scalar_rows(report):
    """(experiment, observable, measured, before, after, z before, z after) of the single numbers."""
    after = words.after_model(report)
    rows = []
    for one in report.details.comparisons:
        if one.time is not None:
            continue
        factor, unit = shown_value(one.observable, one.units)
        sign = {
            "value": "",
            "upper": "\N{LESS-THAN OR EQUAL TO} ",
            "lower": "\N{GREATER-THAN OR EQUAL TO} ",
        }
        for n, measured in enumerate(one.measured):
            sigma = words.number(factor * one.sigma[n], 2)
            text = f"{sign[one.kind]}{words.number(factor * measured)} \N{PLUS-MINUS SIGN} {sigma} {unit}"
            values = [
                (f"{words.number(factor * one.simulated[model][n])} {unit}", one.z[model][n])
                if model in one.simulated and one.simulated[model][n] is not None
                else ("\N{EN DASH}", None)
                for model in (BASELINE, after)
            ]
            rows.append((one.experiment, one.observable, text, values))
    return rows


def candidate_rows(report):
    """(name, candidate or None, hypothesis or None) of all hypotheses, the most probable first."""
    return [
        (name, chance, report.candidates.get(name), report.details.hypotheses.get(name))
        for name, chance in words.ranking(report)
    ]


def reduction_rows(report):
    """(words, unit, fitted, held out) overall and by observable; each part (before, after, closed)."""
    if report.reduction is None:
        return []
    groups = (report.reduction.fitted, report.reduction.held_out)
    names = dict.fromkeys(name for group in groups if group for name in group.by_observable)
    overall = [group.overall if group else None for group in groups]
    rows = [("all observables together", *(reduction_cell(part, (1.0, "")) for part in overall))]
    for name in names:
        parts = [group.by_observable.get(name) if group else None for group in groups]
        units = next(part.units for part in parts if part)
        shown = shown_gap(name, units)
        rows.append((observable_words(name), *(reduction_cell(part, shown) for part in parts)))
    return rows


def reduction_cell(part, shown):
    """(before, after, unit, fraction, interval) of a `Closed` as shown; None without one."""
    if part is None:
        return None
    factor, unit = shown
    before, after = (words.number(factor * value, 2) for value in (part.before, part.after))
    return (
        before,
        after,
        unit,
        words.percent(part.fraction_closed),
        words.span(part.interval, words.percent),
    )


def rung_rows(report):
    """(rung, [(key, parameter)]) of the ladder, effect parameters before re-fitted keys."""
    return [
        (rung, [*rung.parameters.items(), *rung.calibrated.items()])
        for rung in report.details.ladder
    ]


def absorbed_rows(report):
    """(effect, keys whose calibration may hold it, those of them that were re-calibrated) of what is named or left."""
    names = dict.fromkeys([*report.verdict.effects, *report.verdict.set])
    fitted = {key.partition(" ")[0] for rung in report.details.ladder for key in rung.calibrated}
    rows = []
    for name in names:
        stated = report.details.hypotheses.get(name)
        keys = stated.absorbed_in if stated else ()
        keys = keys or (CATALOGUE[name].absorbed_in if name in CATALOGUE else ())
        if keys:
            rows.append((name, keys, [key for key in keys if key in fitted]))
    return rows


def prior_words(prior):
    """A prior in words."""
    if prior is None:
        return "\N{EN DASH}"
    form = PRIORS.get(prior.kind, "{0}, {1} (" + prior.kind + ")")
    return form.format(words.number(prior.first), words.number(prior.second))
