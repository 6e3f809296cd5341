"""Set-ups that could be measured next, around an experiment that was measured."""

from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import msgspec
import numpy as np

from fvcollapse.measure.experiment import Experiment
from fvcollapse.measure.quantities import CURVES

if TYPE_CHECKING:
    from fvcollapse.case.case import Case

SLOPES = (-6.0, 6.0)  # deg, from the slope that was measured
SLOPE_RANGE = (0.0, 24.0)
WIDTHS = (0.5, 2.0)  # times the channel width that was measured
HEIGHT = 1.5  # times the height of the column


class Candidate(NamedTuple):
    """A set-up: {key: value} that differ from the experiment of reference, and observables measured.

    The keys have the same names in the case and in the experiment; `added` are the observables that are
    not measured in the experiment of reference.
    """

    reference: str
    changes: dict[str, float]
    observables: tuple[str, ...]
    added: tuple[str, ...] = ()


def candidates(reference: Experiment, base: "Case") -> list[Candidate]:
    """The `Candidate`s around an experiment.

    Parameters
    ----------
    reference : Experiment
    base : Case
        Its baseline.
    """
    measured = tuple(reference.curves) or ("front",)
    missing = tuple(name for name in CURVES if name not in measured)
    planned = []
    if missing:
        planned.append(Candidate(reference.name, {}, (*measured, *missing), missing))
    planned += [Candidate(reference.name, changes, measured) for changes in set_up_changes(base)]
    return planned


def set_up_changes(base: "Case") -> list[dict[str, float]]:
    """Changes of the set-up of a case, {key: value} each: slopes, widths, the gate, the height."""
    geometry = base.geometry
    changes = []
    for step in SLOPES:
        slope = float(np.clip(geometry.slope_angle_deg + step, *SLOPE_RANGE))
        if abs(slope - geometry.slope_angle_deg) > 0.5 * abs(step):
            changes.append({"geometry.slope_angle_deg": slope})
    if geometry.channel_width < inf:
        changes += [
            {"geometry.channel_width": factor * geometry.channel_width} for factor in WIDTHS
        ]
    if 0.0 < base.gate.speed < inf:
        changes.append({"gate.speed": inf, "gate.time_constant": 0.0})
    return [*changes, {"geometry.height_0": HEIGHT * geometry.height_0}]


def set_up(reference: Experiment, candidate: Candidate) -> Experiment:
    """The `Experiment` of a candidate, without any measurement yet."""
    settings = reference.settings
    for path, value in candidate.changes.items():
        section, _, name = path.partition(".")
        part = msgspec.structs.replace(getattr(settings, section), **{name: value})
        settings = msgspec.structs.replace(settings, **{section: part})
    return Experiment(Path("candidate"), settings, {}, ())
