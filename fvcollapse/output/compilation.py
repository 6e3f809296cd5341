"""Whether the kernels are compiled already: the first start on a machine says that it waits for the compiler.

Two processes compile them together, where there are two cores: those of a pool, or this one and another that it starts.
"""

import atexit
import multiprocessing
import os
import subprocess
import sys
import threading
from contextlib import suppress
from typing import TYPE_CHECKING

from fvcollapse.effects.catalogue import effects_on

if TYPE_CHECKING:
    from logging import Logger

    from fvcollapse.case.case import Case


NOTICE = "compiling the kernels: once on this machine, about a minute"
TOLD: list[bool] = []  # whether this process has said so
PREPARED: set[tuple[str, ...]] = set()  # effects whose kernels are compiled, or being compiled
# Which half a process compiles first, `FIRST` or `SECOND`, where others compile beside it; unset in a process alone
HALF, FIRST, SECOND = "FVCOLLAPSE_COMPILED_HALF", "first", "second"


def is_compiled() -> bool:
    """Whether the kernel of the steps is on the disk, for these sources; True where none is kept."""
    from fvcollapse.files.kernel_cache import kept_types  # these load the compiler
    from fvcollapse.march import march

    try:
        kept = kept_types(march)
    except OSError:  # another process has compiled it, and writes it down
        return True
    return kept is None or bool(kept) or bool(march.overloads)


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
        with suppress(Exception):  # the run needs none of it, and names what is wrong with the case
            share_compilation(case)


def share_compilation(case: "Case") -> None:
    """Let two processes compile the kernels of a case that are not on the disk; see `second_half`."""
    from fvcollapse.output.second_half import compile_second_half, is_kept, simulation_types

    flow, watch = simulation_types(case)
    if is_kept(flow):
        return
    half = os.environ.get(HALF)
    if half == SECOND:
        compile_second_half(flow, watch)
    elif half is None and multiprocessing.parent_process() is None and cores() > 1:
        start_second_half(case)


def cores() -> int:
    """Number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def start_second_half(case: "Case") -> None:
    """Start a process that compiles the second half; it ends with this one, and may fail without harm.

    It has the path of this process, and imports nothing from the folder that it stands in. It ends when its standard
    input does, which this process holds open.
    """
    if not sys.executable or getattr(sys, "frozen", False):  # what would start is another program
        return
    path = os.pathsep.join(os.path.abspath(folder) for folder in sys.path)
    environment = os.environ | {HALF: SECOND, "PYTHONPATH": path, "PYTHONSAFEPATH": "1"}
    command = [sys.executable, "-m", "fvcollapse.output.second_half", case.to_toml()]
    silent = subprocess.DEVNULL
    try:
        helper = subprocess.Popen(
            command, env=environment, stdin=subprocess.PIPE, stdout=silent, stderr=silent
        )
    except OSError:
        return
    atexit.register(end, helper)
    threading.Thread(
        target=helper.wait, daemon=True
    ).start()  # so that none is left when it has ended


def end(helper: "subprocess.Popen") -> None:
    """End the process that compiles the second half."""
    helper.kill()
    helper.wait()
