"""Progress bars on stderr, on terminals and in notebooks; none elsewhere.

Their lock is for the threads of one process only: bars of different processes never share a line here.
The default lock of tqdm is a semaphore of the system. It starts a further process to watch it, which
complains when the process of the bar is killed.
"""

import shutil
import sys
import threading
from typing import TYPE_CHECKING

from tqdm import tqdm

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


tqdm.set_lock(threading.RLock())


def is_shown(quiet: bool) -> bool:
    """Whether a bar is shown: asked for, and on a terminal or in a notebook."""
    return not quiet and (sys.stderr.isatty() or in_notebook())


def in_notebook() -> bool:
    """Whether this process computes for a notebook."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return hasattr(shell, "kernel")


def progress_bar(case: "Case", start: float, quiet: bool) -> tqdm:
    """Bar over the simulated time with step, dt and ETA, on stderr."""
    layout = "{percentage:3.0f}% |{bar}| t = {n:.3f}/{total:.3f} s [{elapsed}<{remaining}{postfix}]"
    terminal = shutil.get_terminal_size()  # never zero, which tqdm would take for no room at all
    return tqdm(
        total=max(case.time.end, start),
        initial=start,
        file=sys.stderr,
        bar_format=layout,
        ncols=terminal.columns,
        nrows=terminal.lines,
        leave=None,  # below a bar over several runs it goes when it is full
        disable=not is_shown(quiet),
    )


def runs_bar(total: int, quiet: bool) -> tqdm:
    """Bar over the runs, with ETA, on stderr."""
    terminal = shutil.get_terminal_size()
    return tqdm(
        total=total,
        unit="run",
        file=sys.stderr,
        disable=not is_shown(quiet),
        ncols=terminal.columns,
        nrows=terminal.lines,
    )
