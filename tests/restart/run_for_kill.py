"""Run a case with a checkpoint after every step: python run_for_kill.py CASE FOLDER [fake]."""

import sys
import time
from pathlib import Path

from fvcollapse.case.case import load_case
from fvcollapse.output import keeper
from fvcollapse.output import run as output


def main(case, folder, kind="real"):
    if kind == "fake":
        sys.path.insert(0, str(Path(__file__).parents[1]))
        from fake_simulation import FakeSimulation

        class SlowSimulation(FakeSimulation):
            """Slow enough to be killed in the midst."""

            def advance(self, time_limit):
                time.sleep(0.005)
                return super().advance(time_limit)

        output.Simulation = SlowSimulation
    keeper.SAVING_SHARE = 1e9  # a checkpoint after every step, whatever it costs
    output.run_case(load_case(case), folder, resume=True, quiet=True, checkpoint_interval=0.0)


main(*sys.argv[1:])
