"""Run a case in a folder: result, checkpoint, log, interruption and resumption.

A checkpoint is always written before the result that goes with it, so that a complete result has a
checkpoint of its end. Both are replaced atomically about every 20 s of wall time, when a run is
interrupted or fails, and at the end.
"""

import io
from collections.abc import Callable
from functools import partial
from logging import Logger
from pathlib import Path
from typing import TYPE_CHECKING, Any

from threadpoolctl import threadpool_limits

from fvcollapse.case.case import Case, case_from_text
from fvcollapse.console.bars import progress_bar
from fvcollapse.console.interruption import deferred_interrupt
from fvcollapse.errors import (
    InputError,
    failures_named,
)
from fvcollapse.files.hdf5 import build_image
from fvcollapse.files.kernel_cache import not_kept
from fvcollapse.files.targets import make_folder
from fvcollapse.output.checkpoint import checkpoint_image, write_header
from fvcollapse.output.compilation import prepare_kernels
from fvcollapse.output.keeper import Keeper
from fvcollapse.output.meshes import write_meshes
from fvcollapse.output.recorder import SAME_TIME, Recorder, schedule
from fvcollapse.output.rest import reached_end, stops
from fvcollapse.output.result import FORMAT, Result, open_result, write_status
from fvcollapse.output.run_folder import (
    CHECKPOINT,
    finished_result,
    holds_run,
    ready,
    refuse_existing,
    renew_xdmf,
    tidy,
    usable_checkpoint,
)
from fvcollapse.output.run_log import log_start, run_log, tell_once
from fvcollapse.output.stepping import Pace, steps_towards, trust_of_record
from fvcollapse.output.trust import COMPLETE, RUNNING
from fvcollapse.simulation import Simulation

if TYPE_CHECKING:
    from fvcollapse.output.checkpoint import Checkpoint
    from fvcollapse.output.recorder import Landing


UNCACHED = (
    "compiled kernels cannot be kept on the disk, so that every start takes a minute and a half: "
    "set NUMBA_CACHE_DIR to a folder that may be written"
)
CHECKPOINT_INTERVAL = 20.0  # s of wall time


def run(case: Case, folder: str | Path | None = None, quiet: bool = True) -> Result:
    """Run a case: into a folder, as the command line does, or in memory if no folder is given.

    A folder that holds a run of the same case is continued.

    Parameters
    ----------
    case : Case
    folder : str or Path, optional
    quiet : bool
        No progress bar. With False there is one in a notebook and on a terminal.

    Returns
    -------
    Result

    Raises
    ------
    InputError
        The folder holds a run of another case.
    OutputError
        It cannot be written.
    NumericalError
        The run failed; in a folder what was computed is kept.
    """
    if folder is not None:
        return run_case(case, folder, holds_run(case, Path(folder)), quiet=quiet)
    prepare_kernels(case, quiet)
    with failures_named(), progress_bar(case, 0.0, quiet) as bar:
        job = Job(case)
        job.march(bar)
    return Result(io.BytesIO(job.result_image(COMPLETE)))


def run_case(
    case: Case,
    folder: str | Path,
    resume: bool = False,
    quiet: bool = False,
    checkpoint_interval: float | None = None,
    force: bool = False,
    simulate: Callable | None = None,
) -> Result:
    """Run a case into `folder`, or continue what is there.

    Parameters
    ----------
    case : Case
    folder : str or Path
        Made if need be.
    resume : bool
        Continue from the checkpoint there, if it is usable; do nothing when the run has reached its
        end.
    quiet : bool
        No progress bar (there is none either when stderr is not a terminal).
    checkpoint_interval : float, optional
        Wall time between checkpoints [s]; default `CHECKPOINT_INTERVAL`.
    force : bool
        Continue a run of the same case, and replace one of another.
    simulate : callable, optional
        Makes the simulation of (case, state), if not `Simulation` itself.

    Raises
    ------
    InputError
        The folder holds a result (without `resume`), or one of another case (with it), or one that
        cannot be read now.
    OutputError
        The folder is not writable, or the disk is full; the previous files are intact.
    NumericalError, KeyboardInterrupt
        After the last good state was saved. Running out of memory is a NumericalError, too.
    """
    folder = Path(folder)
    if not (resume or force):
        refuse_existing(folder)
    make_folder(folder)
    with run_log(folder) as log:
        tidy(folder)
        resume = ready(case, folder, resume, force)
        stored = usable_checkpoint(folder, log) if resume else None
        previous = finished_result(case, folder, stored, log) if resume else None
        if previous is not None:
            log.info(
                "nothing to do: the result is complete to t = %g s", previous.series["time"][-1]
            )
            renew_xdmf(folder)
            return previous
        if stored is not None and stored.state.time > case.time.end + SAME_TIME:
            reached = f">= {stored.state.time:g}, the time already reached"
            raise InputError(folder / CHECKPOINT, "time.end", f"{case.time.end:g}", reached)
        prepare_kernels(case, quiet, log)
        make = partial(Job, simulate=simulate)
        keeper = begun(case, folder, log, stored, make, checkpoint_interval)
        keeper.save(RUNNING)
        march_on(keeper, quiet)
        result = open_result(folder)
        log.info("done\n%s", result.summary_table())
    return result


def begun(
    case: Case,
    folder: Path,
    log: Logger,
    stored: "Checkpoint | None",
    make: Callable,
    interval: float | None = None,
) -> Keeper:
    """The `Keeper` of a run that starts at t = 0, or where a `Checkpoint` was `stored`; `make` makes its `Job`."""
    log_start(log, case, stored)
    if not_kept():
        tell_once(log, UNCACHED)
    with failures_named():
        job = make(case, stored)
    return Keeper(job, folder, log, CHECKPOINT_INTERVAL if interval is None else interval)


def march_on(keeper: Keeper, quiet: bool) -> None:
    """March to the end with a progress bar; a signal is heeded after a step."""
    job = keeper.job
    with progress_bar(job.case, job.state.time, quiet) as bar, deferred_interrupt() as interrupted:
        keeper.march(bar, interrupted)


class Job:
    """A simulation with its recorder: the two always belong to the same instant after `step`.

    `simulate` makes the simulation of (case, state), if not `Simulation` itself; without `fields` none are recorded.
    """

    def __init__(
        self,
        case: Case,
        stored: "Checkpoint | None" = None,
        simulate: Callable | None = None,
        fields: bool = True,
    ) -> None:
        simulate = simulate or Simulation
        self.case, self.landings = case, schedule(case)
        if not fields:
            self.landings = [landing._replace(field=False) for landing in self.landings]
        if stored is None:
            self.simulation, self.recorder = simulate(case), Recorder()
            self.recorder.add_start(self.simulation, self.landings[0])
        else:
            self.simulation, self.recorder = simulate(case, stored.state.copy()), stored.recorder
            before = reached_end(case_from_text(stored.case_text), self.recorder.series)
            if not self.stops_here():
                self.recorder.drop_end(self.landings, before)
            self.simulation.watch_energy(self.recorder.series)
        self.state = self.simulation.state.copy()  # the last good state
        self.pace = Pace()

    def march(self, bar: Any, after_steps: Callable[[list], object] = lambda records: None) -> None:
        """Step from the present time to the end of the case, landing on every scheduled time; see `rest`."""
        with threadpool_limits(1):  # the band is too narrow for threads; runs share the cores
            for landing in self.landings:
                while self.state.time < landing.time - SAME_TIME:
                    records = self.steps(landing)
                    bar.set_postfix_str(
                        f"step {self.state.step}, dt {self.state.dt:.1e} s", refresh=False
                    )
                    bar.update(self.state.time - bar.n)
                    after_steps(records)
                if self.stops_here():
                    return

    def stops_here(self) -> bool:
        """Whether the record ends at a landing at which the run stops before its end, since the pile rests."""
        series = self.recorder.series
        if not stops(self.case, series):
            return False
        return any(abs(landing.time - series["time"][-1]) < SAME_TIME for landing in self.landings)

    def steps(self, landing: "Landing") -> list:
        """Some steps towards a landing, recorded; return their `StepRecord`s.

        Raises
        ------
        NumericalError
            A step has failed; the good ones before it are recorded.
        """
        marched = steps_towards(
            self.simulation, self.recorder, landing, self.pace, self.landings[-1]
        )
        self.state = marched.state.copy()
        if marched.problem is not None:
            raise marched.problem
        return marched.records

    def consistent(self) -> bool:
        """Whether record and last good state belong together (not in the midst of a step)."""
        return self.recorder.series["time"][-1] == self.state.time

    def checkpoint_image(self) -> bytes:
        """checkpoint.h5 as bytes."""
        return checkpoint_image(self.case, self.state, self.recorder)

    def result_image(self, status: str) -> bytes:
        """result.h5 as bytes; `status` says how far the run is (see `Result`)."""

        def fill(file):
            write_header(file, FORMAT, self.case)
            write_status(file, status, trust_of_record(self.recorder, status, self.case))
            self.recorder.write(file)
            write_meshes(file)

        return build_image(fill)
