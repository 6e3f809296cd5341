"""The fitted verdict layer, and the file that holds it.

The model is a small JSON file of the package with a hash of its content. It turns evidences into calibrated
probabilities by a conditional logistic regression; `blind.verdict_training` fits it.

References
----------
Vovk, Gammerman & Shafer (2005), Algorithmic Learning in a Random World (conformal prediction); McFadden (1974),
in Frontiers in Econometrics, 105 (conditional logit).
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.case.grammar import read_text
from fvcollapse.diagnosis.names import NONE, SEVERAL, UNKNOWN
from fvcollapse.diagnosis.new_effects import new_hypotheses
from fvcollapse.diagnosis.verdict_features import CASE_FEATURES, FEATURES, features, known_logits
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import NUISANCE
from fvcollapse.errors import InputError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.output.fingerprint import solver_version

if TYPE_CHECKING:
    from fvcollapse.diagnosis.evidence import Evidence

FORMAT, FORMAT_VERSION = "fvcollapse-verdict", 5
# of diagnoses without controls, and with them
SHIPPED = Path(__file__).with_name("verdict_model.json")
SHIPPED_CONTROLS = Path(__file__).with_name("verdict_model_controls.json")
# probability of each class before any data; single effects share the rest
PRIOR = {NONE: 0.25, UNKNOWN: 0.15, SEVERAL: 0.05}
FARTHEST = 6.0  # standard deviations at which a feature is cut off
DIGITS = 5
# arrays of a model
ARRAYS = ("mean", "scale", "case_mean", "case_scale", "slopes", "case_slopes", "intercept")


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
    sharpness : float
        Factor on all logits: a fit is surer of the cases that it has seen than it may be of others.
    calibration : dict
        Class -> sorted non-conformities 1 - p of its cases, each judged by a model that had not seen it.
    solver : str
        Version of the solver of the suite.
    about : dict
        What the suite was.
    """

    effects: tuple[str, ...]
    classes: tuple[str, ...]
    mean: np.ndarray
    scale: np.ndarray
    case_mean: np.ndarray
    case_scale: np.ndarray
    slopes: np.ndarray
    case_slopes: np.ndarray
    intercept: np.ndarray
    sharpness: float
    calibration: dict[str, np.ndarray]
    solver: str = ""
    about: dict[str, Any] = field(default_factory=dict)

    @classmethod
    def load(cls, path: str | Path | None = None, controls: bool = False) -> "VerdictModel | None":
        """The model in a file; of the package, if it ships one, else None.

        Parameters
        ----------
        path : str or Path, optional
            Default: that of the package.
        controls : bool
            Of the package that of diagnoses with controls.

        Raises
        ------
        InputError
            The file is not what was written.
        """
        shipped = SHIPPED_CONTROLS if controls else SHIPPED
        if path is None and not shipped.exists():
            return None
        return from_json(read_text(path or shipped, "JSON"), path or shipped)

    def save(self, path: str | Path = SHIPPED) -> None:
        """Write the model with its hash."""
        write_atomic(path, to_json(self).encode(), running=False)

    @property
    def is_of_this_solver(self) -> bool:
        """Whether the suite was computed with the present solver, effects that are new left aside."""
        return self.solver == solver_of(self.effects)

    def covers(self, evidence: "Evidence") -> bool:
        """Whether the suite had cases of every effect of an evidence."""
        return not new_hypotheses(evidence, self.classes)

    def judges(self, evidence: "Evidence") -> bool:
        """Whether the suite had cases of none, of unknown, and of an effect of an evidence."""
        known = set(evidence.hypotheses) & set(self.classes)
        return {NONE, UNKNOWN} < known

    def probabilities(self, evidence: "Evidence") -> dict[str, float]:
        """{class: probability} of the classes that were compared."""
        rows, case = features(evidence, self.classes)
        compared = ~np.isnan(rows[:, 0])
        table = (
            standardised(rows, self.mean, self.scale),
            standardised(case, self.case_mean, self.case_scale),
        )
        offset = known_logits(evidence, self.classes)
        fitted = (self.slopes, self.case_slopes, self.intercept)
        shares = softmax(self.sharpness * logits(*table, offset, compared, fitted))
        pairs = zip(self.classes, shares.tolist(), compared, strict=True)
        return {name: share for name, share, rows in pairs if rows}

    def conformal(self, probabilities: Mapping[str, float]) -> dict[str, float]:
        """{class: conformal p-value}: share of the cases whose true cause was as improbable, or more so.

        Classes count as their prior; "none" is judged among the cases of none.
        """
        p_values, prior = {}, class_prior(self.classes)
        count = sum(len(scores) for scores in self.calibration.values())
        for name, probability in probabilities.items():
            stranger: dict[str, int] = {
                cause: np.count_nonzero(scores >= 1.0 - probability)  # type: ignore[misc]
                for cause, scores in self.calibration.items()
            }
            if name == NONE:
                p_values[name] = (1.0 + stranger[name]) / (len(self.calibration[name]) + 1.0)
                continue
            share = sum(
                prior[cause] * number / len(self.calibration[cause])
                for cause, number in stranger.items()
            )
            p_values[name] = float((1.0 + count * share) / (count + 1.0))
        return p_values

    @property
    def cap(self) -> float:
        """Largest probability that the number of cases supports."""
        count = sum(len(scores) for scores in self.calibration.values())
        return 1.0 - 1.0 / (count + 1.0)


def softmax(logits: np.ndarray) -> np.ndarray:
    """Probabilities (..., K) of logits."""
    shares = np.exp(logits - logits.max(axis=-1, keepdims=True))
    return shares / shares.sum(axis=-1, keepdims=True)


def standardised(values: np.ndarray, mean: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Features less their mean, in standard deviations; 0 where there are none."""
    return np.nan_to_num(np.clip((values - mean) / scale, -FARTHEST, FARTHEST))


def logits(
    own: np.ndarray,
    case: np.ndarray,
    offset: np.ndarray,
    compared: np.ndarray,
    coefficients: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> np.ndarray:
    """Logits (..., K) of standardised features (..., K, p) and (..., q) and of known ones (..., K).

    `coefficients` are slopes, slopes of a case and intercept; -inf where nothing was compared.
    """
    slopes, case_slopes, intercept = coefficients
    values = (own * slopes).sum(axis=-1) + case @ case_slopes.T + intercept + offset
    return np.where(compared, values, -np.inf)


def solver_of(effects: Sequence[str]) -> str:
    """`solver_version` with some effects; errors of the set-up act in every diagnosis and always count."""
    errors = [name for name, effect in CATALOGUE.items() if effect.kind == NUISANCE]
    return solver_version((*effects, *errors))


def class_prior(classes: Sequence[str]) -> dict[str, float]:
    """{class: prior probability}."""
    given = {name: share for name, share in PRIOR.items() if name in classes}
    single = [name for name in classes if name not in given]
    others = (1.0 - sum(given.values())) / max(len(single), 1)
    prior = np.array([given.get(name, others) for name in classes])
    return dict(zip(classes, (prior / prior.sum()).tolist(), strict=True))


def to_json(model: VerdictModel) -> str:
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
        "sharpness": rounded(model.sharpness),
        "calibration": {name: rounded(scores) for name, scores in model.calibration.items()},
    }
    return json.dumps(content | {"hash": digest(content)}, indent=1) + "\n"


def from_json(text: str, source: str | Path) -> VerdictModel:
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
        form = content["format"], content["format_version"]
        if form != (FORMAT, FORMAT_VERSION) or stored != digest(content):
            raise InputError(source, "file", "another format, or a hash that does not fit", allowed)
        return VerdictModel(
            effects=tuple(content["effects"]),
            classes=tuple(content["classes"]),
            **{name: np.array(content[name]) for name in ARRAYS},
            sharpness=float(content["sharpness"]),
            calibration={name: np.array(scores) for name, scores in content["calibration"].items()},
            solver=content["solver"],
            about=content["about"],
        )
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise InputError(source, "file", f"no model ({type(error).__name__})", allowed) from None


def rounded(values: Any) -> Any:
    """An array as nested lists of `DIGITS` significant digits."""
    if isinstance(values, np.ndarray):
        values = values.tolist()
    if isinstance(values, list):
        return [rounded(value) for value in values]
    return float(f"{values:.{DIGITS}g}")


def digest(content: dict[str, Any]) -> str:
    """Hash of the content of a file."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
