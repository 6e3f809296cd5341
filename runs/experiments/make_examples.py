"""Three synthetic collapses with a hidden cause, small, so that `fvcollapse diagnose` runs out of the box.

The part `examples` of the study; two minutes of computing per run. The truth is a run of the solver on other
cells than a diagnosis uses, with friction on the lateral walls and a material that is not quite the stated one,
filmed with the errors of a laboratory (scale, origin, clock, drifts, outliers, missing frames). Writes
example_<slope>_<width> into --tables; --cell-size makes a rough copy.
"""

from pathlib import Path

import numpy as np

from fvcollapse import load_experiment, observe
from fvcollapse.blind.measurement import Errors, film
from fvcollapse.blind.truth import View
from fvcollapse.case.case import Case
from fvcollapse.files.atomic import write_atomic
from runs.study import run_cached

CELL_SIZE = 0.005  # m
EXAMPLES = {  # slope [deg], width [m], last frame [s], last place [m]
    "example_16deg_w10cm": (16.0, 0.10, 1.32, 0.90),
    "example_22deg_w10cm": (22.0, 0.10, 1.80, 1.40),
    "example_22deg_w20cm": (22.0, 0.20, 1.80, 1.60),
}
STATED = {"rheology.mu_1": 0.44, "rheology.mu_2": 0.70, "rheology.I_0": 0.279}
TRUE = {"rheology.mu_1": 0.447, "rheology.mu_2": 0.71, "rheology.I_0": 0.279}
CAUSE = {"mu_wall": 0.22, "pressure_ratio": 0.9}
NUMERICS = {"numerics.shear_rate_min": 2e-4, "effects.lateral_friction.scheme": "split"}
ERRORS = Errors(
    thickness=0.0012,
    front=0.005,
    relative_volume=0.005,
    interface=0.0025,
    scale=0.01,
    offset=0.0015,
    time=0.005,
)
SEED = 20170
# of the frames of the film, and of its places, one in so many is kept: the files stay small
EVERY_FRAME = {"front": 1, "volume": 2, "profiles": 3, "interface": 6}
EVERY_PLACE = {"profiles": 2, "interface": 3}
SETTINGS = """title = "example: synthetic collapse, {slope:g} deg, w = {width:g} cm"
source = "runs/experiments/make_examples.py: fvcollapse, {cells:g} mm cells, lateral friction, noise"

[geometry]
slope_angle_deg = {slope:g}
height_0 = 0.14
length_0 = 0.20
channel_width = {width_m:g}

[gate]
speed = 2.3

[material]
mu_1 = {mu_1}
mu_2 = {mu_2}
I_0 = {I_0}
mu_back_wall = 0.30

[front]
thickness = 0.005

[uncertainty]
thickness = {thickness}
front = {front}
relative_volume = {relative_volume}
interface = {interface}
time = {time}
slope_angle_deg = 0.2
height_0 = 0.0014
length_0 = {offset}
mu_1 = 0.015
mu_2 = 0.03
I_0 = 0.05
mu_back_wall = 0.05

[truth]
cause = "lateral_friction"
mu_wall = {mu_wall}
pressure_ratio = {pressure_ratio}
mu_1 = {true_mu_1}
mu_2 = {true_mu_2}
"""


def examples(options):
    """Make all of them."""
    size = options.cell_size or CELL_SIZE
    for name in EXAMPLES:
        write_settings(options.tables / name, name, size)
    results = run_cached({name: truth(name, size) for name in EXAMPLES}, options)
    for number, name in enumerate(EXAMPLES):
        folder = options.tables / name
        write_film(folder, name, results[name], SEED + number)
        print(folder, f"{len(load_experiment(folder).curves)} curves")


def truth(name, cell_size):
    """The case of what really happened."""
    slope, width, end, _ = EXAMPLES[name]
    changes = {
        "geometry.slope_angle_deg": slope,
        "geometry.channel_width": width,
        "boundary.mu_bed": float("inf"),
        "boundary.mu_back_wall": 0.30,
        "grid.cell_size": cell_size,
        "time.end": end + 0.05,
        "effects.lateral_friction": dict(CAUSE),
    }
    return Case().replace(**changes | TRUE | NUMERICS)


def write_settings(folder, name, cell_size):
    """Write `experiment.toml`."""
    slope, width, _, _ = EXAMPLES[name]
    text = SETTINGS.format(
        slope=slope,
        width=100.0 * width,
        width_m=width,
        cells=1000.0 * cell_size,
        **{key.partition(".")[2]: value for key, value in STATED.items()},
        **{f"true_{key.partition('.')[2]}": value for key, value in TRUE.items()},
        **CAUSE,
        **ERRORS._asdict(),
    )
    folder.mkdir(parents=True, exist_ok=True)
    write_atomic(folder / "experiment.toml", text.encode())


def write_film(folder, name, result, seed):
    """Write what a camera sees of a run."""
    _, _, end, reach = EXAMPLES[name]
    view = View.of(observe(result, front_thickness=0.005))
    texts = film(view, end, reach, ERRORS, np.random.default_rng(seed))
    for file, text in texts.items():
        write_atomic(folder / file, thinned(text, Path(file).stem).encode())


def thinned(text, name):
    """The CSV text with fewer frames and places."""
    header, *lines = text.splitlines()
    times = [line.partition(",")[0] for line in lines]
    frames = dict.fromkeys(times)
    kept = set(list(frames)[:: EVERY_FRAME[name]])
    rows, place = [], 0
    for n, (time, line) in enumerate(zip(times, lines, strict=True)):
        place = 0 if n == 0 or time != times[n - 1] else place + 1
        if time in kept and place % EVERY_PLACE.get(name, 1) == 0:
            rows.append(line)
    return "\n".join([header, *rows]) + "\n"
