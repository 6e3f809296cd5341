"""Words and symbols of the page: what no geologist needs to know already."""

from typing import TYPE_CHECKING

from fvcollapse.case.case import describe_keys

if TYPE_CHECKING:
    from fvcollapse.diagnosis.report.schema import Report

WORDS = (
    (
        "Cause, effect, hypothesis",
        "An effect is something that a laboratory has and the model as given has not. A hypothesis is a statement "
        "that the data are compared with: one effect, two together, no missing effect, or something else. A cause is "
        "what a hypothesis says is missing.",
    ),
    ("Catalogue", "The list of all effects that the program can add to its model."),
    (
        "Outside the catalogue",
        "The gap has the size of a gap, but none of the effects makes one of its form: the model lacks something "
        "else, or a measurement is off by more than was stated.",
    ),
    ("Gap", "Simulated minus measured value."),
    (
        "sd, standard uncertainty",
        "Standard deviation: two thirds of all errors are smaller, 95 % are within two of them.",
    ),
    (
        "Combined standard uncertainty",
        "That of a gap: from the measurement (also errors that a whole run shares), the grid of the simulation, and "
        "the parameters that were calibrated. A gap within two of them says nothing.",
    ),
    ("rms", "Root of the mean square: the typical size of values of either sign."),
    (
        "Significant",
        "Larger than chance would make it anywhere in the data more than once in twenty times.",
    ),
    (
        "Evidence",
        "Probability that a hypothesis had given to these very data before they were seen; ln is its natural "
        "logarithm, and 2.3 in it is a factor of ten.",
    ),
    ("Before (prior)", "What was known of a parameter before these data."),
    (
        "Calibrated probabilities",
        "Of all answers that are given 70 %, 70 % are right, on simulated cases with a known cause. Probabilities that "
        "are not calibrated only rank.",
    ),
    (
        "Tempered",
        "The evidence counts less than its size: its logarithm is divided by ten, or by the number of measured values "
        "where these are fewer, because neighbouring measured values err together and evidence is over-confident.",
    ),
    (
        "Verdict layer",
        "The part that turns evidence into calibrated probabilities; it was fitted to simulated cases.",
    ),
    (
        "Sealed case",
        "A synthetic case whose cause was withheld until the answer to it was stored.",
    ),
    (
        "Retained, not excluded",
        "Hypotheses that the data leave open: together they hold the truth in nine of ten cases.",
    ),
    (
        "Typicality p",
        "Share of simulated cases whose true cause looked as improbable as this one does here, or more so.",
    ),
    (
        "Predictive check, p",
        "Chance of a remaining gap as large as this one if the model were right.",
    ),
    (
        "Model as given",
        "The model that was believed before the diagnosis, without any further effect.",
    ),
    (
        "Re-calibrated",
        "The parameters that the user had calibrated are fitted again within their uncertainty.",
    ),
    (
        "Fitted, held out",
        "Used to find the cause; kept aside, to test the answer on what it has not seen.",
    ),
    (
        "Control",
        "An experiment in which nothing is hidden; it shows how far the model errs anyway.",
    ),
    (
        "Signature, cosine",
        "The change that an effect makes to all observables. The cosine compares two of them: 1 is the same form, "
        "\N{MINUS SIGN}1 the same with its sign turned round, 0 is nothing in common.",
    ),
    ("Bit", "Unit of information: one bit halves the number of equally probable causes."),
    ("Grid, cell", "The flow is computed on square cells; smaller ones err less and take longer."),
    ("Static–flowing interface", "The height below which grains move slower than 1 cm/s."),
)
SYMBOLS = (
    ("X, x", "cm", "distance from the back wall, along the bed"),
    ("t", "s", "time since the gate began to open"),
    ("z (of a gap)", "sd", "gap divided by its combined standard uncertainty"),
    (
        "G0, G1, G2, G2'",
        "",
        "model as given; re-calibrated; with the first effect; with the second effect",
    ),
    ("ln Z", "", "logarithm of the evidence"),
)


SHOWN_UNITS = {"-": "", "1": "", "m": "cm"}  # as the page prints parameters


def symbols(report: "Report") -> list[tuple[str, str, str]]:
    """(symbol, unit, meaning) of all that the page prints: its own, and the keys of cases in it."""
    used = [
        f"effects.{name}.{key}"
        for name, candidate in report.candidates.items()
        for key in candidate.parameters
    ]
    used += [key.partition(" ")[0] for rung in report.details.ladder for key in rung.calibrated]
    known = {info.name: info for info in describe_keys()}
    rows = [
        (key.removeprefix("effects."), known[key].unit, known[key].description)
        for key in dict.fromkeys(used)
        if key in known
    ]
    return [
        *SYMBOLS,
        *((name, SHOWN_UNITS.get(unit, unit), text) for name, unit, text in rows),
    ]
