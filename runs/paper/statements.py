"""The table of statements: what the paper says, what is measured here, and the verdict, by code.

    python -m runs.paper.statements

reads the tables of the study and writes statements.csv (one row per measured clause) and
statements.md (one row per statement) beside them. No verdict is written by hand: each follows from
numbers, their grid uncertainty and a criterion, see `verdicts.py`.
"""

from pathlib import Path

from fvcollapse.files.atomic import write_atomic
from runs.paper import statements_mesh, statements_open, statements_viscosity, statements_walls
from runs.paper.verdicts import CONFIRMED, OPEN, REFUTED
from runs.table import FINE, MissingRun, Tables, write_table

HERE = Path(__file__).parent

CLAIMS = (
    *statements_walls.CLAIMS,
    *statements_viscosity.CLAIMS,
    *statements_mesh.CLAIMS,
    *statements_open.CLAIMS,
)
HEAD = (
    "statement",
    "place",
    "claim",
    "criterion",
    "label",
    "value",
    "uncertainty",
    "unit",
    "sense",
    "limit",
    "clause_verdict",
    "verdict",
)
INTRODUCTION = """# The paper's statements, measured

Written by `python -m runs.paper.statements` from the tables of the study; no verdict is written by hand. Values are
those of {fine} mm cells, and the number after ± is their grid uncertainty: the index of the stored convergence study of
the same slope and width, where that has the number, else three times their difference to those of {coarse} mm cells (a
case run on the coarse cells alone has its value there and the uncertainty of µ(I) at the same slope and width; "?":
none known, then one cannot tell). A statement is confirmed when every clause is beyond its limit by more than that, not
confirmed when one is on the other side by as much, and cannot be told otherwise. Of many clauses the range is given,
and those that are not confirmed one by one; all of them are in statements.csv. Fronts are where the layer is thinner
than 5 mm unless said.

{confirmed} of {total} confirmed, {refuted} not confirmed, {open} cannot tell.

| # | figure, section | statement | measured | criterion | verdict |
|---|---|---|---|---|---|
"""


def all_statements(of):
    """Every `Statement`, from the `Tables`."""
    return [claim.statement(of) for claim in CLAIMS]


def clause_rows(statements):
    """Rows of statements.csv."""
    for number, statement in enumerate(statements, start=1):
        first = {
            "statement": number,
            "place": statement.place,
            "claim": statement.claim,
            "criterion": statement.criterion,
            "verdict": statement.verdict,
        }
        for clause in statement.clauses:
            limit = clause.limit
            yield first | {
                "label": clause.label,
                "value": clause.value,
                "uncertainty": clause.uncertainty,
                "unit": clause.unit,
                "sense": clause.sense,
                "limit": " to ".join(f"{side:.6g}" for side in limit)
                if isinstance(limit, tuple)
                else limit,
                "clause_verdict": clause.verdict,
            }
        if not statement.clauses:
            yield first | {"label": statement.also}


def markdown(statements, coarse, fine):
    """Text of statements.md."""
    verdicts = [statement.verdict for statement in statements]
    text = INTRODUCTION.format(
        coarse=f"{coarse:.3g}",
        fine=f"{fine:.3g}",
        total=len(verdicts),
        confirmed=verdicts.count(CONFIRMED),
        refuted=verdicts.count(REFUTED),
        open=verdicts.count(OPEN),
    )
    for number, statement in enumerate(statements, start=1):
        cells = (
            number,
            statement.place,
            statement.claim,
            statement.measured() or "–",
            statement.criterion,
            f"**{statement.verdict}**",
        )
        text += "| " + " | ".join(str(cell).replace("|", "/") for cell in cells) + " |\n"
    return text


def table(of, title, head, rows):
    """A table of numbers without verdicts; one line where a run is missing."""
    try:
        lines = rows(of)
    except MissingRun as missing:
        return f"\n## {title}\n\nNot run: {missing}\n"
    text = f"\n## {title}\n\n| " + " | ".join(head) + " |\n" + "|---" * len(head) + "|\n"
    return text + "".join("| " + " | ".join(line) + " |\n" for line in lines)


def main(folder=HERE):
    """Write both files and print how many statements were confirmed."""
    of = Tables(folder)
    statements = all_statements(of)
    sizes = [of.scalars.get((statements_walls.muI(22, "w10"), r), {}) for r in (1.0, FINE)]
    coarse, fine = (row.get("cell_size_mm", float("nan")) for row in sizes)
    write_table(of.folder / "statements.csv", clause_rows(statements), HEAD)
    text = markdown(statements, coarse, fine)
    text += "".join(table(of, *about) for about in statements_open.TABLES)
    write_atomic(of.folder / "statements.md", text.encode())
    print(next(line for line in text.splitlines() if " confirmed, " in line))


if __name__ == "__main__":
    main()
