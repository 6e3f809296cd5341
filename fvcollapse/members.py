"""One run among many: in a folder of its own, finished or continued, whoever began it."""

from pathlib import Path

from fvcollapse.errors import InputError
from fvcollapse.files import exclusive
from fvcollapse.output import CHECKPOINT, RESULT, run_case
from fvcollapse.recorder import SAME_TIME

LOCK = "lock"


def run_member(case, folder, quiet=True):
    """Run a case into its folder, or continue it; nothing is done if it is finished.

    Another process that works in the folder is waited for.

    Raises
    ------
    InputError
        The folder holds a run of another case, or one to a later end.
    """
    folder = Path(folder)
    with exclusive(folder / LOCK):
        started = (folder / RESULT).exists() or (folder / CHECKPOINT).exists()
        result = run_case(case, folder, resume=started, quiet=quiet)
    if result.case.time.end > case.time.end + SAME_TIME:
        found = f"{case.time.end:g}"
        allowed = f"{result.case.time.end:g}, the end of the result there, or another folder"
        raise InputError(folder / RESULT, "time.end", found, allowed)
