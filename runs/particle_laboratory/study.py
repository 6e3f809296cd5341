"""Collapses computed grain by grain, as a laboratory whose hidden causes are known for certain.

    python -m runs.particle_laboratory.study validation discrepancy labelled --data FOLDER

FOLDER holds `labelled` and `blind` experiment folders; `baseline.toml` is what is believed, nothing in it is
tuned to a collapse. Parts:

    validation    the controls, in which nothing is hidden, beside the baseline: validation.csv, curves.csv
    discrepancy   what the controls teach; each judged by the other: discrepancy.csv
    labelled      diagnosis of the cases whose cause is told, beside the controls: labelled/<case>/
    blind         diagnosis of the cases whose cause is withheld: answers.json, blind/<case>/
    opened        diagnosis of these thirteen again, beside the causes that are told by now: opened.csv
    series        diagnosis of series of three slopes whose cause is withheld: series_answers.json
    thin_layers   all references without a hidden cause, with and without friction of thin layers: thin_layers.csv
    thin_layers_finer   the same lengths on cells of 4 mm: thin_layers_finer.csv
    walls         friction of the walls in the model against walls of the grains: walls.csv
    mobilised     friction that the walls of the model mobilise on average: mobilised.csv
    shape         which effect closes the gap of shape and volume, in all references: shape.csv
    closures      cohesion and dilatancy beside the opened cases that hide them: closures.csv

The pages of the reports, with their figures, go below --out. Runs are kept in the cache of runs: an
interrupted part continues with the same command.
"""

import json
import shutil
import sys
from functools import partial
from pathlib import Path

import numpy as np

from fvcollapse import diagnose, load_case, load_experiment, observe
from fvcollapse.diagnosis.analysis import analyse
from fvcollapse.diagnosis.diagnose import judge
from fvcollapse.diagnosis.question import Question
from fvcollapse.diagnosis.report import FILE_NAME
from fvcollapse.diagnosis.runner import Runner
from fvcollapse.files.atomic import write_atomic
from fvcollapse.measure.align import align
from runs.particle_laboratory.closures import closures
from runs.particle_laboratory.mobilised import mobilised
from runs.particle_laboratory.opened import opened
from runs.particle_laboratory.series import ANSWERS, series
from runs.particle_laboratory.shape import shape
from runs.particle_laboratory.thin_layers import thin_layers, thin_layers_finer
from runs.particle_laboratory.walls import walls
from runs.study import Study, run_cached
from runs.study import main as call
from runs.table import write_table

HERE = Path(__file__).parent
BASELINE = HERE / "baseline.toml"
CELL_SIZES = (0.008, 0.006)  # m, of the validation; the curves are of the last
CONTROLS = ("control_10deg", "control_16deg")
LABELLED = ("lateral_walls_16deg", "slow_gate_16deg")
FRONT_LIMIT, THICKNESS_LIMIT = (
    0.015,
    0.004,
)  # m, of the front at rest and of the final thickness (rms)
LAST_READINGS = 5  # of the front, whose mean is the front at rest: it is jagged
PROFILES_SHOWN = 6  # times in curves.csv


def controls(data):
    """The experiments in which nothing is hidden."""
    return [load_experiment(data / "labelled" / name) for name in CONTROLS]


# -- validation ----------------------------------------------------------------------------------


def validation(arguments):
    """Compare the controls with the baseline; nothing is tuned."""
    base, experiments = load_case(BASELINE), controls(arguments.data)
    wanted = {
        (one.name, size): (one, one.case(base).replace(**{"grid.cell_size": size}))
        for size in reversed(CELL_SIZES)
        for one in experiments
    }
    results = run_cached({label: case for label, (_, case) in wanted.items()}, arguments)
    rows, curves = [], []
    for one in experiments:
        for size in CELL_SIZES:
            pairs = align(observe(results[one.name, size], one), one)
            rows.append({"experiment": one.name, "cell_size": size} | measures(pairs))
        curves += curve_rows(one.name, pairs)
    write_table(arguments.tables / "validation.csv", rows)
    write_table(arguments.tables / "curves.csv", curves)
    for row in rows:
        print("  ".join(f"{name} {value}" for name, value in row.items()))


def measures(pairs):
    """What one comparison says; lengths in m."""
    found = {pair.name: pair for pair in pairs}
    front, profiles = found["front"], found["profiles"]
    at_rest = [
        float(np.mean(values[-LAST_READINGS:])) for values in (front.measured, front.simulated)
    ]
    final = profiles.time == profiles.time[-1]
    thickness = rms(profiles.gap[final])
    passed = abs(at_rest[1] - at_rest[0]) <= FRONT_LIMIT and thickness <= THICKNESS_LIMIT
    return {
        "front_measured": round(at_rest[0], 4),
        "front_simulated": round(at_rest[1], 4),
        "front_difference": round(at_rest[1] - at_rest[0], 4),
        "final_thickness_rms": round(thickness, 5),
        "passed": passed,
        "front_rms_all_times": round(rms(front.gap), 4),
        "thickness_rms_all_times": round(rms(profiles.gap), 5),
        "interface_rms_all_times": round(rms(found["interface"].gap), 5),
        "largest_volume_measured": round(float(found["volume"].measured.max()), 4),
    }


def rms(gap):
    """Root mean square."""
    return float(np.sqrt(np.mean(gap**2)))


def curve_rows(name, pairs):
    """Rows of curves.csv: the front at all times, profiles at some."""
    rows = []
    for pair in pairs:
        if pair.name not in ("front", "profiles"):
            continue
        times = np.unique(pair.time)
        if pair.name == "profiles":
            times = times[np.linspace(1, len(times) - 1, PROFILES_SHOWN).round().astype(int)]
        for n in np.flatnonzero(np.isin(pair.time, times)):
            place = "" if np.isnan(pair.x[n]) else f"{pair.x[n]:.4f}"
            values = (f"{pair.measured[n]:.5f}", f"{pair.simulated[n]:.5f}")
            keys = ("experiment", "observable", "time", "x", "measured", "simulated")
            cells = (name, pair.name, f"{pair.time[n]:.3f}", place, *values)
            rows.append(dict(zip(keys, cells, strict=True)))
    return rows


# -- what the controls teach ----------------------------------------------------------------------


def discrepancy(arguments):
    """Learn from each control, and judge the other by it: nothing is hidden, so nothing may be found."""
    base, experiments = load_case(BASELINE), controls(arguments.data)
    rows = []
    for one in experiments:
        others = [other for other in experiments if other is not one]
        for taught, given in (("nothing", ()), (others[0].name, others)):
            question = Question(
                (one,),
                controls=tuple(given),
                believed=base,
                cell_size=arguments.cell_size,
            )
            found = analyse(question, new_runner(arguments))
            found, answer, _ = judge(found)
            none = found.evidence.hypotheses["none"]
            row = {
                "experiment": one.name,
                "taught_by": taught,
                "verdict": " ".join([answer.kind, *answer.effects]),
                "probability_none": round(answer.probability["none"], 3),
                "p_value_none": float(f"{none.p_value:.2g}"),
                "regions": len(found.gap_map.regions),
            }
            for level in found.gap_map.by_observable:
                if not level.experiment:
                    row[f"ratio_{level.observable}"] = round(level.ratio, 2)
            if found.discrepancy is not None:
                row["correlation"] = round(found.discrepancy.correlation, 2)
                for name, factor in found.discrepancy.factors.items():
                    row[f"factor_{name}"] = round(factor, 2)
            rows.append(row)
    write_table(arguments.tables / "discrepancy.csv", rows)
    for row in rows:
        print("  ".join(f"{name} {value}" for name, value in row.items()))


# -- diagnosis -----------------------------------------------------------------------------------


def labelled(arguments):
    """Diagnose the cases whose cause is told."""
    folders = [arguments.data / "labelled" / name for name in LABELLED]
    answers = diagnoses(folders, "labelled", arguments)
    write_answers(arguments.tables / "labelled" / "answers.json", answers)


def blind(arguments):
    """Diagnose the cases whose cause is withheld."""
    folders = sorted(path for path in (arguments.data / "blind").iterdir() if path.is_dir())
    answers = diagnoses(folders, "blind", arguments)
    write_answers(arguments.tables / "answers.json", answers)


def all_series(arguments):
    """Diagnose the series whose cause is withheld."""
    answers = series(arguments, BASELINE, controls(arguments.data))
    write_answers(arguments.tables / ANSWERS, answers)


def diagnoses(folders, part, arguments):
    """{case: answer}; the report of each goes into a folder of its own, the page stays below --out."""
    answers, taught = {}, controls(arguments.data)
    for folder in folders:
        page = arguments.out / part / folder.name
        report = diagnose(
            [folder],
            BASELINE,
            workers=arguments.workers,
            folder=page,
            cell_size=arguments.cell_size,
            controls=taught,
            cache=arguments.cache,
            quiet=False,
        )
        target = arguments.tables / part / folder.name / FILE_NAME
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(page / FILE_NAME, target)
        found = report.verdict
        answers[folder.name] = {
            "verdict": found.kind,
            "probability": found.probability,
            "set": found.set,
        }
        best = sorted(found.probability.items(), key=lambda item: -item[1])[:3]
        told = ", ".join(f"{name} {chance:.2f}" for name, chance in best)
        print(f"{folder.name}: {found.kind} ({told})", flush=True)
    return answers


# -- files ---------------------------------------------------------------------------------------


def new_runner(arguments):
    """The runs, with a bar."""
    return Runner(arguments.cache, arguments.workers, quiet=False)


def write_answers(path, answers):
    """Write answers as `fvcollapse blind score` reads them."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_atomic(path, (json.dumps(answers, indent=1) + "\n").encode())
    print(path)


STUDY = Study(
    "particle_laboratory",
    __doc__,
    {
        "validation": validation,
        "discrepancy": discrepancy,
        "labelled": labelled,
        "blind": blind,
        "opened": partial(opened, baseline=BASELINE, controls=controls),
        "series": all_series,
        "thin_layers": partial(thin_layers, baseline=BASELINE, measures=measures),
        "thin_layers_finer": partial(thin_layers_finer, baseline=BASELINE, measures=measures),
        "walls": partial(walls, baseline=BASELINE),
        "mobilised": partial(mobilised, baseline=BASELINE),
        "shape": partial(shape, baseline=BASELINE),
        "closures": partial(closures, baseline=BASELINE),
    },
    need_data=(
        "validation",
        "discrepancy",
        "labelled",
        "blind",
        "opened",
        "series",
        "thin_layers",
        "thin_layers_finer",
        "walls",
        "mobilised",
        "shape",
        "closures",
    ),
)
main = partial(call, STUDY)


if __name__ == "__main__":
    sys.exit(main())
