"""Tables of the page: rows of words and numbers."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, NamedTuple

from fvcollapse.diagnosis.names import BASELINE
from fvcollapse.diagnosis.points import PHASES
from fvcollapse.diagnosis.report import words
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.measure.quantities import observable_words, plain_unit, shown_gap, shown_value

if TYPE_CHECKING:
    from fvcollapse.diagnosis.report.drawing import Picture

    Cell = tuple[str, str, str, str, str]  # before, after, unit, fraction closed, its range
    from fvcollapse.diagnosis.report import schema as form

SHARE_LEAST = 0.005  # of the squared gap: what is less is not listed
PRIORS = {
    "uniform": "{0} to {1}{2}",
    "loguniform": "{0} to {1}{2}, logarithmic",
    "normal": "{0} \N{PLUS-MINUS SIGN} {1}{2}",
    "halfnormal": "from {0} upwards, scale {1}{2}",
}


def set_up_rows(report: "form.Report") -> "list[tuple[str, form.SetUp | None, str, list[str]]]":
    """(name, `SetUp`, fitted or held out, measured observables) of each experiment."""
    rows = []
    for name in (*report.experiments, *report.held_out):
        observables = [
            measured_words(one) for one in report.details.comparisons if one.experiment == name
        ]
        role = "held out" if name in report.held_out else "fitted"
        rows.append((name, report.details.set_ups.get(name), role, observables))
    return rows


def measured_words(one: "form.Comparison") -> str:
    """An observable, of a curve with the number of its points that are compared, of all."""
    text, compared = observable_words(one.observable), len(one.measured)
    return text if one.time is None or not one.of else f"{text} ({compared} of {one.of})"


def picture_groups(
    report: "form.Report", pictures: "Iterable[Picture]"
) -> "list[tuple[str, str, str, list[Picture]]]":
    """(experiment, title, fitted or held out, its pictures), the fitted first."""
    groups = []
    for name, set_up, role, _ in set_up_rows(report):
        mine = [picture for picture in pictures if picture.experiment == name]
        if mine:
            groups.append((name, set_up.title if set_up else "", role, mine))
    return groups


def gap_rows(report: "form.Report") -> list[tuple[str, str, str, str, float, int]]:
    """(observable, rms gap, combined uncertainty, unit, ratio, points) as shown."""
    rows = []
    for name, gap in report.by_observable.items():
        factor, unit = shown_gap(name, gap.units)
        rms, combined = (
            words.number(factor * part, 2) for part in (gap.rms_gap, gap.combined_uncertainty)
        )
        rows.append((name, rms, combined, unit, gap.ratio, gap.points))
    return rows


def practical_rows(report: "form.Report") -> list[tuple[str, str, str, float, str, str, str, bool]]:
    """(observable, unit, beyond noise, share of the mean square, uncertainty, controls, codes, larger) as shown."""
    rows = []
    for name, part in report.details.practical.items():
        factor, unit = shown_gap(name, part.units)
        sizes = (part.beyond, part.uncertainty, part.controls, part.codes)
        beyond, *others = (words.number(scaled(size, factor), 2) for size in sizes)
        uncertainty, controls, codes = others
        rows.append((name, unit, beyond, part.share, uncertainty, controls, codes, part.is_larger))
    return rows


def scaled(value: float | None, factor: float) -> float | None:
    """A value times a factor; None where there is none."""
    return None if value is None else factor * value


def share_table(report: "form.Report") -> list[tuple[str, str, list[tuple[float, int] | None]]]:
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


def scalar_rows(
    report: "form.Report",
) -> list[tuple[str, str, str, list[tuple[str, float | None]]]]:
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
            sigma = words.number(scaled(one.sigma[n], factor), 2)
            text = f"{sign[one.kind]}{words.number(scaled(measured, factor))} \N{PLUS-MINUS SIGN} {sigma} {unit}"
            values = [
                (f"{words.number(scaled(one.simulated[model][n], factor))} {unit}", one.z[model][n])
                if model in one.simulated and one.simulated[model][n] is not None
                else ("\N{EN DASH}", None)
                for model in (BASELINE, after)
            ]
            rows.append((one.experiment, one.observable, text, values))
    return rows


def candidate_rows(
    report: "form.Report",
) -> "list[tuple[str, float, form.Candidate | None, form.HypothesisSummary | None]]":
    """(name, candidate or None, hypothesis or None) of all hypotheses, the most probable first."""
    return [
        (name, chance, report.candidates.get(name), report.details.hypotheses.get(name))
        for name, chance in words.ranking(report)
    ]


def reduction_rows(report: "form.Report") -> "list[tuple[str, Cell | None, Cell | None]]":
    """(words, unit, fitted, held out) overall and by observable; each part (before, after, closed)."""
    if report.reduction is None:
        return []
    groups = (report.reduction.fitted, report.reduction.held_out)
    names = dict.fromkeys(name for group in groups if group for name in group.by_observable)
    overall = [group.overall if group else None for group in groups]
    fitted, held_out = (reduction_cell(part, (1.0, "")) for part in overall)
    rows = [("all observables together", fitted, held_out)]
    for name in names:
        parts = [group.by_observable.get(name) if group else None for group in groups]
        units = next(part.units for part in parts if part)
        fitted, held_out = (reduction_cell(part, shown_gap(name, units)) for part in parts)
        rows.append((observable_words(name), fitted, held_out))
    return rows


def reduction_cell(part: "form.Closed | None", shown: tuple[float, str]) -> "Cell | None":
    """(before, after, unit, fraction, interval) of a `Closed` as shown; None without one."""
    if part is None:
        return None
    factor, unit = shown
    before, after = (words.number(factor * value, 2) for value in (part.before, part.after))
    if part.before == 0.0 and part.after == 0.0:  # nothing beyond the noise, and nothing to close
        return before, after, unit, "\N{EN DASH}", ""
    closed = words.percent(part.fraction_closed)
    return before, after, unit, closed, words.span(part.interval, words.percent)


def rung_rows(report: "form.Report") -> "list[tuple[form.Rung, list[tuple[str, form.Parameter]]]]":
    """(rung, [(key, parameter)]) of the ladder, effect parameters before re-fitted keys."""
    return [
        (rung, [*rung.parameters.items(), *rung.calibrated.items()])
        for rung in report.details.ladder
    ]


def absorbed_rows(report: "form.Report") -> list[tuple[str, Sequence[str], list[str]]]:
    """(effect, keys whose calibration may hold it, those of them that were re-calibrated) of what is named or left."""
    names = dict.fromkeys([*report.verdict.effects, *report.verdict.set])
    fitted = {key.partition(" ")[0] for rung in report.details.ladder for key in rung.calibrated}
    rows: list[tuple[str, Sequence[str], list[str]]] = []
    for name in names:
        stated = report.details.hypotheses.get(name)
        keys = stated.absorbed_in if stated else ()
        keys = keys or (CATALOGUE[name].absorbed_in if name in CATALOGUE else ())
        if keys:
            rows.append((name, keys, [key for key in keys if key in fitted]))
    return rows


class ShownParameter(NamedTuple):
    """A parameter in words; `interval` and `prior` are empty where there is none."""

    value: str
    unit: str
    interval: str
    prior: str


def shown_parameter(one: "form.Parameter") -> ShownParameter:
    """A `Parameter` as the page shows it: lengths in cm."""
    factor, unit = (words.CENTIMETRES, "cm") if one.units == "m" else (1.0, plain_unit(one.units))

    def number(value: float) -> str:
        return words.number(factor * value)

    return ShownParameter(
        value=number(one.value),
        unit=unit,
        interval=words.span((one.low, one.high), number)
        if one.low is not None and one.high is not None
        else "",
        prior=prior_words(one.prior, factor, unit) if one.prior else "",
    )


def prior_words(prior: "form.PriorRange", factor: float = 1.0, unit: str = "") -> str:
    """A prior in words, its numbers times a factor and with their unit."""
    form = PRIORS.get(prior.kind, "{0}, {1}{2} (" + prior.kind + ")")
    ends = (words.number(factor * end) for end in (prior.first, prior.second))
    return form.format(*ends, f" {unit}" if unit else "")


def assumed_rows(report: "form.Report") -> "list[tuple[form.Assumption, list[str]]]":
    """(assumption, names of the experiments that share it) of all that was assumed."""
    shared: dict[tuple[str, str], tuple[form.Assumption, list[str]]] = {}
    for one in report.details.assumed:
        shared.setdefault((one.key, one.value), (one, []))[1].append(one.experiment)
    return list(shared.values())
