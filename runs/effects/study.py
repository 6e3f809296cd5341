"""What each effect does to a collapse: three strengths, three slopes, w = 10 cm, nothing else on.

    python -m runs.effects.study catalogue dilatancy [--workers 2] [--cell-size 0.006]

    catalogue   every effect in each of its variants: effects.csv (numbers), curves.csv (fronts, final profiles);
                the figures follow from the tables: python -m plots.effects
    dilatancy   volume against time in two channels: dilatancy.csv

A strength is a quantile of the physical prior (`fvcollapse.effects.catalogue`), of all parameters together, counted
from the end where the effect is weak. What is only seen of a flow needs no run of its own. The runs of the
catalogue stay below --out; give another folder after a change of the solver.
"""

import sys
from functools import partial
from typing import NamedTuple

import numpy as np

from fvcollapse import observe
from fvcollapse.case.case import Case
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.measure.observation import flow_case
from runs.effects.dilatancy import dilatancy
from runs.study import Study, finished_run, run_in_folders
from runs.study import main as call
from runs.table import CURVE, CURVES, Curve, curve_row, write_table

NUMBERS = "effects.csv"
SLOPES = (0, 16, 22)  # deg
STRENGTHS = {"weak": 0.15, "middle": 0.5, "strong": 0.9}
BASELINE = "none"
MEMBER = ("effect", "variant", "strength", "slope_deg")
FRONT_STEP, PROFILE_STEP = 0.02, 0.01  # s, m


class Member(NamedTuple):
    """One effect in one variant at one strength and slope; the baseline is the effect "none"."""

    effect: str
    variant: str
    strength: str
    slope: int
    keys: dict
    case: Case

    @property
    def name(self):
        """Name of its folder."""
        words = (self.effect, self.variant, self.strength, f"{self.slope}deg")
        return "_".join(word for word in words if word)


def catalogue(options):
    """Run all members and write both tables; return a line for each run that is missing."""
    wanted = members(options.cell_size)
    runs = shared_runs(wanted)
    run_in_folders({options.out / name: case for name, case in runs.values()}, options.workers)
    return write_tables(wanted, runs, options.out, options.tables)


# -- which runs ----------------------------------------------------------------------------------


def members(cell_size):
    """The baselines, and all effects in all variants and strengths, at every slope."""
    base = {slope: baseline(slope, cell_size) for slope in SLOPES}
    found = [Member(BASELINE, "", "", slope, {}, base[slope]) for slope in SLOPES]
    for name, effect in CATALOGUE.items():
        for variant in effect.variants:
            for strength, quantile in STRENGTHS.items():
                keys = effect.keys(quantile, variant)
                found += [
                    Member(
                        name,
                        variant_name(effect, variant),
                        strength,
                        slope,
                        keys,
                        base[slope].replace(**{f"effects.{name}": keys}),
                    )
                    for slope in SLOPES
                ]
    return found


def baseline(slope, cell_size):
    """The default collapse without any effect."""
    case = Case().replace(**{"geometry.slope_angle_deg": float(slope), "grid.cell_size": cell_size})
    return case.replace(**{"time.field_interval": case.time.end})


def variant_name(effect, variant):
    """What the variant chooses, else the parameters that only it has; nothing if there is but one."""
    if len(effect.variants) == 1:
        return ""
    chosen = [value for value in variant.values() if isinstance(value, str)]
    return "_".join(chosen or [name for name in effect.priors if variant.get(name, 0) is not None])


def shared_runs(wanted):
    """{what flows: (folder, case)}; members that differ in what is seen only have one run."""
    found = {}
    for member in wanted:
        case = flow_case(member.case)
        found.setdefault(case.resolved, (member.name, case))
    return found


# -- what is kept of them ------------------------------------------------------------------------


def write_tables(wanted, runs, data, folder):
    """Write both tables; return a line for each run that is missing."""
    missing, numbers, curves, base_cost = [], [], [], {}
    for member in wanted:
        place = data / runs[flow_case(member.case).resolved][0]
        result, problem = finished_run(place)
        if result is None:
            missing.append(problem)
            continue
        spent = run_time(result)
        base_cost.setdefault(member.slope, spent)  # the baselines come first
        seen = observe(result, case=member.case)
        first = dict(zip(MEMBER, member[:4], strict=True))
        numbers.append(
            first | scalars(member, result, seen) | {"cost_factor": spent / base_cost[member.slope]}
        )
        curves += [curve_row(first, curve) for curve in curves_of(seen)]
    if numbers:
        write_table(folder / NUMBERS, numbers)
        write_table(folder / CURVES, curves, (*MEMBER, *CURVE))
    return missing


def run_time(result):
    """Wall time of the steps [s], each counted as the median: loading and other users do not count."""
    return float(np.median(result.steps["wall_time"])) * len(result.steps["wall_time"])


def scalars(member, result, seen):
    """Parameters and observables of one member, as they are seen."""
    volume = result.relative_volume
    values = {key: value for key, value in member.keys.items() if not isinstance(value, str)}
    return {
        "quantile": STRENGTHS.get(member.strength),
        "parameters": " ".join(f"{key}={value:.4g}" for key, value in values.items()),
        "cell_size_mm": 1e3 * member.case.grid.cell_size,
        "runout_m": seen.scalars["runout"],
        "final_height_m": seen.scalars["final_height"],
        "peak_front_velocity_m_s": seen.scalars["peak_front_velocity"],
        "arrest_s": seen.scalars["time_stop"],
        "relative_volume_end": float(volume[-1]),
        "relative_volume_largest": float(volume[np.argmax(np.abs(volume))]),
    }


def curves_of(seen):
    """Front against time on the clock of the measurement, and the last profile."""
    time = FRONT_STEP * np.arange(int(seen.front[-1, 0] / FRONT_STEP + 1e-6) + 1)
    front = np.interp(time, *seen.front.T)
    last = seen.profiles[seen.profiles[:, 0] == seen.profiles[-1, 0]]
    x = PROFILE_STEP * np.arange(int(last[-1, 1] / PROFILE_STEP) + 1)
    h = np.interp(x, last[:, 1], last[:, 2])
    x = x[: np.flatnonzero(np.abs(h) > 5e-4).max(initial=0) + 2]
    return (
        Curve("front_m", np.nan, np.nan, "t_s", 0.0, FRONT_STEP, front, 4),
        Curve("thickness_m", last[-1, 0], np.nan, "x_m", 0.0, PROFILE_STEP, h[: len(x)], 4),
    )


STUDY = Study("effects", __doc__, {"catalogue": catalogue, "dilatancy": dilatancy}, cell_size=0.006)
main = partial(call, STUDY)


if __name__ == "__main__":
    sys.exit(main())
