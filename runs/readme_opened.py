"""Table of the opened cases of the particle laboratory, diagnosed again with the present verdict layer."""

from runs.readme_tables import table
from runs.table import RUNS, read_table


def opened_cases():
    """The answer to each opened case beside its cause, and how many are right."""
    rows = read_table(RUNS / "particle_laboratory" / "opened.csv")
    heading = ("case", "cause", "first", "second", "of the cause", "names in the set")
    lines = [
        (
            row["case"],
            row["cause"],
            f"{row['first']} {float(row['probability']):.2f}",
            row["second"],
            f"{float(row['probability_of_cause']):.2f}, rank {row['rank_of_cause']}",
            f"{row['names_in_set']}{'' if row['in_the_set'] == 'True' else ', without it'}",
        )
        for row in rows
    ]
    right = sum(row["first"] == row["cause"] for row in rows)
    held = sum(row["in_the_set"] == "True" for row in rows)
    sure = sum(row["first"] != row["cause"] and float(row["probability"]) >= 0.9 for row in rows)
    return table(heading, lines) + (
        f"\nThe first name is right in {right} of {len(rows)}, the set holds the cause in {held}; {sure} wrong first "
        "names have a probability of 0.9 or more.\n"
    )
