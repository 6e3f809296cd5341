"""Real laboratories, and what is known of them: a diagnosis should say what was done, and no more than that.

    python -m runs.laboratories.study folders --data FOLDER
    python -m runs.laboratories.study diagnose [--only NAME…]

Parts:

    folders     published measurements as experiment folders below --experiments; see `folders.py`
    diagnose    one diagnosis for each laboratory of `LABORATORIES`: answers.json, answers.csv
    columns     all 28 columns of glass beads with one friction of the grains: columns.csv, columns_fit.csv

Nothing is tuned to an answer. The pages go below --out; runs are kept in the cache of runs. An answer that was
given by the present solver and diagnosis is not given again.
"""

import json
import sys
from functools import partial
from pathlib import Path
from typing import NamedTuple

from fvcollapse import diagnose as ask
from fvcollapse import load_case
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.diagnosis.report.sentences import answer as answer_lines
from fvcollapse.diagnosis.report.sentences import headline
from fvcollapse.diagnosis.report.standing import standing
from fvcollapse.files.atomic import write_atomic
from fvcollapse.output.fingerprint import solver_version
from runs.cross_code.study import DIAGNOSIS, called, called_name, digest_of
from runs.laboratories.columns import columns
from runs.laboratories.folders import folders
from runs.study import Study, one_of
from runs.study import main as call
from runs.table import RUNS, write_table

HERE = Path(__file__).parent
EXPERIMENTS = RUNS / "experiments"
ANSWERS = "answers.json"


class Laboratory(NamedTuple):
    """Experiments that are diagnosed together, by their folders below --experiments.

    Attributes
    ----------
    experiments, controls, held_out : tuple of str
    known : str
        What was really done, or what cannot act there, in words.
    right : tuple of str
        Answers that are right: effects, "none" or "unknown"; empty where nobody knows.
    wrong : tuple of str
        Effects that cannot act in this laboratory.
    believed : str
        Case file in this folder; empty: the defaults with the set-up of each experiment.
    """

    experiments: tuple
    controls: tuple = ()
    held_out: tuple = ()
    known: str = ""
    right: tuple = ()
    wrong: tuple = ()
    believed: str = ""


def below(folder, *names):
    """Experiments of one folder."""
    return tuple(f"{folder}/{name}" for name in names)


WATER = "5 % of water; the controls are the same beads, dry"
LABORATORIES = {
    "bars": Laboratory(
        ("bui2008_bars",),
        known="no lateral walls, released at once, horizontal, friction measured",
        wrong=("lateral_friction", "gate", "transverse_profile"),
    ),
    "wet_beads": Laboratory(
        below("alfarizki2023", "d06mm_wet5", "d10mm_wet5"),
        below("alfarizki2023", "d06mm_dry", "d10mm_dry"),
        known=WATER,
        right=("cohesion",),
    ),
    "wet_beads_6mm": Laboratory(
        below("alfarizki2023", "d06mm_wet5"),
        below("alfarizki2023", "d06mm_dry"),
        known=WATER,
        right=("cohesion",),
    ),
    "wet_beads_10mm": Laboratory(
        below("alfarizki2023", "d10mm_wet5"),
        below("alfarizki2023", "d10mm_dry"),
        known=WATER,
        right=("cohesion",),
    ),
    # of the columns between 0.7 and 6 whose run-out and final height were both measured, every third is held out
    "lajeunesse": Laboratory(
        below("lajeunesse2005", "a0.70", "a0.80", "a1.41", "a2.06", "a3.18", "a4.88"),
        held_out=below("lajeunesse2005", "a0.89", "a2.56", "a5.93"),
        known="glass walls 45 mm apart, whose friction was measured; no intervention",
    ),
    "mangeney": Laboratory(
        ("mangeney2010_0deg",),
        known="glass walls 10 cm apart, a gate of 2.3 m/s; no intervention",
    ),
    "narrow_slot": Laboratory(
        below("narrow_slot", "mur0.1_a2", "mur0.1_a4"),
        below("narrow_slot", "mur0_a2", "mur0_a4"),
        known="rolling friction 0.1, no effect of the catalogue; the controls have none",
        right=(UNKNOWN,),
        wrong=("gate", "cohesion"),
        believed="narrow_slot.toml",
    ),
}


# -- diagnosis -----------------------------------------------------------------------------------


def diagnose(options):
    """Diagnose what is not answered yet; every answer is written as soon as it is there."""
    path = options.tables / ANSWERS
    answers = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    made_with = {"solver": solver_version(), "diagnosis": digest_of(DIAGNOSIS)}
    for name in options.only or LABORATORIES:
        if answers.get(name, {}).get("made_with") == made_with:
            continue
        answer = answer_of(diagnosed(name, options), LABORATORIES[name])
        answers[name] = answer | {"made_with": made_with}
        answers = {each: answers[each] for each in LABORATORIES if each in answers}
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomic(path, (json.dumps(answers, indent=1) + "\n").encode())
        print(f"{name}: {answer['headline']}", flush=True)
    write_table(
        options.tables / "answers.csv", [row_of(name, one) for name, one in answers.items()]
    )


def diagnosed(name, options):
    """The `Report` of a laboratory."""
    laboratory = LABORATORIES[name]
    given = (laboratory.experiments, laboratory.held_out, laboratory.controls)
    experiments, held_out, controls = (
        [options.experiments / folder for folder in folders] for folders in given
    )
    return ask(
        experiments,
        load_case(HERE / laboratory.believed) if laboratory.believed else None,
        held_out,
        folder=options.out / name,
        workers=options.workers,
        cell_size=options.cell_size,
        controls=controls,
        cache=options.cache,
        quiet=False,
        force=True,  # the answer of an earlier diagnosis
    )


def answer_of(report, laboratory):
    """What a report says, as `answers.json` keeps it."""
    details = report.details
    return {
        "experiments": report.experiments,
        "controls": [name.rpartition("/")[2] for name in laboratory.controls],
        "held_out": report.held_out,
        "known": laboratory.known,
        "headline": headline(report),
        "answer": answer_lines(report),
        "verdict": report.verdict.kind,
        "effects": report.verdict.effects,
        "state": standing(report).state,
        "probability": {name: round(p, 4) for name, p in report.verdict.probability.items()},
        "set": report.verdict.set,
        "indistinguishable": report.verdict.indistinguishable,
        "gap": {name: float(f"{gap.rms_gap:.3g}") for name, gap in report.by_observable.items()},
        "ratio": {name: round(gap.ratio, 2) for name, gap in report.by_observable.items()},
        "regions": [region.words for region in report.where],
        "models": [model_of(rung) for rung in details.ladder],
        "unexplained": details.unexplained.words if details.unexplained else "",
        "cannot_be_told": details.limits,
        "runs": report.cost.solver_runs,
        "cell_size": report.cost.cell_size,
    }


def model_of(rung):
    """A model of the ladder: how far it closes the gap, and with what parameters."""
    closed = {"fitted": rung.fitted, "held_out": rung.held_out}
    return {
        "model": rung.model,
        "effects": rung.effects,
        "rms": {part: round(one.rms, 2) for part, one in closed.items() if one},
        "closed": {
            part: None if one.fraction_closed is None else round(one.fraction_closed, 3)
            for part, one in closed.items()
            if one
        },
        "parameters": {
            name: [significant(value) for value in (one.value, one.low, one.high)]
            for name, one in (rung.parameters | rung.calibrated).items()
        },
    }


def significant(value):
    """A number with three significant digits; None stays."""
    return None if value is None else float(f"{value:.3g}")


def row_of(name, answer):
    """An answer in one row."""
    laboratory, probability = LABORATORIES[name], answer["probability"]
    best = max(
        (model for model in answer["models"] if model["closed"].get("fitted") is not None),
        key=lambda model: model["closed"]["fitted"],
        default=None,
    )
    impossible = [each for each in probability if set(each.split("+")) & set(laboratory.wrong)]
    return {
        "laboratory": name,
        "called": called(answer),
        "probability": probability[called_name(answer)],
        "state": answer["state"],
        "right": " ".join(laboratory.right),
        "of_the_right": share(probability, laboratory.right),
        "of_the_impossible": round(sum(probability[each] for each in impossible), 4),
        "none": probability[NONE],
        "unknown": probability[UNKNOWN],
        "names_in_set": len(answer["set"]),
        "regions": len(answer["regions"]),
        "largest_ratio": max(answer["ratio"].values()),
        "closes_most": "+".join(best["effects"]) or best["model"] if best else "",
        "closed": best["closed"]["fitted"] if best else "",
        "closed_held_out": best["closed"].get("held_out", "") if best else "",
    }


def share(probability, names):
    """Probability of the hypotheses that hold one of some causes; "" without any."""
    if not names:
        return ""
    held = [each for each in probability if set(each.split("+")) & set(names)]
    return round(sum(probability[each] for each in held), 4)


# -- the call ------------------------------------------------------------------------------------


def add_options(parser):
    """The options of the folders and of single laboratories."""
    where = {"type": Path, "metavar": "FOLDER", "default": EXPERIMENTS}
    parser.add_argument("--experiments", **where, help="folder of the experiment folders")
    only = one_of("--only", LABORATORIES)
    parser.add_argument("--only", nargs="+", type=only, metavar="NAME", help="of diagnose")


STUDY = Study(
    "laboratories",
    __doc__,
    {"folders": folders, "diagnose": diagnose, "columns": columns},
    need_data=("folders",),
    add_options=add_options,
)
main = partial(call, STUDY)


if __name__ == "__main__":
    sys.exit(main())
