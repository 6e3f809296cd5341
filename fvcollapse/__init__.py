"""Granular column collapse on a slope, in two dimensions; see README.md.

The names below are imported when they are first used, so that importing the package costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from fvcollapse.version import __version__

if TYPE_CHECKING:
    from fvcollapse.case.case import load_case as load_case
    from fvcollapse.diagnosis.diagnose import diagnose as diagnose
    from fvcollapse.measure.align import align as align
    from fvcollapse.measure.experiment import load_experiment as load_experiment
    from fvcollapse.measure.observables import observe as observe
    from fvcollapse.output.deposit import from_deposit as from_deposit
    from fvcollapse.output.result import open_result as open_result
    from fvcollapse.output.run import run as run
    from fvcollapse.studies.cache import RunCache as RunCache
    from fvcollapse.studies.converge import converge as converge
    from fvcollapse.studies.sweep import sweep as sweep

PUBLIC = {
    "load_case": "case.case",
    "run": "output.run",
    "open_result": "output.result",
    "from_deposit": "output.deposit",
    "observe": "measure.observables",
    "align": "measure.align",
    "load_experiment": "measure.experiment",
    "diagnose": "diagnosis.diagnose",
    "sweep": "studies.sweep",
    "converge": "studies.converge",
    "RunCache": "studies.cache",
}
__all__ = ["__version__", *PUBLIC]


def __getattr__(name: str) -> Any:
    if name in PUBLIC:
        return getattr(import_module(f"fvcollapse.{PUBLIC[name]}"), name)
    raise AttributeError(f"module 'fvcollapse' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
