"""Tables of stored reports for the README files."""

from pathlib import Path

from fvcollapse.diagnosis.names import NONE
from fvcollapse.diagnosis.report import read_report
from fvcollapse.diagnosis.report.sentences import answer, headline
from fvcollapse.diagnosis.report.words import wrapped
from fvcollapse.verification.problems.all import PROBLEMS
from fvcollapse.verification.tables import markdown_table
from runs.cross_code.study import called_name
from runs.laboratories.study import LABORATORIES
from runs.readme_tables import stored, table
from runs.table import RUNS, read_table

EXAMPLE = Path("example")
TEXT_WIDTH = 118
LATER = ("Where:", "Next:")  # parts of an answer that the README leaves out
NOT_ASKED = ("not asked yet", "–", "–", "–", "–")


# -- verification --------------------------------------------------------------------------------


def verification():
    """The stored table of `fvcollapse verify`, by term of the equations."""
    return markdown_table(
        stored("verification", "verify.json"), {problem.name: problem for problem in PROBLEMS}
    )


# -- laboratories --------------------------------------------------------------------------------


def laboratories():
    """What a diagnosis says of real laboratories, beside what is known of them."""
    rows = {row["laboratory"]: row for row in read_table(RUNS / "laboratories" / "answers.csv")}
    heading = (
        "laboratory",
        "what is known",
        "called",
        "right",
        "impossible",
        "in the set",
        "closes most, of the gap",
    )
    lines = [
        (f"`{name}`", one.known, *(answer_cells(rows[name]) if name in rows else NOT_ASKED))
        for name, one in LABORATORIES.items()
    ]
    return table(heading, lines)


def answer_cells(row):
    """Cells of an answer: what is called, the right and the impossible causes, the set, what closes the gap."""
    return (
        f"{row['called']} {float(row['probability']):.2f}",
        f"{row['right']} {float(row['of_the_right']):.2f}" if row["right"] else "–",
        f"{float(row['of_the_impossible']):.2f}",
        row["names_in_set"],
        closing(row),
    )


def closing(row):
    """The model that closes most of a gap, and how much of it."""
    if not row["closes_most"]:
        return "no model was run"
    held_out = row["closed_held_out"]
    more = f"; {100 * float(held_out):.0f} % of that held out" if held_out else ""
    return f"{row['closes_most']}, {100 * float(row['closed']):.0f} %{more}"


# -- columns of glass beads ------------------------------------------------------------------------

ASPECTS = ((0.0, 1.0), (1.0, 3.0), (3.0, 8.0), (8.0, 20.0))
MODELS = (  # friction of the walls, share of the stated friction of the grains, words
    ("absent", 1.0, "constants as stated, walls without friction"),
    ("measured", 1.0, "constants as stated, measured friction of the walls"),
    ("measured", 0.75, "the same, 0.75 of the friction of the grains"),
    ("measured", 0.5, "the same, half of the friction of the grains"),
)
MEASURED = {"runout": "run-out", "final_height": "final height"}


def laboratory_columns():
    """Mean of computed less measured over measured, in per cent, by aspect ratio."""
    rows = read_table(RUNS / "laboratories" / "columns.csv")
    heading = ("computed less measured, %", *(f"a = {low:g}–{high:g}" for low, high in ASPECTS))
    lines = [
        (f"{words}: {quantity}", *(mean_gap(rows, walls, factor, name, span) for span in ASPECTS))
        for name, quantity in MEASURED.items()
        for walls, factor, words in MODELS
    ]
    return table(heading, lines)


def mean_gap(rows, walls, factor, name, span):
    """A cell: the mean over the columns of a class, and their number."""
    gaps = [
        float(row[f"computed_{factor:g}"]) / float(row["measured"]) - 1.0
        for row in rows
        if (row["walls"], row["quantity"]) == (walls, name)
        and span[0] <= float(row["aspect"]) < span[1]
    ]
    return f"{100.0 * sum(gaps) / len(gaps):+.0f} ({len(gaps)})".replace("-", "−")


def diagnosis_example():
    """The answer of a stored diagnosis, as `fvcollapse diagnose` prints it, but for where and what next."""
    report = read_report(RUNS / EXAMPLE)
    shown = [line for line in answer(report) if not line.startswith(LATER)]
    lines = [wrapped(line, TEXT_WIDTH) for line in (headline(report), *shown)]
    return "\n".join(["```text", *lines, "```\n"])


# -- another code --------------------------------------------------------------------------------


def cross_code():
    """What a diagnosis says of another code in which nothing is hidden."""
    heading = (
        "question",
        "called",
        "most probable other cause",
        "in the set",
        "regions",
        "rms of thickness and front, in combined uncertainties",
    )
    lines = [
        (f"`{name}`", *called_cells(answer))
        for name, answer in stored("cross_code", "answers.json").items()
    ]
    return table(heading, lines)


def cross_code_precision():
    """What a diagnosis says of more precise films of another code."""
    heading = ("noise", "question", "called", "unknown", "in the set", "regions")
    lines = [
        (
            f"× {row['noise_factor']}",
            f"`{row['question']}`",
            f"{row['called']} {float(row['probability']):.2f}",
            f"{float(row['unknown']):.2f}",
            row["names_in_set"],
            row["regions"],
        )
        for row in read_table(RUNS / "cross_code" / "precision.csv")
    ]
    return table(heading, lines)


def called_cells(answer):
    """Cells of an answer: what is called, the most probable cause, the set, regions, sizes of the gap."""
    called = called_name(answer)
    cause, chance = likeliest_cause(answer)
    ratio = answer["ratio"]
    return (
        f"{called if called == NONE else f'**{called}**'} {answer['probability'][called]:.2f}",
        f"{cause} {chance:.2f}",
        str(len(answer["set"])),
        str(answer["regions"]),
        f"{ratio['profiles']:.2f}, {ratio['front']:.2f}",
    )


def likeliest_cause(answer):
    """(name, probability) of the most probable hypothesis but "none"."""
    causes = {name: chance for name, chance in answer["probability"].items() if name != NONE}
    return max(causes.items(), key=lambda item: item[1])
