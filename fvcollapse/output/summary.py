"""The summary of a run as lines of text."""

from math import isclose
from typing import TYPE_CHECKING

from fvcollapse.output.trust import Trust, cells_in_column
from fvcollapse.step.grid import spacing

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


def share_of_dissipation(summary: dict, name: str) -> float:
    """An energy of the summary in % of the dissipated energy."""
    total = summary["dissipation"] + summary["numerical_loss"]
    return 100.0 * summary[name] / total if total > 0.0 else 0.0


def runout_words(s: dict) -> str:
    """The farthest front, and that of the deposit, which may be nearer where the tip thins."""
    return f"{s['runout']:.4f} m, the farthest; {s['final_front']:.4f} m at the end"


def end_words(s: dict, case: "Case") -> str:
    """How the simulated time is related to the end of the case; empty where it is that."""
    if s["ended_at_rest"]:
        return f" of {case.time.end:g} s (ended at rest)"
    return "" if s["complete"] else f" of {case.time.end:g} s (incomplete)"


def cell_words(case: "Case") -> str:
    """The cells that a run has; those of the case are fitted to the gate, which is a grid line."""
    dx, dz = (1000.0 * size for size in spacing(case.resolved))
    high, long = cells_in_column(case)
    stated = 1000.0 * case.grid.cell_size
    fitted = "" if isclose(dx, stated) else f" (cell_size = {stated:.4g} mm, fitted to the gate)"
    return f"{dx:.4g} mm along the bed{fitted}, {dz:.4g} mm normal to it; {long:.3g} x {high:.3g} in the column"


def summary_rows(summary: dict, case: "Case") -> list[tuple[str, str]]:
    """Name and value, as text, of each line of the summary table."""
    s = summary
    arrest = (
        f"{s['arrest_time']:.3f} s"
        if s["arrest_time"] is not None
        else (f"not at rest ({s['final_max_speed']:.3g} m/s)")
    )
    return [
        ("simulated time", f"{s['time']:.4g} s{end_words(s, case)}"),
        ("trust", Trust(s["trust"], tuple(filter(None, [s["trust_reasons"]]))).words),
        ("cells", cell_words(case)),
        ("runout at 10 mm thickness", f"{s['runout_10mm']:.4f} m"),
        (f"runout at {1000 * case.front.thickness:g} mm thickness", runout_words(s)),
        ("runout at 1 mm thickness", f"{s['runout_1mm']:.4f} m"),
        ("x_99 (99 % of the volume)", f"{s['x_99']:.4f} m"),
        ("final / largest height", f"{s['final_thickness']:.4f} m / {s['max_thickness']:.4f} m"),
        (
            "peak front velocity",
            f"{s['peak_front_velocity']:.3f} m/s at {s['peak_front_velocity_time']:.3f} s",
        ),
        ("time of arrest (below 1 mm/s)", arrest),
        ("largest volume error", f"{100 * s['volume_error_max']:.2e} %"),
        ("sum of |volume corrections|", f"{100 * s['volume_correction']:.3f} %"),
        (
            "energy lost to the discretisation",
            f"{share_of_dissipation(s, 'numerical_loss'):.2f} % of the dissipation (time step "
            f"{share_of_dissipation(s, 'loss_time'):.2f}, advection "
            f"{share_of_dissipation(s, 'loss_advection'):.2f}, surface "
            f"{share_of_dissipation(s, 'loss_surface'):.2f})",
        ),
        ("largest detached volume", f"{100 * s['detached_volume_max']:.4f} %"),
        ("largest number of cells in suction", f"{s['negative_pressure_cells_max']}"),
        ("steps, sweeps", f"{s['steps']}, {s['sweeps']}"),
        ("capped steps", f"{s['capped_steps']} (largest residual {s['residual_max']:.1e})"),
        ("wall time of the time loop", f"{s['wall_time']:.1f} s"),
    ]
