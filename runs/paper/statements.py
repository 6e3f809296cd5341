"""The table of statements: what the paper says, what is measured here, and the verdict, by code.

    python -m runs.paper.statements

reads the tables of the study and writes statements.csv (one row per measured clause of each reading) and
statements.md (one row per statement) beside them. No verdict is written by hand: each follows from
numbers, their grid uncertainty and a criterion, see `verdicts.py` and `settled.py`.
"""

from pathlib import Path

from fvcollapse.files.atomic import write_atomic
from runs.paper import (
    statements_cost,
    statements_mesh,
    statements_open,
    statements_viscosity,
    statements_walls,
)
from runs.paper.beds import BEDS, SLIDES, WORDS
from runs.paper.settled import VERDICTS, reading_name, settle
from runs.table import MissingRun, Tables, write_table

HERE = Path(__file__).parent

CLAIMS = (
    *statements_walls.CLAIMS,
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

Each statement is read on the bed of the paper, on which the grains slide with µ_b = µ1, and on a rough bed (no slip),
with and without `thin_layer` (L = 1.65 d). A front is where the layer is thinner than 5 mm; it is also read at 1 and
10 mm. The column "measured" is the paper's reading at 5 mm. A statement whose readings contradict each other depends on
the bed, or on the thickness at which the front is read; the reading that contradicts is given then.

{counts}.

| # | figure, section | statement | measured | other readings | criterion | verdict |
|---|---|---|---|---|---|---|
"""


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
            rows = [clause_cells(clause) for clause in statement.clauses]
            for cells in rows or [{"label": statement.also}]:
                yield {"statement": number} | about | first | cells
                about = {}


def clause_cells(clause):
    """What a row of statements.csv holds of a clause."""
    limit = clause.limit
    if isinstance(limit, tuple):
        limit = " to ".join(f"{side:.6g}" for side in limit)
    return {
        "label": clause.label,
        "value": clause.value,
        "uncertainty": clause.uncertainty,
        "unit": clause.unit,
        "sense": clause.sense,
        "limit": limit,
        "clause_verdict": clause.verdict,
    }


def counted(settled):
    """How many statements have each verdict, in words."""
    verdicts = [of.verdict for of in settled]
    words = (f"{verdicts.count(verdict)} {verdict}" for verdict in VERDICTS)
    return f"Of {len(verdicts)} statements: " + ", ".join(words)


def markdown(settled):
    """Text of statements.md."""
    text = INTRODUCTION.format(counts=counted(settled))
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
    text = markdown(settled)
    text += "".join(table(tables[SLIDES], *about) for about in statements_open.TABLES)
    write_atomic(folder / "statements.md", text.encode())
    print(counted(settled))
    return settled, tables


if __name__ == "__main__":
    main()
