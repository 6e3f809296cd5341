"""One time step: one file per term of the balance; see `fvcollapse.simulation` for their order."""

import atexit
import shutil
import tempfile

import numba
from numba.core.caching import FunctionCache


def _ensure_cache_folder():
    """Give Numba a folder of this process, where neither the package nor the home is writable."""
    try:
        FunctionCache(_ensure_cache_folder)
    except RuntimeError:  # "no locator available"
        numba.config.CACHE_DIR = tempfile.mkdtemp(prefix="fvcollapse-")
        atexit.register(shutil.rmtree, numba.config.CACHE_DIR, ignore_errors=True)


_ensure_cache_folder()
