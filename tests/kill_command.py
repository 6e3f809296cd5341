"""The command line as the tests kill it: frequent checkpoints, and a line for every run that begins or ends.

Workers that are spawned import this file too, and are changed in the same way.
"""

import os
import sys

from fvcollapse.__main__ import main
from fvcollapse.output import keeper
from fvcollapse.output import run as output
from fvcollapse.output.trust import COMPLETE
from fvcollapse.studies.cache import cache_key

Keeper, log_start = output.Keeper, output.log_start


def note(word, case):
    """Append a line to the file that tells what was run; one system call, so that lines stay whole."""
    handle = os.open(os.environ["RUNS_LOG"], os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o600)
    os.write(handle, f"{word} {cache_key(case)} {case.time.end:g}\n".encode())
    os.close(handle)


class OftenKept(Keeper):
    """A keeper that writes a checkpoint every tenth of a second."""

    def __init__(self, job, folder, log, interval):
        super().__init__(job, folder, log, 0.1)

    def save(self, status):
        super().save(status)
        if status == COMPLETE:
            note("end", self.job.case)


def noted_start(log, case, stored):
    note("begin" if stored is None else "resume", case)
    log_start(log, case, stored)


output.Keeper, output.log_start, keeper.SAVING_SHARE = OftenKept, noted_start, 1.0


def shorten_diagnosis():
    """A few short runs are enough to be killed."""
    from fvcollapse.diagnosis import baseline
    from fvcollapse.diagnosis.diagnose import diagnose

    baseline.END_STEP = 0.12
    diagnose.__kwdefaults__["draws"] = 4


if __name__ == "__main__":
    if sys.argv[1] == "diagnose":
        shorten_diagnosis()
    sys.exit(main())
