"""Runs through the cache, read as the experiment would.

An effect that changes the observation and not the flow is read off the run without it.
"""

from copy import copy

from fvcollapse.errors import NumericalError, failures_named
from fvcollapse.measure.observables import observe
from fvcollapse.measure.observation import flow_case
from fvcollapse.studies.cache import EXTRACT, RunCache, ready_folder


class Runner:
    """Runs cases through the cache and reads them as an experiment would; counts what it took.

    Parameters
    ----------
    folder : Path, optional
        Of the cache of runs; default that of the user.
    workers, scheduler, quiet
        See `workers.run_all`.
    """

    def __init__(self, folder=None, workers=1, scheduler=None, quiet=True):
        self.cache = RunCache(ready_folder(folder))
        self.workers, self.scheduler, self.quiet = workers, scheduler, quiet
        self.asked, self.computed, self.failed = set(), set(), set()
        self.record = {}  # place of a run in the cache -> (name of the experiment, case)

    def observations(self, wanted):
        """({label: Observations}, {label: NumericalError}) of {label: (experiment, case)}.

        The costly ones first.
        """
        flows = {label: flow_case(case) for label, (_, case) in wanted.items()}
        places = {label: self.cache.place(case) for label, case in flows.items()}
        missing = {place for place in places.values() if not (place / EXTRACT).exists()}
        self.asked |= set(places.values())
        self.computed |= missing
        for label, place in places.items():
            self.record.setdefault(place, (wanted[label][0].name, flows[label]))
        runs = self.cache.run_all(flows, self.workers, self.scheduler, self.quiet)
        seen, failures = {}, dict(runs.failures)
        self.failed |= {places[label] for label in failures}
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
