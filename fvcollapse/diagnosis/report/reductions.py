"""The ladder of models as parts of the report."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.diagnosis.closing import closing, gaps_of, with_simulated
from fvcollapse.diagnosis.ladder import fold_fractions
from fvcollapse.diagnosis.names import BASELINE, WINNER
from fvcollapse.diagnosis.report import schema as form
from fvcollapse.diagnosis.report.candidates import parameters, units_of_keys
from fvcollapse.diagnosis.report.limits import confirmation_reasons

if TYPE_CHECKING:
    from fvcollapse.diagnosis.analysis import Analysis
    from fvcollapse.diagnosis.closing import Closing, Group
    from fvcollapse.diagnosis.confirmation import ConfirmationTests
    from fvcollapse.diagnosis.ladder import Ladder
    from fvcollapse.diagnosis.nuisances import Nuisance

SIZE_UNITS = "standard uncertainties beyond the noise"


def reductions(ladder: "Ladder", seed: int) -> form.Reductions | None:
    """The gap before and after the winner was added; None if its runs failed."""
    if WINNER not in ladder.fitted.simulated:
        return None
    folds = fold_fractions(ladder)
    left_out = [
        fractions[WINNER]
        for (_, held), fractions in folds.items()
        if WINNER in fractions and not held
    ]
    held = [
        fractions[WINNER] for (_, held), fractions in folds.items() if WINNER in fractions and held
    ]
    held_out = None
    if ladder.held_out is not None and WINNER in ladder.held_out.simulated:
        held_out = group_reduction(ladder.held_out, seed, held)
    return form.Reductions(fitted=group_reduction(ladder.fitted, seed, left_out), held_out=held_out)


def group_reduction(group: "Group", seed: int, values: Sequence[float]) -> form.Reduction:
    """The `Reduction` of a group of experiments; the range of the whole also covers `values`."""
    observable = group.points.observable
    everything = np.ones(len(group.points), bool)
    overall = closing(group, WINNER, everything, seed, values=values)
    by_observable = {}
    for block in group.points.blocks:
        if block.observable not in by_observable:
            rows = observable == block.observable
            part = closing(group, WINNER, rows, seed, in_units=True)
            by_observable[block.observable] = closed(part, block.units)
    return form.Reduction(overall=closed(overall, SIZE_UNITS), by_observable=by_observable)


def closed(part: "Closing", units: str) -> form.Closed:
    """A `Closing` as the report has it."""
    return form.Closed(
        before=part.before,
        after=part.after,
        fraction_closed=part.fraction,
        interval=part.interval,
        units=units,
    )


def rungs(analysis: "Analysis", ladder: "Ladder") -> list[form.Rung]:
    """The models of the ladder."""
    parts, units = [], units_of_keys()
    folds = fold_fractions(ladder)
    for model, fit in ladder.fits.items():
        if model not in ladder.fitted.simulated:
            continue
        held = None
        if ladder.held_out is not None and model in ladder.held_out.simulated:
            values = [
                fractions[model]
                for (_, held), fractions in folds.items()
                if model in fractions and held
            ]
            held = misfit(ladder.held_out, model, analysis.seed, values)
        values = [
            fractions[model]
            for (_, held), fractions in folds.items()
            if model in fractions and not held
        ]
        parts.append(
            form.Rung(
                model=model,
                effects=sorted(fit.effects),
                fitted=misfit(
                    ladder.fitted, model, analysis.seed, values, ladder.predicted.get(model)
                ),
                held_out=held,
                parameters={
                    f"{name}.{key}": value
                    for name, (closure, u) in fit.effects.items()
                    for key, value in parameters(closure, (u,), units).items()
                },
                calibrated={} if model == BASELINE else calibrated(ladder.quantities, fit.z, units),
            )
        )
    return parts


def calibrated(
    quantities: "Sequence[Nuisance]", z: np.ndarray, units: Mapping[str, str]
) -> dict[str, form.Parameter]:
    """{key: `Parameter`} of the calibrated parameters; each once, though experiments may differ."""
    parts = {}
    for quantity, shift in zip(quantities, z, strict=True):
        name = quantity.key
        if name in parts:
            name = f"{name} ({', '.join(quantity.experiments)})"
        parts[name] = form.Parameter(
            value=quantity.value(shift),
            low=None,
            high=None,
            units=units[quantity.key],
            prior=form.PriorRange(kind="normal", first=quantity.mean, second=quantity.sd),
        )
    return parts


def misfit(
    group: "Group",
    model: str,
    seed: int,
    values: Sequence[float] = (),
    predicted: np.ndarray | None = None,
) -> form.Misfit:
    """The `Misfit` of a model over a group."""
    z = gaps_of(group, model) / np.sqrt(np.diag(group.covariance))
    everything = np.ones(len(z), bool)
    fraction = interval = foreseen = None
    if model != BASELINE:
        change = closing(group, model, everything, seed, values=values)
        fraction, interval = change.fraction, change.interval
        if predicted is not None:
            again = with_simulated(group, {model: predicted})
            foreseen = closing(again, model, everything, seed).fraction
    return form.Misfit(
        rms=rms(z),
        fraction_closed=fraction,
        interval=interval,
        predicted=foreseen,
        by_experiment={name: rms(z[group.points.of(name)]) for name in group.points.names},
    )


def rms(z: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(z**2)))


def confirmation_of(tests: "ConfirmationTests | None") -> form.Confirmation | None:
    """`ConfirmationTests` as the report has them; None where there are none."""
    if tests is None:
        return None
    folds = [
        form.Fold(
            experiment=fold.experiment,
            winner=fold.winner,
            runner_up=fold.rival,
            held_out=fold.held_out,
            winner_left=fold.winner_left,
            runner_up_left=fold.rival_left,
        )
        for fold in tests.folds
    ]
    return form.Confirmation(
        wording=tests.strength,  # type: ignore[arg-type]
        reasons=confirmation_reasons(tests),
        folds=folds,
    )
