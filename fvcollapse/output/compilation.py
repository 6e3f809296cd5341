"""Whether the kernels are compiled already: the first start on a machine says that it waits for the compiler."""

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logging import Logger


NOTICE = "compiling the kernels: once on this machine, about a minute and a half"
TOLD: list[bool] = []  # whether this process has said so


def is_compiled() -> bool:
    """Whether the kernel of the steps is on the disk, for these sources; True where none is kept."""
    from fvcollapse.march import march  # loads the compiler

    files = getattr(march._cache, "_cache_file", None)
    return files is None or bool(march.overloads) or bool(files._load_index())


def tell_compilation(quiet: bool, log: "Logger | None" = None) -> None:
    """Say that the kernels will be compiled; nothing if they are.

    Parameters
    ----------
    quiet : bool
        Not on stderr, where it is said once in a process, whether a terminal or a file.
    log : Logger, optional
        The log of a run, which says it too.
    """
    said = quiet or bool(TOLD)
    if (said and log is None) or is_compiled():
        return
    if log is not None:
        log.info("%s", NOTICE)
    if not said:
        TOLD.append(True)
        print(NOTICE, file=sys.stderr, flush=True)
