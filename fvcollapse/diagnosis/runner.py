"""Runs through the cache, read as the experiment would.

An effect that changes the observation and not the flow is read off the run without it.
"""

from collections.abc import Callable, Mapping
from copy import copy
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fvcollapse.case.case import Case
from fvcollapse.diagnosis.progress import cost_of_run
from fvcollapse.errors import NumericalError, failures_named
from fvcollapse.measure.observables import observe
from fvcollapse.measure.observation import flow_case
from fvcollapse.output.compilation import tell_compilation
from fvcollapse.studies.cache import RunCache, entry
from fvcollapse.studies.cache_folder import ready_folder
from fvcollapse.studies.workers import run_all

if TYPE_CHECKING:
    from collections.abc import Hashable
    from typing import TypeVar

    from fvcollapse.console.rounds_bar import RoundsBar
    from fvcollapse.errors import FvcollapseError
    from fvcollapse.measure.experiment import Experiment
    from fvcollapse.measure.observables import Observations
    from fvcollapse.studies.standing import StandingWorkers

    # what a run is of (model, or effect and number of its closure), and its draw, or its level and realisation
    What = str | tuple[str, int]
    Number = int | str | tuple[int | str, int] | None
    Label = tuple[What, Number, str]  # the last is the name of its experiment
    Wanted = dict[Label, tuple[Experiment, Case]]
    Failures = dict[Label, FvcollapseError]
    AnyLabel = TypeVar("AnyLabel", bound=Hashable)


class RunRecord(NamedTuple):
    """A run that was asked for: the name of its experiment, its `Case`, and its folder in the cache."""

    experiment: str
    case: Case
    folder: Path


class Runner:
    """Runs cases through the cache and reads them as an experiment would; counts what it took.

    Parameters
    ----------
    folder : Path, optional
        Of the cache of runs; default that of the user.
    workers, scheduler, quiet
        See `workers.run_all`.

    Attributes
    ----------
    asked, computed, failed : set of str
        Keys of the runs in the cache: of all, of those that were not at hand, of those that failed.
    record : dict
        Key -> `RunRecord`, in the order in which they were asked for.
    """

    if TYPE_CHECKING:
        asked: set[str]
        computed: set[str]
        failed: set[str]
        record: dict[str, RunRecord]

    def __init__(
        self,
        folder: str | Path | None = None,
        workers: int = 1,
        scheduler: str | None = None,
        quiet: bool = True,
    ) -> None:
        self.cache = RunCache(ready_folder(folder))
        self.workers, self.scheduler, self.quiet = workers, scheduler, quiet
        self.asked, self.computed, self.failed = set(), set(), set()
        self.record = {}

    def observations(
        self, wanted: "Mapping[AnyLabel, tuple[Experiment, Case]]", phase: str = ""
    ) -> "tuple[dict[AnyLabel, Observations], dict[AnyLabel, FvcollapseError]]":
        """({label: Observations}, {label: NumericalError}) of {label: (experiment, case)}.

        The costly ones first. `phase` is the word of the progress bar for these runs.
        """
        flows = {label: flow_case(case) for label, (_, case) in wanted.items()}
        runs = self.cache.run_by(partial(self.make_calls, phase, flows), flows)
        self.asked |= set(runs.keys.values())
        self.computed |= runs.computed
        self.failed |= {runs.keys[label] for label in runs.failures}
        for label, key in runs.keys.items():
            place = entry(Path(self.cache.folder), key)
            self.record.setdefault(key, RunRecord(wanted[label][0].name, flows[label], place))
        seen, failures = {}, dict(runs.failures)
        for label, result in runs.results.items():
            experiment, case = wanted[label]
            view = copy(result)
            view.case = case.replace(**{"time.end": result.case.time.end})
            try:
                with failures_named():
                    seen[label] = observe(view, experiment)
            except NumericalError as error:
                failures[label] = error
        return seen, failures

    def make_calls(
        self,
        phase: str,
        flows: Mapping[Any, Case],
        task: Callable,
        calls: dict[str, tuple],
        finished: Callable[[str, Any], None],
    ) -> None:
        """Make the calls that the cache needs; see `workers.run_all`."""
        run_all(task, calls, finished, self.workers, self.scheduler, self.quiet)


class StandingRunner(Runner):
    """A `Runner` whose workers stay from one call to the next, with one bar over all of them.

    Parameters
    ----------
    folder : Path, optional
        See `Runner`.
    workers : StandingWorkers
    bar : RoundsBar
    """

    def __init__(
        self, folder: str | Path | None, workers: "StandingWorkers", bar: "RoundsBar"
    ) -> None:
        super().__init__(folder)
        self.standing, self.bar = workers, bar

    def make_calls(
        self,
        phase: str,
        flows: Mapping[Any, Case],
        task: Callable,
        calls: dict[str, tuple],
        finished: Callable[[str, Any], None],
    ) -> None:
        """See `Runner.make_calls`."""
        if calls and self.standing.scheduler is None:
            tell_compilation(self.bar.off)
        costs = {key: cost_of_run(case) for key, (case, *_) in calls.items()}
        self.bar.begin(phase, [*costs.values()], sum(map(cost_of_run, flows.values())))

        def end(key: str, outcome: Any) -> None:
            """Count a run that has ended."""
            self.bar.end_run(costs[key])
            finished(key, outcome)

        self.standing.run_all(task, calls, end)
