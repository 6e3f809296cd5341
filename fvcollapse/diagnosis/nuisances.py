"""Calibrated parameters and set-up: what is known within a standard deviation, and draws of it."""

import zlib
from collections.abc import Iterable, Mapping, Sequence
from math import inf
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.stats import norm

from fvcollapse.errors import CaseError, NumericalError

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.diagnosis.runner import Failures, Wanted
    from fvcollapse.measure.experiment import Experiment

# case key: key of [uncertainty]. The first are of the material, one truth for all experiments of it
CALIBRATED = {
    "rheology.mu_1": "mu_1",
    "rheology.mu_2": "mu_2",
    "rheology.I_0": "I_0",
    "boundary.mu_bed": "mu_bed",
    "boundary.mu_back_wall": "mu_back_wall",
}
SET_UP = {  # drawn for each experiment by itself; the clock is in the covariance of the measurement
    "geometry.slope_angle_deg": "slope_angle_deg",
    "geometry.height_0": "height_0",
    "geometry.length_0": "length_0",
    "gate.speed": "speed",
}
LAWS_WITH_I = ("mu_I", "mu_I_regularised")
SLOPE_MAX = 30.0  # deg
FOLDED = 3.0  # standard deviations below which a slope may have either sign, and its error is no common one


class Nuisance(NamedTuple):
    """A quantity that is known within a standard deviation.

    `experiments` are the names of those whose runs it enters, `design` tells their set-up; `mean` and
    `sd` are in the unit of the key, those of the first experiment. A common error of the set-up is one shift, in
    standard deviations, of several set-ups: `others` holds the (mean, sd) of every experiment then.
    """

    key: str
    experiments: tuple[str, ...]
    mean: float
    sd: float
    design: str = ""
    others: tuple[tuple[float, float], ...] = ()

    def value(self, z: float, experiment: str | None = None) -> float:
        """Value at z standard deviations in an experiment, default the first; positive quantities are lognormal."""
        mean, sd = self.mean, self.sd
        if self.others and experiment is not None:
            mean, sd = self.others[self.experiments.index(experiment)]
        if self.key == "geometry.slope_angle_deg":
            return min(abs(mean + z * sd), SLOPE_MAX)
        return mean * float(np.exp(z * sd / mean))

    def realised(self, z: float) -> float:
        """The z that the value stands for: a slope is never negative."""
        if self.key == "geometry.slope_angle_deg":
            return (self.value(z) - self.mean) / self.sd
        return z


def nuisances(
    experiments: "Sequence[Experiment]", cases: "Mapping[str, Case]"
) -> tuple[Nuisance, ...]:
    """All `Nuisance`s of the experiments: shared where it is the same material, or a common error of the set-up."""
    material, common, own = {}, {}, []  # type: ignore[var-annotated]
    for experiment in experiments:
        case = cases[experiment.name]
        for key, quantity in (CALIBRATED | SET_UP).items():
            mean = value_of(case, key)
            if mean is None:
                continue
            sd = experiment.standard_deviation(quantity, mean)
            if sd > 0.0 and key in CALIBRATED:
                material.setdefault((key, mean, sd), []).append(experiment.name)
            elif sd > 0.0 and experiment.has_common(quantity) and mean > FOLDED * sd:
                common.setdefault(key, {})[experiment.name] = (mean, sd)
            elif sd > 0.0:
                own.append(Nuisance(key, (experiment.name,), mean, sd, design_text(case)))
    grains = [Nuisance(key, tuple(names), *about) for (key, *about), names in material.items()]
    tank = [
        Nuisance(key, tuple(about), *next(iter(about.values())), "common", tuple(about.values()))  # type: ignore[call-arg]
        for key, about in common.items()
    ]
    return (*grains, *tank, *own)


def design_text(case: "Case") -> str:
    """The set-up in a few numbers."""
    geometry = case.geometry
    numbers = (geometry.slope_angle_deg, geometry.height_0, geometry.length_0)
    return " ".join(f"{number:g}" for number in (*numbers, geometry.channel_width, case.gate.speed))


def value_of(case: "Case", key: str) -> float | None:
    """Value of a key that can be drawn; None where it is infinite, zero (but a slope) or has no effect."""
    section, _, name = key.partition(".")
    value = getattr(getattr(case, section), name)
    if name in ("mu_2", "I_0") and case.rheology.law not in LAWS_WITH_I:
        return None
    return value if value < inf and (value > 0.0 or name == "slope_angle_deg") else None


def draw(quantities: Sequence[Nuisance], count: int, seed: int = 0) -> np.ndarray:
    """Standard normal draws (count, n), a Latin hypercube.

    A column depends on its quantity and not on its neighbours: an experiment has the same runs alone and
    in company. Two of the same design have different errors.
    """
    columns, seen = [], {}  # type: ignore[var-annotated]
    for quantity in quantities:
        label = f"{quantity.key} {quantity.design}"
        number = seen[label] = seen.get(label, 0) + 1
        generator = np.random.default_rng([seed, zlib.crc32(label.encode()), number])
        columns.append(norm.ppf((generator.permutation(count) + 0.5) / count))
    return np.column_stack(columns)


def with_nuisances(
    case: "Case", name: str, quantities: Sequence[Nuisance], z: Iterable[float]
) -> "Case":
    """The case of an experiment with quantities z (n,) standard deviations off.

    A column of another size keeps its number of cells, so that the response is smooth.
    """
    changes = {
        quantity.key: quantity.value(shift, name)
        for quantity, shift in zip(quantities, z, strict=True)
        if name in quantity.experiments
    }
    geometry, grid = case.geometry, case.grid
    if "rheology.mu_2" in changes or "rheology.mu_1" in changes:
        mu_1 = changes.get("rheology.mu_1", case.rheology.mu_1)
        changes["rheology.mu_2"] = max(changes.get("rheology.mu_2", case.rheology.mu_2), mu_1)
    length = changes.get("geometry.length_0", geometry.length_0) / geometry.length_0
    height = changes.get("geometry.height_0", geometry.height_0) / geometry.height_0
    if length != 1.0 or height != 1.0:
        changes["grid.cell_size"] = grid.cell_size * length
        changes["grid.cell_size_z"] = (grid.cell_size_z or grid.cell_size) * height
    return case.replace(**changes)


def ensemble_runs(
    experiments: "Sequence[Experiment]",
    cases: "Mapping[str, Case]",
    quantities: Sequence[Nuisance],
    z: np.ndarray,
) -> "tuple[Wanted, Failures]":
    """Runs of the draws z (m, n) of the quantities, and why the others cannot be.

    Returns
    -------
    (dict, dict)
        {label: (experiment, case)}, and {label: NumericalError} of draws that are no legal case.
    """
    wanted, refused = {}, {}
    for n, row in enumerate(z):
        for one in experiments:
            label = "draw", n, one.name
            try:
                wanted[label] = one, with_nuisances(cases[one.name], one.name, quantities, row)
            except CaseError as error:
                refused[label] = NumericalError(f"{error.key} cannot be {error.found}")
    return wanted, refused  # type: ignore[return-value]


def realised(quantities: Sequence[Nuisance], z: np.ndarray) -> np.ndarray:
    """The draws (m, n) that the values stand for; see `Nuisance.realised`."""
    return np.array(
        [[one.realised(shift) for one, shift in zip(quantities, row, strict=True)] for row in z]
    )
