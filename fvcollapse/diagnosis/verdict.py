"""From evidences to a verdict whose probabilities mean what they say.

Raw evidences are over-confident. A logistic regression, fitted to synthetic cases whose cause is known
(made with other grids, closures and parameters than a diagnosis uses), turns them into probabilities;
what it got wrong there says, class by class, how strange a case may look and still belong to the class
(conformal p-values). The verdict leaves open all hypotheses that are not rejected at 10 %; "none" is
given up at 5 % only, so that one case in twenty without an effect raises a false alarm.

The fitted model is a small JSON file of the package. It knows nothing of a discrepancy that controls have
taught: with them (on particle collapses in which nothing is hidden it named unknown and an effect of
the view) and without a model evidences are tempered by
`TEMPERATURE`, which is no calibration: probabilities are capped, and there are no conformal p-values.

References
----------
Vovk, Gammerman & Shafer (2005), Algorithmic Learning in a Random World (conformal prediction, class by
class); Vovk (2015), Ann. Math. Artif. Intell. 74, 9 (cross-conformal).
"""

import hashlib
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fvcollapse.case_keys import read_text
from fvcollapse.errors import InputError
from fvcollapse.files import write_atomic
from fvcollapse.fingerprint import solver_version

FORMAT, FORMAT_VERSION = "fvcollapse-verdict", 1
SHIPPED = Path(__file__).with_name("verdict_model.json")
NONE, UNKNOWN, SEVERAL = "none", "unknown", "several"
# probability of each class before any data; single effects share the rest
PRIOR = {NONE: 0.25, UNKNOWN: 0.15, SEVERAL: 0.05}
KEPT = 0.10  # conformal p-value from which a hypothesis is left open
NONE_KEPT = 0.05  # and from which "none" is not given up
TEMPERATURE = 10.0  # without a model
CAP = 0.9  # largest probability without a model
CLEAR = 10.0  # odds against none from which a name is told although the check is passed
PAIR_TEMPERATURE = 5.0  # shares the probability of two effects among the pairs that were opened
REGULARISATION = 0.5  # inverse strength C of the L2 penalty
FOLDS = 5
LEAST_SHARE = 1.0e-3
DIGITS = 5
# (p-values are not among them: they tell how real the noise of the suite is, and on cases left out the answers
# were no better with them: first name right in 65 %, without them in 66 %)
GLOBAL_FEATURES = (
    "best_outside",
    "best_sigma",
    "none_outside",
    "none_sigma",
    "unknown_sigma",
    "pair_gain",
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
        Hypothesis -> conformal p-value; empty without a model.
    """

    kind: str
    effects: tuple
    indistinguishable: tuple
    probability: dict
    set: tuple
    conformal: dict


# -- features ------------------------------------------------------------------------------------


def features(evidence, effects):
    """Features of an evidence, {name: number}; an effect that was not compared does as well as none.

    Parameters
    ----------
    evidence : Evidence
    effects : sequence of str
    """
    found = evidence.hypotheses
    single = {name: found[name] for name in (*effects, NONE, UNKNOWN) if name in found}
    top = max(each.log_evidence for each in single.values())
    values = {name: float(np.log1p(top - each.log_evidence)) for name, each in single.items()}
    values |= {name: values[NONE] for name in effects if name not in single}
    own = {name: each for name, each in single.items() if name not in (NONE, UNKNOWN)}
    best = max((own or single).values(), key=lambda each: each.log_evidence)
    pairs = [each for name, each in found.items() if "+" in name]
    pair = max(pairs, key=lambda each: each.log_evidence, default=None)
    gain = 0.0 if pair is None else pair.log_evidence - best.log_evidence
    none = found[NONE]
    return values | {
        "best_outside": float(np.log(max(best.residual_outside, LEAST_SHARE))),
        "best_sigma": float(np.log(best.sigma)),
        "none_outside": float(np.log(max(none.residual_outside, LEAST_SHARE))),
        "none_sigma": float(np.log(none.sigma)),
        "unknown_sigma": float(np.log(found[UNKNOWN].sigma)),
        "pair_gain": float(np.sign(gain) * np.log1p(abs(gain))),
        "runs": float(len(best.p_by_run)),
    }


def class_of(cause):
    """Class of a cause: two effects together are one class."""
    return SEVERAL if "+" in cause else cause


# -- the model -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class VerdictModel:
    """A fitted verdict; all arrays in the order of `names` (features) and `classes`.

    Attributes
    ----------
    effects : tuple of str
        Of the catalogue when it was fitted.
    names : tuple of str
        The n features.
    classes : tuple of str
        The K classes.
    fill, mean, scale : (n,) arrays
        Value of a feature that is missing; mean and standard deviation in the suite.
    coefficients, intercept : (K, n), (K,) arrays
    calibration : dict
        Class -> sorted non-conformities 1 - p of its cases, each judged by a model that had not seen it.
    solver : str
        Version of the solver of the suite.
    about : dict
        What the suite was.
    """

    effects: tuple
    names: tuple
    classes: tuple
    fill: np.ndarray
    mean: np.ndarray
    scale: np.ndarray
    coefficients: np.ndarray
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
        """Whether the suite was computed with the present solver."""
        return self.solver == solver_version()

    def covers(self, evidence):
        """Whether the suite had cases of every effect of an evidence."""
        return {name for name in evidence.hypotheses if "+" not in name} <= set(self.classes)

    def row(self, evidence):
        """Standardised features of an evidence, (n,)."""
        return standardised([features(evidence, self.effects)], self.names, self.fill, self)[0]

    def probabilities(self, evidence):
        """{class: probability} of the classes that were compared."""
        logits = self.coefficients @ self.row(evidence) + self.intercept
        shares = dict(zip(self.classes, softmax(logits), strict=True))
        possible = {class_of(name) for name in evidence.hypotheses}
        shares = {name: float(share) for name, share in shares.items() if name in possible}
        total = sum(shares.values())
        return {name: share / total for name, share in shares.items()}

    def conformal(self, probabilities):
        """{class: conformal p-value}: share of its cases that looked as strange or stranger."""
        found = {}
        for name, probability in probabilities.items():
            scores = self.calibration[name]
            stranger = int(np.count_nonzero(scores >= 1.0 - probability))
            found[name] = (1.0 + stranger) / (len(scores) + 1.0)
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


def standardised(rows, names, fill, model=None):
    """Features (m, n) with the missing ones filled; standardised if a model is given."""
    table = np.array([[row.get(name, np.nan) for name in names] for row in rows])
    table = np.where(np.isnan(table), fill, table)
    return table if model is None else (table - model.mean) / model.scale


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
        Fewer than `FOLDS` cases of a class, or no package scikit-learn.
    """
    effects = tuple(effects)
    rows = [features(evidence, effects) for evidence, _ in suite]
    truth = np.array([class_of(cause) for _, cause in suite])
    classes = tuple(sorted({class_of(cause) for _, cause in suite}))
    for name in classes:
        count = int(np.count_nonzero(truth == name))
        if count < FOLDS:
            raise InputError("suite", name, f"{count} cases", f">= {FOLDS} of every class")
    names = (*effects, NONE, UNKNOWN, *GLOBAL_FEATURES)
    table = standardised(rows, names, np.nan)
    missing = np.isnan(table)
    fill = np.nanquantile(np.where(missing.all(axis=0), 0.0, table), 0.95, axis=0)
    table = np.where(missing, fill, table)
    mean, scale = table.mean(axis=0), table.std(axis=0)
    scale = np.where(scale > 1.0e-9, scale, 1.0)
    table = (table - mean) / scale
    scores = out_of_fold(table, truth, classes, kinds)
    coefficients, intercept = regression(table, truth, classes)
    return VerdictModel(
        effects=effects,
        names=names,
        classes=classes,
        fill=fill,
        mean=mean,
        scale=scale,
        coefficients=coefficients,
        intercept=intercept,
        calibration={name: np.sort(scores[truth == name]) for name in classes},
        solver=solver_version(),
        about={"cases": len(suite)} | (about or {}),
    )


def class_prior(classes):
    """{class: prior probability}."""
    given = {name: share for name, share in PRIOR.items() if name in classes}
    single = [name for name in classes if name not in given]
    rest = (1.0 - sum(given.values())) / max(len(single), 1)
    prior = np.array([given.get(name, rest) for name in classes])
    return dict(zip(classes, (prior / prior.sum()).tolist(), strict=True))


def regression(table, truth, classes):
    """(coefficients (K, n), intercept (K,)) of the L2 multinomial logistic regression.

    Cases are weighted so that classes count as their prior, whatever their number.
    """
    try:
        from sklearn.linear_model import LogisticRegression
    except ImportError:
        found, allowed = "no package scikit-learn", 'after pip install "fvcollapse[diagnose]"'
        raise InputError("command line", "verdict", found, allowed) from None
    counts = {name: np.count_nonzero(truth == name) for name in classes}
    prior = class_prior(classes)
    weights = np.array([prior[name] * len(truth) / counts[name] for name in truth])
    model = LogisticRegression(C=REGULARISATION, max_iter=5000, tol=1.0e-6)
    model.fit(table, truth, sample_weight=weights)
    order = [list(model.classes_).index(name) for name in classes]
    if len(classes) == 2:  # scikit-learn keeps one row then
        coefficients = np.vstack([-model.coef_[0], model.coef_[0]]) / 2.0
        intercept = np.array([-model.intercept_[0], model.intercept_[0]]) / 2.0
        return coefficients[order], intercept[order]
    return model.coef_[order], model.intercept_[order]


def out_of_fold(table, truth, classes, kinds=None, seed=0):
    """1 - probability of the true class, (m,), each case judged by a model fitted without its fold.

    Cases of one kind are in one fold: what is unknown is of a kind that was never seen.
    """
    fold, rng = np.empty(len(truth), int), np.random.default_rng(seed)
    for name in classes:
        own = np.flatnonzero(truth == name)
        fold[own] = rng.permutation(len(own)) % FOLDS
    kinds = np.array([kind or "" for kind in kinds or [None] * len(truth)])
    several = sorted(set(kinds) - {""})
    for number, kind in enumerate(several if len(several) > 1 else ()):
        fold[kinds == kind] = number % FOLDS
    scores, index = np.empty(len(truth)), {name: k for k, name in enumerate(classes)}
    for number in range(FOLDS):
        rest, own = fold != number, np.flatnonzero(fold == number)
        coefficients, intercept = regression(table[rest], truth[rest], classes)
        shares = softmax(table[own] @ coefficients.T + intercept)
        scores[own] = 1.0 - shares[np.arange(len(own)), [index[name] for name in truth[own]]]
    return scores


# -- the file ------------------------------------------------------------------------------------


def to_json(model):
    """The model as text, with the hash of everything else in it."""
    arrays = ("fill", "mean", "scale", "coefficients", "intercept")
    content = {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "solver": model.solver,
        "about": model.about,
        "effects": list(model.effects),
        "names": list(model.names),
        "classes": list(model.classes),
        **{name: rounded(getattr(model, name)) for name in arrays},
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
            names=tuple(content["names"]),
            classes=tuple(content["classes"]),
            fill=np.array(content["fill"]),
            mean=np.array(content["mean"]),
            scale=np.array(content["scale"]),
            coefficients=np.array(content["coefficients"]),
            intercept=np.array(content["intercept"]),
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


def verdict(evidence, model=None, separability=None):
    """The `Verdict` of an evidence.

    Parameters
    ----------
    evidence : Evidence
    model : VerdictModel, optional
        None, or one that does not know an effect of the evidence: tempered evidences.
    separability : Separability, optional
        Its classes are groups that cannot be told apart.
    """
    if model is None or not model.covers(evidence):
        return tempered(evidence, separability)
    shares = model.probabilities(evidence)
    p_values = model.conformal(shares)  # before the cap: the scores of the suite have none
    probability = in_order(named(evidence, capped(shares, model.cap)))
    conformal = {name: p_values.get(class_of(name), 0.0) for name in probability}
    kept = tuple(name for name in probability if is_open(name, probability, conformal))
    if NONE in kept:
        return finished(NONE, probability, kept, conformal, separability)
    return finished(kept[0] if kept else UNKNOWN, probability, kept, conformal, separability)


def tempered(evidence, separability):
    """The verdict without a model.

    A gap that passes the predictive check needs no effect, unless one is ten times as probable as none.
    The prior is that of the classes, as in a model.
    """
    names = tuple(evidence.hypotheses)
    classes = tuple(dict.fromkeys(class_of(name) for name in names))
    prior = class_prior(classes)
    pairs = sum("+" in name for name in names)
    logs = [each.log_evidence / TEMPERATURE for each in evidence.hypotheses.values()]
    logs += np.log([prior[class_of(name)] / (pairs if "+" in name else 1) for name in names])
    shares = dict(zip(names, softmax(np.array(logs)).tolist(), strict=True))
    probability = in_order(capped(shares, CAP))
    kept, total = [], 0.0
    for name, share in probability.items():
        if total < 1.0 - KEPT:
            kept.append(name)
            total += share
    passes = evidence.hypotheses[NONE].p_value >= NONE_KEPT
    clear = probability[kept[0]] > CLEAR * probability[NONE]
    best = NONE if passes and NONE in kept and not clear else kept[0]
    return finished(best, probability, tuple(kept), {}, separability)


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
        parts = shares[SEVERAL] * softmax(logs)
        probability |= dict(zip(pairs, parts.tolist(), strict=True))
    return probability


def capped(shares, cap):
    """Probabilities none of which is above the cap; the others share what is cut off."""
    name = max(shares, key=shares.get)
    if shares[name] <= cap or len(shares) == 1:
        return shares
    rest = 1.0 - shares[name]
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
    effects = () if best in (NONE, UNKNOWN) else tuple(best.split("+"))
    kind = best if not effects else ("several" if len(effects) > 1 else "effect")
    open_effects = tuple(n for n in kept if n not in (NONE, UNKNOWN) and "+" not in n)
    groups = list(separability.classes) if separability is not None else []
    if len(open_effects) > 1 and not any(set(open_effects) <= set(group) for group in groups):
        groups = [group for group in groups if not set(group) <= set(open_effects)]
        groups.insert(0, open_effects)
    groups = tuple(tuple(group) for group in groups)
    return Verdict(kind, effects, groups, probability, kept, conformal)
