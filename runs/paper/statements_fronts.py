"""What the paper's section VII says of front velocities and of volume, as measures of the tables."""

from runs.paper.cases import SLOPES
from runs.paper.measures import PLATEAU_LEAST
from runs.paper.statement_terms import muI, peak_below, peak_less
from runs.paper.verdicts import Clause, claims

CLAIMS, claim = claims()


@claim(
    "7, 8",
    "with lateral friction the peak of the front velocity is lower",
    "peak below that without",
)
def peak_lower(t):
    return [
        peak_less(t, muI(a, w), muI(a, "winf"), f"{a}°, w = {w[1:]} cm", "below")
        for a in (10, 16, 22)
        for w in ("w10", "w20")
    ]


@claim(
    "7, 8",
    "all peaks of the front velocity are below 1.6 m/s",
    "peak of the front velocity below 1.6 m/s",
)
def peaks_below(t):
    return [
        peak_below(t, muI(a, w), f"{a}°, {w[1:]}", 1.6)
        for a in (10, 16, 22)
        for w in ("w10", "w20", "winf")
    ]


@claim("5, 6", "velocities are slightly higher at w = 20 cm than 10 cm", "higher peak, all slopes")
def wide_faster(t):
    return [peak_less(t, muI(a, "w20"), muI(a, "w10"), f"{a}°", "above") for a in (10, 16, 22)]


@claim(
    "I", "the deceleration lasts longer the larger the slope", "time from peak to stop, w = 10 cm"
)
def decelerates_longer(t):
    def lasting(a, r):
        row = t.row(muI(a, "w10"), r)
        return row["stop_time_s"] - row["peak_time_s"]

    return [
        Clause(
            f"{a}→{b}°",
            t.measure(lambda r, a=a, b=b: lasting(b, r) - lasting(a, r)),
            "above",
            0.0,
            "s",
        )
        for a, b in zip(SLOPES[:-1], SLOPES[1:], strict=True)
    ]


@claim(
    "7, 8",
    "at 22° η_I gives no slow propagation phase, with or without lateral friction",
    f"no plateau of the front velocity as long as {PLATEAU_LEAST} s",
)
def no_plateau(t):
    return [
        Clause(
            f"w = {w[1:]}", t.value(muI(22, w), "plateau_duration_s"), "below", PLATEAU_LEAST, "s"
        )
        for w in ("w10", "w20", "winf")
    ]


@claim(
    "5, 6",
    "the computed mass loses 2–3 % of its volume",
    "of that code; this one restores the volume in every step",
    on_beds=False,
)
def volume_lost(t):
    rows = [t.row(muI(22, w)) for w in ("w10", "w20")]
    moved = ", ".join(f"{100 * row['volume_correction']:.1f}" for row in rows)
    error = max(100.0 * row["volume_error_max"] for row in rows)
    return [], f"here at most {error:.2f} %; what is restored sums to {moved} %"
