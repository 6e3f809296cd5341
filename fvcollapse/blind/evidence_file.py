"""A file of evidence: what is kept of the analysis of one case, and the form that it must have."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import msgspec
import numpy as np

from fvcollapse.blind.forms import NAMES, Share, Whole, is_name, read_form
from fvcollapse.blind.plain_values import Content
from fvcollapse.blind.separation import separation_of
from fvcollapse.blind.simple_rules import chi_square, signature
from fvcollapse.diagnosis.evidence import Evidence, Hypothesis
from fvcollapse.diagnosis.left import Left
from fvcollapse.diagnosis.mass_balance import MassBalance
from fvcollapse.diagnosis.names import NONE
from fvcollapse.errors import InputError
from fvcollapse.measure.quantities import QUANTITIES
from fvcollapse.output.fingerprint import solver_version
from fvcollapse.output.forms import form_problems

if TYPE_CHECKING:
    from fvcollapse.diagnosis.analysis import Analysis

FORMAT = "fvcollapse-evidence"
QUANTILE_ENDS = 0.002  # of reported parameters: some priors have no end
EMPTY = np.empty(0)
# numbers and arrays of a hypothesis that a file holds
NUMBERS = ("log_evidence", "log_evidence_wide", "log_prior", "sigma", "p_value", "residual_outside")
ARRAYS = ("u", "low", "high")
Pair = tuple[float, float]
NotNegative = Annotated[float, msgspec.Meta(ge=0.0)]


class StoredHypothesis(msgspec.Struct):
    """See `stored_hypothesis`."""

    log_evidence: float
    log_evidence_wide: float
    log_prior: float
    sigma: NotNegative
    p_value: Share
    residual_outside: NotNegative
    u: list[Share]
    low: list[Share]
    high: list[Share]
    variant: list[Whole]
    p_by_run: dict[str, float]
    closes: Annotated[float, msgspec.Meta(le=1.0)] | None
    worsens: list[str]


class StoredLeft(msgspec.Struct):
    """See `evidence.Left`."""

    regions: Whole
    practical: NotNegative
    gain: float


class Simple(msgspec.Struct):
    """Statistics of the simple rules (see `simple_rules`)."""

    chi_square: dict[str, tuple[NotNegative, Share]]
    signature: dict[str, float]


class Levels(msgspec.Struct):
    """Quantiles of the levels of a closure, and their columns; see `separation`."""

    levels: list[list[float]]
    columns: list[Whole]


class Separation(msgspec.Struct):
    """See `separation.separation_of`."""

    closures: dict[str, list[Levels]]
    products: list[list[float]]


class EvidenceFile(msgspec.Struct):
    """Content of a file."""

    hypotheses: dict[str, StoredHypothesis]
    mass_balance: tuple[Pair, tuple[Pair, Pair]] | None
    left: StoredLeft | None
    classes: list[list[str]]
    simple: Simple
    separation: Separation


def content_of(analysis: "Analysis") -> Content:
    """The content of the file of an analysis, as plain values."""
    left = analysis.evidence.left
    return {
        "format": FORMAT,
        "solver": solver_version(),
        "experiments": list(analysis.points.names),
        "hypotheses": {
            name: stored_hypothesis(analysis, hypothesis)
            for name, hypothesis in analysis.evidence.hypotheses.items()
        },
        "mass_balance": stored_balance(analysis.evidence.balance),
        "left": None if left is None else left._asdict(),
        "classes": [list(group) for group in analysis.separability.classes],
        "separation": separation_of(analysis),
        "simple": {"chi_square": chi_square(analysis), "signature": signature(analysis)},
    }


def stored_balance(balance: MassBalance | None) -> list[Any] | None:
    """A `MassBalance` as plain values, None if there is none."""
    return None if balance is None else [part.tolist() for part in balance]


def stored_hypothesis(analysis: "Analysis", hypothesis: Hypothesis) -> dict[str, Any]:
    """A hypothesis as plain values, with the parameters of a single effect."""
    stored: dict[str, Any] = {name: float(getattr(hypothesis, name)) for name in NUMBERS}
    stored |= {name: getattr(hypothesis, name).tolist() for name in ARRAYS}
    stored |= {"variant": list(hypothesis.variant), "p_by_run": hypothesis.p_by_run}
    stored |= {"closes": hypothesis.closes, "worsens": list(hypothesis.worsens)}
    if hypothesis.name in analysis.library.closures:
        closure = analysis.library.closures[hypothesis.name][hypothesis.variant[0]]
        inside = [
            np.clip(getattr(hypothesis, name), QUANTILE_ENDS, 1.0 - QUANTILE_ENDS)
            for name in ARRAYS
        ]
        value, low, high = (closure.values(u) for u in inside)
        stored["parameters"] = {
            name: {
                "value": value[name],
                "low": min(low[name], high[name]),
                "high": max(low[name], high[name]),
            }
            for name in value
        }
    return stored


def read_evidence(path: str | Path) -> tuple[Content, Evidence]:
    """(content, `Evidence`) of a file.

    Raises
    ------
    InputError
    """
    content = read_content(path)
    hypotheses = {
        name: read_hypothesis(name, stored) for name, stored in content["hypotheses"].items()
    }
    balance = content["mass_balance"]
    return content, Evidence(
        hypotheses,
        None if balance is None else MassBalance(*map(np.array, balance)),
        None if content["left"] is None else Left(**content["left"]),
    )


def read_hypothesis(name: str, stored: Mapping[str, Any]) -> Hypothesis:
    """A hypothesis from plain values, see `stored_hypothesis`."""
    values: dict[str, Any] = {key: stored[key] for key in (*NUMBERS, "p_by_run", "closes")}
    values |= {key: np.array(stored[key]) for key in ARRAYS}
    values |= {key: tuple(stored[key]) for key in ("variant", "worsens")}
    return Hypothesis(name=name, p_by_phase={}, difference=EMPTY, **values)


def read_content(path: str | Path) -> Content:
    """The content of a file of evidence.

    Raises
    ------
    InputError
    """
    content = read_form(path, FORMAT, "hypotheses")
    for refusal in evidence_problems(content):
        raise InputError(path, *refusal)
    return content


def evidence_problems(content: Any) -> Iterator[tuple[str, str, str]]:
    """(key, found, allowed) of what is wrong in the content of a file."""
    wrong = list(form_problems(content, EvidenceFile))
    if wrong:
        yield from wrong
        return
    tables = {"hypotheses": content["hypotheses"]} | content["simple"]
    for key in ("hypotheses", "chi_square", "signature"):
        if NONE not in tables[key] or len(tables[key]) < 2:
            yield key, f"{len(tables[key])} names", f"{NONE} and one effect or more"
        for name in tables[key]:
            if not is_name(name):
                yield key, f"the name {name!r:.40}", NAMES
    for name, stored in content["hypotheses"].items():
        if not len(stored["u"]) == len(stored["low"]) == len(stored["high"]):
            yield (
                f"hypotheses.{name}.u",
                f"{len(stored['u'])} numbers",
                "as many as in low and high",
            )
        for observable in stored["worsens"]:
            if observable not in QUANTITIES:
                yield f"hypotheses.{name}.worsens", f"{observable!r:.40}", ", ".join(QUANTITIES)
    balance = content["mass_balance"]
    if balance is not None and np.linalg.eigvalsh(balance[1]).min() <= 0.0:
        yield "mass_balance", "a covariance that is none", "a positive definite matrix"
