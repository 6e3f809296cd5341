"""What all tests share: the same random examples in every run, and no window for a figure."""

import os

import hypothesis

os.environ.setdefault("MPLBACKEND", "Agg")

# Derandomised: a test that fails on one machine fails on all. No deadline: compilation is slow.
hypothesis.settings.register_profile("fvcollapse", derandomize=True, deadline=None)
hypothesis.settings.load_profile("fvcollapse")
