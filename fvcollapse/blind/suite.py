"""Cases by the hundred through the evidence of the diagnosis, and the verdict that is fitted to them.

    study     every case of a folder -> one small file of evidence each; no label is read
    train     these files and the labels of a training suite -> the verdict layer of the diagnosis
    answers   these files and a verdict layer -> answers to a blind suite
    distances after the reveal: how far each true cause is from its nearest rival

All cases of a set-up share its library of runs, which is computed once, through the cache.
"""

import json
from pathlib import Path

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.stats import chi2

from fvcollapse.blind.evidence_form import FORMAT, read_content
from fvcollapse.blind.generator import BLIND, TRAINING, draw_pair, known_effects
from fvcollapse.blind.make import make, read_labels
from fvcollapse.blind.metrics import Outcome, all_scores
from fvcollapse.blind.verdict_training import FOLDS, fit
from fvcollapse.diagnosis.analysis import analyse
from fvcollapse.diagnosis.evidence import Evidence, Hypothesis
from fvcollapse.diagnosis.mass_balance import MassBalance
from fvcollapse.diagnosis.names import EFFECT, NONE, SEVERAL, UNKNOWN
from fvcollapse.diagnosis.question import Question
from fvcollapse.diagnosis.runner import Runner
from fvcollapse.diagnosis.separability import DISCREPANCY, separability
from fvcollapse.diagnosis.verdict import verdict
from fvcollapse.diagnosis.verdict_features import class_of
from fvcollapse.diagnosis.verdict_model import class_prior
from fvcollapse.errors import FvcollapseError, InputError, NumericalError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.files.targets import make_folder
from fvcollapse.measure.experiment import SETTINGS, load_experiment
from fvcollapse.output.fingerprint import solver_version
from fvcollapse.studies.workers import run_all

SHARES = {NONE: 1.5, UNKNOWN: 1.5, SEVERAL: 1.0}  # cases of a class over those of an effect
QUANTILE_ENDS = 0.002  # of parameters that are told: some priors have no end
LEVEL = 0.01  # p-value of the chi-square baseline
BASELINE_PROBABILITY = 0.9  # that the simple answers give to what they name
EMPTY = np.empty(0)
# numbers of a hypothesis that a file keeps, and arrays
NUMBERS = ("log_evidence", "log_evidence_wide", "log_prior", "sigma", "p_value", "residual_outside")
ARRAYS = ("u", "low", "high")


class SharingRunner(Runner):
    """A `Runner` that keeps what it has read, for the next case of the same design."""

    kept, design = {}, None

    @classmethod
    def begin(cls, design):
        """Forget what belongs to another design."""
        if design != cls.design:
            cls.kept.clear()
            cls.design = design

    def observations(self, wanted):
        """See `Runner.observations`."""
        keys = {
            label: (case, experiment.front_thickness, experiment.time_origin)
            for label, (experiment, case) in wanted.items()
        }
        missing = {label: wanted[label] for label, key in keys.items() if key not in self.kept}
        seen, failures = super().observations(missing) if missing else ({}, {})
        for label, observations in seen.items():
            self.kept[keys[label]] = observations
        found = {label: self.kept[key] for label, key in keys.items() if key in self.kept}
        return found, failures


# -- evidence of every case --------------------------------------------------------------------------------


def study(folder, out, workers=1, scheduler=None, quiet=True, **options):
    """Write the evidence of every case of a folder; what is there is kept.

    Parameters
    ----------
    folder : str or Path
        As `make` leaves it.
    out : str or Path
        Gets `<case>.json`.
    workers, scheduler, quiet
        See `workers.run_all`.
    **options
        `cache`, `cell_size`, `draws`, `effects`, `refinements` and `seed` of the diagnosis.

    Returns
    -------
    dict
        Case -> NumericalError, of those that could not be compared.
    """
    out = make_folder(Path(out).absolute())
    designs = {}
    for case in case_folders(folder):
        path = out / f"{case.name}.json"
        if not path.exists():
            designs.setdefault(design_of(case), []).append((case, path))
    calls, failed = {}, {}
    for cases in designs.values():  # the first of each design computes the library
        (case, path), *rest = cases
        keep_evidence(case, path, options, workers, scheduler, quiet)
        calls |= {case.name: (case, path, options) for case, path in rest}

    def finished(name, outcome):
        if isinstance(outcome, NumericalError):
            failed[name] = outcome
        elif isinstance(outcome, FvcollapseError):
            raise outcome

    run_all(keep_evidence, calls, finished, workers, scheduler, quiet)
    return failed


def case_folders(folder):
    """Folders of the cases, in order."""
    folder = Path(folder).absolute()
    found = sorted({path.parent.parent for path in folder.glob(f"*/*/{SETTINGS}")})
    if not found:
        raise InputError(folder, "folder", "no cases", "a folder that blind make has written")
    return found


def design_of(case):
    """Names of the experiments of a case."""
    return tuple(sorted(path.parent.name for path in case.glob(f"*/{SETTINGS}")))


def analysis_of(case, options, workers=1, scheduler=None, quiet=True):
    """The `Analysis` of a case."""
    options, design = dict(options), design_of(case)
    SharingRunner.begin(design)
    runner = SharingRunner(options.pop("cache", None), workers, scheduler, quiet)
    experiments = tuple(load_experiment(case / name) for name in design)
    asked = {key: options.pop(key) for key in ("cell_size", "seed") if key in options}
    return analyse(Question(experiments, **asked), runner, **options)


def keep_evidence(case, path, options, workers=1, scheduler=None, quiet=True):
    """Write the evidence of one case."""
    analysis = analysis_of(case, options, workers, scheduler, quiet)
    write_atomic(path, (json.dumps(summary(analysis)) + "\n").encode())


def summary(analysis):
    """What a file keeps of an analysis."""
    return {
        "format": FORMAT,
        "solver": solver_version(),
        "experiments": list(analysis.points.names),
        "hypotheses": {
            name: kept_hypothesis(analysis, each)
            for name, each in analysis.evidence.hypotheses.items()
        },
        "mass_balance": kept_balance(analysis.evidence.balance),
        "classes": [list(group) for group in analysis.separability.classes],
        "simple": {"chi_square": chi_square(analysis), "signature": signature(analysis)},
    }


def kept_balance(balance):
    """A `MassBalance` as plain values, None if there is none."""
    return None if balance is None else [part.tolist() for part in balance]


def kept_hypothesis(analysis, hypothesis):
    """A hypothesis as plain values, with the parameters of a single effect."""
    kept = {name: float(getattr(hypothesis, name)) for name in NUMBERS}
    kept |= {name: getattr(hypothesis, name).tolist() for name in ARRAYS}
    kept |= {"variant": list(hypothesis.variant), "p_by_run": hypothesis.p_by_run}
    if hypothesis.name in analysis.library.closures:
        closure = analysis.library.closures[hypothesis.name][hypothesis.variant[0]]
        inside = [
            np.clip(getattr(hypothesis, name), QUANTILE_ENDS, 1.0 - QUANTILE_ENDS)
            for name in ARRAYS
        ]
        value, low, high = (closure.values(u) for u in inside)
        kept["parameters"] = {
            name: {
                "value": value[name],
                "low": min(low[name], high[name]),
                "high": max(low[name], high[name]),
            }
            for name in value
        }
    return kept


def read_evidence(path):
    """(content, `Evidence`) of a file.

    Raises
    ------
    InputError
    """
    content = read_content(path)
    found = {
        name: Hypothesis(
            name=name,
            variant=tuple(each["variant"]),
            p_by_run=each["p_by_run"],
            p_by_phase={},
            difference=EMPTY,
            **{key: each[key] for key in NUMBERS},
            **{key: np.array(each[key]) for key in ARRAYS},
        )
        for name, each in content["hypotheses"].items()
    }
    kept = content["mass_balance"]
    balance = None if kept is None else MassBalance(*map(np.array, kept))
    return content, Evidence(found, balance)


# -- answers that take less thought ------------------------------------------------------------------------


def chi_square(analysis):
    """{hypothesis: (chi-square, p-value)} with independent errors of measurement and nothing else."""
    points = analysis.points
    use = points.kind == "value"
    sigma, gap = points.sigma[use], (analysis.baseline - points.measured)[use] / points.sigma[use]
    found = {NONE: float(gap @ gap)}
    for name, responses in analysis.responses.items():
        best = min(fit_of(gap, response.differences[:, use] / sigma) for response in responses)
        found[name] = best
    return {name: (value, float(chi2.sf(value, len(gap)))) for name, value in found.items()}


def fit_of(gap, levels):
    """Least square of gap + level over the levels that were run."""
    return float(((gap + levels) ** 2).sum(axis=1).min())


def signature(analysis):
    """{effect: cosine between the gap and its signature}, whitened; and p-value of no gap as `none`."""
    covariance = analysis.covariance + DISCREPANCY**2 * analysis.kernel
    factor = cholesky(covariance, lower=True, check_finite=False)
    gap = analysis.baseline - analysis.shift + analysis.expected - analysis.points.measured
    white = solve_triangular(factor, gap, lower=True, check_finite=False)
    found = {NONE: float(chi2.sf(white @ white, len(white)))}
    for name, responses in analysis.responses.items():
        middle = [response.at(np.full(response.dimension, 0.5)) for response in responses]
        columns = solve_triangular(factor, np.array(middle).T, lower=True, check_finite=False)
        lengths = np.linalg.norm(columns, axis=0) * np.linalg.norm(white)
        cosines = -(columns.T @ white) / np.where(lengths > 0.0, lengths, 1.0)
        found[name] = float(cosines.max())
    return found


def chi_square_answer(simple):
    """What a chi-square test and the best fit say."""
    values = simple["chi_square"]
    if values[NONE][1] >= LEVEL:
        return NONE
    best = min((name for name in values if name != NONE), key=lambda name: values[name][0])
    return best if values[best][1] >= LEVEL else UNKNOWN


def chi_square_ranking(simple):
    """The best fit of all effects, whatever its p-value, unless there is no gap."""
    values = simple["chi_square"]
    if values[NONE][1] >= LEVEL:
        return NONE
    return min((name for name in values if name != NONE), key=lambda name: values[name][0])


def signature_answer(simple):
    """The effect whose signature is nearest, unless there is no gap."""
    values = simple["signature"]
    if values[NONE] >= LEVEL:
        return NONE
    return max((name for name in values if name != NONE), key=values.get)


SIMPLE = {
    "chi_square_test": chi_square_answer,
    "chi_square_ranking": chi_square_ranking,
    "nearest_signature": signature_answer,
}


# -- training, answering -----------------------------------------------------------------------------------


def make_training(per_class, folder, seed, labels=None, first=None, **options):
    """Make a training suite: `per_class` cases of every effect, and of the others `SHARES` times that.

    They are in random order: the `first` of them, if that is given, are a smaller suite. See `make` for
    the rest.
    """
    classes = [name for name in known_effects() for _ in range(per_class)]
    counts = {name: round(share * per_class) for name, share in SHARES.items()}
    classes += [NONE] * counts[NONE] + [UNKNOWN] * counts[UNKNOWN]
    rng = np.random.default_rng([seed, 1])
    classes += [draw_pair(rng) for _ in range(counts[SEVERAL])]
    classes = rng.permutation(classes).tolist()[:first]
    style = options.pop("style", TRAINING)
    return make(len(classes), folder, labels, style=style, classes=classes, seed=seed, **options)


def read_suite(out, labels):
    """{case: (Evidence, entry of the labels)} of a suite whose labels are known."""
    cases = read_labels(labels)["cases"]
    return {
        name: (read_evidence(Path(out) / f"{name}.json")[1], entry)
        for name, entry in cases.items()
        if (Path(out) / f"{name}.json").exists()
    }


def train(suites, about=None):
    """The `VerdictModel` of one or more suites.

    Kinds of unknown that blind suites hide are left out of one that is used up: the next has them too.

    Parameters
    ----------
    suites : sequence of (str or Path, str or Path)
        Folder of the evidence, and labels, of each.
    """
    return fit_to([pair for suite in suites for pair in read_suite(*suite).values()], about)


def may_teach(pair):
    """Whether an (Evidence, entry of the labels) hides no kind of unknown that is kept for blind suites."""
    return pair[1]["label"]["unknown_kind"] not in BLIND.unknowns


def fit_to(pairs, about=None):
    """The `VerdictModel` of (Evidence, entry of the labels) pairs, of those that may teach."""
    pairs = [pair for pair in pairs if may_teach(pair)]
    cases = [(evidence, entry["label"]["cause"]) for evidence, entry in pairs]
    kinds = [entry["label"]["unknown_kind"] for _, entry in pairs]
    return fit(cases, known_effects(), about, kinds)


def answers(out, model=None, simple=None):
    """{case: answer} of every file of evidence in a folder.

    Parameters
    ----------
    out : str or Path
    model : VerdictModel, optional
    simple : str, optional
        Key of `SIMPLE`: the answers of that rule instead.
    """
    found = {}
    for path in sorted(Path(out).glob("*.json")):
        content, evidence = read_evidence(path)
        if simple is not None:
            found[path.stem] = simple_answer(SIMPLE[simple](content["simple"]), evidence)
            continue
        if model is not None and not model.covers(evidence):
            allowed = "a verdict layer that was fitted with them: fit it again"
            raise InputError(path, "hypotheses", "effects that the model does not know", allowed)
        found[path.stem] = answer(content, verdict(evidence, model))
    return found


def no_answer(names):
    """The answer to a case that could not be compared: what was known before, and every name open."""
    return {
        "verdict": UNKNOWN,
        "probability": class_prior(names),
        "set": list(names),
        "parameters": {},
    }


def answer(content, found):
    """A `Verdict` in the form of `score`."""
    return {
        "verdict": found.kind,
        "probability": found.probability,
        "set": list(found.set),
        "parameters": {
            name: content["hypotheses"][name]["parameters"]
            for name in found.effects
            if "parameters" in content["hypotheses"].get(name, {})
        },
    }


def simple_answer(name, evidence):
    """An answer that names one hypothesis."""
    others = [each for each in evidence.hypotheses if each != name and "+" not in each]
    share = (1.0 - BASELINE_PROBABILITY) / len(others)
    kind = name if name in (NONE, UNKNOWN) else EFFECT
    probability = {name: BASELINE_PROBABILITY} | dict.fromkeys(others, share)
    return {"verdict": kind, "probability": probability, "set": [name]}


def write_answers(path, found):
    """Write answers as JSON."""
    write_atomic(path, (json.dumps(found, indent=1) + "\n").encode(), running=False)


def cross_validated(suites, folds=FOLDS, leave_kind_out=True, seed=0):
    """All scores of a suite whose every case is judged by a model that had not seen it.

    Parameters
    ----------
    suites : sequence of (str or Path, str or Path)
        See `train`.
    leave_kind_out : bool
        A model that judges a kind of unknown has not seen that kind at all.
    """
    cases = [pair for suite in suites for pair in read_suite(*suite).values()]
    rng = np.random.default_rng(seed)
    part = np.empty(len(cases), int)
    groups = {}
    for number, (_, entry) in enumerate(cases):
        label = entry["label"]
        key = label["unknown_kind"] if leave_kind_out else None
        groups.setdefault((class_of(label["cause"]), key), []).append(number)
    for (_, kind), members in groups.items():
        if kind is None:
            part[rng.permutation(members)] = np.arange(len(members)) % folds
        else:
            part[members] = folds + sorted({k for _, k in groups if k}).index(kind)
    outcomes = []
    for number in np.unique(part):
        model = fit_to([pair for pair, own in zip(cases, part, strict=True) if own != number])
        for (evidence, entry), own in zip(cases, part, strict=True):
            if own == number:
                found, label = verdict(evidence, model), entry["label"]
                outcomes.append(
                    Outcome(
                        *(label["cause"], label["unknown_kind"], found.kind, found.probability),
                        found.set,
                    )
                )
    return all_scores(outcomes)


# -- after the reveal --------------------------------------------------------------------------------------


def distances(folder, labels, workers=1, scheduler=None, quiet=True, **options):
    """{case: d} of every case with a single effect: its distance to the nearest other hypothesis.

    d^2 is that of `diagnosis.separability`, at the strength and closure that were hidden, against every
    other effect at its median and a free amplitude, and against none.

    Parameters
    ----------
    folder, labels : str or Path
        Cases and their labels.
    **options
        As for `study`, with which the library has been computed.
    """
    found, calls = {}, {}
    for name, entry in read_labels(labels)["cases"].items():
        effects = entry["label"]["effects"]
        if len(effects) == 1:
            calls[name] = (Path(folder).absolute() / name, *next(iter(effects.items())), options)

    def finished(name, outcome):
        if isinstance(outcome, NumericalError):
            return
        if isinstance(outcome, FvcollapseError):
            raise outcome
        found[name] = outcome

    run_all(distance, calls, finished, workers, scheduler, quiet)
    return dict(sorted(found.items()))


def distance(case, effect, drawn, options):
    """D of one case; 0 where the effect changes nothing that was measured."""
    analysis = analysis_of(case, options)
    if effect not in analysis.responses:
        return 0.0
    closure = analysis.library.closures[effect][drawn["closure"]]
    responses = analysis.responses | {effect: analysis.responses[effect][drawn["closure"]]}
    at = {effect: np.array([drawn["quantiles"][name] for name in closure.parameters])}
    found = separability(analysis.covariance, analysis.kernel, responses, at)
    own = found.names.index(effect)
    rivals = np.delete(found.distance[own], own)
    return float(np.sqrt(min([found.snr[own] ** 2, *rivals])))
