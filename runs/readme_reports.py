"""Tables of stored reports for the README files."""

import textwrap
from pathlib import Path

from fvcollapse.diagnosis.report import read_report
from fvcollapse.diagnosis.report.sentences import answer, headline
from fvcollapse.verification.problems.all import PROBLEMS
from fvcollapse.verification.tables import markdown_table
from runs.readme_tables import stored, table
from runs.table import RUNS, read_table

AIM_FIRST, AIM_SET, AIM_NAMES, AIM_ALARM = "90 %", "90 %", "2.5", "5 %"  # set before the check
AIM_UNKNOWN, AIM_CONFIDENT, AIM_REDUCTION = "60 %", "4", "80 %"
EXAMPLE = Path("particle_laboratory") / "labelled" / "lateral_walls_16deg"
TEXT_WIDTH = 100
OUTSIDE = {
    "quadratic_drag": "another drag",
    "slippery_strip": "a worn strip of the bed",
    "slumped_column": "a slumped column",
    "short_channel": "a channel that ends",
    "magnification": "a wrong scale of the film",
}


# -- verification and collapses ------------------------------------------------------------------


def verification():
    """The stored table of `fvcollapse verify`, by term of the equations."""
    return markdown_table(
        stored("verification", "verify.json"), {problem.name: problem for problem in PROBLEMS}
    )


def runouts():
    """Runout, front velocity and arrest of the collapses of the acceptance study, w = 10 cm and without walls."""
    rows = {row["name"]: row for row in read_table(RUNS / "acceptance" / "matrix.csv")}
    lines = []
    for slope in sorted({int(name[1:].partition("_")[0]) for name in rows}):
        both = [rows[f"a{slope}_{width}"] for width in ("w0.1", "winf")]
        lines.append(
            (
                f"{slope}°, 10 cm / ∞",
                pair(both, "runout", ".3f", "m"),
                pair(both, "runout_10mm", ".3f", "m"),
                pair(both, "peak_front_velocity", ".2f", "m/s"),
                pair(both, "rest_since", ".2f", "s"),
            )
        )
    heading = ("α, w", "runout (5 mm)", "runout (10 mm)", "peak front velocity", "at rest since")
    return table(heading, lines)


def pair(rows, name, form, unit):
    """A column of two rows with its unit."""
    return " / ".join(format(float(row[name]), form) for row in rows) + f" {unit}"


# -- the blind check -----------------------------------------------------------------------------


def percent(score, interval=True):
    """A share with its 95 % interval."""
    value, low, high = (100 * score[name] for name in ("value", "low", "high"))
    return f"{value:.0f} % [{low:.0f}, {high:.0f}]" if interval else f"{value:.0f} %"


def number(score):
    """How many of the cases a share is."""
    return f"{score['value'] * score['n']:.0f} of {score['n']}"


def blind_scores():
    """The scores of the sealed suite, beside the aims that were set before."""
    scores = stored("blind", "scores.json")
    heading = (f"{scores['cases']} sealed cases", "reached [95 % interval]", "aim")
    rows = [naming, alarms, probabilities, reductions]
    return table(heading, [line for make in rows for line in make(scores)])


def naming(scores):
    """Rows on the name of the cause."""
    overall, single = scores["all"], scores["by_class"]["single"]
    separable = scores["by_separability"]["separable"]["top_1"]
    printed = scores["alarms"]["single"]
    return [
        (
            f"right name first, of {separable['n']} single effects that the data can tell (d ≥ 3)",
            percent(separable),
            AIM_FIRST,
        ),
        (
            f"right name first, of all {single['top_1']['n']} single effects; of all cases",
            f"{percent(single['top_1'], False)}; {percent(overall['top_1'])}",
            "",
        ),
        ("right name among the first two", percent(overall["top_2"]), ""),
        (
            f"verdict on the {single['top_1']['n']}: right name, none, another name",
            ", ".join(
                percent(printed[name], False)
                for name in ("named", "taken_for_none", "wrongly_named")
            ),
            "",
        ),
        ("prediction set holds the truth", percent(overall["set_holds_truth"]), AIM_SET),
        (
            "names in the prediction set",
            "{value:.1f} [{low:.1f}, {high:.1f}]".format(**overall["mean_set_size"]),
            AIM_NAMES,
        ),
    ]


def alarms(scores):
    """Rows on false alarms and on causes outside of the catalogue."""
    alarm, unknown = scores["alarms"]["false_alarm_on_none"], scores["alarms"]["unknown"]
    kinds = scores["alarms"]["unknown_by_kind"]
    return [
        (
            f"false alarms, of {alarm['n']} cases in which nothing is hidden",
            "{:.1f} % [{:.1f}, {:.1f}]".format(
                *(100 * alarm[name] for name in ("value", "low", "high"))
            ),
            AIM_ALARM,
        ),
        (
            f"causes outside of the catalogue recognised, of {unknown['found']['n']}",
            percent(unknown["found"]),
            AIM_UNKNOWN,
        ),
        (
            "of these, taken for an effect of the catalogue",
            number(unknown["wrongly_named"]),
            "",
        ),
        *(
            (f"recognised: {words}", number(kinds[kind]["found"]), "")
            for kind, words in OUTSIDE.items()
        ),
    ]


def probabilities(scores):
    """Rows on probabilities and intervals of parameters."""
    calibration = scores["calibration"]
    error, confident = calibration["ece_5_bins"], calibration["confident_errors"]
    covered = scores["parameters"]["interval_90_covers"]
    return [
        ("wrong answers with a probability above 90 %", number(confident), AIM_CONFIDENT),
        (
            "calibration error, and that of a perfect diagnosis of this size (95 %)",
            f"{error['value']:.3f}, {error['perfect_95']:.3f}",
            "within",
        ),
        (
            "mean probability of the answer, and share of right answers",
            f"{100 * calibration['mean_confidence']:.0f} %, {100 * calibration['accuracy']:.0f} %",
            "equal",
        ),
        (f"90 % intervals hold the parameter, of {covered['n']}", percent(covered), "90 %"),
    ]


def reductions(scores):
    """Rows on the gap that closes, and on simpler methods."""
    reduction, simple = scores["reduction"], scores["baselines"]
    predicted = reduction["within_tolerance"]
    methods = ("answers_nearest_signature", "answers_chi_square_ranking", "always_none")
    return [
        (
            f"predicted reduction of the gap within 0.15 of the actual one, of {predicted['n']} named",
            number(predicted),
            AIM_REDUCTION,
        ),
        (
            "winner beats runner-up on the held-out experiment",
            number(reduction["winner_beats_runner_up"]),
            AIM_REDUCTION,
        ),
        (
            "right name first with a simpler method: nearest signature, chi-square, always none",
            ", ".join(percent(simple[name]["top_1"], False) for name in methods),
            "",
        ),
    ]


def diagnosis_example():
    """The answer of a stored diagnosis, as `fvcollapse diagnose` prints it."""
    report = read_report(RUNS / EXAMPLE)
    lines = [
        textwrap.fill(line, TEXT_WIDTH, subsequent_indent="  ")
        for line in (headline(report), *answer(report))
    ]
    return "\n".join(["```text", *lines, "```\n"])
