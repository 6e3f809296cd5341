"""The hidden truth: a run of the solver, with forces that no case can name, and what is seen of it."""

import math
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fvcollapse.blind.outside import brake, read_wrongly
from fvcollapse.blind.plain_values import Force, Run
from fvcollapse.case.case import case_from_text
from fvcollapse.console.bars import progress_bar
from fvcollapse.files.atomic import write_atomic
from fvcollapse.measure.align import as_grid
from fvcollapse.measure.observables import observe
from fvcollapse.output.extract import FinishedRun, extract_image, open_image
from fvcollapse.output.result import open_result
from fvcollapse.output.run import Job
from fvcollapse.simulation import Simulation
from fvcollapse.step.advance import STAGES, Stages
from fvcollapse.step.flow import Flow

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.measure.observables import Observations
    from fvcollapse.output.result import Result

SEEDS = 2**31  # of the scatter of jumping grains


class View(NamedTuple):
    """What is seen of a collapse, without noise; SI units, t = 0 when the gate starts.

    `front` (n, 2) and `volume` (n, 2) are time and value; `thickness` and `static_height` (m, nx)
    are over `time` (m,) and `x` (nx,).
    """

    front: np.ndarray
    volume: np.ndarray
    time: np.ndarray
    x: np.ndarray
    thickness: np.ndarray
    static_height: np.ndarray

    @classmethod
    def of(cls, seen: "Observations") -> "View":
        """Of the `Observations` of a run."""
        time, x, thickness = as_grid(seen.profiles)
        return cls(seen.front, seen.volume, time, x, thickness, as_grid(seen.interface)[2])


def with_forces(forces: Sequence[Force]) -> Stages:
    """The stages of a step in which further forces act on the grains, between advection and the implicit solve."""

    def carry_momentum(flow: Flow, packing: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray]:
        u_star, w_star = STAGES.carry_momentum(flow, packing, dt)
        balance = flow.constants.balance
        slope = math.degrees(math.atan2(balance.gx, -balance.gz))
        brake(forces, u_star, w_star, dt, flow.constants.dx, slope)
        return u_star, w_star

    return STAGES._replace(carry_momentum=carry_momentum)


def run_truth(case: "Case", forces: Sequence[Force]) -> "Result":
    """The `Result` of a case with forces, without fields.

    Raises
    ------
    NumericalError
    """
    stages = with_forces(forces) if forces else STAGES
    job = Job(case, simulate=partial(Simulation, stages=stages))
    with progress_bar(case, 0.0, quiet=True) as bar:
        job.march(bar)
    return open_image(extract_image(FinishedRun.of(job.recorder, case)))


def keep_truth(case_text: str, forces: Sequence[Force], path: Path) -> None:
    """Run a truth into a file, unless it is there.

    Raises
    ------
    NumericalError, OutputError
    """
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomic(path, extract_image(run_truth(case_from_text(case_text), forces)))


def view_of(path: Path, case: "Case", label: Run) -> View:
    """What is seen of the truth in a file.

    Parameters
    ----------
    path : Path
    case : Case
        Of the truth; jumping grains jump as they like: not as they do in a diagnosis, nor alike in two runs.
    label : dict
        Of the experiment: its wrong `readings` (see `outside`), and the seed of its `noise`.
    """
    if case.effects.front_saltation is not None:
        case = case.replace(**{"effects.front_saltation.seed": label["noise"] % SEEDS})
    seen = observe(open_result(path), front_thickness=case.front.thickness, case=case)
    return read_wrongly(label["readings"], case.front.thickness, View.of(seen))
