"""Another code, nothing hidden: what a diagnosis says of an honest error of the model.

    python -m runs.cross_code.study differences null --data FOLDER

FOLDER holds the curves of a volume-of-fluid code that solves the same equations with the same constants. Parts:

    differences   the two codes side by side, without noise, on the points of a diagnosis: differences.csv
    null          the curves filmed with the noise of a laboratory and diagnosed with the right model, without
                  controls, alone and as series: answers.json, answers.csv
    precision     some of these questions filmed with a half and a quarter of the noise: precision.csv

Every answer but "none" is wrong. Films and pages go below --out; runs are kept in the cache of runs. An answer
that was given by the present solver and diagnosis is not given again.
"""

import ast
import json
import sys
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fvcollapse import diagnose, observe
from fvcollapse.blind.measurement import Errors
from fvcollapse.diagnosis import baseline
from fvcollapse.diagnosis.baseline import REFINEMENT
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.diagnosis.question import Question
from fvcollapse.diagnosis.report.standing import standing
from fvcollapse.files.atomic import write_atomic
from fvcollapse.output.fingerprint import Counted, solver_version
from runs.cross_code.films import ERRORS, PEERS, write_experiment
from runs.study import Study, one_of, run_cached
from runs.study import main as call
from runs.table import write_table

ANSWERS = "answers.json"
DIAGNOSIS = Path(baseline.__file__).parent
SOURCES = (".py", ".json")
EXACT = Errors(*[0.0] * len(Errors._fields))
REFINEMENTS = (1.0, REFINEMENT, 0.5)  # cell sizes relative to the coarser grid of a diagnosis


class Posed(NamedTuple):
    """A question of the null: names of `PEERS` that are filmed, and the seed of the noise."""

    peers: tuple
    noise: int = 1


QUESTIONS = {
    **{name: Posed((name,)) for name in PEERS},
    "flat_3mm_noise2": Posed(("flat_3mm",), 2),
    "flat_3mm_noise3": Posed(("flat_3mm",), 3),
    "steep_3mm_noise2": Posed(("steep_3mm",), 2),
    "steep_3mm_noise3": Posed(("steep_3mm",), 3),
    "series_3mm": Posed(("flat_3mm", "steep_3mm")),
    "series_3mm_noise2": Posed(("flat_3mm", "steep_3mm"), 2),
    "series_6mm": Posed(("flat_6mm", "steep_6mm")),
    "series_slippery": Posed(("flat_3mm_slippery", "flat_6mm_slippery"), 2),
}


PRECISE = ("flat_3mm", "steep_3mm", "series_3mm")  # questions that are filmed with less noise
FACTORS = (0.5, 0.25)  # on all errors of the measurement


# -- the two codes side by side --------------------------------------------------------------------


def differences(options):
    """How far the two codes differ on the points of a diagnosis, grid by grid."""
    exact = {
        name: write_experiment(options.out / "exact" / name, options.data, peer, 0, EXACT)
        for name, peer in PEERS.items()
    }
    questions = {name: Question((one,), cell_size=options.cell_size) for name, one in exact.items()}
    cases = {
        (name, size): refined_case(question.baseline, size)
        for name, question in questions.items()
        for size in REFINEMENTS
    }
    results = run_cached(cases, options)
    rows = []
    for (name, size), case in cases.items():
        points, one = questions[name].points, exact[name]
        gap = points.simulated({one.name: observe(results[name, size], one)}) - points.measured
        row = {"collapse": name, "cell_size_mm": round(1000.0 * case.grid.cell_size, 2)}
        rows.append(row | measures(points, gap))
        print("  ".join(f"{key} {value}" for key, value in rows[-1].items()), flush=True)
    write_table(options.tables / "differences.csv", rows)


def refined_case(case, size):
    """A case on cells `size` times as large, with steps shorter in proportion."""
    changes = {
        "grid.cell_size": size * case.grid.cell_size,
        "time.step_max": size * case.time.step_max,
    }
    return case.replace(**changes)


def measures(points, gap):
    """Root mean square and mean of a gap, by observable: lengths in mm."""
    found, observable = {}, points.observable
    for name, quantity in (("thickness", "profiles"), ("front", "front")):
        own = 1000.0 * gap[observable == quantity]
        found[f"{name}_rms_mm"] = round(float(np.sqrt(np.mean(own**2))), 2)
        found[f"{name}_mean_mm"] = round(float(np.mean(own)), 2)
    return found


# -- the null --------------------------------------------------------------------------------------


def null(options):
    """Diagnose what is not answered yet; every answer is written as soon as it is there."""
    path = options.tables / ANSWERS
    answers = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    made_with = {"solver": solver_version(), "diagnosis": digest_of(DIAGNOSIS)}
    for name in options.only or QUESTIONS:
        if answers.get(name, {}).get("made_with") == made_with:
            continue
        answer = answer_of(diagnosed(name, options), QUESTIONS[name])
        answers[name] = answer | {"made_with": made_with}
        answers = {each: answers[each] for each in QUESTIONS if each in answers}
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomic(path, (json.dumps(answers, indent=1) + "\n").encode())
        print(f"{name}: {called(answer)} {answer['probability'][called_name(answer)]:.2f}")
    rows = [row_of(name, answer) for name, answer in answers.items()]
    write_table(options.tables / "answers.csv", rows)
    print(summary(answers))


def digest_of(folder):
    """Digest of the modules and of the verdict layers in a folder; hints, docstrings and comments do not count."""
    paths = sorted(path for path in folder.iterdir() if path.suffix in SOURCES)
    texts = [path.read_text(encoding="utf-8") for path in paths]
    read = [
        code_of(text) if path.suffix == ".py" else text
        for path, text in zip(paths, texts, strict=True)
    ]
    return sha256("\n".join(read).encode()).hexdigest()[:12]


def code_of(text):
    """The statements of a module without hints, imports, docstrings and comments."""
    return ast.unparse(
        ast.fix_missing_locations(WithoutHints(lambda _: None).visit(ast.parse(text)))
    )


class WithoutHints(Counted):
    """A module without its hints, those of variables and attributes included."""

    def visit_AnnAssign(self, node):  # noqa: N802
        """A variable with a hint: what it is set to, or its name."""
        node = self.generic_visit(node)
        if node.value is None:
            return ast.Expr(node.target)
        return ast.Assign([node.target], node.value)

    def visit_If(self, node):  # noqa: N802
        """A condition; nothing of what only a type checker reads."""
        return None if ast.unparse(node.test) == "TYPE_CHECKING" else self.generic_visit(node)


def precision(options):
    """What a diagnosis says of films with less noise, which state so."""
    rows = []
    for factor in FACTORS:
        for name in PRECISE:
            answer = answer_of(diagnosed(name, options, factor), QUESTIONS[name])
            rows.append({"noise_factor": factor} | row_of(name, answer))
            print(f"{name}, noise x {factor}: {called(answer)} {rows[-1]['probability']:.2f}")
    write_table(options.tables / "precision.csv", rows)


def diagnosed(name, options, factor=1.0):
    """The `Report` of a question, all errors of the measurement times a factor."""
    peers, noise = QUESTIONS[name]
    less = "" if factor == 1.0 else f"_of_{factor:g}"
    folder = options.out / "films" / f"noise{noise}{less}"
    errors = Errors(*(factor * error for error in ERRORS))
    experiments = [
        write_experiment(folder / peer, options.data, PEERS[peer], noise, errors) for peer in peers
    ]
    return diagnose(
        experiments,
        folder=options.out / "null" / f"{name}{less}",
        workers=options.workers,
        cell_size=options.cell_size,
        cache=options.cache,
        quiet=False,
        force=True,  # the answer of an earlier diagnosis
    )


def answer_of(report, posed):
    """What a report says, as `answers.json` keeps it."""
    gaps = report.by_observable
    return {
        "experiments": list(posed.peers),
        "noise": posed.noise,
        "verdict": report.verdict.kind,
        "effects": report.verdict.effects,
        "state": standing(report).state,
        "probability": {name: round(p, 4) for name, p in report.verdict.probability.items()},
        "set": report.verdict.set,
        "regions": len(report.where),
        "gap": {name: float(f"{gap.rms_gap:.3g}") for name, gap in gaps.items()},
        "ratio": {name: round(gap.ratio, 2) for name, gap in gaps.items()},
    }


def called(answer):
    """none, unknown, or the effects that are named."""
    return called_name(answer) if answer["effects"] else answer["verdict"]


def called_name(answer):
    """The hypothesis that is named."""
    return "+".join(sorted(answer["effects"])) or answer["verdict"]


def row_of(name, answer):
    """An answer in one row."""
    probability = answer["probability"]
    return {
        "question": name,
        "experiments": " ".join(answer["experiments"]),
        "noise": answer["noise"],
        "called": called(answer),
        "probability": probability[called_name(answer)],
        "state": answer["state"],
        "none": probability[NONE],
        "unknown": probability[UNKNOWN],
        "names_in_set": len(answer["set"]),
        "regions": answer["regions"],
        "thickness_mm": round(1000.0 * answer["gap"]["profiles"], 2),
        "thickness_ratio": answer["ratio"]["profiles"],
        "front_mm": round(1000.0 * answer["gap"]["front"], 1),
        "front_ratio": answer["ratio"]["front"],
    }


def summary(answers):
    """How many are called what, in one line."""
    wrong = {name: one for name, one in answers.items() if one["verdict"] != NONE}
    unknown = sum(one["verdict"] == UNKNOWN for one in answers.values())
    largest = max((one["probability"][called_name(one)] for one in wrong.values()), default=0.0)
    return (
        f"{len(answers)} of {len(QUESTIONS)} answered: none {len(answers) - len(wrong)}, unknown {unknown}, an effect "
        f"{len(wrong) - unknown}; largest probability of a wrong answer {largest:.2f}"
    )


def add_options(parser):
    """The option of single questions."""
    only = one_of("--only", QUESTIONS)
    parser.add_argument("--only", nargs="+", type=only, metavar="QUESTION", help="of the null")


STUDY = Study(
    "cross_code",
    __doc__,
    {"differences": differences, "null": null, "precision": precision},
    need_data=("differences", "null", "precision"),
    add_options=add_options,
)
main = partial(call, STUDY)


if __name__ == "__main__":
    sys.exit(main())
