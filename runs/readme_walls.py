"""Friction of the walls of the particle laboratory, of grains and of the model, for its README."""

from pathlib import PurePosixPath

import numpy as np

from runs.particle_laboratory.walls import EARLY, PAIRS, RATIOS, SLIDING
from runs.readme_stamps import solver_line
from runs.readme_tables import bullets, rounded, signed, span, table
from runs.table import RUNS, read_table

TABLE = "particle_laboratory/walls.csv"
FLAT = "16°, frictionless walls"  # flat walls without friction, less none
STEEP = "22°"
MOBILISED = "particle_laboratory/mobilised.csv"
UNFAIR = "16°"  # less collapses without flat walls: the model has the same runs for both
FAIR = ("16°, less frictionless walls", "16°, slow gate", STEEP)  # that are compared with the model
FLAT_OF = {UNFAIR: FAIR[0]}  # the pair whose grains are compared
SHOWN = ((0.5, ""), (1.0, ""), (1.1, ""), (1.0, "thin_layer"), (1.0, "dilatancy"))  # K_w, added


class Pair:
    """What the walls change in one pair of collapses, of the grains and of the model.

    Attributes
    ----------
    grains : dict
        The row of the grains.
    mobilised : float
        Friction that the grains mobilised on the walls.
    """

    def __init__(self, words, rows):
        self.words = words
        own = [row for row in rows if row["pair"] == words]
        self.grains = next(row for row in own if row["of"] == "grains")
        self.mobilised = float(self.grains["mobilised"])
        self.runs = [row for row in own if row["of"] == "model"]
        self.wanted = [row for row in own if row["of"].startswith("model, ")]

    def run(self, ratio, added=""):
        """The row of the model with K_w = `ratio`."""
        return self.at(ratio * self.mobilised, added)

    def at(self, product, added=""):
        """The row of the model whose mu_w K_w is nearest to `product`."""
        of = [row for row in self.runs if row["added"] == added]
        return min(of, key=lambda row: abs(float(row["mu_w_K_w"]) - product))

    def needed(self, added=""):
        """mu_w K_w with which the front of the model changes as that of the grains."""
        (row,) = (row for row in self.wanted if row["added"] == added)
        return float(row["mu_w_K_w"])

    def front_at(self, product):
        """Change of the front of the model with mu_w K_w = `product`, mm; interpolated."""
        of = sorted(
            (float(row["mu_w_K_w"]), float(row["front"])) for row in self.runs if not row["added"]
        )
        return float(np.interp(product, *zip((0.0, 0.0), *of, strict=True)))

    def needed_for(self, front, added=""):
        """mu_w K_w for another change of the front, mm; interpolated."""
        of = [row for row in self.runs if row["added"] == added]
        shorter = [0.0, *(-float(row["front"]) for row in of)]
        return float(np.interp(-front, shorter, [0.0, *(float(row["mu_w_K_w"]) for row in of)]))


def pairs():
    """{words: Pair}."""
    rows = read_table(RUNS / TABLE)
    return {words: Pair(words, rows) for words in PAIRS}


# -- the table -----------------------------------------------------------------------------------


def walls():
    """Change of front and rear by the walls, of the grains and of the model with several K_w."""
    heading = ("collapses", "friction mobilised", "grains", *map(variant, SHOWN), "µ_w K_w needed")
    lines = [
        (compared(words), rounded(pair.mobilised, 2), both(pair.grains), *model_cells(pair))
        for words, pair in pairs().items()
    ]
    return table((*heading, "with dilatancy"), lines) + solver_line(TABLE)


def variant(of):
    """Heading of a column of the model."""
    ratio, added = of
    return f"model, K_w = {ratio:g}" + (f", `{added}`" if added else "")


def compared(words):
    """Slope and cases of a pair."""
    pair = PAIRS[words]
    walled, *free = (f"`{PurePosixPath(name).name}`" for name in (pair.walled, *pair.free))
    return f"{words}: {walled} less {' and '.join(free)}"


def both(row):
    """Change of the front and of the rear of a row, mm."""
    return f"{signed(row['front'])}, {signed(row['rear'])}"


def model_cells(pair):
    """Cells of the model; none where the walls have no friction."""
    if not pair.runs:
        return ("",) * (len(SHOWN) + 2)
    needed = (rounded(pair.needed(added), 2) for added in ("", "dilatancy"))
    return (*(both(pair.run(*of)) for of in SHOWN), *needed)


# -- what it says --------------------------------------------------------------------------------


def walls_say():
    """What is missing in the model, read off the table."""
    found = pairs()
    return bullets([*flat(found), *friction(found), when(found), others(found)])


def flat(found):
    """Flat walls without friction, and 22 deg less what they would do there."""
    row, steep = found[FLAT].grains, found[STEEP]
    left = float(steep.grains["front"]) - float(row["front"])
    needed = [rounded(steep.needed_for(left, added), 2) for added in ("", "dilatancy")]
    yield (
        f"**Flat walls without friction** shorten the front of the grains by {shorter(row['front'])} mm at 16°, "
        f"{shorter(row['front_0.3s'])} mm of it in the first 0.3 s. The model has no such walls, so the fair "
        "comparison at 16° is with `b03`."
    )
    yield (
        f"**At 22°** there is no such case. If flat walls do the same there, {shorter(left)} mm of the "
        f"{shorter(steep.grains['front'])} mm are left, and the friction needed is {needed[0]} ({needed[1]} with "
        "dilatancy)."
    )


def friction(found):
    """How much of the change the model gives, the friction that it needs, and the bounds of mu_w."""
    of = [found[words] for words in FAIR]
    given = [float(pair.run(1.0)["front"]) / float(pair.grains["front"]) for pair in of]
    left = float(found[STEEP].grains["front"]) - float(found[FLAT].grains["front"])
    needed = [(pair.needed(added), pair) for pair in of for added in ("", "dilatancy")]
    needed += [(found[STEEP].needed_for(left, added), found[STEEP]) for added in ("", "dilatancy")]
    ratios = span(
        [value / pair.mobilised for value, pair in needed], lambda value: rounded(value, 1)
    )
    sliding = ", ".join(
        f"{shorter(pair.at(SLIDING)['front'])} mm ({words})"
        for words, pair in found.items()
        if words in ("0°", *FAIR)
    )
    yield (
        f"**With the friction that the grains mobilised** (K_w = 1) the model shortens the fronts at 16 and 22° by "
        f"{span(given, lambda value: rounded(value, 0, 100))} % of what the grains do."
    )
    yield (
        f"**It needs** µ_w K_w = {span([value for value, _ in needed], lambda value: rounded(value, 2))} there, "
        f"which is K_w = {ratios}. The prior ends at {RATIOS[-1]:g}."
    )
    yield f"**With {SLIDING:g}**, as of grains that all slide, the model shortens the fronts by {sliding}."


def when(found):
    """When the fronts fall behind at 22 deg."""
    steep = found[STEEP]
    told = ", ".join(f"{time:g}" for time in EARLY)
    grains, model, walls_alone = (
        ", ".join(shorter(row[f"front_{time:g}s"]) for time in EARLY)
        for row in (steep.grains, steep.run(1.0), found[FLAT].grains)
    )
    return (
        f"**When.** At {told} s the fronts of the grains at 22° are behind by {grains} mm, those of the model "
        f"(K_w = 1) by {model} mm. Flat walls without friction put those of the grains at 16° behind by {walls_alone} "
        "mm."
    )


def others(found):
    """What dilatancy and thin layers change of it."""
    told = "; ".join(
        f"{words} "
        + ", ".join(
            f"{differs(found[of], added)} mm ({of})"
            for of in found
            if found[of].runs and of != UNFAIR
        )
        for added, words in (("dilatancy", "dilatancy (K = 4)"), ("thin_layer", "`thin_layer`"))
    )
    return (
        "**Other effects** (K_w = 1). By how much more (+) or less (−) the walls shorten the front of the model if "
        f"another effect acts: {told}."
    )


def differs(pair, added):
    """By how much more the friction of the walls shortens the front with an added effect, mm."""
    more = float(pair.run(1.0)["front"]) - float(pair.run(1.0, added)["front"])
    return signed(round(more, 1), 1)


def shorter(front):
    """A change of the front that shortens it, mm, without its sign."""
    return rounded(-float(front))


# -- what the walls of the model mobilise --------------------------------------------------------


def mobilised():
    """Mean friction of the walls, of grains and model, and the model with the mean of the grains."""
    lines = [
        (
            words,
            rounded(row["grains"], 2),
            *(rounded(mean, 2) for mean in row["means"].values()),
            rounded(row["alike"], 2),
            f"{signed(row['front'])} mm",
            f"{signed(row['front_grains'])} mm",
        )
        for words, row in alike().items()
    ]
    heading = (
        "collapse",
        "grains, mean",
        "model, mean, µ_w = that of the grains",
        f"µ_w = {SLIDING:g}",
        "µ_w for the mean of the grains",
        "front with it",
        "front, grains",
    )
    return table(heading, lines) + solver_line(MOBILISED, TABLE)


def alike():
    """{words: means of the model by mu_w, mu_w for the mean of the grains, changes of the front with it, mm}."""
    found, runs = pairs(), {}
    for row in read_table(RUNS / MOBILISED):
        runs.setdefault(row["pair"], []).append(row)
    rows = {}
    for words, of in runs.items():
        means = {float(row["mu_wall"]): float(row["whole_run"]) for row in of}
        grains = float(of[0]["grains"])
        mu_wall = float(np.interp(grains, [0.0, *means.values()], [0.0, *means]))
        compared_with = FLAT_OF.get(words, words)
        rows[words] = {
            "grains": grains,
            "means": means,
            "alike": mu_wall,
            "front": found[words].front_at(mu_wall),
            "front_grains": float(found[compared_with].grains["front"]),
        }
    return rows


def mobilised_says():
    """What the walls of the model mobilise says of the missing friction."""
    rows = alike()
    steeper = {words: row for words, row in rows.items() if words != "0°"}
    sliding = span([row["means"][SLIDING] for row in rows.values()], lambda of: rounded(of, 2))
    grains = span([row["grains"] for row in rows.values()], lambda of: rounded(of, 2))
    more = span([row["alike"] for row in steeper.values()], lambda of: rounded(of, 2))
    given = [row["front"] / row["front_grains"] for row in steeper.values()]
    flat = float(pairs()[FLAT].grains["front"])
    left = rows[STEEP]["front"] / (rows[STEEP]["front_grains"] - flat)
    return bullets(
        [
            f"**Walls on which grains slide with {SLIDING:g}** mobilise {sliding} on average in the model, {grains} in "
            "the grains.",
            f"**With the same mean as the grains** µ_w is {more} at 16 and 22°, and the model shortens the fronts by "
            f"{span(given, lambda of: rounded(of, 0, 100))} % of what the grains do; at 22° by {rounded(left, 0, 100)} "
            "% if flat walls take there what they take at 16°.",
        ]
    )
