"""Compiled kernels are read from the disk without the compiler, which comes when one is missing."""

import os
import subprocess
import sys

import pytest

from fvcollapse.step import stencils

PROGRAM = """
import sys
from fvcollapse.step.banded import new_system
from fvcollapse.step.geometry import wetted_edge

band, rhs = new_system(5, 2)
assert band.shape[0] == rhs.size and not band.any()
hits = sum(new_system.stats.cache_hits.values())
print(hits, "numba.np.linalg" in sys.modules)
if hits:
    assert wetted_edge(-1.0, 1.0) == 0.5
    print(sum(wetted_edge.stats.cache_hits.values()), "numba.np.linalg" in sys.modules)
"""


def run(folder):
    environment = os.environ | {"NUMBA_CACHE_DIR": str(folder)}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True, check=True
    )
    return done.stdout.splitlines()


def test_the_second_start_does_not_load_the_compiler(tmp_path):
    assert run(tmp_path) == ["0 True"]
    assert run(tmp_path) == ["1 False", "0 True"]


def test_a_kernel_without_an_entry_for_python_refuses_it():
    inner = vars(stencils)["minmod"]
    inner.compile("(float64, float64)")  # as another kernel does
    with pytest.raises(TypeError, match="minmod is called by kernels only"):
        inner(1.0, 2.0)
    assert inner.py_func(1.0, 2.0) == 1.0
