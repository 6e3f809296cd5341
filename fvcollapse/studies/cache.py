"""A content-addressed cache of runs: no run is computed twice.

The key of a run is a digest of the solver and of the resolved case without its outputs. Every key
has a folder. During the run it holds the checkpoint, from which the next caller continues;
afterwards it holds the extract only. Any number of processes may use a cache.

An entry is taken only if it reaches the end that is asked for, if the case that is stored in it has
its key, and if all of its numbers are finite. Another one, copied by hand, damaged or left by a solver
that failed without a word, is computed again, which is said on stderr.
"""

import shutil
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fvcollapse.case.grammar import as_table, toml_lines
from fvcollapse.errors import (
    FvcollapseError,
    InputError,
    NumericalError,
    UnreadableError,
    failures_named,
)
from fvcollapse.files.atomic import write_atomic
from fvcollapse.files.locks import LOCK, exclusive
from fvcollapse.output.extract import FinishedRun, extract_image
from fvcollapse.output.fingerprint import solver_version
from fvcollapse.output.recorder import SAME_TIME
from fvcollapse.output.result import open_result
from fvcollapse.output.run_folder import CHECKPOINT, OUTPUT_KEYS, RESULT, stored_case
from fvcollapse.output.run_without_result import run_without_result
from fvcollapse.studies.workers import run_all

if TYPE_CHECKING:
    from typing import TypeVar

    from fvcollapse.case.case import Case
    from fvcollapse.output.result import Result

    Name = TypeVar("Name")  # of a run: a text, or whatever else tells the runs apart


FORMAT = 2  # of the extract; it is part of every key
EXTRACT, WORK = "extract.h5", "run"
PROFILE_INTERVAL = 0.02  # s; the same for all runs, since output times influence the time steps


def cached_case(case: "Case") -> "Case":
    """The case that is run: physics and numerics of a case, with the outputs of the cache."""
    return case.replace(
        **{
            "time.output_interval": PROFILE_INTERVAL,
            "time.field_interval": max(case.time.end, PROFILE_INTERVAL),
            "time.output_times": [],
            "time.stop_at_rest": False,  # comparisons go on to the last moment that was measured
        }
    )


def cache_key(case: "Case") -> str:
    """Digest of all that a run depends on: the solver with its effects, and the case without its outputs."""
    table = as_table(case)
    solver = solver_version(tuple(table["effects"]))  # an effect that is off has no section
    for path in OUTPUT_KEYS:
        section, _, name = path.partition(".")
        table[section].pop(name, None)
    text = "\n".join([f"extract {FORMAT}", f"solver {solver}", *toml_lines(table)])
    return sha256(text.encode()).hexdigest()


class Runs(NamedTuple):
    """Outcome of many runs.

    Attributes
    ----------
    results : dict
        Name -> `Result`.
    failures : dict
        Name -> NumericalError of a run that failed.
    keys : dict
        Name -> key of its run.
    computed : frozenset of str
        Keys of the runs that were not at hand.
    """

    results: dict
    failures: dict
    keys: dict
    computed: frozenset


@dataclass(frozen=True)
class RunCache:
    """A cache in a folder, and libraries of finished runs that are only read.

    Attributes
    ----------
    folder : str or Path
    libraries : tuple of Path
        Searched first.
    """

    folder: str | Path
    libraries: tuple = ()

    def place(self, case: "Case") -> Path:
        """Folder of a case."""
        return entry(Path(self.folder).absolute(), cache_key(case))

    def get(self, case: "Case") -> "Result | None":
        """The `Result` of a case, with series thinned and no fields; None if there is none.

        A run to a later end serves as well.
        """
        return self.entry(cache_key(case), case)

    def entry(self, key: str, case: "Case") -> "Result | None":
        """As `get`, of a case whose key is known."""
        for folder in (*self.libraries, self.folder):
            result, defect = read_extract(entry(Path(folder), key), case, key)
            if result is not None:
                return result
            if defect:
                print(f"{defect}; it is computed again", file=sys.stderr)
        return None

    def run(self, case: "Case", quiet: bool = True) -> "Result":
        """The `Result` of a case, computed if it is not there.

        Raises
        ------
        NumericalError, OutputError, KeyboardInterrupt
            The next call continues from the checkpoint.
        """
        found = self.get(case)
        if found is None:
            make_extract(case, self.place(case), quiet)
            found = self.get(case)
        return found  # type: ignore[return-value]

    def run_all(
        self,
        cases: "Mapping[str, Case]",
        workers: int = 1,
        scheduler: str | None = None,
        quiet: bool = True,
    ) -> Runs:
        """The results of {name: case}; equal cases are run once, and failures stop no other run.

        Parameters
        ----------
        cases : dict
            The costly ones first.
        workers, scheduler, quiet
            See `workers.run_all`.

        Returns
        -------
        Runs

        Raises
        ------
        InputError
            The workers of the scheduler do not share the folder.
        OutputError, KeyboardInterrupt
            What is finished is kept; the next call continues.
        """
        return self.run_by(
            partial(run_all, workers=workers, scheduler=scheduler, quiet=quiet), cases
        )

    def run_by(self, make_calls: Callable, cases: "Mapping[Name, Case]") -> Runs:
        """As `run_all`, the calls made by `make_calls(task, calls, finished)`; see `workers.run_all`."""
        keys = {name: cache_key(case) for name, case in cases.items()}
        wanted = longest(keys, cases)
        found = {key: self.entry(key, case) for key, case in wanted.items()}
        missing = {key: case for key, case in wanted.items() if found[key] is None}
        made, failures = self.compute(missing, make_calls)
        found |= made
        results, failed = {}, {}
        for name, key in keys.items():
            # where a longer run fails, a shorter one may be at hand
            result = self.entry(key, cases[name]) if key in failures else found[key]
            if result is None:
                failed[name] = failures[key]
            else:
                results[name] = result
        return Runs(results, failed, keys, frozenset(missing))

    def compute(
        self, missing: "Mapping[str, Case]", make_calls: Callable
    ) -> tuple[dict[str, Any], dict[str, NumericalError]]:
        """Compute {key: case}; ({key: Result}, {key: NumericalError} of those that failed)."""
        made, failures = {}, {}

        def finished(key, outcome):
            if isinstance(outcome, NumericalError):
                failures[key] = outcome
            elif isinstance(outcome, FvcollapseError):
                raise outcome
            else:
                made[key] = self.entry(key, missing[key])
                if made[key] is None:
                    found = "workers that do not see this folder"
                    raise InputError(self.folder, "--scheduler", found, "a shared file system")

        folder = Path(self.folder).absolute()
        calls = {key: (case, entry(folder, key), True) for key, case in missing.items()}
        make_calls(make_extract, calls, finished)
        return made, failures


def longest(keys: "Mapping[Name, str]", cases: "Mapping[Name, Case]") -> "dict[str, Case]":
    """{key: case} of {name: key} and {name: case}; of cases that share a key the case with the latest end."""
    found: dict[str, Case] = {}
    for name, key in keys.items():
        case = cases[name]
        if key not in found or case.time.end > found[key].time.end:
            found[key] = case
    return found


def entry(folder: Path, key: str) -> Path:
    """Folder of a key."""
    return folder / key[:2] / key


def read_extract(place: Path, case: "Case", key: str) -> "tuple[Result | None, str]":
    """(extract in a place, "") if it serves a case of this key, else (None, why what is there may not be used)."""
    path = place / EXTRACT
    if not path.exists():
        return None, ""
    try:
        result = open_result(path)
    except UnreadableError:  # it may be sound
        raise
    except InputError as error:
        return None, str(error)
    if not result.complete or result.case.time.end < case.time.end - SAME_TIME:
        return None, ""
    if cache_key(result.case) != key:
        return None, f"{path}: an entry of another case"
    if not is_finite(result):
        return None, f"{path}: an entry with numbers that are not finite"
    return result, ""


def is_finite(result: Any) -> bool:
    """Whether all numbers of a result are finite."""
    values = (*result.series.values(), *result.steps.values(), *result.profiles)
    return all(np.isfinite(array).all() for array in values)


def make_extract(case: "Case", place: Path, quiet: bool = True) -> None:
    """Run or continue a case in its folder and write the extract, unless it exists.

    Another process that computes the same case is waited for.

    Raises
    ------
    NumericalError
        Among others if the result has numbers that are not finite; nothing is left of it.
    """
    work = place / WORK

    def keep(job):
        """Write the extract, unless some of its numbers are not finite."""
        finished = FinishedRun.of(job.recorder, job.case)
        if not is_finite(finished):
            shutil.rmtree(work, ignore_errors=True)
            raise NumericalError("the result has numbers that are not finite", f"in {work}")
        write_atomic(place / EXTRACT, extract_image(finished))

    with failures_named(), exclusive(place / LOCK):
        if read_extract(place, case, cache_key(case))[0] is None:
            # a longer run that was cut short is finished as such
            end = max(case.time.end, begun_end(work))
            longest = cached_case(case.replace(**{"time.end": end}))
            run_without_result(longest, work, keep, quiet)
        shutil.rmtree(work, ignore_errors=True)


def begun_end(work: Path) -> float:
    """End of the run that was begun in a folder [s]; 0 if there is none."""
    begun = [stored_case(work / name) for name in (CHECKPOINT, RESULT)]
    return max((case.time.end for case in begun if case is not None), default=0.0)
