"""Contradictions inside a report: none may be written or read."""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from fvcollapse.diagnosis.names import NONE, RUNGS, UNKNOWN

if TYPE_CHECKING:
    from fvcollapse.diagnosis.report.schema import Report, Separability

SUM_TOLERANCE = 1.0e-6


def contradictions(report: "Report") -> Iterator[tuple[str, str]]:
    """(key, problem) of everything in a report that does not agree with the rest."""
    yield from verdict_contradictions(report)
    yield from candidate_contradictions(report)
    yield from where_contradictions(report)
    yield from comparison_contradictions(report)
    yield from separability_contradictions(report.details.separability)
    yield from ladder_contradictions(report)
    yield from remainder_contradictions(report)


def verdict_contradictions(report: "Report") -> Iterator[tuple[str, str]]:
    """Probabilities that are none, and effects that the kind does not allow."""
    verdict = report.verdict
    values = verdict.probability.values()
    if any(not 0.0 <= value <= 1.0 for value in values):
        yield "verdict.probability", "a number outside 0..1"
    if abs(math.fsum(values) - 1.0) > SUM_TOLERANCE:
        yield "verdict.probability", f"a sum of {math.fsum(values):.8g} instead of 1"
    for name in (NONE, UNKNOWN):
        if name not in verdict.probability:
            yield "verdict.probability", f"no {name!r}"
    if (verdict.kind in (NONE, UNKNOWN)) != (not verdict.effects):
        yield "verdict.effects", f"{verdict.effects} for the verdict {verdict.kind!r}"
    for name in verdict.set:
        if name not in verdict.probability:
            yield "verdict.set", f"{name!r}, which has no probability"
    known = {part for name in verdict.probability for part in name.split("+")}
    for name in [*verdict.effects, *(one for group in verdict.indistinguishable for one in group)]:
        if name not in known:
            yield "verdict.effects", f"{name!r}, which has no probability"


def candidate_contradictions(report: "Report") -> Iterator[tuple[str, str]]:
    """Candidates whose probability is not that of the verdict."""
    for name, candidate in report.candidates.items():
        stated = report.verdict.probability.get(name)
        if stated is None or abs(stated - candidate.probability) > SUM_TOLERANCE:
            yield f"candidates.{name}.probability", f"{candidate.probability:g} beside {stated}"
    for name in report.verdict.probability:
        if name not in report.candidates and name not in (NONE, UNKNOWN) and "+" not in name:
            yield "candidates", f"no {name!r}, which has a probability"


def where_contradictions(report: "Report") -> Iterator[tuple[str, str]]:
    """Regions of an experiment that is not compared, and ranges that run backwards."""
    compared = {*report.experiments, *report.held_out}
    for n, region in enumerate(report.where):
        if region.experiment not in compared:
            yield f"where[{n}]", f"the experiment {region.experiment!r}, not compared"
        for span in (region.t_range, region.x_range):
            if span is not None and span[0] > span[1]:
                yield f"where[{n}]", f"the range {span}"
    for name in set(report.experiments) & set(report.held_out):
        yield "held_out", f"{name!r}, which was fitted as well"


def comparison_contradictions(report: "Report") -> Iterator[tuple[str, str]]:
    """Columns of unequal length, models without a name, regions that do not exist."""
    compared = {*report.experiments, *report.held_out}
    for n, one in enumerate(report.details.comparisons):
        key, size = f"details.comparisons[{n}]", len(one.measured)
        columns: list[Sequence[object]] = [
            one.sigma,
            one.combined,
            *one.simulated.values(),
            *one.z.values(),
        ]
        columns += [column for column in (one.time, one.x) if column is not None]
        columns += [column for column in (one.region, one.phase) if column]
        if any(len(column) != size for column in columns):
            yield key, "columns of unequal length"
        if one.experiment not in compared:
            yield key, f"the experiment {one.experiment!r}, not compared"
        for model in {*one.simulated, *one.z} - set(RUNGS):
            yield key, f"the model {model!r}"
        if any(index is not None and index >= len(report.where) for index in one.region):
            yield key, "a region that does not exist"


def separability_contradictions(separability: "Separability | None") -> Iterator[tuple[str, str]]:
    """Matrices that are not k x k, classes that are no partition."""
    if separability is None:
        return
    k = len(separability.names)
    for name in ("cosine", "distance_squared"):
        matrix = getattr(separability, name)
        if len(matrix) != k or any(len(row) != k for row in matrix):
            yield f"details.separability.{name}", f"no {k} x {k} matrix"
    if len(separability.unique_snr) != k:
        yield "details.separability.unique_snr", f"{len(separability.unique_snr)} values for {k}"
    members = sorted(name for one in separability.classes for name in one)
    if members != sorted(separability.names):
        yield "details.separability.classes", "classes that do not hold every effect once"


def ladder_contradictions(report: "Report") -> Iterator[tuple[str, str]]:
    """Models without a name, and held-out values where nothing was held out."""
    for n, rung in enumerate(report.details.ladder):
        if rung.model not in RUNGS:
            yield f"details.ladder[{n}].model", repr(rung.model)
        if rung.held_out is not None and not report.held_out:
            yield f"details.ladder[{n}].held_out", "values although no experiment was held out"
    reduction = report.reduction
    if reduction is not None and reduction.held_out is not None and not report.held_out:
        yield "reduction.held_out", "values although no experiment was held out"
    confirmation = report.details.confirmation
    if confirmation is not None and confirmation.wording == "confirmed" and not report.held_out:
        yield "details.confirmation", "'confirmed' although no experiment was held out"


def remainder_contradictions(report: "Report") -> Iterator[tuple[str, str]]:
    """Sizes of what was not compared, and shares of what is left that are none."""
    for name in report.details.practical:
        if name not in report.by_observable:
            yield "details.practical", f"{name!r}, which was not compared"
    part, key = report.details.unexplained, "details.unexplained"
    if part is None:
        return
    total = math.fsum(one.share for one in part.shares)
    if part.shares and abs(total - 1.0) > SUM_TOLERANCE:
        yield f"{key}.shares", f"a sum of {total:.8g} instead of 1"
    if bool(part.shares) != bool(part.regions):
        yield f"{key}.shares", f"{len(part.shares)} beside {len(part.regions)} regions"
    for name in {part.experiment, *(one.experiment for one in part.regions)}:
        if name not in report.experiments:
            yield key, f"the experiment {name!r}, not fitted"
    if part.beside not in report.verdict.probability:
        yield f"{key}.beside", f"{part.beside!r}, which has no probability"
