"""Compiled kernels are read from the disk without the compiler, which comes when one is missing."""

import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import fvcollapse
from fvcollapse.step import arrays, stencils

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


HITS = """
from fvcollapse.step.geometry import wetted_edge
wetted_edge(-1.0, 1.0)
print(sum(wetted_edge.stats.cache_hits.values()))
"""


def run(folder, program=PROGRAM, source=None):
    environment = os.environ | {"NUMBA_CACHE_DIR": str(folder)}
    if source is not None:
        environment["PYTHONPATH"] = str(source)
    done = subprocess.run(
        [sys.executable, "-c", program],
        env=environment,
        cwd=source,
        capture_output=True,
        text=True,
        check=True,
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


def test_a_kernel_is_made_again_when_another_file_of_the_step_changes(tmp_path):
    """It may contain kernels of that file."""
    package = Path(fvcollapse.__file__).parent
    shutil.copytree(package, tmp_path / package.name)
    runs = [run(tmp_path / "kernels", HITS, tmp_path) for _ in range(2)]
    with (tmp_path / package.name / "step" / "stencils.py").open("a") as file:
        file.write("# changed\n")
    runs.append(run(tmp_path / "kernels", HITS, tmp_path))
    assert runs == [["0"], ["1"], ["0"]]


def test_kernels_of_a_class_that_is_gone_are_made_again(tmp_path):
    """An index on the disk names the classes of the arguments."""
    package = Path(fvcollapse.__file__).parent
    shutil.copytree(package, tmp_path / package.name)
    program = (
        "from fvcollapse.step.geometry import allocate_geometry, last_face\n"
        "print(last_face(allocate_geometry(3, 2)), sum(last_face.stats.cache_hits.values()))"
    )
    runs = [run(tmp_path / "kernels", program, tmp_path) for _ in range(2)]
    file = tmp_path / package.name / "step" / "geometry.py"
    text = file.read_text(encoding="utf-8")
    text = text.replace("class Geometry(", "class Grains(").replace(
        "return Geometry(", "return Grains("
    )
    file.write_text(text, encoding="utf-8")
    runs.append(run(tmp_path / "kernels", program, tmp_path))
    assert runs == [["4 0"], ["4 1"], ["4 0"]]


@pytest.mark.parametrize("values", [[math.nan, 1.0], [1.0, math.nan], [math.nan, math.nan]])
def test_the_larger_of_a_number_and_nan_is_nan(values):
    assert math.isnan(arrays.largest(np.array([values])))
