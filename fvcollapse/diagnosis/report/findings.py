"""The results of a diagnosis as a `Report`."""

from collections.abc import Iterable, Sequence
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec.structs import replace

from fvcollapse.diagnosis.closing import gaps_of
from fvcollapse.diagnosis.confirmation import confirm
from fvcollapse.diagnosis.names import BASELINE, NAMED
from fvcollapse.diagnosis.report import schema as form
from fvcollapse.diagnosis.report.assumed import assumptions
from fvcollapse.diagnosis.report.candidates import candidates, hypotheses, separability
from fvcollapse.diagnosis.report.limits import grain_words, limits, model_words
from fvcollapse.diagnosis.report.reductions import confirmation_of, reductions, rms, rungs
from fvcollapse.diagnosis.report.remainder import practical_of, region_parts, unexplained_of
from fvcollapse.diagnosis.report.words import candidate_words
from fvcollapse.diagnosis.verdict_features import temperature

if TYPE_CHECKING:
    from fvcollapse.diagnosis.analysis import Analysis
    from fvcollapse.diagnosis.closing import Group
    from fvcollapse.diagnosis.ladder import Ladder
    from fvcollapse.diagnosis.next_experiment import Choice
    from fvcollapse.diagnosis.points import Block, Points
    from fvcollapse.diagnosis.verdict import Verdict
    from fvcollapse.diagnosis.verdict_model import VerdictModel
    from fvcollapse.measure.experiment import Experiment


def report_of(
    analysis: "Analysis",
    verdict: "Verdict",
    ladder: "Ladder",
    choices: "Sequence[Choice]",
    cost: form.Cost,
    model: "VerdictModel | None" = None,
) -> form.Report:
    """The `Report` of a diagnosis.

    Parameters
    ----------
    analysis : Analysis
    verdict : Verdict
    ladder : Ladder
    choices : list of Choice
        What to measure next, the best first.
    cost : Cost
    model : VerdictModel, optional
        What the verdict was made with.
    """
    upcoming = next_experiments(analysis, choices)
    return form.Report(
        experiments=[experiment.name for experiment in analysis.experiments],
        held_out=[experiment.name for experiment in held_out_of(ladder)],
        baseline_case=analysis.question.baseline.to_toml(),
        where=region_parts(analysis.points, analysis.gap_map.regions, analysis.gap_map.z),
        by_observable=levels_of(analysis),
        verdict=answer_of(verdict),
        candidates=candidates(analysis, verdict),
        reduction=reductions(ladder, analysis.seed) if verdict.kind in NAMED else None,
        next_experiment=upcoming[0] if upcoming else None,
        cost=cost,
        details=details_of(analysis, verdict, ladder, upcoming[1:], model),
    )


def details_of(
    analysis: "Analysis",
    verdict: "Verdict",
    ladder: "Ladder",
    alternatives: list[form.NextExperiment],
    model: "VerdictModel | None",
) -> form.Details:
    """What the page shows beyond the stable keys; parameters as of `report_of`."""
    return form.Details(
        expected=expected(analysis),
        coarse_cells=dict(analysis.question.coarse_cells),
        set_ups=set_ups(analysis, ladder),
        comparisons=comparisons(analysis, ladder),
        shares=[form.Share(**share._asdict()) for share in analysis.gap_map.shares],
        budget=budget(analysis),
        practical=practical_of(analysis),
        unexplained=unexplained_of(analysis, verdict),
        grains=grain_words(analysis.evidence.balance),
        shared_physics=analysis.discrepancy.effects if analysis.discrepancy else {},
        hypotheses=hypotheses(analysis, verdict),
        temperature=temperature_of(analysis, verdict),
        separability=separability(analysis, verdict),
        ladder=rungs(analysis, ladder),
        confirmation=confirmation_of(confirm(analysis, verdict, ladder)),
        alternatives=alternatives,
        assumed=assumptions(analysis.question),
        limits=[*limits(analysis, ladder), model_words(model, analysis.evidence)],
    )


def temperature_of(analysis: "Analysis", verdict: "Verdict") -> float | None:
    """What logarithms of evidences were divided by; None where the verdict layer judged."""
    return None if verdict.conformal else temperature(analysis.evidence)


def held_out_of(ladder: "Ladder") -> "tuple[Experiment, ...]":
    """The experiments that were held out."""
    return ladder.held_out.points.experiments if ladder.held_out else ()


def answer_of(verdict: "Verdict") -> form.Verdict:
    """A `Verdict` of the diagnosis as the report has it."""
    return form.Verdict(
        kind=verdict.kind,  # type: ignore[arg-type]
        effects=list(verdict.effects),
        indistinguishable=[list(group) for group in verdict.indistinguishable],
        probability=dict(verdict.probability),
        set=list(verdict.set),
    )


def partial_answers(
    answers: "Iterable[tuple[tuple[str, ...], Verdict]]",
) -> list[form.PartialAnswer]:
    """What `sequence` found, as the report has it."""
    return [
        form.PartialAnswer(experiments=list(names), verdict=answer_of(verdict))
        for names, verdict in answers
    ]


def levels_of(analysis: "Analysis") -> dict[str, form.ObservableGap]:
    """Size of the gap of every observable."""
    observable = analysis.points.observable
    return {
        level.observable: form.ObservableGap(
            rms_gap=level.rms,
            combined_uncertainty=level.combined,
            ratio=level.ratio,
            units=level.units,
            points=int(np.count_nonzero(observable == level.observable)),
        )
        for level in analysis.gap_map.by_observable
        if not level.experiment
    }


def expected(analysis: "Analysis") -> dict[str, float]:
    """Observable -> root mean square of the gap that the controls let expect, SI; empty without controls."""
    if not analysis.controls:
        return {}
    observable = analysis.points.observable
    return {
        str(name): rms(analysis.shift[observable == name]) for name in dict.fromkeys(observable)
    }


def set_ups(analysis: "Analysis", ladder: "Ladder") -> dict[str, form.SetUp]:
    """Experiment -> `SetUp`, fitted and held out."""
    return {one.name: set_up(one) for one in (*analysis.experiments, *held_out_of(ladder))}


def set_up(experiment: "Experiment") -> form.SetUp:
    """The set-up of an experiment."""
    geometry = experiment.settings.geometry
    width = geometry.channel_width
    return form.SetUp(
        title=experiment.settings.title,
        source=experiment.settings.source,
        slope_angle_deg=geometry.slope_angle_deg,  # type: ignore[arg-type]
        height_0=geometry.height_0,  # type: ignore[arg-type]
        length_0=geometry.length_0,  # type: ignore[arg-type]
        channel_width=None if width is None or width == inf else width,
    )


def comparisons(analysis: "Analysis", ladder: "Ladder") -> list[form.Comparison]:
    """Every observable of every experiment with all models."""
    combined = np.sqrt(np.diag(analysis.covariance))
    region = np.full(len(analysis.points), -1)
    for number, significant in enumerate(analysis.gap_map.regions):
        region[significant.points] = number
    pairs = group_comparisons(ladder.fitted, combined, region, analysis.gap_map.z)
    if ladder.held_out is not None:
        group = ladder.held_out
        nowhere = np.full(len(group.points), -1)
        pairs += group_comparisons(group, np.sqrt(np.diag(group.covariance)), nowhere)
    return pairs


def group_comparisons(
    group: "Group", combined: np.ndarray, region: np.ndarray, baseline: np.ndarray | None = None
) -> list[form.Comparison]:
    """The `Comparison`s of a group.

    Parameters
    ----------
    group : Group
    combined : (n,) array
        Standard uncertainties.
    region : (n,) int array
        -1: in none.
    baseline : (n,) array, optional
        z of the baseline, as the map of the gap has it.
    """
    points, pairs = group.points, []
    phase = points.phase
    z = {model: gaps_of(group, model) / combined for model in group.simulated}
    if baseline is not None:
        z[BASELINE] = baseline
    for block in points.blocks:
        rows = slice(block.start, block.stop)
        columns: dict[str, Any] = {  # arrays, which are lists of numbers in the file
            "time": None if np.isnan(block.time).all() else block.time,
            "x": None if np.isnan(block.x).all() else block.x,
            "measured": points.measured[rows],
            "sigma": points.sigma[rows],
            "combined": combined[rows],
            "simulated": {model: values[rows] for model, values in group.simulated.items()},
            "z": {model: values[rows] for model, values in z.items()},
        }
        pairs.append(
            form.Comparison(
                experiment=block.experiment,
                observable=block.observable,
                units=block.units,
                **columns,
                kind=block.kind,
                region=[int(n) if n >= 0 else None for n in region[rows]],
                phase=phase[rows].tolist(),
                of=measured_points(points, block),
            )
        )
    return pairs


def measured_points(points: "Points", block: "Block") -> int:
    """Number of measured points of the curve that a block is chosen from; of a number its own."""
    experiment = next(one for one in points.experiments if one.name == block.experiment)
    curve = experiment.curves.get(block.observable)
    return block.stop - block.start if curve is None else len(curve.value)


def budget(analysis: "Analysis") -> dict[str, dict[str, float]]:
    """Observable -> source of uncertainty -> its root mean square."""
    points = analysis.points
    sources = {
        "measurement, single points": points.sigma**2,
        "measurement, whole run": np.diag(analysis.measurement) - points.sigma**2,
        "grid": np.diag(analysis.numerical),
        "calibrated parameters and set-up": np.diag(analysis.calibration),
    }
    if analysis.controls:
        sources = {
            "measurement and grid": np.diag(analysis.measurement + analysis.numerical),
        }
        conditioned = np.diag(analysis.covariance) - sources["measurement and grid"]
        sources["parameters, set-up and discrepancy, after the controls"] = conditioned
    observable = points.observable
    return {
        str(name): {
            source: float(np.sqrt(np.mean(np.maximum(values[observable == name], 0.0))))
            for source, values in sources.items()
        }
        for name in dict.fromkeys(observable)
    }


def next_experiments(
    analysis: "Analysis", choices: "Sequence[Choice]"
) -> list[form.NextExperiment]:
    """What to measure next as the report has it, the first with the case file of the first new set-up."""
    upcoming = [next_experiment(choice) for choice in choices]
    if upcoming:
        new = next((choice for choice in choices if choice.candidate.changes), choices[0])
        upcoming[0] = replace(upcoming[0], case=next_case(analysis, new))
    return upcoming


def next_experiment(choice: "Choice") -> form.NextExperiment:
    """A `Choice` as the report has it."""
    finite = {key: value for key, value in choice.candidate.changes.items() if value < inf}
    return form.NextExperiment(
        description=candidate_words(choice.candidate),
        separates=list(choice.separates),
        expected_gain=choice.gain,
        set_up=finite,
        repeats=choice.repeats,
    )


def next_case(analysis: "Analysis", choice: "Choice") -> str:
    """Case file (TOML) of the set-up of a `Choice`: the model as given, in that set-up."""
    given = analysis.library.cases[choice.candidate.reference]
    return given.replace(**choice.candidate.changes).to_toml()
