"""What a run leaves in its folder while it goes on, when it is stopped, and at its end."""

import io
import time
from collections.abc import Callable
from logging import Logger
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py

from fvcollapse.console.interruption import Interrupted
from fvcollapse.errors import OutputError, as_output_error
from fvcollapse.files.atomic import write_atomic
from fvcollapse.output.run_folder import CHECKPOINT, RESULT, XDMF
from fvcollapse.output.stepping import ending
from fvcollapse.output.trust import COMPLETE, INTERRUPTED, RUNNING
from fvcollapse.output.xdmf import xdmf_text

if TYPE_CHECKING:
    from fvcollapse.output.run import Job
    from fvcollapse.step.advance import StepRecord


SAVING_SHARE = 0.05  # largest share of the wall time that is spent on saving
CAPPED_LOGGED = 20  # capped steps that are logged one by one


class Keeper:
    """Advances a job and saves its files at intervals, when it is stopped, and at the end.

    Attributes
    ----------
    keep : function or None
        Gets the finished job, of which no result is wanted; see `run_without_result`.
    """

    def __init__(self, job: "Job", folder: Path, log: Logger, interval: float) -> None:
        self.job, self.folder, self.log, self.interval = job, folder, log, interval
        self.saved_at, self.cost, self.capped, self.running = time.monotonic(), 0.0, 0, False
        self.keep: Callable | None = None

    def march(self, bar: Any, interrupted: Callable[[], int]) -> None:
        """Run the job to its end; the last good state is saved, whatever ends the run."""

        def after_steps(records):
            for record in records:
                self.note(record)
            if number := interrupted():
                raise Interrupted(number)
            if time.monotonic() - self.saved_at > max(self.interval, self.cost / SAVING_SHARE):
                self.save(RUNNING)

        self.running = True
        try:
            self.job.march(bar, after_steps)
        except OutputError:  # the log says so already
            raise
        except KeyboardInterrupt:
            self.log.error("stopped: interrupted")
            if self.job.consistent():
                self.save(INTERRUPTED)
            raise
        except Exception as error:
            failure, status = ending(error, self.job.state.time)
            self.log.error("stopped: %s", failure, exc_info=None if failure is error else error)
            self.save(status)
            raise failure from (None if failure is error else error)
        self.save(COMPLETE)

    def note(self, record: "StepRecord") -> None:
        """Log a capped step."""
        if not record.capped:
            return
        self.capped += 1
        if self.capped <= CAPPED_LOGGED:
            self.log.warning(
                "capped step at t = %.6f s: residual %.2e after %d sweeps",
                record.time,
                record.residual,
                record.sweeps,
            )
        if self.capped == CAPPED_LOGGED:
            self.log.warning("further capped steps are only counted")

    def save(self, status: str) -> None:
        """Checkpoint, result and XDMF file, in this order, each replaced atomically; see `keep`."""
        start, job = time.monotonic(), self.job
        try:
            if self.keep is not None and status == COMPLETE:
                self.keep(job)
                return
            write_atomic(self.folder / CHECKPOINT, job.checkpoint_image(), self.running)
            if self.keep is None or status not in (RUNNING, INTERRUPTED):
                self.save_result(status)
        except (OutputError, MemoryError) as problem:
            error = as_output_error(problem, self.folder, self.running)
            self.log.error("%s", error)
            raise error from None
        self.saved_at = time.monotonic()
        self.cost = self.saved_at - start
        self.log.info(
            "checkpoint at t = %.6f s, step %d, %d capped",
            job.state.time,
            job.state.step,
            self.capped,
        )

    def save_result(self, status: str) -> None:
        """Result and XDMF file."""
        image = self.job.result_image(status)
        with h5py.File(io.BytesIO(image), "r") as file:
            text = xdmf_text(file, RESULT)
        write_atomic(self.folder / RESULT, image, self.running)
        write_atomic(self.folder / XDMF, text, self.running)
