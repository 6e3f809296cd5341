"""A report in a notebook: the answer as a table, probabilities as a figure, what was compared as labelled arrays."""

from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.draw.html import html_table
from fvcollapse.files.labelled import Labelled, tree
from fvcollapse.measure.quantities import QUANTITIES

if TYPE_CHECKING:
    import xarray

    from fvcollapse.diagnosis.report.schema import Report
    from fvcollapse.draw.drawing import Picture

MOST_BARS = 8
PLACES = {
    "time": ("s", "time on the clock of the experiment"),
    "x": ("m", "distance along the bed"),
}


def answer_table(report: "Report") -> str:
    """The answer of a report as HTML."""
    from fvcollapse.diagnosis.report.sentences import answer, headline  # which know the schema

    rows = [line.split(": ", 1) for line in answer(report)]
    return html_table(headline(report), rows)


def draw_probabilities(report: "Report") -> "Picture":
    """The most probable hypotheses as bars, those of the prediction set in full colour.

    Returns
    -------
    Picture
        What a notebook shows.
    """
    from fvcollapse.diagnosis.report.words import hypothesis_name
    from fvcollapse.draw.drawing import new_figure  # loads matplotlib

    first = list(report.verdict.probability.items())[:MOST_BARS]
    made = new_figure(6.0, 1.0 + 0.3 * len(first))
    axes = made.add_subplot()
    names = [hypothesis_name(name) for name, _ in first]
    strength = [1.0 if name in report.verdict.set else 0.35 for name, _ in first]
    bars = axes.barh(names, [share for _, share in first], color="C0")
    for bar, alpha in zip(bars, strength, strict=True):
        bar.set_alpha(alpha)
    axes.invert_yaxis()
    axes.set_xlim(0.0, 1.0)
    axes.set_xlabel("probability (full colour: not excluded)")
    return made


def arrays_of(report: "Report") -> "xarray.DataTree":
    """What was compared, as a tree: one group for each observable of each experiment.

    Raises
    ------
    ImportError
        xarray is not installed.
    """
    groups = {}
    for one in report.details.comparisons:
        name, about = one.observable, QUANTITIES.get(one.observable)
        words = name.replace("_", " ") if about is None else about.words
        arrays = {
            "measured": Labelled(("point",), np.array(one.measured), one.units, words),
            "sigma": Labelled(("point",), np.array(one.sigma), one.units, "of the measurement"),
        }
        for place, (units, meaning) in PLACES.items():
            if (values := getattr(one, place)) is not None:
                arrays[place] = Labelled(("point",), np.array(values), units, meaning)
        for model, values in one.simulated.items():
            arrays[f"simulated_{model}"] = Labelled(("point",), np.array(values), one.units, model)
        groups[f"{one.experiment}/{name}"] = arrays
    return tree(groups, {"verdict": report.verdict.kind, "effects": list(report.verdict.effects)})
