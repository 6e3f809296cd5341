"""What all tests share: the same random examples in every run, one thread, and no window for a figure."""

import os

import hypothesis

os.environ.setdefault("MPLBACKEND", "Agg")
# one process for each core: more threads only wait for each other, and move the last digit
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("MKL_NUM_THREADS", "1")

# Derandomised: a test that fails on one machine fails on all. No deadline: compilation is slow.
hypothesis.settings.register_profile("fvcollapse", derandomize=True, deadline=None)
hypothesis.settings.load_profile("fvcollapse")
