"""The particle laboratory: a three-dimensional particle code as a laboratory that knows nothing of this solver.

    python -m runs.particle_laboratory.study validate --data FOLDER   the two controls against the untuned model
    python -m runs.particle_laboratory.study labelled --data FOLDER   diagnosis of the cases whose cause is known
    python -m runs.particle_laboratory.study blind    --data FOLDER   diagnosis of the others: answers.json

FOLDER holds `labelled/` and `blind/`, folders of experiments. Nothing is tuned: mu(I) of the beads as measured in
shear and chute flow, no slip on the bed of glued beads, back wall 0.5. The controls, in which nothing is hidden,
teach the discrepancy of the model from this laboratory; the cases are judged after it. Finished runs are kept in
the cache, so that the same command goes on after a stop.
"""

import argparse
import csv
import json
import sys
from pathlib import Path

import numpy as np

from fvcollapse.align import align
from fvcollapse.blind.score import answer_of
from fvcollapse.case import Case
from fvcollapse.diagnosis.diagnose import diagnose
from fvcollapse.diagnosis.effect_library import Runner, baseline_cases, refined
from fvcollapse.diagnosis.report import FILE_NAME, read_report
from fvcollapse.errors import FvcollapseError, InputError
from fvcollapse.experiment import load_experiment
from fvcollapse.files import write_atomic

HERE = Path(__file__).parent
CONTROLS = ("control_10deg", "control_16deg")
BACK_WALL = 0.5  # a flat plate with this friction
CELL_SIZE = 0.010  # m, of the comparison with the controls
AT_REST = 0.1  # s; the front at rest is the mean of the measurements in the last of them


def main(argv=None):
    """Run one part; return the exit status: 0 done, 1 a run failed, 2 bad input, 130 stopped."""
    try:
        arguments = parse(argv)
        return PARTS[arguments.part](arguments)
    except FvcollapseError as error:
        print(error, file=sys.stderr)
        return error.exit_status
    except KeyboardInterrupt:
        print("interrupted; the same command goes on", file=sys.stderr)
        return 130


def parse(argv):
    """The arguments."""
    parser = argparse.ArgumentParser(
        prog="python -m runs.particle_laboratory.study", description=__doc__.split("\n")[0]
    )
    parser.add_argument("part", choices=PARTS)
    parser.add_argument("--data", type=Path, required=True, help="folder of the experiments")
    parser.add_argument("--out", type=Path, default=HERE, help="folder of tables and reports")
    parser.add_argument("--workers", type=int, default=2, help="processes; default 2")
    parser.add_argument("--cache", type=Path, help="folder of the cache of runs")
    return parser.parse_args(argv)


def believed():
    """The model before any comparison; the set-up and the friction of the beads come with each experiment."""
    return Case().replace(**{"boundary.mu_back_wall": BACK_WALL})


def controls(data):
    """The experiments in which nothing is hidden."""
    return [load_experiment(data / "labelled" / name) for name in CONTROLS]


# ---------------------------------------------------------------- validation


def validate(arguments):
    """Compare the untuned model with the controls, on two grids."""
    experiments = controls(arguments.data)
    coarse = baseline_cases(experiments, believed(), CELL_SIZE)
    wanted = {}
    for one in experiments:
        wanted[one.name, CELL_SIZE] = one, coarse[one.name]
        fine = refined(coarse[one.name])
        wanted[one.name, fine.grid.cell_size] = one, fine
    runner = Runner(arguments.cache, arguments.workers, quiet=False)
    seen, failures = runner.observations(wanted)
    for failure in failures.values():
        raise failure
    by_name = {one.name: one for one in experiments}
    rows, curves = [], []
    for (name, cell), observed in seen.items():
        rows.append(compare(by_name[name], cell, observed))
        curves += curve_rows(by_name[name], cell, observed)
    write_rows(arguments.out / "validation.csv", rows)
    write_rows(arguments.out / "validation_curves.csv", curves)
    for row in rows:
        print(", ".join(f"{key} {value}" for key, value in row.items()))
    return 0


def compare(experiment, cell, observed):
    """What differs between one control and the model: at rest, and in motion; m, s."""
    found = {each.name: each for each in align(observed, experiment)}
    front, profiles = found["front"], found["profiles"]
    last = front.time > front.time[-1] - AT_REST
    rest = profiles.time == profiles.time[-1]
    thick = rest & ((profiles.measured > 0.0) | (profiles.simulated > 0.0))
    moving = ~last
    return {
        "experiment": experiment.name,
        "cell_size": cell,
        "front_measured": round(float(front.measured[last].mean()), 4),
        "front_simulated": round(float(front.simulated[last].mean()), 4),
        "front_gap": round(float(front.gap[last].mean()), 4),
        "front_gap_in_motion_rms": round(float(np.sqrt(np.mean(front.gap[moving] ** 2))), 4),
        "thickness_rms": round(float(np.sqrt(np.mean(profiles.gap[thick] ** 2))), 5),
        "thickness_largest": round(float(np.abs(profiles.gap[thick]).max()), 5),
    }


def curve_rows(experiment, cell, observed):
    """Measured and simulated front and final profile, as rows."""
    found = {each.name: each for each in align(observed, experiment)}
    front, profiles = found["front"], found["profiles"]
    rest = profiles.time == profiles.time[-1]
    sides = [("front", front.time, front, slice(None)), ("profile", profiles.x, profiles, rest)]
    return [
        {
            "experiment": experiment.name,
            "cell_size": cell,
            "curve": kind,
            "at": round(float(at), 4),
            "measured": round(float(measured), 5),
            "simulated": round(float(simulated), 5),
            "sigma": round(float(sigma), 5),
        }
        for kind, place, each, own in sides
        for at, measured, simulated, sigma in zip(
            place[own], each.measured[own], each.simulated[own], each.sigma[own], strict=True
        )
    ]


def write_rows(path, rows):
    """Write rows (dicts of the same keys) as CSV."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)


# ---------------------------------------------------------------- diagnosis


def labelled(arguments):
    """Diagnose the cases whose cause is known, the controls left out in turn."""
    folders = sorted((arguments.data / "labelled").iterdir())
    return answer_all(arguments, folders, arguments.out / "answers_labelled.json")


def blind(arguments):
    """Diagnose the cases whose cause is withheld."""
    folder = arguments.data / "blind"
    if not folder.is_dir():
        raise InputError(folder, "folder", "nothing there", "the folder of the blind cases")
    return answer_all(arguments, sorted(folder.iterdir()), arguments.out / "answers.json")


def answer_all(arguments, folders, path):
    """Diagnose each folder by itself and write the answers and the reports; a finished one is kept."""
    found = {}
    for folder in folders:
        out = arguments.out / "reports" / folder.name
        if not (out / FILE_NAME).exists():
            others = [one for one in controls(arguments.data) if one.name != folder.name]
            diagnose(
                [folder],
                believed(),
                controls=others,
                workers=arguments.workers,
                cache=arguments.cache,
                folder=out,
                quiet=False,
            )
        found[folder.name] = answer_of(read_report(out))
        first = max(found[folder.name]["probability"].items(), key=lambda item: item[1])
        print(folder.name, found[folder.name]["verdict"], f"{first[0]} {first[1]:.2f}", flush=True)
    write_atomic(path, json.dumps(found, indent=1).encode() + b"\n")
    return 0


PARTS = {"validate": validate, "labelled": labelled, "blind": blind}

if __name__ == "__main__":
    sys.exit(main())
