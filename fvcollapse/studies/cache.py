"""A content-addressed cache of runs: no run is computed twice.

The key of a run is a digest of the solver and of the resolved case without its outputs. Every key
has a folder. During the run it holds the checkpoint, from which the next caller continues;
afterwards it holds the extract only. Any number of processes may use a cache.

An entry is taken only if it reaches the end that is asked for, if the case that is stored in it has
its key, and if all of its numbers are finite. Another one, copied by hand, damaged or left by a solver
that failed without a word, is computed again, which is said on stderr.
"""

import os
import shutil
import sys
from dataclasses import dataclass
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fvcollapse.case.grammar import as_table, toml_lines
from fvcollapse.errors import (
    FvcollapseError,
    InputError,
    NumericalError,
    UnreadableError,
    failures_named,
)
from fvcollapse.files.atomic import locked_temporary, remove_stale, write_atomic
from fvcollapse.files.locks import LOCK, exclusive
from fvcollapse.output.extract import FinishedRun, extract_image
from fvcollapse.output.fingerprint import solver_version
from fvcollapse.output.recorder import SAME_TIME
from fvcollapse.output.result import open_result
from fvcollapse.output.run_folder import CHECKPOINT, OUTPUT_KEYS, RESULT, stored_case
from fvcollapse.output.run_without_result import run_without_result
from fvcollapse.studies.workers import run_all

FORMAT = 2  # of the extract; it is part of every key
EXTRACT, WORK = "extract.h5", "run"
PROFILE_INTERVAL = 0.02  # s; the same for all runs, since output times influence the time steps
VARIABLE = "FVCOLLAPSE_CACHE"


def default_folder():
    """Folder of the cache of this user: $FVCOLLAPSE_CACHE, else in $XDG_CACHE_HOME or ~/.cache."""
    if named := os.environ.get(VARIABLE):
        return Path(named)
    if named := os.environ.get("XDG_CACHE_HOME"):
        return Path(named) / "fvcollapse"
    try:
        return Path.home() / ".cache" / "fvcollapse"
    except RuntimeError:
        found = "no home folder of this user"
        raise InputError("environment", VARIABLE, found, "a folder that may be written") from None


def ready_folder(folder=None):
    """A folder for a cache, made if need be; default that of this user.

    Raises
    ------
    InputError
        It cannot be written; the line names what to set.
    """
    folder = Path(folder or default_folder()).absolute()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        remove_stale(folder)
        handle, name = locked_temporary(folder)
        os.close(handle)
        os.unlink(name)
    except OSError as error:
        found = f"a folder that cannot be written ({(error.strerror or str(error)).lower()})"
        allowed = f"one that can: set {VARIABLE} or --cache"
        raise InputError(folder, "cache of runs", found, allowed) from None
    return folder


def cached_case(case):
    """The case that is run: physics and numerics of a case, with the outputs of the cache."""
    return case.replace(
        **{
            "time.output_interval": PROFILE_INTERVAL,
            "time.field_interval": max(case.time.end, PROFILE_INTERVAL),
            "time.output_times": [],
        }
    )


def cache_key(case):
    """Digest of all that a run depends on: the solver with its effects, and the case without its outputs."""
    table = as_table(case)
    solver = solver_version(tuple(table["effects"]))  # an effect that is off has no section
    for path in OUTPUT_KEYS:
        section, _, name = path.partition(".")
        table[section].pop(name, None)
    text = "\n".join([f"extract {FORMAT}", f"solver {solver}", *toml_lines(table)])
    return sha256(text.encode()).hexdigest()


class Runs(NamedTuple):
    """Outcome of many runs: {name: Result}, and {name: NumericalError} of those that failed."""

    results: dict
    failures: dict


@dataclass(frozen=True)
class RunCache:
    """A cache in a folder, and libraries of finished runs that are only read.

    Attributes
    ----------
    folder : Path
    libraries : tuple of Path
        Searched first.
    """

    folder: Path
    libraries: tuple = ()

    def place(self, case):
        """Folder of a case."""
        return entry(Path(self.folder).absolute(), cache_key(case))

    def get(self, case):
        """The `Result` of a case, with series thinned and no fields; None if there is none.

        A run to a later end serves as well.
        """
        key = cache_key(case)
        for folder in (*self.libraries, self.folder):
            result, defect = read_extract(entry(Path(folder), key), case)
            if result is not None:
                return result
            if defect:
                print(f"{defect}; it is computed again", file=sys.stderr)
        return None

    def run(self, case, quiet=True):
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
        return found

    def run_all(self, cases, workers=1, scheduler=None, quiet=True):
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

    def run_by(self, make_calls, cases):
        """As `run_all`, the calls made by `make_calls(task, calls, finished)`; see `workers.run_all`."""
        found = {name: self.get(case) for name, case in cases.items()}
        missing = {name: case for name, case in cases.items() if found[name] is None}
        made, failures = self.compute(longest(missing.values()), make_calls)
        for name, case in missing.items():
            found[name] = made.get(cache_key(case))
        failed = {name: failures.get(cache_key(case)) for name, case in missing.items()}
        results = {name: result for name, result in found.items() if result is not None}
        return Runs(results, {name: error for name, error in failed.items() if error is not None})

    def compute(self, missing, make_calls):
        """Compute {key: case}; ({key: Result}, {key: NumericalError} of those that failed)."""
        made, failures = {}, {}

        def finished(key, outcome):
            if isinstance(outcome, NumericalError):
                failures[key] = outcome
            elif isinstance(outcome, FvcollapseError):
                raise outcome
            else:
                made[key] = self.get(missing[key])
                if made[key] is None:
                    found = "workers that do not see this folder"
                    raise InputError(self.folder, "--scheduler", found, "a shared file system")

        calls = {key: (case, self.place(case), True) for key, case in missing.items()}
        make_calls(make_extract, calls, finished)
        return made, failures


def longest(cases):
    """{key: case}; of cases that share a key the case with the latest end."""
    found = {}
    for case in cases:
        key = cache_key(case)
        if key not in found or case.time.end > found[key].time.end:
            found[key] = case
    return found


def entry(folder, key):
    """Folder of a key."""
    return folder / key[:2] / key


def read_extract(place, case):
    """(extract in a place, "") if it serves a case, else (None, why what is there may not be used)."""
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
    if cache_key(result.case) != cache_key(case):
        return None, f"{path}: an entry of another case"
    if not is_finite(result):
        return None, f"{path}: an entry with numbers that are not finite"
    return result, ""


def is_finite(result):
    """Whether all numbers of a result are finite."""
    values = (*result.series.values(), *result.steps.values(), *result.profiles)
    return all(np.isfinite(array).all() for array in values)


def make_extract(case, place, quiet=True):
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
        if read_extract(place, case)[0] is None:
            # a longer run that was cut short is finished as such
            end = max(case.time.end, begun_end(work))
            longest = cached_case(case.replace(**{"time.end": end}))
            run_without_result(longest, work, keep, quiet)
        shutil.rmtree(work, ignore_errors=True)


def begun_end(work):
    """End of the run that was begun in a folder [s]; 0 if there is none."""
    begun = [stored_case(work / name) for name in (CHECKPOINT, RESULT)]
    return max((case.time.end for case in begun if case is not None), default=0.0)
