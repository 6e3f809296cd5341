"""How far to trust the solver and the diagnosis: the table of the first README, read off the stored tables."""

import re

from fvcollapse import load_experiment
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.verification.problems.all import PROBLEMS
from fvcollapse.verification.terms import TERMS
from runs.paper.settled import ON_BED, ON_FRONT
from runs.paper.verdicts import CONFIRMED, OPEN, REFUTED
from runs.readme_acceptance import NARROW, READ, WIDE, between
from runs.readme_acceptance import rows_of as acceptance
from runs.readme_reports import likeliest_cause
from runs.readme_tables import require, rounded, signed, span, stored, table
from runs.table import RUNS, read_table

REFERENCE, FINER = "dx6mm", "dx3mm"  # the reference collapse and its finest grid
FRONTS = {  # comparison of differences.csv: thickness at which its final front is read
    "discs a = 0.5": "front at one disc",
    "discs a = 6.26, fine": "front at one disc",
    "volume of fluid, h0/26": "front at 0.03 h0",
    "volume of fluid, its h0/51, h0/52": "front at 0.03 h0",
}
BEADS = "mangeney2010_0deg"
WANTED = (  # bullets of the paper's README: what would decide the statements that they name
    ("Measured curves", "The finite-element code"),
    ("A number for a word",),
)
NOTHING = (NONE, UNKNOWN)  # answers that name no effect
PERCENT = 100


def trust():
    """The table: a claim, the number that it rests on, and where that stands."""
    return table(("claim", "number", "where"), [(*row(), link(*where)) for row, where in ROWS])


def link(words, path):
    """A link to another README."""
    return f"[{words}]({path})"


# -- the solver ----------------------------------------------------------------------------------


def exact():
    """Terms with an exact solution, and on how many grids."""
    rows = stored("verification", "verify.json")
    terms = {problem.name: problem.term for problem in PROBLEMS}
    require(all(row["passed"] for row in rows), "each term passes all of its problems")
    require({terms[row["name"]] for row in rows} == set(TERMS), "each term has a problem")
    grids = span([len(row["grids"]) for row in rows], str)
    return (
        "each term of the equations solves its exact solution",
        f"{len(TERMS)} terms, observed order or a stated bound on {grids} grids",
    )


def volume():
    """Error of the volume of the reference collapse."""
    error = float(acceptance("grid")[REFERENCE]["relative_volume_max"])
    return "the volume is conserved", f"to {error:.0e} at every step of the reference collapse"


def grid():
    """What finer cells change of the runouts of the reference collapse."""
    rows = acceptance("grid")
    changes = between(rows[REFERENCE], rows[FINER])
    return (
        "the runout depends on the grid",
        f"22°, w = 10 cm, from 6 to 3 mm cells; front read at a thickness of {changes} (99 % of the volume)",
    )


def arrest():
    """How many of the collapses of the paper come to rest."""
    rows = acceptance("matrix")
    resting = sum(bool(row["rest_since"]) for row in rows.values())
    of = f"all {resting}" if resting == len(rows) else f"{resting} of the {len(rows)}"
    return (
        "collapses come to rest by themselves",
        f"{of} set-ups of the paper (slopes, widths) on 6 mm cells",
    )


# -- other codes, experiments, the paper -------------------------------------------------------------


def codes():
    """Final fronts less those of two other codes."""
    low, tall, fluid, finer = (final_front(name, at) for name, at in FRONTS.items())
    return (
        "it agrees with other codes",
        f"final front: discs {low} (a = 0.5) and {tall} (a = 6.26), a volume-of-fluid code {fluid} ({finer} on finer "
        "grids of both)",
    )


def final_front(name, quantity):
    """Relative difference of the last front of a comparison."""
    rows = read_table(RUNS / "comparison" / "differences.csv")
    found = [row for row in rows if (row["comparison"], row["quantity"]) == (name, quantity)]
    return f"{signed(found[-1]['relative_difference'], 1, PERCENT)} %"


def beads():
    """Runout (from the back wall) of glass beads on the horizontal, and of the model, which has nothing tuned."""
    experiment = load_experiment(RUNS / "experiments" / BEADS)
    (runout,) = [scalar for scalar in experiment.scalars if scalar.name == "runout"]
    measured, rows = runout.value, acceptance("matrix")
    fronts = {
        (width, name): float(rows[f"a0_{width}"][name])
        for width in (WIDE, NARROW)
        for name in ("runout", "runout_1mm")
    }
    require(max(fronts.values()) < measured - runout.sigma, "the model runs less far than beads")
    free, walled = (
        " or ".join(rounded(fronts[width, name], 3) for name in ("runout", "runout_1mm"))
        for width in (WIDE, NARROW)
    )
    read = " or ".join(READ[name] for name in ("runout", "runout_1mm"))
    return (
        "it agrees with experiments",
        f"not without tuning: at 0° the runout, from the back wall, is {rounded(measured, 3)} m of beads; of the "
        f"model, read where the layer is {read} thick, {free} m without walls and {walled} m between walls",
    )


def paper():
    """How many statements of the paper have each verdict, and why some cannot be decided."""
    found = {}
    for row in read_table(RUNS / "paper" / "statements.csv"):
        found.setdefault(int(row["statement"]), []).append(row)
    verdicts = [rows[0]["verdict"] for rows in found.values()]
    is_open = {number for number, rows in found.items() if rows[0]["verdict"] == OPEN}
    without_value = {number for number in found if not any(row["value"] for row in found[number])}
    text = (RUNS / "paper" / "README.md").read_text(encoding="utf-8")
    supplied, words = (set().union(*(named(text, of) for of in titles)) for titles in WANTED)
    require(without_value <= supplied, "every statement without a value wants data or code")
    require(supplied | words <= is_open, "what statements want is named of the undecided alone")
    either = verdicts.count(ON_BED) + verdicts.count(ON_FRONT)
    return (
        "it confirms the paper",
        f"{verdicts.count(CONFIRMED)} of {len(verdicts)} statements; {verdicts.count(REFUTED)} not; {either} depend on "
        f"the bed or on how a front is read; {len(is_open)} cannot be decided, {len(supplied)} of them for want of "
        f"data or code, {len(words)} for want of a number in the paper",
    )


def named(text, title):
    """Statements that a bullet of the paper's README names in brackets after its title."""
    found = re.search(
        rf"^- \*\*{title}\*\* \((?:statements )?(\d+(?:(?:, |–)\d+)*)", text, re.MULTILINE
    )
    require(found is not None, f"{title} (statements …), in runs/paper/README.md")
    numbers = set()
    for part in found[1].split(", "):
        first, _, last = part.partition("–")
        numbers |= set(range(int(first), int(last or first) + 1))
    return numbers


# -- the diagnosis -------------------------------------------------------------------------------


def laboratories():
    """Wetted beads, laboratories in which nothing may be named, and the columns of beads."""
    rows = read_table(RUNS / "laboratories" / "answers.csv")
    wet = [row for row in rows if row["right"] == "cohesion"]
    first = [float(row["of_the_right"]) for row in wet if row["called"] == "cohesion"]
    free = [row for row in rows if not row["right"]]
    silent = sum(row["called"] in NOTHING for row in free)
    outside = [row for row in rows if row["right"] == UNKNOWN]
    missed = sum(row["called"] != UNKNOWN for row in outside)
    fits = read_table(RUNS / "laboratories" / "columns_fit.csv")
    (walled,) = [row for row in fits if row["walls"] == "measured"]
    shorter = -float(walled["runout_mean_percent"])
    require(shorter > 0.0, "the columns run less far in the model")
    columns = read_table(RUNS / "laboratories" / "columns.csv")
    seen = [row for row in columns if (row["quantity"], row["walls"]) == ("runout", "measured")]
    return (
        "its diagnoses of real laboratories",
        f"cohesion is the answer in {len(first)} of {len(wet)} groupings of one data set of wetted beads (probability "
        f"{span(first, lambda of: rounded(of, 0, PERCENT))} %); no effect is named in {silent} of {len(free)} "
        f"laboratories without an intervention; {missed} of {len(outside)} causes outside of the catalogue (rolling "
        f"friction) is missed; {len(seen)} columns of beads of measured runout run {rounded(shorter)} % less far in "
        "the model, on average",
    )


def names():
    """Right answers, right most probable causes and false alarms of the sealed cases, with controls and alone."""
    ways = stored("blind", "scores.json")
    named, right, alarms = (
        [read(ways[way]) for way in ("controls", "alone")]
        for read in (
            lambda scores: scores["answers"]["named"],
            lambda scores: scores["by_separability"]["separable"]["top_1"],
            lambda scores: scores["alarms"]["false_alarm_on_none"],
        )
    )
    return (
        "the diagnosis names the right effect",
        f"with controls (the same apparatus without the change that is asked about) {percent(named[0])} of "
        f"{named[0]['n']} sealed answers that name an effect are right; the most probable cause is right for "
        f"{percent(right[0])} of {right[0]['n']} effects that the data can tell apart; false alarms "
        f"{percent(alarms[0])} of {alarms[0]['n']}. Without controls {percent(named[1])} of {named[1]['n']}, "
        f"{percent(right[1])} of {right[1]['n']}, {percent(alarms[1])} of {alarms[1]['n']}",
    )


def null():
    """What is called none of the collapses of another code in which nothing is hidden."""
    answers = stored("cross_code", "answers.json").values()
    none = sum(answer["verdict"] == NONE for answer in answers)
    precise = read_table(RUNS / "cross_code" / "precision.csv")
    silent = sum(row["called"] == NONE for row in precise)
    wrong = max(likeliest_cause(answer)[1] for answer in answers)
    return (
        "the diagnosis names nothing where nothing is hidden and another code is the laboratory",
        f"none is the answer to {none} of {len(answers)} questions without controls, by a rule that was made after "
        f"them (the most probable other cause has {rounded(wrong, 0, PERCENT)} % at most), and to {silent} of "
        f"{len(precise)} with a half or a quarter of the noise",
    )


def percent(score):
    """A share of the scores in %."""
    return f"{rounded(score['value'], 0, PERCENT)} %"


ROWS = (
    (exact, ("verification", "fvcollapse/verification/README.md")),
    (volume, ("accuracy", "fvcollapse/step/README.md#accuracy")),
    (grid, ("acceptance", "runs/acceptance/README.md#cells-and-time-steps")),
    (arrest, ("acceptance", "runs/acceptance/README.md")),
    (codes, ("comparison", "runs/comparison/README.md")),
    (beads, ("acceptance", "runs/acceptance/README.md")),
    (laboratories, ("laboratories", "runs/laboratories/README.md")),
    (paper, ("paper", "runs/paper/README.md")),
    (names, ("diagnosis", "fvcollapse/diagnosis/README.md#how-good-it-is")),
    (null, ("another code", "runs/cross_code/README.md#answers")),
)
