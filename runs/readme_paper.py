"""The statements of the paper by verdict, for its README."""

from runs.paper.settled import ON_BED, ON_FRONT, VERDICTS
from runs.paper.verdicts import OPEN
from runs.table import RUNS, read_table

TITLES = {OPEN: "Cannot be told"}


def statements_by_verdict():
    """One paragraph a verdict: how many, and the statements with their numbers; readings where they contradict."""
    found = {}
    for row in read_table(RUNS / "paper" / "statements.csv"):
        found.setdefault(int(row["statement"]), []).append(row)
    text = ""
    for verdict in VERDICTS:
        told = [
            f"{number} {rows[0]['claim']}{how(rows)}"
            for number, rows in found.items()
            if rows[0]["verdict"] == verdict
        ]
        title = TITLES.get(verdict, verdict.capitalize())
        text += f"- **{title} ({len(told)}).** {'; '.join(told)}.\n" if told else ""
    return text or "No statement has been measured.\n"


def how(rows):
    """The readings of each verdict, of a statement that depends on one; else nothing."""
    if rows[0]["verdict"] not in (ON_BED, ON_FRONT):
        return ""
    readings = {}
    for row in rows:
        front = f" {row['front_mm']} mm" if row["front_mm"] else ""
        readings.setdefault(row["reading_verdict"], {})[f"{row['bed']}{front}"] = None
    told = [f"{verdict}: {', '.join(names)}" for verdict, names in readings.items()]
    return f" ({'; '.join(told)})"
