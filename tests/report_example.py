"""A report such as a diagnosis of three fitted and one held-out collapse leaves, from analytic curves.

What no test looks at is filled in from the types of the schema.
"""

import typing

import msgspec
import numpy as np
from msgspec.structs import replace
from report_curves import EVERY, FITTED, HELD_OUT, SIGMA, SLOPE, WIDTH, comparison, with_regions

from fvcollapse.diagnosis.names import BASELINE, RECALIBRATED, RUNNER_UP, WINNER
from fvcollapse.diagnosis.report import schema as form
from fvcollapse.diagnosis.report.unexplained_words import sentence
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import NUISANCE
from fvcollapse.measure.quantities import QUANTITIES

EFFECTS = tuple(name for name, effect in CATALOGUE.items() if effect.kind != NUISANCE)


# -- from the schema -----------------------------------------------------------------------------


def made(part, /, **given):
    """A part of the report; required fields that are not given are filled in by their type."""
    required = [f for f in msgspec.structs.fields(part) if f.required and f.name not in given]
    return part(**given, **{field.name: filler(field.type, field.name) for field in required})


def filler(annotation, name):
    """A value of a type: the name as a text, 0.5, 1, an empty list or dict, None where it may be."""
    options = typing.get_args(annotation)
    origin = typing.get_origin(annotation)
    if origin is typing.Literal:
        return options[0]
    if type(None) in options:
        return None
    return {str: name, float: 0.5, int: 1, bool: True, list: [], dict: {}}[origin or annotation]


# -- sizes ---------------------------------------------------------------------------------------


def rms(parts):
    """Root mean square of arrays."""
    return float(np.sqrt(np.mean(np.concatenate(list(parts)) ** 2)))


def rms_z(comparisons, model, experiments):
    """Root mean square of z over some experiments."""
    return rms(pair.z[model] for pair in comparisons if pair.experiment in experiments)


def rms_gap(comparisons, model):
    """Root mean square gap."""
    return rms(pair.simulated[model] - pair.measured for pair in comparisons)


def sizes(comparisons):
    """The gap of each observable over the fitted experiments."""
    found = {}
    for name in SIGMA:
        mine = [pair for pair in comparisons if pair.observable == name]
        mine = [pair for pair in mine if pair.experiment in FITTED]
        gap, sd = rms_gap(mine, BASELINE), rms(pair.combined for pair in mine)
        count = sum(len(pair.measured) for pair in mine)
        found[name] = form.ObservableGap(gap, sd, gap / sd, QUANTITIES[name].unit, count)
    return found


def closed(before, after, units):
    """A gap before and after."""
    share = 1.0 - after / before
    return form.Closed(
        before, after, share, (max(share - 0.1, -1.0), min(share + 0.05, 1.0)), units
    )


def reduction(comparisons, experiments):
    """Before and after with the winner, overall and by observable."""
    overall = [rms_z(comparisons, model, experiments) for model in (BASELINE, WINNER)]
    parts = {}
    for name in (name for name in SIGMA if name != "volume"):
        mine = [pair for pair in comparisons if pair.observable == name]
        mine = [pair for pair in mine if pair.experiment in experiments]
        both = [rms_gap(mine, model) for model in (BASELINE, WINNER)]
        parts[name] = closed(*both, QUANTITIES[name].unit)
    return form.Reduction(closed(*overall, "standard uncertainties beyond the noise"), parts)


def misfit(comparisons, model, experiments):
    """Gap of a model over a group of experiments."""
    before, after = (rms_z(comparisons, which, experiments) for which in (BASELINE, model))
    share = 1.0 - after / before
    foreseen = {"interval": (share - 0.08, min(share + 0.06, 1.0)), "predicted": share - 0.03}
    return form.Misfit(
        rms=after,
        fraction_closed=share,
        by_experiment={name: rms_z(comparisons, model, [name]) for name in experiments},
        **({} if model == BASELINE else foreseen),
    )


# -- causes --------------------------------------------------------------------------------------


def parameters(name, place=0.4):
    """The parameters of an effect at the quantile `place` of their priors, with intervals."""
    found = {}
    for key, prior in CATALOGUE[name].priors.items():
        quantiles = (place, 0.7 * place, 1.0 - 0.7 * (1.0 - place))
        numbers = (float(prior.distribution().ppf(quantile)) for quantile in quantiles)
        found[key] = form.Parameter(*numbers, "-", form.PriorRange(**prior._asdict()))
    return found


def separability(rng):
    """Signatures in which the second and the third effect look alike."""
    vectors = rng.standard_normal((len(EFFECTS), 6))
    vectors[2] = vectors[1] + 0.15 * rng.standard_normal(6)
    norm = np.linalg.norm(vectors, axis=1)
    cosine = vectors @ vectors.T / np.outer(norm, norm)
    alike = list(EFFECTS[1:3])
    return form.Separability(
        names=list(EFFECTS),
        cosine=cosine,
        distance_squared=norm[:, None] ** 2 * (1.0 - cosine**2),
        unique_snr=norm,
        threshold=3.0,
        classes=[alike, *([name] for name in EFFECTS if name not in alike)],
        split_by={", ".join(alike): "front positions every 10 ms before 0.15 s"},
    )


def rung(comparisons, model, effects):
    """One model, fitted and held out."""
    prior = made(form.PriorRange, kind="normal", first=0.48, second=0.015)
    mu_1 = form.Parameter(0.492, 0.481, 0.503, "-", prior)
    return form.Rung(
        model=model,
        effects=effects,
        fitted=misfit(comparisons, model, FITTED),
        held_out=misfit(comparisons, model, HELD_OUT),
        calibrated={} if model == BASELINE else {"rheology.mu_1": mu_1},
        parameters={f"{name}.{key}": p for name in effects for key, p in parameters(name).items()},
    )


def confirmation():
    """A cause that the runs support without confirming it."""
    folds = [form.Fold(name, 0.7, 0.4 + 0.15 * n) for n, name in enumerate(FITTED)]
    return form.Confirmation(
        wording="consistent with",
        reasons=["it beats the runner-up on the held-out experiment and in 2 of 3 folds"],
        folds=[
            *folds,
            form.Fold(HELD_OUT[0], 1.0, 1.0, True, winner_left=0.62, runner_up_left=0.81),
        ],
    )


def with_remainder(report):
    """The report with the sizes in practice and a remainder: thin layers at the front, late."""
    found = next(one for one in report.where if one.observable == "profiles")
    part = form.Unexplained(
        beside="none",
        p_value=1e-6,
        regions=[found],
        shares=[
            form.PlaceShare("thin part", "deposit", 0.6, 1.0),
            form.PlaceShare("front", "arrest", 0.37, 1.0),
            form.PlaceShare("middle", "arrest", 0.03, 0.0),
        ],
        sizes={"profiles": form.RemainderSize(0.0043, 0.0041, 3.2, "m")},
        direction=1.0,
        experiment=found.experiment,
        t_range=(0.62, 1.4),
        span=(0.04, 1.4),
        resembles=[
            form.Likeness(EFFECTS[0], 0.83, 2.14, ["front"]),
            form.Likeness(EFFECTS[1], -0.4, 0.0, []),
        ],
    )
    practical = {
        "profiles": form.Practical(0.0043, 0.0034, 0.625, 0.0026, "m", None, 0.00196, True),
        "front": form.Practical(0.02, 0.0, 0.0, 0.018, "m", None, 0.05, False),
    }
    unexplained = replace(part, words=sentence(part))
    return replace(
        report, details=replace(report.details, practical=practical, unexplained=unexplained)
    )


def example(kind="effect", probable=0.87):
    """A report with a given verdict."""
    rng = np.random.default_rng(7)
    is_named = kind in ("effect", "several")
    models = (BASELINE, RECALIBRATED, WINNER, RUNNER_UP)[: 4 if is_named else 2]
    pairs = [comparison(name, observable, rng, models) for name in EVERY for observable in SIGMA]
    marked, regions = (pairs, []) if kind == "none" else with_regions(pairs)
    names, top = [*EFFECTS, "none", "unknown"], EFFECTS[0] if is_named else kind
    effects = {"effect": [EFFECTS[0]], "several": list(EFFECTS[:2])}.get(kind, [])
    share = (1.0 - probable) / (len(names) - 1)
    probability = dict.fromkeys(names, share) | {top: probable}
    evidence = {name: 812.0 - 3.0 * n for n, name in enumerate(names)} | {"none": 590.2}
    groups = (FITTED, HELD_OUT)
    return made(
        form.Report,
        experiments=list(FITTED),
        held_out=list(HELD_OUT),
        baseline_case="[geometry]\nslope_angle_deg = 22.0\n\n[rheology]\nmu_1 = 0.48\n",
        where=regions,
        by_observable=sizes(pairs),
        verdict=form.Verdict(kind, effects, [list(EFFECTS[1:3])], probability, [top]),
        candidates={
            name: form.Candidate(
                probability[name], evidence[name], parameters(name), name != EFFECTS[-1]
            )
            for name in EFFECTS
        },
        reduction=form.Reductions(*(reduction(pairs, g) for g in groups)) if is_named else None,
        next_experiment=made(form.NextExperiment, separates=list(EFFECTS[:2]), repeats=2),
        cost=form.Cost(solver_runs=31, wall_time_s=412.0, cell_size=0.012, cached_runs=16),
        details=details(marked, models, evidence, rng, top, is_named),
    )


def details(comparisons, models, evidence, rng, top, is_named):
    """What the page shows beyond the stable keys."""
    rivals = {WINNER: [EFFECTS[0]], RUNNER_UP: [EFFECTS[1]]}
    share = 1.0 / sum(len(set(pair.phase)) for pair in comparisons if pair.experiment in FITTED)
    return form.Details(
        set_ups={
            name: made(form.SetUp, slope_angle_deg=SLOPE[name], channel_width=WIDTH[name])
            for name in EVERY
        },
        comparisons=comparisons,
        shares=[
            form.Share(pair.experiment, pair.observable, phase, share, 1 if n % 3 else -1)
            for n, pair in enumerate(comparisons)
            if pair.experiment in FITTED
            for phase in dict.fromkeys(pair.phase)
        ],
        budget={name: {"measurement": sd, "grid": 0.3 * sd} for name, sd in SIGMA.items()},
        hypotheses={
            name: form.HypothesisSummary(
                log_evidence=value,
                log_evidence_wide=value - 0.7,
                conformal_p=0.62 if name == top else 0.03,
                like_miscalibration=name == EFFECTS[1],
                absorbed_in=list(CATALOGUE[name].absorbed_in) if name in CATALOGUE else [],
            )
            for name, value in evidence.items()
        },
        separability=separability(rng),
        ladder=[rung(comparisons, model, rivals.get(model, [])) for model in models],
        confirmation=confirmation() if is_named else None,
        alternatives=[made(form.NextExperiment, separates=list(EFFECTS[:2]))],
        limits=["A friction mu_1 calibrated in this channel may already hold lateral friction."],
    )
