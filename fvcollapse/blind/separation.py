"""How far apart the effects of a case are for its data, kept in a file so that no run is read again.

With W the whitened responses at all levels of all closures, C(s) at the discrepancy s of the best hypothesis (at most
the largest that is taken for an error of the model where nothing acts), the file holds W^T W. The response of a
closure at any u is a sum of its levels with the weights of the emulator, so that every distance follows from these
products, also the one at the parameters that were hidden.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.blind.plain_values import Drawn, Levels, Separation
from fvcollapse.diagnosis.emulator import Kriging
from fvcollapse.diagnosis.evidence import LARGEST

if TYPE_CHECKING:
    from fvcollapse.diagnosis.analysis import Analysis

DIGITS = 6


def separation_of(analysis: "Analysis") -> Separation:
    """The part of a file of evidence, as plain values.

    Returns
    -------
    dict
        `closures` {effect: [{"levels": (m, d), "columns": (m,)}]}, and `products` (n, n) of all columns.
    """
    comparison = analysis.comparison
    sigma = min(analysis.evidence.best.sigma, LARGEST)
    white = comparison.whitened[sigma]
    closures: dict[str, list[Levels]] = {}
    columns: list[int] = []
    for name, variants in comparison.closures.items():
        closures[name] = []
        for variant in variants:
            (response,) = variant.responses
            place = range(len(columns), len(columns) + len(variant.levels))
            closures[name].append({"levels": response.levels.tolist(), "columns": [*place]})
            columns += variant.levels.tolist()
    products = white.products[np.ix_(columns, columns)]
    rounded = [[float(f"{value:.{DIGITS}g}") for value in row] for row in products]
    return {"closures": closures, "products": rounded}


def distance(separation: Separation, effects: Mapping[str, Drawn]) -> float:
    """D of one effect, or of two, that are hidden: 0 where one of them changes nothing that was measured.

    Of one effect the distance to the nearest other hypothesis: every other effect at its median with a free
    amplitude, and none. Of two the smaller one of each against the other alone.

    Parameters
    ----------
    separation : dict
        See `separation_of`.
    effects : dict
        Effect -> {"closure", "quantiles"}, one or two.
    """
    closures, products = separation["closures"], np.array(separation["products"])
    if not set(effects) <= set(closures):
        return 0.0
    weights = {
        name: column_weights(variants[0], None, len(products))
        for name, variants in closures.items()
    }
    for name, drawn in effects.items():
        u = np.array([*drawn["quantiles"].values()])
        weights[name] = column_weights(closures[name][drawn["closure"]], u, len(products))
    truths = list(effects)
    others = truths if len(truths) > 1 else [name for name in weights if name not in effects]
    rows = {name: weights[name] for name in {*truths, *others}}
    names = list(rows)
    columns = np.array([rows[name] for name in names])
    gram = columns @ products @ columns.T
    squares = []
    for truth in map(names.index, truths):
        own = gram[truth, truth]
        squares += [own] if len(truths) == 1 else []
        rivals = [number for number in range(len(names)) if number != truth]
        squares += [
            own - gram[truth, rival] ** 2 / max(gram[rival, rival], 1.0e-300) for rival in rivals
        ]
    return float(np.sqrt(max(min(squares), 0.0)))


def column_weights(closure: Levels, u: np.ndarray | None, count: int) -> np.ndarray:
    """Weights (count,) of all columns for a closure at u (d,); default the median of every prior."""
    levels = np.array(closure["levels"])
    u = np.full(levels.shape[1], 0.5) if u is None else u
    weights, _ = Kriging(levels)(u[None])
    row = np.zeros(count)
    row[closure["columns"]] = weights[0]
    return row
