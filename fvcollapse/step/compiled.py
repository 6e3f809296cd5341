"""The decorators of the kernels: exact arithmetic, compiled once and then read from the disk.

Beside a function itself Numba compiles two entries to it, one for Python and one for C, which take
longer than the function where arguments are tuples of many arrays. None of ours is called from C;
most are called by other kernels only.

Where nothing can be kept on the disk (no folder may be written, the disk is full), kernels are compiled
anew at each start; `files.kernel_cache.not_kept` says so.
"""

from functools import partial

from numba import config, njit

from fvcollapse.files.kernel_cache import keep_on_disk


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
