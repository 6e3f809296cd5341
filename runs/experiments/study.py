"""Experiment folders that are shipped: published measurements, and synthetic examples.

    python -m runs.experiments.study convert --data FOLDER
    python -m runs.experiments.study examples

See `convert.py` and `make_examples.py`. `--tables` takes the folders elsewhere.
"""

import sys
from functools import partial

from runs.experiments.convert import convert
from runs.experiments.make_examples import examples
from runs.study import Study
from runs.study import main as call

STUDY = Study(
    "experiments", __doc__, {"convert": convert, "examples": examples}, need_data=("convert",)
)
main = partial(call, STUDY)


if __name__ == "__main__":
    sys.exit(main())
