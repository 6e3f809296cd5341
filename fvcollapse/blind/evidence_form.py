"""The form of a file of evidence (`suite.keep_evidence`)."""

from typing import Annotated

import msgspec
import numpy as np

from fvcollapse.blind.forms import NAMES, Share, Whole, is_name, read_form
from fvcollapse.diagnosis.names import NONE
from fvcollapse.errors import InputError
from fvcollapse.output.forms import form_problems

FORMAT = "fvcollapse-evidence"
Pair = tuple[float, float]
NotNegative = Annotated[float, msgspec.Meta(ge=0.0)]


class KeptHypothesis(msgspec.Struct):
    """See `suite.kept_hypothesis`."""

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


class Simple(msgspec.Struct):
    """Answers that take less thought."""

    chi_square: dict[str, tuple[NotNegative, Share]]
    signature: dict[str, float]


class EvidenceFile(msgspec.Struct):
    """All that a file keeps of an analysis."""

    hypotheses: dict[str, KeptHypothesis]
    mass_balance: tuple[Pair, tuple[Pair, Pair]] | None
    classes: list[list[str]]
    simple: Simple


def read_content(path):
    """The content of a file of evidence.

    Raises
    ------
    InputError
    """
    content = read_form(path, FORMAT, "hypotheses")
    for refusal in evidence_problems(content):
        raise InputError(path, *refusal)
    return content


def evidence_problems(content):
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
    for name, each in content["hypotheses"].items():
        if not len(each["u"]) == len(each["low"]) == len(each["high"]):
            yield f"hypotheses.{name}.u", f"{len(each['u'])} numbers", "as many as in low and high"
    balance = content["mass_balance"]
    if balance is not None and np.linalg.eigvalsh(balance[1]).min() <= 0.0:
        yield "mass_balance", "a covariance that is none", "a positive definite matrix"
