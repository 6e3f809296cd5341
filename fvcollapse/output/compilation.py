"""Whether the kernels are compiled already: the first start on a machine says that it waits for the compiler.

Two processes compile them together, where there are two cores: those of a pool, or this one and another that it starts.
"""

import atexit
import multiprocessing
import os
import subprocess
import sys
from typing import TYPE_CHECKING

from fvcollapse.effects.catalogue import effects_on

if TYPE_CHECKING:
    from logging import Logger

    from fvcollapse.case.case import Case


NOTICE = "compiling the kernels: once on this machine, about a minute"
TOLD: list[bool] = []  # whether this process has said so
PREPARED: set[tuple[str, ...]] = set()  # effects whose kernels are compiled, or being compiled
# Which half a process compiles first, "first" or "second", where others compile beside it; unset in a process alone
HALF = "FVCOLLAPSE_COMPILED_HALF"


def is_compiled() -> bool:
    """Whether the kernel of the steps is on the disk, for these sources; True where none is kept."""
    from fvcollapse.march import march  # loads the compiler

    return (
        not keeps_kernels() or bool(march.overloads) or bool(march._cache._cache_file._load_index())
    )


def keeps_kernels() -> bool:
    """Whether compiled kernels are kept on the disk."""
    from fvcollapse.march import march

    return hasattr(getattr(march, "_cache", None), "_cache_file")


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


def prepare_kernels(case: "Case", quiet: bool, log: "Logger | None" = None) -> None:
    """Before a run: say that kernels will be compiled, and let two processes compile them; nothing if they are.

    Parameters
    ----------
    case : Case
    quiet, log
        See `tell_compilation`.
    """
    tell_compilation(quiet, log)
    effects = tuple(effect.name for effect, _ in effects_on(case.resolved))
    if effects not in PREPARED:
        PREPARED.add(effects)
        share_compilation(case)


def share_compilation(case: "Case") -> None:
    """Let two processes compile the kernels of a case that are not on the disk; see `second_half`."""
    from fvcollapse.output.second_half import compile_second_half, is_kept, simulation_types

    if not keeps_kernels():
        return
    flow, watch = simulation_types(case)
    if is_kept(flow):
        return
    half = os.environ.get(HALF)
    if half == "second":
        compile_second_half(flow, watch)
    elif half is None and multiprocessing.parent_process() is None and (os.cpu_count() or 1) > 1:
        start_second_half(case)


def start_second_half(case: "Case") -> None:
    """Start a process that compiles the second half; it ends with this one, and may fail without harm."""
    command = [sys.executable, "-m", "fvcollapse.output.second_half"]
    silent = subprocess.DEVNULL
    try:
        helper = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=silent,
            stderr=silent,
            text=True,
            encoding="utf-8",
        )
        with helper.stdin as pipe:
            pipe.write(case.to_toml())
    except OSError:
        return
    atexit.register(helper.kill)
