"""The runs that a diagnosis would make, before any of them is made."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from fvcollapse.diagnosis.analysis import REFINED, REFINEMENTS
from fvcollapse.diagnosis.levels import effect_runs
from fvcollapse.diagnosis.library import DRAWS, baseline_runs, chosen_closures
from fvcollapse.diagnosis.names import RUNGS
from fvcollapse.diagnosis.next_candidates import candidates
from fvcollapse.diagnosis.next_experiment import MOST_HYPOTHESES
from fvcollapse.diagnosis.nuisances import draw, ensemble_runs, nuisances
from fvcollapse.measure.observation import flow_case
from fvcollapse.studies.cache import EXTRACT, RunCache
from fvcollapse.studies.cache_folder import default_folder
from fvcollapse.studies.estimate import Plan, plan_of

if TYPE_CHECKING:
    from pathlib import Path

    from fvcollapse.case.case import Case
    from fvcollapse.diagnosis.question import Question


class DiagnosisPlan(NamedTuple):
    """What a diagnosis would run.

    Attributes
    ----------
    sure : Plan
        Model as given, ensemble, effects.
    further : int
        Most runs that may follow from the answer: more levels, models with the effect, next experiments.
    """

    sure: Plan
    further: int

    def line(self, workers: int = 1) -> str:
        """One line for the user."""
        return (
            f"{self.sure.line(workers)}; then up to {self.further} more that depend on the answer"
        )


def plan_diagnosis(
    question: "Question",
    effects: Sequence[str] | None = None,
    draws: int = DRAWS,
    cache: "Path | None" = None,
) -> DiagnosisPlan:
    """The `DiagnosisPlan` of a `Question`; nothing is run and nothing is written.

    Parameters
    ----------
    question : Question
    effects : sequence of str, optional
    draws : int
    cache : Path, optional
        Folder of the cache of runs; default that of the user.

    Raises
    ------
    InputError
        An effect is not in the catalogue, or none can act.
    """
    runs = RunCache(cache or default_folder())
    places = {runs.place(case): case for case in planned_cases(question, effects, draws)}
    missing = [case for place, case in places.items() if not (place / EXTRACT).exists()]
    return DiagnosisPlan(plan_of(missing, len(places) - len(missing)), further(question))


def planned_cases(question: "Question", effects: Sequence[str] | None, draws: int) -> "list[Case]":
    """Cases of all runs that do not depend on the answer."""
    simulated, cases = question.simulated, question.cases
    closures, _ = chosen_closures(question, effects)
    quantities = nuisances(simulated, cases)
    drawn, _ = ensemble_runs(simulated, cases, quantities, draw(quantities, draws, question.seed))
    levels, _ = effect_runs(closures, simulated, cases)
    wanted = baseline_runs(simulated, cases) | drawn | levels
    return [flow_case(case) for _, case in wanted.values()]


def further(question: "Question") -> int:
    """Most runs that may follow from the answer."""
    fitted, held_out = len(question.experiments), len(question.held_out)
    more_levels = REFINEMENTS * REFINED * fitted
    ladder = len(RUNGS) * (fitted + held_out) + held_out
    folds = 0 if held_out or fitted == 1 else (len(RUNGS) - 1) * fitted
    first = question.experiments[0]
    set_ups = len(candidates(first, question.cases[first.name]))
    return more_levels + ladder + folds + set_ups * (2 + MOST_HYPOTHESES)
