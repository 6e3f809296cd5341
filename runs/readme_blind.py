"""The table of the sealed check for the README of the diagnosis."""

from runs.readme_tables import stored, table

OUTSIDE = {
    "quadratic_drag": "another drag",
    "slippery_strip": "a worn strip of the bed",
    "slumped_column": "a slumped column",
    "short_channel": "a channel that ends",
    "magnification": "a wrong scale of the film",
}
MISSING = "–"


def blind_scores():
    """Scores of the sealed worlds, alone and with the controls, beside the aims that were set before."""
    scores = stored("blind", "scores.json")
    ways = scores["alone"], scores["controls"]
    heading = ("share [95 % interval]", *map(laboratories, ways), "aim")
    rows = [*NAMING, *ALARMS, *(unknown_of(kind) for kind in OUTSIDE), *PROBABILITIES, *OTHERS]
    lines = [(words, *(shown(read, way) for way in ways), aim) for words, read, aim in rows]
    return table(heading, lines)


def laboratories(scores):
    """Heading of a column."""
    way = (
        "alone"
        if "slight" in scores["by_laboratory"]["strength"]
        and ("strong" not in scores["by_laboratory"]["strength"])
        else "with controls"
    )
    return f"{way}: {scores['cases']} cases of {scores['worlds']} worlds"


def shown(read, scores):
    """A number of the scores; a dash where there is none."""
    try:
        return read(scores)
    except (KeyError, TypeError):
        return MISSING


def percent(score, interval=True):
    """A share with its 95 % interval and its number of cases."""
    value, low, high = (100 * score[name] for name in ("value", "low", "high"))
    ends = f" [{low:.0f}, {high:.0f}]" if interval else ""
    return f"{value:.0f} %{ends} of {score['n']}"


def number(score):
    """How many of the cases a share is."""
    return f"{score['value'] * score['n']:.0f} of {score['n']}"


def first_of(part, name="top_1"):
    """Reader of a share of a group of `by_separability` or `by_class`."""
    where = "by_class" if part in ("single", "pair") else "by_separability"
    return lambda scores: percent(scores[where][part][name])


def unknown_of(kind):
    """Row of a kind of unknown cause."""
    return (
        f"answered unknown: {OUTSIDE[kind]}",
        lambda scores: number(scores["alarms"]["unknown_by_kind"][kind]["found"]),
        "",
    )


def error_of(scores):
    """Calibration error and its floor."""
    error = scores["calibration"]["ece_5_bins"]
    return f"{error['value']:.3f} ({error['perfect_95']:.3f})"


def sureness(scores):
    """Mean probability of the most probable cause, and share of right ones."""
    calibration = scores["calibration"]
    return f"{100 * calibration['mean_confidence']:.0f} %, {100 * calibration['accuracy']:.0f} %"


def names_of(scores):
    """Mean number of names in the set."""
    return "{value:.1f} [{low:.1f}, {high:.1f}]".format(**scores["all"]["mean_set_size"])


def strong(scores):
    """First name right in worlds with physics of their own."""
    return percent(scores["by_laboratory"]["strength"]["strong"]["top_1"])


def of_closure(kind):
    """Reader of the share of right most probable causes of effects that act by a kind of closure."""
    return lambda scores: percent(scores["by_laboratory"]["closure"][kind]["top_1"])


def answers_of(kind):
    """Reader of the share of right answers of a kind."""
    return lambda scores: percent(scores["answers"][kind])


def simpler(scores):
    """First name right with simpler methods."""
    methods = ("answers_nearest_signature", "answers_chi_square_ranking", "always_none")
    shares = [scores["baselines"][name]["top_1"]["value"] for name in methods]
    return ", ".join(f"{100 * share:.0f} %" for share in shares)


NAMING = (
    ("most probable cause right, single effects with d ≥ 3", first_of("separable"), "92 %; 88 %"),
    ("most probable cause right, all single effects", first_of("single"), "82 %; 75 %"),
    (
        "most probable cause right, all cases",
        lambda scores: percent(scores["all"]["top_1"]),
        "82 %; 78 %",
    ),
    ("the same in strong worlds", strong, ""),
    ("the same of effects by a closure of the catalogue", of_closure("catalogue"), ""),
    ("the same of effects by another closure", of_closure("another"), ""),
    ("true cause among the two most probable", lambda scores: percent(scores["all"]["top_2"]), ""),
    (
        "two effects, both with d ≥ 3: most probable cause right (half for one of the two)",
        first_of("separable_pairs"),
        "",
    ),
    ("two effects: both named", lambda scores: percent(scores["alarms"]["pair"]["named"]), "60 %"),
    (
        "prediction set holds the truth",
        lambda scores: percent(scores["all"]["set_holds_truth"]),
        "92 %",
    ),
    ("names in the prediction set", names_of, "2.0; 2.5"),
)
ALARMS = (
    (
        "false alarms (another answer than none) where nothing is hidden",
        lambda scores: percent(scores["alarms"]["false_alarm_on_none"]),
        "4 %",
    ),
    *(
        (f"of the answers {words}, right ones (half for one of two effects)", answers_of(kind), "")
        for kind, words in (
            ("named", "that name an effect"),
            ("none", '"none"'),
            ("unknown", '"unknown"'),
        )
    ),
    (
        "causes outside of the catalogue answered unknown",
        lambda scores: percent(scores["alarms"]["unknown"]["found"]),
        "85 %",
    ),
    (
        "of these, taken for an effect of the catalogue",
        lambda scores: number(scores["alarms"]["unknown"]["wrongly_named"]),
        "",
    ),
)
PROBABILITIES = (
    (
        "wrong answers with a probability above 90 %",
        lambda scores: number(scores["calibration"]["confident_errors"]),
        "1 %",
    ),
    ("calibration error (that of a perfect diagnosis of this size, 95 %)", error_of, "within"),
    ("mean probability of the most probable cause, share of right ones", sureness, "equal"),
    (
        "90 % intervals hold the parameter",
        lambda scores: percent(scores["parameters"]["interval_90_covers"]),
        "88–93 %",
    ),
)
OTHERS = (("most probable cause right: nearest signature, chi-square, always none", simpler, ""),)
