"""The decorators of the kernels: exact arithmetic, compiled once and then read from the disk.

Beside a function itself Numba compiles two entries to it, one for Python and one for C, which take
longer than the function where arguments are tuples of many arrays. None of ours is called from C;
most are called by other kernels only.

Where nothing can be kept on the disk (no folder may be written, the disk is full), kernels are compiled
anew at each start; `not_kept` says so.
"""

from functools import cache, partial
from hashlib import sha256
from pathlib import Path

from numba import __version__ as numba_version
from numba import config, njit
from numba.core.caching import FunctionCache
from numba.core.runtime import rtsys

FILES_OF_KERNELS = ("step/*.py", "measure/pile.py", "measure/series_row.py", "march.py")


@cache
def source_digest():
    """Digest of all files with kernels: what is compiled into one may stand in any of them."""
    digest, package = sha256(), Path(__file__).parents[1]
    for path in sorted(file for pattern in FILES_OF_KERNELS for file in package.glob(pattern)):
        digest.update(path.read_bytes())
    return digest.hexdigest()


class KernelCache(FunctionCache):
    """Compiled kernels on the disk, made again when any file of the step has changed.

    Numba itself looks at the file of a kernel only, not at those of the kernels it calls. They are read
    without the tables of the compiler, which take half a second to import; a miss loads them.
    """

    def __init__(self, function, kind=""):
        super().__init__(function)
        self._kind = kind
        # the index of another version is not even read: it may name classes that are gone
        self._cache_file._version = f"{numba_version}+{source_digest()}"

    def _index_key(self, sig, codegen):
        """Numba's own key pickles the kernels in a closure, anew in each process; the digest covers their files."""
        return (sig, codegen.magic_tuple(), self._kind)

    def save_overload(self, sig, data):
        """Keep a kernel; one that the disk does not take is compiled again next time."""
        try:
            super().save_overload(sig, data)
        except OSError:
            NOT_KEPT.add(self._name)

    def load_overload(self, sig, target_context):
        """The kernel for these argument types, or None."""
        rtsys.initialize(target_context)  # what the kernels allocate memory with
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)


NOT_KEPT = set()  # names of kernels that the disk did not take


def not_kept():
    """Number of kernels that could not be kept on the disk."""
    return len(NOT_KEPT)


def keep_on_disk(kernel, function, kind=""):
    """Let a kernel be kept on the disk, as does `cache=True`, where a folder can be written.

    `kind` tells kernels apart that are made of one function.
    """
    try:
        kernel._cache = KernelCache(function, kind)
    except RuntimeError:  # Numba has no place for it
        NOT_KEPT.add(function.__name__)


def kernel_jit(**options):
    """Decorator of a kernel that Python may call."""

    def compiled(function):
        kernel = njit(no_cfunc_wrapper=True, **options)(function)
        if not config.DISABLE_JIT:
            keep_on_disk(kernel, function)
        return kernel

    return compiled


def inner_jit(**options):
    """Decorator of a kernel that only kernels call: it has no entry for Python, where a call is a TypeError."""

    def compiled(function):
        kernel = kernel_jit(no_cpython_wrapper=True, **options)(function)
        if not config.DISABLE_JIT:
            kernel.add_overload = partial(_keep, kernel.overloads)
            kernel._compile_for_args = partial(_refuse, function.__name__)
        return kernel

    return compiled


KEPT = ("error_model", "inline")  # options that a kernel shares with its entry for Python


def from_python(kernel):
    """The same function with an entry for Python, compiled when it is first called."""
    options = {name: kernel.targetoptions[name] for name in KEPT if name in kernel.targetoptions}
    entry = njit(no_cfunc_wrapper=True, **options)(kernel.py_func)
    if not config.DISABLE_JIT:
        keep_on_disk(entry, kernel.py_func, "from Python")
    return entry


def is_kernel(function):
    """Whether a function is compiled."""
    return hasattr(function, "py_func")


def _keep(overloads, made):
    """Keep what was compiled; offered to Python as well, as Numba does, a call would end the process."""
    overloads[tuple(made.signature.args)] = made


def _refuse(name, *arguments, **keywords):
    raise TypeError(f"{name} is called by kernels only; from Python use its py_func")
