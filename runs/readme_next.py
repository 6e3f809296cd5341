"""The tables of the value of the next experiment, and of the whole diagnoses, for the README of the diagnosis."""

from runs.readme_blind import number, percent
from runs.readme_tables import stored, table

CHOICES = {
    "recommended": "the recommended one",
    "random": "a random one (mean over all candidates)",
    "best": "the best possible, known afterwards only",
}
KINDS = {  # beginnings of the names of candidates
    "slope": "another slope",
    "width": "another width of the channel",
    "height": "a higher column",
    "speed": "a gate removed at once",
}


def next_scores():
    """Scores of the next experiments as they are stored."""
    return stored("blind", "next", "next_scores.json")


def next_experiments():
    """Gains by a next experiment: recommended, random and best."""
    scores = next_scores()["all"]
    heading = (
        f"{scores['cases']} cases in which something is left to separate",
        "right first names",
        "probability of the truth",
        "drop of the entropy",
    )
    before = scores["before"]
    rows = [("after the first experiment", *levels(before))]
    rows += [
        (f"gain by {words}", *(gain(scores["gain"][measure][name], measure) for measure in before))
        for name, words in CHOICES.items()
    ]
    ahead = (gain(scores["ahead"][measure], measure) for measure in before)
    rows.append(("the recommended one ahead of a random one", *ahead))
    aim = (gain(scores["ahead_of_aim"][measure], measure) for measure in before)
    rows.append(("ahead of twice the gain of a random one (aim: above 0)", *aim))
    rows.append(
        ("what the plan expected of the recommended one, of a random one", "", "", expected_drops())
    )
    return table(heading, rows)


def expected_drops():
    """Expected drops of the entropy: of the recommended experiment, and of the mean candidate."""
    about = next_scores()["expectation"]
    parts = ("expected_drop_of_entropy", "expected_drop_by_a_random_one")
    return ", ".join(f"{about[part]['value']:.2f}" for part in parts) + " bit"


def levels(before):
    """Numbers after the first experiment."""
    right, sure, left = (before[name]["value"] for name in ("right", "probability", "entropy"))
    return f"{100 * right:.0f} %", f"{100 * sure:.0f} %", f"{left:.2f} bit left"


def gain(score, measure):
    """A gain with its interval."""
    factor, unit, digits = (1.0, "bit", 2) if measure == "entropy" else (100.0, "%", 0)
    value, low, high = (factor * score[name] for name in ("value", "low", "high"))
    return f"{value:+.{digits}f} {unit} [{low:+.{digits}f}, {high:+.{digits}f}]"


def next_kinds():
    """Gains by the kind of set-up that is measured next."""
    kinds = {}
    for name, about in next_scores()["by_candidate"].items():
        kind = KINDS[name.split("_")[0]]
        kinds.setdefault(kind, []).append(about)
    heading = (
        "next experiment",
        "possible",
        "recommended",
        "best",
        "gain in right names",
        "in the probability of the truth",
        "in entropy",
    )
    return table(heading, [(kind, *kind_row(rows)) for kind, rows in kinds.items()])


def kind_row(rows):
    """Cells of one kind."""
    count = sum(row["cases"] for row in rows)
    mean = {
        name: sum(row["cases"] * row["gain"][name] for row in rows) / count
        for name in ("right", "probability", "entropy")
    }
    counts = (str(sum(row[name] for row in rows)) for name in ("recommended", "best"))
    return (
        str(count),
        *counts,
        f"{100 * mean['right']:+.0f} %",
        f"{100 * mean['probability']:+.0f} %",
        f"{mean['entropy']:+.2f} bit",
    )


def held_out():
    """Predicted beside actual closing, and winner beside runner-up, of whole diagnoses with controls."""
    scores = next_scores()["reduction"]
    heading = (
        f"{scores['diagnoses']} diagnoses, {scores['named']} of which name an effect",
        "share [95 % interval]",
        "aim",
    )
    rows = [
        (
            "predicted closing of the gap within 0.10 of the actual one",
            percent(scores["within_narrow"]),
            "85 %",
        ),
        ("the same within 0.15", percent(scores["within_tolerance"]), ""),
        (
            "winner leaves less of the gap of the held-out experiment than the runner-up",
            percent(scores["winner_leaves_less"]),
            "90 %",
        ),
        (
            "the same two where the name is right",
            both_of(scores["right_name"]),
            "",
        ),
        (
            "winner closes a larger fraction of it beyond the noise",
            number(scores["winner_beats_runner_up"]),
            "",
        ),
    ]
    return table(heading, rows)


def both_of(scores):
    """How many closings are predicted within 0.10, and how many winners leave less than the runner-up."""
    return "; ".join(number(scores[name]) for name in ("within_narrow", "winner_leaves_less"))
