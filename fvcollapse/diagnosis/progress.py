"""The rounds of runs that a diagnosis asks for, and what they cost, about."""

from math import ceil
from typing import TYPE_CHECKING

from fvcollapse.diagnosis.baseline import refined

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.diagnosis.question import Question

LIBRARY, FURTHER, MODELS, NEXT = (
    "baseline, ensemble and effects",
    "further levels",
    "models with the effect",
    "next experiment",
)
FITTED_MODELS = 3  # of the ladder, beside the baseline
FURTHER_LEVELS, CANDIDATES, CANDIDATE_RUNS = 2, 5, 4


def cost_of_run(case: "Case") -> float:
    """What a run costs, in units of one second of collapse of one cell of its column."""
    geometry, grid = case.geometry, case.grid
    cells = geometry.height_0 / (grid.cell_size_z or grid.cell_size)
    return case.time.end * ceil(cells) * ceil(geometry.length_0 / grid.cell_size)


def expected_costs(question: "Question") -> dict[str, list[float]]:
    """{round: costs of its runs} that a diagnosis will ask for after its library.

    Parameters
    ----------
    question : Question
    """
    fitted = [question.cases[experiment.name] for experiment in question.experiments]
    held_out = [*question.held_out_cases.values()]
    coarse = [cost_of_run(case) for case in fitted]
    fine = [cost_of_run(refined(case)) for case in (*fitted, *held_out)]
    folds = FITTED_MODELS * fine if not held_out and len(fitted) > 1 else []
    return {
        FURTHER: FURTHER_LEVELS * coarse,
        MODELS: FITTED_MODELS * fine + folds + [cost_of_run(case) for case in held_out],
        NEXT: CANDIDATES * CANDIDATE_RUNS * [sum(coarse) / len(coarse)],
    }
