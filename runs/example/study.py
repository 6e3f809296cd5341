"""The diagnosis of the README: three synthetic collapses, of which two are fitted and one is held out.

    python -m runs.example.study diagnose

`report.json` is its report without the curves and the table of runs, which are large and remade with it. The hidden
cause stands in the experiments (`[truth]`), where no diagnosis reads it.
"""

import sys
from functools import partial
from pathlib import Path

from msgspec.structs import replace

from fvcollapse import diagnose
from fvcollapse.diagnosis.report import write_report
from runs.study import Study
from runs.study import main as call

EXPERIMENTS = Path("runs") / "experiments"  # from the root: the report names them
FITTED = ("example_16deg_w10cm", "example_22deg_w10cm")
HELD_OUT = ("example_22deg_w20cm",)


def answer(arguments):
    """Diagnose the examples, and keep the report without what is large."""
    report = diagnose(
        [EXPERIMENTS / name for name in FITTED],
        hold_out=[EXPERIMENTS / name for name in HELD_OUT],
        workers=arguments.workers,
        folder=arguments.out / "diagnosis",
        cache=arguments.cache,
        quiet=False,
    )
    details = replace(report.details, comparisons=[], runs=[])
    write_report(replace(report, details=details), arguments.tables)


STUDY = Study("example", __doc__, {"diagnose": answer}, uses=("cache",), all_parts=True)
main = partial(call, STUDY)


if __name__ == "__main__":
    sys.exit(main())
