"""Granular column collapse on a slope, in two dimensions; see README.md.

The names below are imported when they are first used, so that importing the package costs nothing.
"""

from importlib import import_module

from fvcollapse.version import __version__

PUBLIC = {
    "load_case": "case.case",
    "run": "output.run",
    "open_result": "output.result",
    "observe": "measure.observables",
    "load_experiment": "measure.experiment",
    "diagnose": "diagnosis.diagnose",
}
__all__ = ["__version__", *PUBLIC]


def __getattr__(name):
    if name in PUBLIC:
        return getattr(import_module(f"fvcollapse.{PUBLIC[name]}"), name)
    raise AttributeError(f"module 'fvcollapse' has no attribute {name!r}")


def __dir__():
    return sorted([*globals(), *__all__])
