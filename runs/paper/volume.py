"""What can make a side view of a collapse at 22 deg swell by 3 to 10 % and come back: grains, view, beads, thresholds.

The measures stand in `volume_seen.py`. All cases come to rest, but for the friction of chutes (0.38, 0.64).
"""

import math

import numpy as np
from scipy.integrate import trapezoid

from fvcollapse.diagnosis.mass_balance import area_beyond
from runs.paper import volume_seen
from runs.study import add_rows, cost, run_settings
from runs.table import CURVE, Curve, curve_row, read_table, write_table

SLOPE, END = 22.0, 2.5  # deg, s
WIDTHS = (0.10, 0.20, math.inf)  # m
GRAINS = {  # words: mu_1, mu_2, whether they slide on the bed with mu_1
    "0.44, 0.69; no slip": (0.44, 0.69, False),
    "0.38, 0.64; no slip": (0.38, 0.64, False),
    "0.48, 0.73; slides": (0.48, 0.73, True),
}
MAIN = "0.44, 0.69; no slip"
KEYS = ("dilatancy_factor", "solid_fraction_critical", "solid_fraction_slope", "solid_fraction_0")
DILATANCY = {  # K, nu_c, slope b, nu_0
    "K = 4, 0.62 to 0.60": (4.0, 0.60, 0.15, 0.62),
    "K = 4, from 0.60": (4.0, 0.60, 0.15, 0.60),
    "K = 4, 0.58 to 0.60": (4.0, 0.60, 0.15, 0.58),
    "K = 1, 0.62 to 0.60": (1.0, 0.60, 0.15, 0.62),
    "K = 5, b = 0.2, 0.62 to 0.585": (5.0, 0.585, 0.20, 0.62),
    "K = 5, b = 0.2, 0.64 to 0.585": (5.0, 0.585, 0.20, 0.64),
    "K = 5, b = 0.2, from 0.60": (5.0, 0.60, 0.20, 0.60),
    "K = 20, b = 0.25, from 0.62": (20.0, 0.62, 0.25, 0.62),
    "K = 5, b = 0.25, 0.64 to 0.585": (5.0, 0.585, 0.25, 0.64),
}
ON_OTHER_GRAINS = ("K = 4, 0.62 to 0.60", "K = 4, from 0.60")
RATIOS = (1.2, 1.5)  # velocity in the middle of the channel over that at the walls
VIEWS = ("wall", "centre")
THRESHOLDS = (1.0e-3, 2.0e-3, 5.0e-3)  # m
ZEROS = (3.5e-4, 7.0e-4, 1.4e-3)  # m: half a grain, one, two
EXPOSURES = (0.01, 0.02)  # s
SHARES = (0.1, 0.2)  # of the speed of the surface, with which beads leave it
WANTED = (0.03, 0.10)  # swelling of the experiments, w = 10 and 20 cm
LINE_STEP = 0.02  # s
KINDS = (  # what the figure shows of the main grains in both channels
    "K = 5, b = 0.2, 0.64 to 0.585; grains",
    "K = 4, 0.62 to 0.60; grains",
    "K = 4, from 0.60; grains",
    "ratio 1.2; from the wall",
    "plain; from 5 mm on",
    "plain; bed 0.7 mm too low",
    "plain; exposed for 20 ms",
    "plain; beads that leave with 0.1 of the speed",
)


def search(options):
    """Run the cases, and write what is seen of each; return a line for each run that failed."""
    path, out = options.tables / "volume" / "runs.csv", options.out / "volume"
    settings = {name: of | {"grid.cell_size": options.cell_size} for name, of in cases().items()}
    missing, runs, rows, lines = [], [], [], []
    for name, _, result, problem in run_settings(path, settings, out, options.workers):
        if result is None:
            missing.append(problem)
            continue
        runs.append({"name": name} | about(result) | {"cpu_s": round(cost(out / name), 1)})
        for words, time, change in seen(result):
            rows.append({"name": f"{name}; {words}"} | row_of(time, change))
            if f"{name}; {words}" in SHOWN:
                lines.append(line_of(f"{name}; {words}", time, change))
    add_rows(options.tables / "volume" / "seen.csv", rows)
    add_lines(options.tables / "volume" / "changes.csv", lines)
    add_rows(path, runs)
    return missing


# -- the cases -----------------------------------------------------------------------------------


def cases():
    """{name: settings} of all runs."""
    found = {}
    for grains in GRAINS:
        for width in WIDTHS:
            found[name_of(grains, width, "plain")] = collapse(grains, width)
            for words, values in DILATANCY.items():
                if grains == MAIN or (words in ON_OTHER_GRAINS and math.isfinite(width)):
                    swelling = {"effects.dilatancy": dict(zip(KEYS, values, strict=True))}
                    found[name_of(grains, width, words)] = collapse(grains, width) | swelling
            for ratio in RATIOS if math.isfinite(width) else ():
                profile = {"effects.transverse_profile": {"velocity_ratio": ratio}}
                found[name_of(grains, width, f"ratio {ratio:g}")] = (
                    collapse(grains, width) | profile
                )
    return found


def name_of(grains, width, words):
    """The name of a run."""
    walls = f"w = {100 * width:g} cm" if math.isfinite(width) else "no walls"
    return f"{grains}; {walls}; {words}"


SHOWN = [name_of(MAIN, width, kind) for width in WIDTHS[:2] for kind in KINDS]


def collapse(grains, width):
    """Settings of the grains in a channel."""
    mu_1, mu_2, slides = GRAINS[grains]
    return {
        "geometry.slope_angle_deg": SLOPE,
        "geometry.channel_width": width,
        "time.end": END,
        "time.output_interval": 0.01,
        "time.field_interval": 0.02,
        "rheology.mu_1": mu_1,
        "rheology.mu_2": mu_2,
        "boundary.mu_bed": mu_1 if slides else math.inf,
        "effects.lateral_friction": {} if math.isfinite(width) else None,
    }


# -- what is seen of them ------------------------------------------------------------------------


def seen(result):
    """(words, times, change) of what can be seen of a run: the grains themselves, and each way of reading them."""
    time, effects = result.profiles.time, result.case.effects
    yield "grains", time, volume_seen.as_it_is(result)
    if effects.transverse_profile is not None:
        for view in VIEWS:
            yield f"from the {view}", time, volume_seen.from_a_side(result, view)
    elif effects.dilatancy is None:
        yield from read_otherwise(result)


def read_otherwise(result):
    """(words, times, change) of thresholds, of a wrong zero, of long exposures and of beads above the surface."""
    time = result.profiles.time
    for least in THRESHOLDS:
        yield f"from {1e3 * least:g} mm on", time, volume_seen.above(result, least)
    for zero in ZEROS:
        yield f"bed {1e3 * zero:g} mm too low", time, volume_seen.raised(result, zero)
    for exposure in EXPOSURES:
        yield f"exposed for {1e3 * exposure:g} ms", time, volume_seen.blurred(result, exposure)
    if not math.isfinite(result.case.geometry.channel_width):
        return
    for share in SHARES:
        above = volume_seen.cloud(result, share)
        yield f"beads that leave with {share:g} of the speed", result.field_times, above


def row_of(time, change):
    """Largest change, when, and what is left of it at the end, in per cent."""
    largest = int(np.argmax(np.abs(change)))
    return {
        "largest_percent": round(100.0 * float(change[largest]), 3) + 0.0,
        "at_s": float(time[largest]),
        "last_percent": round(100.0 * float(change[-1]), 3) + 0.0,
    }


def line_of(name, time, change):
    """The row of a change against time [%], every 20 ms."""
    at = LINE_STEP * np.arange(int(time[-1] / LINE_STEP + 1e-6) + 1)
    values = 100.0 * np.interp(at, time, change)
    curve = Curve("change_percent", math.nan, math.nan, "t_s", 0.0, LINE_STEP, values, 2)
    return curve_row({"case": name}, curve)


def add_lines(path, lines):
    """Add curves to their table; one of the same name is replaced."""
    table = {row["case"]: row for row in [*read_table(path), *lines]}
    write_table(path, table.values(), ("case", *CURVE))


def about(result):
    """How far and how long a run went; where its surface moved, and what a cloud of beads above it needs."""
    summary, profiles, gate = result.summary(), result.profiles, result.case.geometry.length_0
    last = profiles.thickness[-1]
    moving = [
        volume_seen.moving_length(result.field(n), result.case)
        for n in range(len(result.field_times))
    ]
    row = {
        "runout_1mm_m": summary["runout_1mm"],
        "runout_5mm_m": summary["runout"],
        "arrest_s": summary["arrest_time"],
        "beyond_gate": area_beyond(profiles.x, last, gate) / trapezoid(last, profiles.x),
        "moving_length_m": max(moving),
        "capped_steps": summary["capped_steps"],
        "steps": summary["steps"],
    }
    if math.isfinite(result.case.geometry.channel_width):
        reached = float(volume_seen.cloud(result, SHARES[0]).max())  # it goes as the square
        for wanted in WANTED:
            row[f"share_for_{100 * wanted:g}_percent"] = SHARES[0] * math.sqrt(wanted / reached)
    return row
