"""The progress bar of every command: `tqdm`, whose lock is for the threads of one process only.

Bars of different processes never share a line here. The lock that tqdm would make by default is a
semaphore of the system: it starts a further process that watches it, and that complains of it when the
process it belongs to is killed.
"""

import threading

from tqdm import tqdm

__all__ = ["tqdm"]

tqdm.set_lock(threading.RLock())
