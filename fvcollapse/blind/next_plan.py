"""What the diagnosis of the first experiment of a case recommends to measure next; no label is read.

A plan holds the answer to the first experiment, with the controls of its laboratory, and every set-up that could be
measured next: the one that the diagnosis recommends, one of them drawn at random, and all others, among which the best
possible is found later. It is written before anything of the next experiment is known.
"""

import json
import zlib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.blind.case_evidence import analysis_of, design_of, runner_of
from fvcollapse.blind.plain_values import Answer, NextPlan, Planned
from fvcollapse.blind.set_ups import VARIED, SetUp, set_up_of, varied
from fvcollapse.diagnosis.diagnose import judge
from fvcollapse.diagnosis.next_experiment import choices, leading
from fvcollapse.diagnosis.report.words import candidate_words
from fvcollapse.errors import NumericalError
from fvcollapse.files.atomic import write_atomic

if TYPE_CHECKING:
    from fvcollapse.diagnosis.next_experiment import Choice
    from fvcollapse.diagnosis.runner import Runner
    from fvcollapse.diagnosis.verdict import Verdict

SEED = 2027  # of the random choice


def first_experiment(case: Path) -> Path:
    """Folder of the experiment of a case that is there before the next one."""
    return case / design_of(case)[0]


def keep_plans(
    cases: Sequence[Path], out: Path, options: Mapping[str, Any]
) -> dict[str, NumericalError]:
    """Write `<case>.json` into a folder for some cases; {case: NumericalError} of those that failed.

    Parameters
    ----------
    cases : sequence of Path
    out : Path
    options : dict
        See `case_evidence.study`.
    """
    runner, failed = runner_of(options), dict[str, NumericalError]()
    for case in cases:
        try:
            text = json.dumps(plan_of(case, runner, options), indent=1)
        except NumericalError as error:
            failed[case.name] = error
        else:
            write_atomic(out / f"{case.name}.json", f"{text}\n".encode())
    return failed


def plan_of(case: Path, runner: "Runner", options: Mapping[str, Any]) -> NextPlan:
    """The plan of a case.

    Returns
    -------
    dict
        `first`: answer; `leading`: hypotheses that the next experiment is to separate; `candidates` {name: {"changes",
        "words", "expected_gain" [bit], "separates"}}, the most promising first; `recommended` and `random`: two of
        their names, None where the diagnosis sees nothing left to separate.
    """
    folder = first_experiment(case)
    analysis, judged, _ = judge(analysis_of(case, runner, options, [folder]))
    candidates = candidates_of(
        set_up_of(folder.name), choices(analysis, judged.probability, runner)
    )
    return {
        "first": short_answer(judged),
        "leading": [*leading(judged.probability, analysis.responses)] if candidates else [],
        "candidates": candidates,
        "recommended": next(iter(candidates), None),
        "random": one_of(candidates, case.name),
    }


def candidates_of(set_up: SetUp, found: "Iterable[Choice]") -> dict[str, Planned]:
    """{name: about} of the `Choice`s of a diagnosis that are no repeat of the set-up, in their order."""
    table: dict[str, Planned] = {}
    for choice in found:
        changes = choice.candidate.changes
        if varied(set_up, changes) != set_up:
            table[name_of(changes)] = {
                "changes": changes,
                "words": candidate_words(choice.candidate),
                "expected_gain": choice.gain,
                "separates": list(choice.separates),
            }
    return table


def name_of(changes: Mapping[str, float]) -> str:
    """Name of a set-up that differs from the first one, which is that of its folder."""
    parts = [f"{VARIED[key]}_{value:g}" for key, value in changes.items() if key in VARIED]
    return "_".join(parts)


def one_of(candidates: Mapping[str, Planned], name: str) -> str | None:
    """A candidate drawn at random for the case of a name, whatever is recommended; None if there is none."""
    rng = np.random.default_rng([SEED, zlib.crc32(name.encode())])
    names = sorted(candidates)
    return names[rng.integers(len(names))] if names else None


def short_answer(judged: "Verdict") -> Answer:
    """A `Verdict` as an answer, without parameters."""
    return {
        "verdict": judged.kind,
        "probability": judged.probability,
        "set": list(judged.set),
    }
