"""What the printed facts of a published study say of friction on the lateral walls.

Do they decide that it was missing?

    python -m runs.paper_case.study facts power

The baseline is the model of Martin et al. (2017) without lateral friction (`baseline.toml`). Parts:

    facts   diagnosis of what is printed of the experiments (runs/experiments/mangeney2010_0deg and
            martin2017): a runout, a height and bounds; facts/report.json
    power   a collapse at 22 degrees made with walls (the paper's mu_wall, other cells, noise), measured
            less and less well: which measurement decides? power.csv

Pages and films go below --out. Runs are kept in the cache of runs: an interrupted part continues with the same
command.
"""

import sys
from functools import partial
from pathlib import Path

import numpy as np

from fvcollapse import diagnose, load_case, load_experiment, observe
from fvcollapse.blind.measurement import Errors, film
from fvcollapse.blind.truth import View
from fvcollapse.files.atomic import write_atomic
from fvcollapse.measure.curves import Scalar, scalars_text
from runs.experiments.convert import LAST_GRAINS, MARTIN, SALTATION
from runs.study import Study, run_cached
from runs.study import main as call
from runs.table import write_table

HERE = Path(__file__).parent
EXPERIMENTS = HERE.parent / "experiments"
FACTS = ("mangeney2010_0deg", *(f"martin2017/martin2017_{a}deg_w{100 * w:g}cm" for a, w in MARTIN))
SLOPE, WIDTH = 22, 0.10  # deg, m; of the synthetic experiment
END, REACH = 2.0, 1.5  # s, m; last frame and last place on the film
TRUTH = {  # what really acts; the laboratory believes the baseline
    "rheology.mu_1": 0.486,
    "rheology.mu_2": 0.74,
    "grid.cell_size": 0.005,
    "numerics.shear_rate_min": 2e-4,
    "effects.lateral_friction": {"mu_wall": 0.18, "scheme": "split"},
}
ERRORS = Errors(
    thickness=0.002,
    front=0.010,
    relative_volume=0.01,
    interface=0.003,
    scale=0.007,
    offset=0.001,
    time=0.005,
)
SEED = 2017
# name -> (scalars and their kinds, curves that are kept)
MEASURED = {
    "bounds as printed": ({"runout": "upper", "time_stop": "upper"}, ()),
    "runout": ({"runout": "value"}, ()),
    "runout and final height": ({"runout": "value", "final_height": "value"}, ()),
    "front": ({}, ("front",)),
    "front and profiles": ({}, ("front", "profiles")),
    "all curves": ({}, ("front", "profiles", "volume", "interface")),
}
SIGMA = {"runout": SALTATION, "final_height": 0.005, "time_stop": LAST_GRAINS}
SETTINGS = """title = "synthetic: {title}"
source = "runs/paper_case/study.py: fvcollapse with lateral friction, 5 mm cells, noise"

[geometry]
slope_angle_deg = {slope}
height_0 = 0.14
length_0 = 0.20
channel_width = {width}

[gate]
speed = 2.3
"""


def diagnosed(experiments, out, arguments):
    """The `Report` of experiments against the baseline without walls."""
    return diagnose(
        experiments,
        load_case(HERE / "baseline.toml"),
        folder=out,
        cache=arguments.cache,
        cell_size=arguments.cell_size,
        workers=arguments.workers,
        quiet=False,
    )


def facts(arguments):
    """Diagnose the printed facts."""
    out = arguments.out / "facts"
    report = diagnosed([EXPERIMENTS / name for name in FACTS], out, arguments)
    target = arguments.tables / "facts" / "report.json"
    target.parent.mkdir(parents=True, exist_ok=True)
    write_atomic(target, (out / "report.json").read_bytes())
    print(row_of("printed facts", report))


def power(arguments):
    """Diagnose one synthetic collapse, known better and better."""
    folder = arguments.out / "power"
    seen, texts = filmed(arguments)
    rows = []
    for title, (kinds, curves) in MEASURED.items():
        name = title.replace(" ", "_")
        experiment = write_experiment(folder / name / "collapse", title, seen, texts, kinds, curves)
        report = diagnosed([experiment], folder / name / "diagnosis", arguments)
        rows.append(row_of(title, report))
        print(rows[-1])
    write_table(arguments.tables / "power.csv", rows)


def filmed(arguments):
    """(scalars, CSV texts) of the collapse with walls."""
    base = load_case(HERE / "baseline.toml")
    case = base.replace(
        **TRUTH,
        **{
            "geometry.slope_angle_deg": float(SLOPE),
            "geometry.height_0": 0.14,
            "geometry.length_0": 0.20,
            "geometry.channel_width": WIDTH,
            "gate.speed": 2.3,
            "time.end": 2.6,
        },
    )
    result = run_cached({"truth": case}, arguments)["truth"]
    seen = observe(result, front_thickness=0.005)
    texts = film(View.of(seen), END, REACH, ERRORS, np.random.default_rng(SEED))
    return seen.scalars, texts


def write_experiment(folder, title, seen, texts, kinds, curves):
    """An experiment folder with some of what was seen; bounds are those that the paper prints."""
    folder.mkdir(parents=True, exist_ok=True)
    settings = SETTINGS.format(title=title, slope=float(SLOPE), width=WIDTH)
    write_atomic(folder / "experiment.toml", settings.encode())
    rng = np.random.default_rng(SEED)
    scatter = {name: sigma * rng.standard_normal() for name, sigma in SIGMA.items()}
    bounds = dict(zip(("runout", "time_stop"), MARTIN[SLOPE, WIDTH], strict=True))
    scalars = [
        Scalar(name, bounds[name], SIGMA[name], kind)
        if kind == "upper"
        else Scalar(name, round(seen[name] + scatter[name], 4), SIGMA[name], kind)
        for name, kind in kinds.items()
    ]
    if scalars:
        write_atomic(folder / "scalars.csv", scalars_text(scalars).encode())
    for name in curves:
        write_atomic(folder / f"{name}.csv", texts[f"{name}.csv"].encode())
    return load_experiment(folder)


def row_of(title, report):
    """What a diagnosis answers, in one row."""
    chance = report.verdict.probability
    walls = chance.get("lateral_friction", 0.0)
    found = report.candidates.get("lateral_friction")
    best = sorted(chance, key=chance.get, reverse=True)[:3]
    return {
        "measured": title,
        "verdict": " ".join([report.verdict.kind, *report.verdict.effects]),
        "lateral_friction": round(walls, 3),
        "first_three": "; ".join(f"{name} {chance[name]:.2f}" for name in best),
        "set_size": len(report.verdict.set),
        "regions": len(report.where),
        "p_none": round(chance.get("none", 0.0), 3),
        "mu_wall": "" if found is None else parameter_text(found),
    }


def parameter_text(candidate):
    """The friction of the walls with its interval."""
    mu_wall = candidate.parameters["mu_wall"]
    return f"{mu_wall.value:.2f} ({mu_wall.low:.2f}-{mu_wall.high:.2f})"


STUDY = Study("paper_case", __doc__, {"facts": facts, "power": power})
main = partial(call, STUDY)


if __name__ == "__main__":
    sys.exit(main())
