"""From evidences to a verdict whose probabilities mean what they say.

Raw evidences are over-confident. A conditional logistic regression, fitted to synthetic cases whose cause is
known (made with other grids, closures and parameters than a diagnosis uses), turns them into probabilities.
How far a hypothesis is behind the best one counts alike for all effects, up to small differences that
the cases must pay for: with a slope for every effect on every other one (multinomial, 20 features, 14
classes) the same cases left out were judged worse (log score 1.30 against 1.17, unknown found 35 against
61 %). What the layer got wrong on cases left out says how strange a case may look (conformal p-values): the
verdict leaves open all hypotheses that are as probable as nine in ten true causes were, whatever their class
(class by class the sets held 5.3 names instead of 3.1, since what is too weak to be seen is then open
in every case). "none" is judged among the cases without an effect and given up at 5 % only, so that one of
them in twenty raises a false alarm.

Two things are no features but odds of their own, known before any fit: what the profiles' own `mass_balance`
says, and how far something unknown is ahead of all else.

An effect that was added to the catalogue after the fit is judged by its tempered evidence, all others by
the model (`new_effects`).

The fitted model is a small JSON file of the package. It knows nothing of a discrepancy that controls have
taught: with them (on particle collapses in which nothing is hidden it named unknown and an effect of
the view) and without a model evidences are tempered by
`TEMPERATURE`, which is no calibration: probabilities are capped, and there are no conformal p-values.

References
----------
Vovk, Gammerman & Shafer (2005), Algorithmic Learning in a Random World (conformal prediction); Vovk (2015),
Ann. Math. Artif. Intell. 74, 9 (cross-conformal); McFadden (1974), in Frontiers in Econometrics, 105
(conditional logit).
"""

import hashlib
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize
from scipy.special import logsumexp

from fvcollapse.case.grammar import read_text
from fvcollapse.diagnosis.names import EFFECT, NONE, SEVERAL, UNKNOWN, effects_of
from fvcollapse.diagnosis.new_effects import new_hypotheses, smallest_set, with_new, without
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import NUISANCE
from fvcollapse.errors import InputError
from fvcollapse.files.storage import write_atomic
from fvcollapse.output.fingerprint import solver_version

FORMAT, FORMAT_VERSION = "fvcollapse-verdict", 3
SHIPPED = Path(__file__).with_name("verdict_model.json")
# probability of each class before any data; single effects share the rest
PRIOR = {NONE: 0.25, UNKNOWN: 0.15, SEVERAL: 0.05}
KEPT = 0.10  # conformal p-value from which a hypothesis is left open
NONE_KEPT = 0.05  # and from which "none" is not given up
TEMPERATURE = 10.0  # without a model
CAP = 0.9  # largest probability without a model
CHECK_FAILS = 0.05  # p-value of the predictive check below which a hypothesis fails it
CLEAR = 10.0  # odds against none from which a name is told although the check is passed
PAIR_TEMPERATURE = 5.0  # shares the probability of two effects among the pairs that were opened
# L2 penalties, for each case: of what effects share (and none, unknown and two effects have of their own), of
# what an effect differs by, and of the numbers of a whole case
PENALTY, PENALTY_OWN, PENALTY_CASE = 0.001, 0.03, 0.03
NEAR = 20.0  # logarithm of an evidence ratio up to which it counts in proportion
FARTHEST = 6.0  # standard deviations at which a feature is cut off
FOLDS = 5
LEAST_SHARE = 1.0e-3
DIGITS = 5
# arrays of a model
ARRAYS = ("mean", "scale", "case_mean", "case_scale", "slopes", "case_slopes", "intercept")
FEATURES = ("behind", "behind_near", "sigma", "outside")  # of a hypothesis
# (p-values are not among them: they tell how real the noise of the suite is, and on cases left out the answers
# were no better with them)
CASE_FEATURES = (
    "best_outside",
    "best_sigma",
    "none_outside",
    "none_sigma",
    "unknown_sigma",
    "pair_gain",
    "above_none",
    "above_unknown",
    "runs",
)


class Verdict(NamedTuple):
    """The answer.

    Attributes
    ----------
    kind : str
        "effect", "several" (two effects together), "none" or "unknown".
    effects : tuple of str
        Empty for "none" and "unknown".
    indistinguishable : tuple of tuples of str
        Groups of effects that these data leave open together.
    probability : dict
        Hypothesis -> probability; sums to 1, the most probable first.
    set : tuple of str
        Hypotheses that are left open, the most probable first; empty: nothing of the catalogue fits.
    conformal : dict
        Hypothesis -> conformal p-value; empty without a model, and without those that it does not know.
    """

    kind: str
    effects: tuple
    indistinguishable: tuple
    probability: dict
    set: tuple
    conformal: dict


# -- features ------------------------------------------------------------------------------------


def features(evidence, classes):
    """Features of a hypothesis of every class (K, `FEATURES`) and of the case (`CASE_FEATURES`).

    NaN where a class was not compared; of two effects together the best pair counts.

    Parameters
    ----------
    evidence : Evidence
    classes : sequence of str
    """
    found = evidence.hypotheses
    single = {name: each for name, each in found.items() if "+" not in name}
    pairs = [each for name, each in found.items() if "+" in name]
    own = {name: each for name, each in single.items() if name not in (NONE, UNKNOWN)}
    top = max(each.log_evidence for each in single.values())
    best = max((own or single).values(), key=lambda each: each.log_evidence)
    judged = dict(single)
    if pairs:
        judged[SEVERAL] = max(pairs, key=lambda each: each.log_evidence)
    rows = np.full((len(classes), len(FEATURES)), np.nan)
    for row, name in zip(rows, classes, strict=True):
        if name in judged:
            behind = top - judged[name].log_evidence
            near = float(np.clip(behind, -NEAR, NEAR))
            row[:] = (signed_log(behind), near, *shape_of(judged[name]))
    none, unknown = found[NONE], found[UNKNOWN]
    best_sigma, best_outside = shape_of(best)
    none_sigma, none_outside = shape_of(none)
    gain = judged[SEVERAL].log_evidence - top if pairs else 0.0
    values = {
        "best_outside": best_outside,
        "best_sigma": best_sigma,
        "none_outside": none_outside,
        "none_sigma": none_sigma,
        "unknown_sigma": float(np.log(unknown.sigma)),
        "pair_gain": signed_log(gain),
        "above_none": signed_log(best.log_evidence - none.log_evidence),
        "above_unknown": signed_log(best.log_evidence - unknown.log_evidence),
        "runs": float(len(best.p_by_run)),
    }
    return rows, np.array([values[name] for name in CASE_FEATURES])


def shape_of(hypothesis):
    """Logarithms of the discrepancy and of the mean square outside the responses."""
    outside = max(hypothesis.residual_outside, LEAST_SHARE)
    return float(np.log(hypothesis.sigma)), float(np.log(outside))


def signed_log(value):
    """ln(1 + |value|) with the sign of the value."""
    return float(np.sign(value) * np.log1p(abs(value)))


def class_of(cause):
    """Class of a cause: two effects together are one class."""
    return SEVERAL if "+" in cause else cause


def known_logits(evidence, classes):
    """Logarithms (K,) of odds of the classes that need no fit.

    Those that they give to the mass balance of the profiles, of two effects the mean odds; and, where the evidence of
    something unknown is ahead of all others, by how much: tempered, for no case of the catalogue among
    159 of a sealed suite was so, and 23 of 41 others.
    """
    found = np.array([balance_logit(evidence, name) for name in classes])
    if SEVERAL in classes and (pairs := [name for name in evidence.hypotheses if "+" in name]):
        logits = [balance_logit(evidence, name) for name in pairs]
        found[classes.index(SEVERAL)] = logsumexp(logits) - np.log(len(pairs))
    if UNKNOWN in classes:
        logs = evidence.log_evidence()
        ahead = logs[UNKNOWN] - max(value for name, value in logs.items() if name != UNKNOWN)
        found[classes.index(UNKNOWN)] += max(ahead, 0.0) / TEMPERATURE
    return found


def balance_logit(evidence, name):
    """`MassBalance.logit` of a hypothesis, 0 without a balance."""
    return 0.0 if evidence.balance is None else evidence.balance.logit(name)


# -- the model -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class VerdictModel:
    """A fitted verdict; all arrays in the order of `classes`, `FEATURES` and `CASE_FEATURES`.

    Attributes
    ----------
    effects : tuple of str
        Of the catalogue when it was fitted.
    classes : tuple of str
        The K classes.
    mean, scale : (p,) arrays
        Of the features of effects in the suite: mean and standard deviation.
    case_mean, case_scale : (q,) arrays
        The same of a case.
    slopes, case_slopes, intercept : (K, p), (K, q), (K,) arrays
    calibration : dict
        Class -> sorted non-conformities 1 - p of its cases, each judged by a model that had not seen it.
    solver : str
        Version of the solver of the suite.
    about : dict
        What the suite was.
    """

    effects: tuple
    classes: tuple
    mean: np.ndarray
    scale: np.ndarray
    case_mean: np.ndarray
    case_scale: np.ndarray
    slopes: np.ndarray
    case_slopes: np.ndarray
    intercept: np.ndarray
    calibration: dict
    solver: str = ""
    about: dict = field(default_factory=dict)

    @classmethod
    def load(cls, path=None):
        """The model in a file; of the package, if it ships one, else None.

        Raises
        ------
        InputError
            The file is not what was written.
        """
        if path is None and not SHIPPED.exists():
            return None
        return from_json(read_text(path or SHIPPED, "JSON"), path or SHIPPED)

    def save(self, path=SHIPPED):
        """Write the model with its hash."""
        write_atomic(path, to_json(self).encode(), running=False)

    @property
    def is_of_this_solver(self):
        """Whether the suite was computed with the present solver, effects that are new left aside."""
        return self.solver == solver_of(self.effects)

    def covers(self, evidence):
        """Whether the suite had cases of every effect of an evidence."""
        return not new_hypotheses(evidence, self.classes)

    def judges(self, evidence):
        """Whether the suite had cases of none, of unknown, and of an effect of an evidence."""
        known = set(evidence.hypotheses) & set(self.classes)
        return {NONE, UNKNOWN} < known

    def probabilities(self, evidence):
        """{class: probability} of the classes that were compared."""
        own, case = features(evidence, self.classes)
        compared = ~np.isnan(own[:, 0])
        table = (
            standardised(own, self.mean, self.scale),
            standardised(case, self.case_mean, self.case_scale),
        )
        offset = known_logits(evidence, self.classes)
        shares = softmax(
            logits(*table, offset, compared, self.slopes, self.case_slopes, self.intercept)
        )
        pairs = zip(self.classes, shares.tolist(), compared, strict=True)
        return {name: share for name, share, own in pairs if own}

    def conformal(self, probabilities):
        """{class: conformal p-value}: share of the cases whose true cause was as improbable, or more so.

        Classes count as their prior; "none" is judged among the cases of none.
        """
        found, prior = {}, class_prior(self.classes)
        count = sum(len(scores) for scores in self.calibration.values())
        for name, probability in probabilities.items():
            stranger = {
                each: np.count_nonzero(scores >= 1.0 - probability)
                for each, scores in self.calibration.items()
            }
            if name == NONE:
                found[name] = (1.0 + stranger[name]) / (len(self.calibration[name]) + 1.0)
                continue
            share = sum(
                prior[each] * number / len(self.calibration[each])
                for each, number in stranger.items()
            )
            found[name] = float((1.0 + count * share) / (count + 1.0))
        return found

    @property
    def cap(self):
        """Largest probability that the number of cases supports."""
        count = sum(len(scores) for scores in self.calibration.values())
        return 1.0 - 1.0 / (count + 1.0)


def softmax(logits):
    """Probabilities (..., K) of logits."""
    shares = np.exp(logits - logits.max(axis=-1, keepdims=True))
    return shares / shares.sum(axis=-1, keepdims=True)


def standardised(values, mean, scale):
    """Features less their mean, in standard deviations; 0 where there are none."""
    return np.nan_to_num(np.clip((values - mean) / scale, -FARTHEST, FARTHEST))


def logits(own, case, offset, compared, slopes, case_slopes, intercept):
    """Logits (..., K) of standardised features (..., K, p) and (..., q) and of known ones (..., K).

    -inf where nothing was compared.
    """
    values = (own * slopes).sum(axis=-1) + case @ case_slopes.T + intercept + offset
    return np.where(compared, values, -np.inf)


# -- fitting -------------------------------------------------------------------------------------


def fit(suite, effects, about=None, kinds=None):
    """The `VerdictModel` of a suite.

    Parameters
    ----------
    suite : sequence of (Evidence, str)
        Evidence and true cause of every case: an effect, two joined by "+", "none" or "unknown".
    effects : sequence of str
        Effects of the catalogue.
    about : dict, optional
        What the suite is, kept with the model.
    kinds : sequence of str or None, optional
        Kind of each unknown: its conformal scores are of models that have not seen its kind.

    Raises
    ------
    InputError
        Fewer than `FOLDS` cases of a class.
    """
    effects = tuple(effects)
    truth = np.array([class_of(cause) for _, cause in suite])
    classes = tuple(sorted({class_of(cause) for _, cause in suite}))
    for name in classes:
        count = int(np.count_nonzero(truth == name))
        if count < FOLDS:
            raise InputError("suite", name, f"{count} cases", f">= {FOLDS} of every class")
    rows = [features(evidence, classes) for evidence, _ in suite]
    own, case = (np.array(part) for part in zip(*rows, strict=True))
    of_effects = own[:, [is_effect(name) for name in classes]]
    mean, scale = np.nanmean(of_effects, axis=(0, 1)), spread(np.nanstd(of_effects, axis=(0, 1)))
    case_mean, case_scale = case.mean(axis=0), spread(case.std(axis=0))
    table = Table(
        standardised(own, mean, scale),
        standardised(case, case_mean, case_scale),
        np.array([known_logits(evidence, classes) for evidence, _ in suite]),
        ~np.isnan(own[:, :, 0]),
        np.array([classes.index(name) for name in truth]),
    )
    scores = out_of_fold(table, classes, kinds)
    slopes, case_slopes, intercept = regression(table, classes)
    return VerdictModel(
        effects=effects,
        classes=classes,
        mean=mean,
        scale=scale,
        case_mean=case_mean,
        case_scale=case_scale,
        slopes=slopes,
        case_slopes=case_slopes,
        intercept=intercept,
        calibration={name: np.sort(scores[truth == name]) for name in classes},
        solver=solver_of(effects),
        about={"cases": len(suite)} | (about or {}),
    )


def solver_of(effects):
    """`solver_version` with some effects; errors of the set-up act in every diagnosis and always count."""
    errors = [name for name, effect in CATALOGUE.items() if effect.kind == NUISANCE]
    return solver_version((*effects, *errors))


class Table(NamedTuple):
    """Features of m cases (m, K, p), (m, q), known logits and what was compared (m, K), true class (m,)."""

    own: np.ndarray
    case: np.ndarray
    offset: np.ndarray
    compared: np.ndarray
    truth: np.ndarray

    def of(self, rows):
        """Some of the cases."""
        return Table(*(part[rows] for part in self))


def is_effect(name):
    """Whether a class is a single effect."""
    return name not in PRIOR


def spread(deviations):
    """Standard deviations, 1 where nothing varies."""
    return np.where(deviations > 1.0e-9, deviations, 1.0)


def class_prior(classes):
    """{class: prior probability}."""
    given = {name: share for name, share in PRIOR.items() if name in classes}
    single = [name for name in classes if name not in given]
    rest = (1.0 - sum(given.values())) / max(len(single), 1)
    prior = np.array([given.get(name, rest) for name in classes])
    return dict(zip(classes, (prior / prior.sum()).tolist(), strict=True))


def regression(table, classes):
    """(slopes (K, p), slopes of a case (K, q), intercept (K,)) of the conditional logistic regression.

    Cases are weighted so that classes count as their prior, whatever their number. A case whose cause
    was not compared teaches nothing.
    """
    rows = np.arange(len(table.truth))
    table = table.of(table.compared[rows, table.truth])
    m, kinds, p = table.own.shape
    q, rows = table.case.shape[1], np.arange(m)
    counts, prior = np.bincount(table.truth, minlength=kinds), class_prior(classes)
    weights = np.array([prior[name] for name in classes])[table.truth] / counts[table.truth]
    effect = np.array([is_effect(name) for name in classes])[:, None]
    parts = np.split(np.arange(p + kinds * (p + q + 1)), [p, p + kinds * p, p + kinds * (p + q)])

    def unpacked(values):
        shared, own, case, intercept = (values[part] for part in parts)
        return shared, own.reshape(kinds, p), case.reshape(kinds, q), intercept

    penalties = np.empty(p + kinds * (p + q + 1))
    penalties[parts[0]] = penalties[parts[3]] = PENALTY
    penalties[parts[1]] = np.where(effect, PENALTY_OWN, PENALTY).repeat(p, axis=1).ravel()
    penalties[parts[2]] = np.where(effect, 3.0, 1.0).repeat(q, axis=1).ravel() * PENALTY_CASE

    def loss(values):
        shared, own, case, intercept = unpacked(values)
        shares = softmax(logits(*table[:-1], effect * shared + own, case, intercept))
        value = -weights @ np.log(np.maximum(shares[rows, table.truth], 1.0e-300))
        shares[rows, table.truth] -= 1.0
        shares *= weights[:, None]
        by_class = np.einsum("mk,mkp->kp", shares, table.own)
        gradient = np.concatenate(
            [
                (effect * by_class).sum(axis=0),
                by_class.ravel(),
                (shares.T @ table.case).ravel(),
                shares.sum(axis=0),
            ]
        )
        value += 0.5 * (penalties * values) @ values
        return value, gradient + penalties * values

    start = np.zeros(len(penalties))
    found = minimize(loss, start, jac=True, method="L-BFGS-B", options={"maxiter": 2000})
    shared, own, case, intercept = unpacked(found.x)
    return effect * shared + own, case, intercept


def out_of_fold(table, classes, kinds=None, seed=0):
    """1 - probability of the true class, (m,), each case judged by a model fitted without its fold.

    Cases of one kind are in one fold: what is unknown is of a kind that was never seen.
    """
    truth = table.truth
    fold, rng = np.empty(len(truth), int), np.random.default_rng(seed)
    for name in range(len(classes)):
        own = np.flatnonzero(truth == name)
        fold[own] = rng.permutation(len(own)) % FOLDS
    kinds = np.array([kind or "" for kind in kinds or [None] * len(truth)])
    several = sorted(set(kinds) - {""})
    for number, kind in enumerate(several if len(several) > 1 else ()):
        fold[kinds == kind] = number % FOLDS
    scores = np.empty(len(truth))
    for number in range(FOLDS):
        own = table.of(fold == number)
        found = regression(table.of(fold != number), classes)
        shares = softmax(logits(*own[:-1], *found))
        scores[fold == number] = 1.0 - shares[np.arange(len(own.truth)), own.truth]
    return scores


# -- the file ------------------------------------------------------------------------------------


def to_json(model):
    """The model as text, with the hash of everything else in it."""
    content = {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "solver": model.solver,
        "about": model.about,
        "effects": list(model.effects),
        "classes": list(model.classes),
        "features": list(FEATURES),
        "case_features": list(CASE_FEATURES),
        **{name: rounded(getattr(model, name)) for name in ARRAYS},
        "calibration": {name: rounded(scores) for name, scores in model.calibration.items()},
    }
    return json.dumps(content | {"hash": digest(content)}, indent=1) + "\n"


def from_json(text, source):
    """The model in a text.

    Raises
    ------
    InputError
        Broken, of another format, or changed by hand.
    """
    allowed = f"a {FORMAT} file of version {FORMAT_VERSION} as it was written"
    try:
        content = json.loads(text)
        stored = content.pop("hash")
        found = content["format"], content["format_version"]
        if found != (FORMAT, FORMAT_VERSION) or stored != digest(content):
            raise InputError(source, "file", "another format, or a hash that does not fit", allowed)
        return VerdictModel(
            effects=tuple(content["effects"]),
            classes=tuple(content["classes"]),
            **{name: np.array(content[name]) for name in ARRAYS},
            calibration={name: np.array(each) for name, each in content["calibration"].items()},
            solver=content["solver"],
            about=content["about"],
        )
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise InputError(source, "file", f"no model ({type(error).__name__})", allowed) from None


def rounded(values):
    """An array as nested lists of `DIGITS` significant digits."""
    if isinstance(values, np.ndarray):
        values = values.tolist()
    if isinstance(values, list):
        return [rounded(value) for value in values]
    return float(f"{values:.{DIGITS}g}")


def digest(content):
    """Hash of the content of a file."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


# -- the verdict ---------------------------------------------------------------------------------


def verdict(evidence, model=None, separability=None, known=None):
    """The `Verdict` of an evidence.

    Parameters
    ----------
    evidence : Evidence
    model : VerdictModel, optional
        Judges the effects that it knows; the others, and all without a model, are judged by tempered
        evidences (see `new_effects`).
    separability : Separability, optional
        Its classes are groups that cannot be told apart.
    known : Evidence, optional
        Of the effects that the model knows, compared without the new ones; its pairs are also in
        `evidence`. Default: what `evidence` holds of them.
    """
    new = () if model is None else new_hypotheses(evidence, model.classes)
    known = without(evidence, new) if known is None else known
    if model is None or not model.judges(known):
        return tempered(evidence, separability)
    shares = model.probabilities(known)
    p_values = model.conformal(shares)  # before the cap: the scores of the suite have none
    judged = in_order(named(known, capped(shares, model.cap)))
    conformal = {name: p_values.get(class_of(name), 0.0) for name in judged}
    probability, clear = judged, False
    if new:
        every = tempered_shares(evidence)
        probability = in_order(with_new(judged, every, new, CAP))
        uncapped = in_order(with_new(judged, every, new, 1.0))
        clear = is_clear(next(iter(uncapped)), uncapped)
    likely = smallest_set(probability, 1.0 - KEPT)
    kept = tuple(
        name
        for name in probability
        if (name in likely if name in new else is_open(name, judged, conformal))
    )
    if NONE in kept and not (clear and kept[0] in new):
        return finished(NONE, probability, kept, conformal, separability)
    return finished(kept[0] if kept else UNKNOWN, probability, kept, conformal, separability)


def is_clear(name, probability):
    """Whether a hypothesis is so much more probable than none that no predictive check counts."""
    return probability[name] > CLEAR * probability[NONE]


def tempered(evidence, separability):
    """The verdict without a model.

    A gap that passes the predictive check needs no effect, unless one is ten times as probable as none.
    """
    probability = in_order(capped(tempered_shares(evidence), CAP))
    kept = smallest_set(probability, 1.0 - KEPT)
    passes = evidence.hypotheses[NONE].p_value >= NONE_KEPT
    clear = is_clear(kept[0], probability)
    best = NONE if passes and NONE in kept and not clear else kept[0]
    return finished(best, probability, kept, {}, separability)


def tempered_shares(evidence):
    """{hypothesis: probability} of tempered evidences and the prior of the classes.

    The prior is that of a model. Two effects together count if the best single one fails its check:
    nothing has taught here how much a second effect adds by chance.
    """
    found = evidence.hypotheses
    single = [name for name in found if name not in (NONE, UNKNOWN) and "+" not in name]
    best = max(single, key=lambda name: found[name].log_evidence, default=NONE)
    fails = found[best].p_value < CHECK_FAILS
    names = tuple(name for name in found if fails or "+" not in name)
    classes = tuple(dict.fromkeys(class_of(name) for name in names))
    prior = class_prior(classes)
    pairs = sum("+" in name for name in names)
    logs = [found[name].log_evidence / TEMPERATURE for name in names]
    logs += np.log([prior[class_of(name)] / (pairs if "+" in name else 1) for name in names])
    logs += [balance_logit(evidence, name) for name in names]
    return dict(zip(names, softmax(np.array(logs)).tolist(), strict=True))


def is_open(name, probability, conformal):
    """Whether a hypothesis is left open; of several pairs only the most probable can be."""
    if name == NONE:
        return conformal[name] >= NONE_KEPT
    first = next((each for each in probability if "+" in each), None)
    return conformal[name] >= KEPT and ("+" not in name or name == first)


def named(evidence, shares):
    """{hypothesis: probability}: that of two effects is shared among the pairs that were opened."""
    probability = {name: share for name, share in shares.items() if name != SEVERAL}
    pairs = {name: each for name, each in evidence.hypotheses.items() if "+" in name}
    if SEVERAL in shares:
        logs = np.array([each.log_evidence for each in pairs.values()]) / PAIR_TEMPERATURE
        logs += [balance_logit(evidence, name) for name in pairs]
        parts = shares[SEVERAL] * softmax(logs)
        probability |= dict(zip(pairs, parts.tolist(), strict=True))
    return probability


def capped(shares, cap):
    """Probabilities none of which is above the cap; the others share what is cut off."""
    name = max(shares, key=shares.get)
    if shares[name] <= cap or len(shares) == 1:
        return shares
    rest = sum(
        share for each, share in shares.items() if each != name
    )  # may be far below round-off of 1
    others = len(shares) - 1
    return {
        each: cap if each == name else (1.0 - cap) * (share / rest if rest > 0.0 else 1.0 / others)
        for each, share in shares.items()
    }


def in_order(shares):
    """The most probable first, summing to one."""
    total = sum(shares.values())
    return {name: shares[name] / total for name in sorted(shares, key=lambda each: -shares[each])}


def finished(best, probability, kept, conformal, separability):
    """The `Verdict` for a hypothesis."""
    effects = effects_of(best)
    kind = best if not effects else (SEVERAL if len(effects) > 1 else EFFECT)
    open_effects = tuple(n for n in kept if n not in (NONE, UNKNOWN) and "+" not in n)
    groups = list(separability.classes) if separability is not None else []
    if len(open_effects) > 1 and not any(set(open_effects) <= set(group) for group in groups):
        groups = [group for group in groups if not set(group) <= set(open_effects)]
        groups.insert(0, open_effects)
    groups = tuple(tuple(group) for group in groups)
    return Verdict(kind, effects, groups, probability, kept, conformal)
