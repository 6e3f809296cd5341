"""The table of statements: what the paper says, what is measured here, and the verdict, by code.

    python -m runs.paper.statements

reads the tables of the study and writes statements.csv (one row per measured clause of each reading) and
statements.md (one row per statement) beside them. No verdict is written by hand: each follows from
numbers, their grid uncertainty and a criterion, see `verdicts.py` and `settled.py`.
"""

from pathlib import Path
from textwrap import fill

from fvcollapse.files.atomic import write_atomic
from runs.paper import (
    statements_cost,
    statements_fronts,
    statements_mesh,
    statements_open,
    statements_viscosity,
    statements_walls,
)
from runs.paper.beds import BEDS, ROUGH, SLIDES, WORDS
from runs.paper.settled import VERDICTS, reading_name, settle
from runs.paper.verdicts import told
from runs.table import REFINEMENTS, MissingRun, Tables, write_table

HERE = Path(__file__).parent

CLAIMS = (
    *statements_walls.CLAIMS,
    *statements_fronts.CLAIMS,
    *statements_viscosity.CLAIMS,
    *statements_mesh.CLAIMS,
    *statements_open.CLAIMS,
    *statements_cost.CLAIMS,
)
HEAD = (
    "statement",
    "place",
    "claim",
    "criterion",
    "verdict",
    "bed",
    "front_mm",
    "reading_verdict",
    "label",
    "window",
    "value",
    "uncertainty",
    "unit",
    "sense",
    "limit",
    "clause_verdict",
)
INTRODUCTION = """# The paper's statements, measured

Written by `python -m runs.paper.statements` from the tables of the study; no verdict is written by hand. Values are
those of the finest grid that a case was run on, and the number after ± is their grid uncertainty: three times the
difference of two grids, the grid convergence index of three, that of the fitted trend of four (`runs/measured.py`). A
case run on 6 mm cells alone has the uncertainty of µ(I) at the same slope and width; "?": none known, then one cannot
tell. A reading is confirmed when every clause is beyond its limit by more than that, not confirmed when one is on the
other side by as much, and cannot be told otherwise. Of many clauses the range is given, and those that are not
confirmed one by one; all of them are in statements.csv.

A verdict must not hang on a choice of ours. Where the paper gives no number for a limit, the verdict must be the same
with a limit a quarter lower and a quarter higher (of a range: with a range narrower and wider by that). Where a number
is read in a window, it must be the same in all windows that the criterion names. A peak is that of a parabola through
what is above 0.9 of it; the verdict must be the same with 0.85, with 0.95 and with the largest value itself. Otherwise
one cannot tell, and a window that says otherwise is given in brackets.

Each statement is read on the bed of the paper, on which the grains slide with µ_b = µ1, and on a rough bed (no slip),
with and without `thin_layer` (L = 1.65 d).

{beds}

A front is where the layer is thinner than 5 mm; it is also read at 1 and 10 mm. The column "measured" is the paper's
reading at 5 mm. A statement whose readings contradict each other depends on the bed, or on the thickness at which the
front is read; the reading that contradicts is given then. Where one contradicts with our limit, and not with one a
quarter off, one cannot tell.

{counts}.

| # | figure, section | statement | measured | other readings | criterion | verdict |
|---|---|---|---|---|---|---|
"""


def about_beds(tables):
    """What each bed stands for, and which one is nearest to that of the finite elements, with the numbers of both."""
    case, column = "muI_a22_winf", "runout_5mm_m"
    text = (
        "The bed with µ_b = µ1 is that of the paper's equation (12) and Table I: a plate with the friction of the "
        "grains. A bed that holds the grains, with or without `thin_layer`, stands for the experiments' glued beads."
    )
    try:
        slides, held = (fronts(tables[bed], case, column) for bed in (SLIDES, ROUGH))
        last = told(tables[SLIDES].value(case, column))
    except (KeyError, MissingRun):  # a part of the study
        return fill(text, 120)
    more = f"""Of these beds that of the finite elements is nearest to Coulomb friction, µ_b = µ1: without walls at
    22°, where the paper has 1.6 m, grains that slide end at {slides} ({last} m, at the edge of "about 1.6"), and grains
    that are held at {held}. This does not prove it."""
    return fill(f"{text} {' '.join(more.split())}", 120)


def fronts(of, case, column):
    """The runout of a case on all grids, in words."""
    grids = [r for r in REFINEMENTS if (case, r) in of.scalars]
    values = ", ".join(f"{of.row(case, r)[column]:.3f}" for r in grids)
    return f"{values} m on cells of {', '.join(f'{of.cell_size(case, r):g}' for r in grids)} mm"


def all_statements(folder=HERE):
    """Every statement `Settled`, from the tables in a folder; and {bed: Tables}."""
    tables = {bed: Tables(Path(folder) / bed) for bed in BEDS}
    run = {bed: of for bed, of in tables.items() if of.scalars or bed == SLIDES}
    return settle(CLAIMS, run), run


def clause_rows(settled):
    """Rows of statements.csv; what a statement says stands in its first."""
    for number, of in enumerate(settled, start=1):
        about = {
            "place": of.claim.place,
            "claim": of.claim.claim,
            "criterion": of.claim.criterion,
            "verdict": of.verdict,
        }
        for (bed, front), statement in of.readings.items():
            first = {
                "bed": WORDS[bed],
                "front_mm": front if of.claim.front else "",
                "reading_verdict": statement.verdict,
            }
            rows = [cells for clause in statement.clauses for cells in clause_cells(clause)]
            for cells in rows or [{"label": statement.also}]:
                yield {"statement": number} | about | first | cells
                about = {}


def clause_cells(clause):
    """What the rows of statements.csv hold of a clause: one for its number, one more for each other window."""
    limit = clause.limit
    if isinstance(limit, tuple):
        limit = " to ".join(f"{side:.6g}" for side in limit)
    return [
        {
            "label": clause.label,
            "window": window,
            "value": measured.value,
            "uncertainty": measured.uncertainty,
            "unit": clause.unit,
            "sense": clause.sense,
            "limit": limit,
            "clause_verdict": clause.verdict if not window else clause.verdict_in(measured),
        }
        for window, measured in (("", clause.measured), *clause.windows)
    ]


def counted(settled):
    """How many statements have each verdict, in words."""
    verdicts = [of.verdict for of in settled]
    words = (f"{verdicts.count(verdict)} {verdict}" for verdict in VERDICTS)
    return f"Of {len(verdicts)} statements: " + ", ".join(words)


def markdown(settled, tables):
    """Text of statements.md."""
    text = INTRODUCTION.format(counts=counted(settled), beds=about_beds(tables))
    for number, of in enumerate(settled, start=1):
        claim = of.claim
        cells = (
            number,
            claim.place,
            claim.claim,
            of.paper.measured() or "–",
            readings_told(of) or "–",
            claim.criterion,
            f"**{of.verdict}**",
        )
        text += "| " + " | ".join(str(cell).replace("|", "/") for cell in cells) + " |\n"
    return text


def readings_told(of):
    """What the other readings of a statement give, with the numbers of one that contradicts."""
    found = of.contrary()
    if found is None:
        return of.others()
    bed, front, statement = found
    return f"{of.others()}. On {reading_name((bed, front), of.claim.front)}: {statement.measured()}"


def table(of, title, head, rows):
    """A table of numbers without verdicts; one line where a run is missing."""
    try:
        lines = rows(of)
    except MissingRun as missing:
        return f"\n## {title}\n\nNot run: {missing}\n"
    text = f"\n## {title}\n\n| " + " | ".join(head) + " |\n" + "|---" * len(head) + "|\n"
    return text + "".join("| " + " | ".join(line) + " |\n" for line in lines)


def main(folder=HERE):
    """Write both files and print how many statements have which verdict; return them."""
    folder = Path(folder)
    settled, tables = all_statements(folder)
    write_table(folder / "statements.csv", clause_rows(settled), HEAD)
    text = markdown(settled, tables)
    text += "".join(table(tables[SLIDES], *about) for about in statements_open.TABLES)
    write_atomic(folder / "statements.md", text.encode())
    print(counted(settled))
    return settled, tables


if __name__ == "__main__":
    main()
