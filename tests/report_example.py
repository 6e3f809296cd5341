"""A report such as a diagnosis of three fitted and one held-out collapse leaves, from analytic curves.

The front follows x_f = L + R tanh^2(t / T), the thickness h = H (1 - (x / x_f)^2) with the volume kept,
the interface half of it behind the front. The "measurement" has a smaller reach R than the model,
as with lateral friction, and noise of its stated standard deviation.
"""

import numpy as np

from fvcollapse.diagnosis.report import (
    BASELINE,
    RECALIBRATED,
    RUNNER_UP,
    WINNER,
    Candidate,
    Closed,
    Comparison,
    Confirmation,
    Cost,
    Details,
    Fold,
    Hypothesis,
    Misfit,
    NextExperiment,
    ObservableGap,
    Parameter,
    PriorRange,
    Reduction,
    Reductions,
    Region,
    Report,
    Rung,
    Separability,
    SetUp,
    Share,
    Verdict,
)
from fvcollapse.diagnosis.report_words import observable_name
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import NUISANCE

FITTED = ("collapse_00deg_w10cm", "collapse_16deg_w10cm", "collapse_22deg_w10cm")
HELD_OUT = ("collapse_22deg_w20cm",)
SLOPE = dict(zip((*FITTED, *HELD_OUT), (0.0, 16.0, 22.0, 22.0), strict=True))
WIDTH = dict(zip((*FITTED, *HELD_OUT), (0.10, 0.10, 0.10, 0.20), strict=True))
HEIGHT, LENGTH = 0.14, 0.20  # m
REACH_TOO_FAR = {BASELINE: 0.28, RECALIBRATED: 0.10, WINNER: 0.01, RUNNER_UP: 0.07}
SIGMA = {"front": 0.01, "profiles": 0.002, "interface": 0.003, "volume": 0.01}
UNITS = {"front": "m", "profiles": "m", "interface": "m", "volume": "1", "runout": "m"}
PROFILE_TIMES = (0.1, 0.2, 0.32, 0.48, 0.7, 0.95, 1.4)
FRONT_TIMES = np.linspace(0.04, 1.4, 25)
EFFECTS = tuple(name for name, effect in CATALOGUE.items() if effect.kind != NUISANCE)


def reach(experiment, model=None):
    """How far the front advances [m]; model None: measured."""
    slope = SLOPE[experiment] / 22.0
    walls = 0.5 if WIDTH[experiment] == 0.20 else 1.0
    excess = REACH_TOO_FAR[model] * walls * (0.4 + 0.6 * slope) if model else 0.0
    return (0.30 + 0.55 * slope) * (1.0 + excess)


def front(experiment, time, model=None):
    """Position of the front [m]."""
    return LENGTH + reach(experiment, model) * np.tanh(time / 0.45) ** 2


def thickness(experiment, time, x, model=None):
    """Thickness normal to the bed [m]."""
    x_f = front(experiment, time, model)
    return 1.5 * HEIGHT * LENGTH / x_f * np.maximum(1.0 - (x / x_f) ** 2, 0.0)


def value(experiment, observable, time, x, model=None):
    """Any observable on its points."""
    if observable == "front":
        return front(experiment, time, model)
    if observable == "profiles":
        return thickness(experiment, time, x, model)
    if observable == "interface":
        return 0.5 * thickness(experiment, time, x, model) * np.minimum(time / 0.5, 1.0)
    if observable == "volume":
        return np.zeros_like(time) if model else 0.004 * np.tanh(time)
    return np.array([front(experiment, 3.0, model)])


def points(experiment, observable):
    """(time, x) of the points of an observable; None where it has none."""
    if observable == "front":
        return FRONT_TIMES, None
    if observable == "volume":
        return FRONT_TIMES[::3], None
    if observable == "runout":
        return None, None
    places = {"profiles": (PROFILE_TIMES, 22), "interface": (PROFILE_TIMES[:5], 8)}[observable]
    rows = [
        (np.full(places[1], t), np.linspace(0.01, 1.08 * front(experiment, t), places[1]))
        for t in places[0]
    ]
    return tuple(np.concatenate(column) for column in zip(*rows, strict=True))


def comparison(experiment, observable, rng, models):
    """One observable of one experiment, with z and the region of its significant points."""
    time, x = points(experiment, observable)
    truth = value(experiment, observable, time, x)
    sigma = np.full(len(truth), SIGMA.get(observable, 0.012))
    if observable == "profiles":
        sigma = sigma * (1.0 + 1.5 * (x > 0.9 * front(experiment, time)))
    measured = truth + sigma * rng.standard_normal(len(truth))
    combined = np.hypot(sigma, 0.03 * np.abs(truth) + 0.5 * sigma)
    simulated = {model: value(experiment, observable, time, x, model) for model in models}
    return Comparison(
        experiment=experiment,
        observable=observable,
        units=UNITS[observable],
        time=time,
        x=x,
        measured=measured,
        sigma=sigma,
        combined=combined,
        simulated=simulated,
        z={model: (values - measured) / combined for model, values in simulated.items()},
        region=[None] * len(truth),
        phase=[
            "deposit"
            if t > 1.0
            else "arrest"
            if t > 0.7
            else "spreading"
            if t > 0.15
            else "release"
            for t in (time if time is not None else [9.0])
        ],
    )


def with_regions(comparisons):
    """(comparisons with the region of each point, regions): those beyond 2 and where the gap is positive."""
    regions, marked = [], []
    for one in comparisons:
        z = one.z[BASELINE]
        inside = np.abs(z) > 2.0
        if one.experiment in HELD_OUT or one.time is None or inside.sum() < 4:
            marked.append(one)
            continue
        index = np.full(len(z), -1)
        for sign in (1, -1):
            here = inside & (np.sign(z) == sign)
            if here.sum() >= 4:
                index[here] = len(regions)
                regions.append(region(one, here))
        marked.append(replaced(one, region=[int(n) if n >= 0 else None for n in index]))
    return marked, regions


def replaced(one, **changes):
    """A comparison with other columns."""
    from msgspec.structs import replace

    return replace(one, **changes)


def region(one, here):
    """The region of the points `here`."""
    gap = (one.simulated[BASELINE] - one.measured)[here]
    x_range = None if one.x is None else (float(one.x[here].min()), float(one.x[here].max()))
    return Region(
        experiment=one.experiment,
        observable=one.observable,
        t_range=(float(one.time[here].min()), float(one.time[here].max())),
        x_range=x_range,
        gap=float(gap.mean()),
        gap_sd=float(one.combined[here].mean()),
        units=one.units,
        significance=float(np.abs(one.z[BASELINE][here]).max()),
        p_value=0.002,
    )


def gaps(comparisons):
    """The gap of each observable over the fitted experiments."""
    found = {}
    for name in dict.fromkeys(one.observable for one in comparisons):
        mine = [one for one in comparisons if one.observable == name and one.experiment in FITTED]
        gap = np.concatenate([one.simulated[BASELINE] - one.measured for one in mine])
        combined = np.concatenate([one.combined for one in mine])
        rms, sd = np.sqrt(np.mean(gap**2)), np.sqrt(np.mean(combined**2))
        found[name] = ObservableGap(
            rms_gap=rms,
            combined_uncertainty=sd,
            ratio=rms / sd,
            units=mine[0].units,
            points=len(gap),
        )
    return found


def rms_z(comparisons, model, experiments):
    """Root mean square of z over some experiments."""
    parts = [one.z[model] for one in comparisons if one.experiment in experiments]
    return float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))


def misfit(comparisons, model, experiments):
    """Gap of a model over a group of experiments."""
    before, after = (rms_z(comparisons, which, experiments) for which in (BASELINE, model))
    closed = 1.0 - after / before
    return Misfit(
        rms=after,
        fraction_closed=closed,
        interval=None if model == BASELINE else (closed - 0.08, min(closed + 0.06, 1.0)),
        predicted=None if model == BASELINE else closed - 0.03,
        by_experiment={name: rms_z(comparisons, model, [name]) for name in experiments},
    )


def reduction(comparisons, experiments):
    """Before and after with the winner, overall and by observable."""

    def part(chosen, units, measure):
        before, after = measure(chosen, BASELINE), measure(chosen, WINNER)
        closed = 1.0 - after / before
        span = (max(closed - 0.1, -1.0), min(closed + 0.05, 1.0))
        return Closed(
            before=before, after=after, fraction_closed=closed, interval=span, units=units
        )

    def rms_gap(chosen, model):
        gap = np.concatenate([one.simulated[model] - one.measured for one in chosen])
        return float(np.sqrt(np.mean(gap**2)))

    mine = [one for one in comparisons if one.experiment in experiments]
    names = dict.fromkeys(one.observable for one in mine if one.observable != "volume")
    units = "standard uncertainties beyond the noise"
    return Reduction(
        overall=part(mine, units, lambda chosen, model: rms_z(chosen, model, experiments)),
        by_observable={
            name: part([one for one in mine if one.observable == name], UNITS[name], rms_gap)
            for name in names
        },
    )


def parameter(name, key, place):
    """A parameter at the quantile `place` of its prior, with an interval."""
    prior = CATALOGUE[name].priors[key]
    law = prior.distribution()
    value, low, high = (float(law.ppf(q)) for q in (place, 0.7 * place, 1.0 - 0.7 * (1.0 - place)))
    return Parameter(
        value=value, low=low, high=high, units="-", prior=PriorRange(**prior._asdict())
    )


def separability(rng):
    """Signatures in which the second and the third effect look alike."""
    k = len(EFFECTS)
    vectors = rng.standard_normal((k, 6))
    vectors[2] = vectors[1] + 0.15 * rng.standard_normal(6)
    norm = np.linalg.norm(vectors, axis=1)
    cosine = vectors @ vectors.T / np.outer(norm, norm)
    squared = norm[:, None] ** 2 * (1.0 - cosine**2)
    alike = list(EFFECTS[1:3])
    return Separability(
        names=list(EFFECTS),
        cosine=cosine,
        distance_squared=squared,
        unique_snr=norm,
        threshold=3.0,
        classes=[alike, *([name] for name in EFFECTS if name not in alike)],
        split_by={", ".join(alike): "front positions every 10 ms before 0.15 s"},
    )


def ladder(comparisons, models, first, second):
    """The four models, fitted and held out."""
    effects = {WINNER: [first], RUNNER_UP: [second]}
    mu_1 = PriorRange(kind="normal", first=0.48, second=0.015, source="stated with the case")
    return [
        Rung(
            model=model,
            effects=effects.get(model, []),
            fitted=misfit(comparisons, model, FITTED),
            held_out=misfit(comparisons, model, HELD_OUT),
            calibrated=(
                {}
                if model == BASELINE
                else {
                    "rheology.mu_1": Parameter(
                        value=0.492, low=0.481, high=0.503, units="-", prior=mu_1
                    )
                }
            ),
            parameters={
                f"{name}.{key}": parameter(name, key, 0.4)
                for name in effects.get(model, [])
                for key in list(CATALOGUE[name].priors)[:1]
            },
        )
        for model in models
    ]


def example(kind="effect", probable=0.87):
    """A report with a given verdict."""
    rng = np.random.default_rng(7)
    named = kind in ("effect", "several")
    models = (BASELINE, RECALIBRATED, WINNER, RUNNER_UP) if named else (BASELINE, RECALIBRATED)
    comparisons = [
        comparison(experiment, observable, rng, models)
        for experiment in (*FITTED, *HELD_OUT)
        for observable in UNITS
    ]
    comparisons, regions = with_regions(comparisons)
    first, second = EFFECTS[:2]
    rest = (1.0 - probable) / (len(EFFECTS) + 1)
    names = [*EFFECTS, "none", "unknown"]
    top = {"effect": first, "several": first}.get(kind, kind)
    probability = {name: probable if name == top else rest for name in names}
    evidence = {name: 812.0 - 3.0 * n for n, name in enumerate(names)} | {"none": 590.2}
    hypotheses = {
        name: Hypothesis(
            log_evidence=value,
            log_evidence_wide=value - 0.7,
            conformal_p=0.62 if name == top else 0.03,
            predictive_p=0.31,
            like_miscalibration=name == second,
            absorbed_in=list(CATALOGUE[name].absorbed_in) if name in CATALOGUE else [],
        )
        for name, value in evidence.items()
    }
    total = len(comparisons)
    return Report(
        experiments=list(FITTED),
        held_out=list(HELD_OUT),
        baseline_case='[geometry]\nslope_angle_deg = 22.0\nheight_0 = 0.14\n\n[rheology]\nlaw = "mu_I"\nmu_1 = 0.48\n',
        where=[] if kind == "none" else regions,
        by_observable=gaps(comparisons),
        verdict=Verdict(
            kind=kind,
            effects={"effect": [first], "several": [first, second]}.get(kind, []),
            indistinguishable=[list(EFFECTS[1:3])],
            probability=probability,
            set=[top],
        ),
        candidates={
            name: Candidate(
                probability=probability[name],
                log_evidence=evidence[name],
                parameters={key: parameter(name, key, 0.4) for key in CATALOGUE[name].priors},
                plausible=name != EFFECTS[-1],
            )
            for name in EFFECTS
        },
        reduction=(
            Reductions(
                fitted=reduction(comparisons, FITTED), held_out=reduction(comparisons, HELD_OUT)
            )
            if named
            else None
        ),
        next_experiment=NextExperiment(
            description="a channel 5 cm wide at 16\N{DEGREE SIGN}, front every 20 ms",
            separates=[first, second],
            expected_gain=0.41,
            set_up={"geometry.channel_width": 0.05, "geometry.slope_angle_deg": 16.0},
            repeats=2,
        ),
        cost=Cost(solver_runs=31, wall_time_s=412.0, cell_size=0.012, cached_runs=16),
        details=Details(
            set_ups={
                name: SetUp(
                    title=f"Collapse at {SLOPE[name]:g}\N{DEGREE SIGN}, channel {100 * WIDTH[name]:g} cm wide",
                    source="analytic curves of the test suite",
                    slope_angle_deg=SLOPE[name],
                    height_0=HEIGHT,
                    length_0=LENGTH,
                    channel_width=WIDTH[name],
                )
                for name in (*FITTED, *HELD_OUT)
            },
            comparisons=[
                replaced(one, region=[None] * len(one.measured)) if kind == "none" else one
                for one in comparisons
            ],
            shares=[
                Share(
                    experiment=one.experiment,
                    observable=one.observable,
                    phase=phase,
                    share=1.0 / total / len(set(one.phase)),
                    sign=1 if n % 3 else -1,
                )
                for n, one in enumerate(comparisons)
                if one.experiment in FITTED
                for phase in dict.fromkeys(one.phase)
            ],
            budget={
                name: {
                    "measurement": SIGMA.get(name, 0.012),
                    "run level": 0.4 * SIGMA.get(name, 0.012),
                    "grid": 0.3 * SIGMA.get(name, 0.012),
                    "calibrated parameters": 0.8 * SIGMA.get(name, 0.012),
                }
                for name in UNITS
            },
            hypotheses=hypotheses,
            separability=separability(rng),
            ladder=ladder(comparisons, models, first, second),
            confirmation=(
                Confirmation(
                    wording="consistent with",
                    reasons=[
                        "it beats the runner-up on the held-out experiment and in 2 of 3 folds",
                        f"its {observable_name('profiles')} gap passes the predictive check",
                    ],
                    folds=[
                        Fold(experiment=name, winner=0.7, runner_up=0.4 + 0.15 * n)
                        for n, name in enumerate(FITTED)
                    ]
                    + [Fold(experiment=HELD_OUT[0], winner=0.55, runner_up=0.4, held_out=True)],
                )
                if named
                else None
            ),
            alternatives=[
                NextExperiment(
                    description="a second gate speed of 1 m/s at 0\N{DEGREE SIGN}",
                    separates=[first, second],
                    expected_gain=0.22,
                    repeats=4,
                )
            ],
            limits=[
                "With three fitted experiments the intervals are the range of the leave-one-out values.",
                "A friction mu_1 calibrated in this channel may already hold part of the lateral friction.",
            ],
        ),
    )
