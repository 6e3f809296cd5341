"""A content-addressed cache of runs: no run is computed twice.

The key of a run is a digest of the solver and of the resolved case without its outputs. Every key
has a folder. During the run it holds the checkpoint, from which the next caller continues;
afterwards it holds the extract only. Any number of processes may use a cache.
"""

import os
import shutil
from contextlib import suppress
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

from fvcollapse.case.grammar import as_table, toml_lines
from fvcollapse.errors import FvcollapseError, InputError, NumericalError, failures_named
from fvcollapse.files.storage import exclusive, write_atomic
from fvcollapse.output.extract import extract_image
from fvcollapse.output.fingerprint import solver_version
from fvcollapse.output.recorder import SAME_TIME
from fvcollapse.output.result import open_result
from fvcollapse.output.run import OUTPUT_KEYS
from fvcollapse.studies.members import run_member
from fvcollapse.studies.workers import run_all

FORMAT = 1  # of the extract; it is part of every key
EXTRACT, LOCK, WORK = "extract.h5", "lock", "run"
PROFILE_INTERVAL = 0.02  # s; the same for all runs, since output times influence the time steps
VARIABLE = "FVCOLLAPSE_CACHE"


def default_folder():
    """Folder of the cache of this user: $FVCOLLAPSE_CACHE, else in $XDG_CACHE_HOME or ~/.cache."""
    if named := os.environ.get(VARIABLE):
        return Path(named)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fvcollapse"


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
            result = read_extract(entry(Path(folder), key), case)
            if result is not None:
                return result
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
        found = {name: self.get(case) for name, case in cases.items()}
        missing = {name: case for name, case in cases.items() if found[name] is None}
        failures = self.compute(longest(missing.values()), workers, scheduler, quiet)
        failed = {name: failures.get(cache_key(case)) for name, case in missing.items()}
        found |= {name: self.get(cases[name]) for name, error in failed.items() if error is None}
        results = {name: result for name, result in found.items() if result is not None}
        return Runs(results, {name: error for name, error in failed.items() if error is not None})

    def compute(self, missing, workers, scheduler, quiet):
        """Compute {key: case}; return {key: NumericalError} of those that failed."""
        failures = {}

        def finished(key, outcome):
            if isinstance(outcome, NumericalError):
                failures[key] = outcome
            elif isinstance(outcome, FvcollapseError):
                raise outcome
            elif self.get(missing[key]) is None:
                found = "workers that do not see this folder"
                raise InputError(self.folder, "--scheduler", found, "a shared file system")

        calls = {key: (case, self.place(case), True) for key, case in missing.items()}
        run_all(make_extract, calls, finished, workers, scheduler, quiet)
        return failures


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
    """The extract in a place if it reaches the end of the case, else None."""
    try:
        result = open_result(place / EXTRACT)
    except InputError:  # missing, or broken: it is made again
        return None
    reached = result.complete and result.case.time.end >= case.time.end - SAME_TIME
    return result if reached else None


def make_extract(case, place, quiet=True):
    """Run or continue a case in its folder and write the extract, unless it exists.

    Another process that computes the same case is waited for.
    """
    work = place / WORK
    with failures_named(), exclusive(place / LOCK):
        if read_extract(place, case) is None:
            # a longer run that was cut short is finished as such
            end = max(case.time.end, begun_end(work))
            run_member(cached_case(case.replace(**{"time.end": end})), work, quiet)
            write_atomic(place / EXTRACT, extract_image(open_result(work)))
        shutil.rmtree(work, ignore_errors=True)


def begun_end(work):
    """End of the run that was begun in a folder [s]; 0 if there is none."""
    with suppress(InputError):
        return open_result(work).case.time.end
    return 0.0
