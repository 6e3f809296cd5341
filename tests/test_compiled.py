"""Compiled kernels are read from the disk without the compiler, which comes when one is missing."""

import inspect
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest
from numba.core.caching import FunctionCache
from numba.core.runtime import rtsys

import fvcollapse
from fvcollapse.files.kernel_cache import KernelCache
from fvcollapse.step import arrays, geometry, stencils

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


def copied_package(folder):
    """A copy of the package, without its compiled kernels, that may be changed."""
    source = Path(fvcollapse.__file__).parent
    ignore = shutil.ignore_patterns("__pycache__")
    return Path(shutil.copytree(source, folder / source.name, ignore=ignore))


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
    package = copied_package(tmp_path)
    runs = [run(tmp_path / "kernels", HITS, tmp_path) for _ in range(2)]
    with (package / "step" / "stencils.py").open("a") as file:
        file.write("# changed\n")
    runs.append(run(tmp_path / "kernels", HITS, tmp_path))
    assert runs == [["0"], ["1"], ["0"]]


def test_kernels_of_a_class_that_is_gone_are_made_again(tmp_path):
    """An index on the disk names the classes of the arguments."""
    package = copied_package(tmp_path)
    program = (
        "from fvcollapse.step.geometry import allocate_geometry, last_face\n"
        "print(last_face(allocate_geometry(3, 2)), sum(last_face.stats.cache_hits.values()))"
    )
    runs = [run(tmp_path / "kernels", program, tmp_path) for _ in range(2)]
    file = package / "step" / "geometry.py"
    text = file.read_text(encoding="utf-8")
    text = text.replace("class Geometry(", "class Grains(").replace(
        "return Geometry(", "return Grains("
    )
    file.write_text(text, encoding="utf-8")
    runs.append(run(tmp_path / "kernels", program, tmp_path))
    assert runs == [["4 0"], ["4 1"], ["4 0"]]


# -- what `files/kernel_cache.py` and `step/compiled.py` take from the inside of Numba, which has no upper version --

METHODS = {  # of a cache, which ours calls or replaces
    "_index_key": ["self", "sig", "codegen"],
    "save_overload": ["self", "sig", "data"],
    "load_overload": ["self", "sig", "target_context"],
    "_load_overload": ["self", "sig", "target_context"],
    "_guard_against_spurious_io_errors": ["self"],
}


@pytest.mark.parametrize("name", METHODS)
def test_the_cache_of_numba_has_the_methods_that_ours_builds_on(name):
    assert list(inspect.signature(getattr(FunctionCache, name)).parameters) == METHODS[name]


def test_an_index_of_another_version_is_not_read(tmp_path, monkeypatch):
    """Numba compares the version that ours sets with that in the index before it reads the entries."""
    monkeypatch.setattr("numba.core.config.CACHE_DIR", str(tmp_path))

    def loaded(version):
        file = KernelCache(geometry.wetted_edge.py_func)._cache_file
        assert isinstance(file._version, str)
        file._version = version
        return file

    loaded("a").save("key", 3.0)
    assert loaded("a").load("key") == 3.0
    assert loaded("b").load("key") is None


def test_a_kernel_has_the_parts_that_are_replaced():
    """The entry of a call, the place of what is compiled, and the two wrappers that are left out."""
    kernel = numba.njit(no_cfunc_wrapper=True, no_cpython_wrapper=True)(lambda x: x + 1.0)
    assert callable(kernel._compile_for_args)
    assert list(inspect.signature(kernel.add_overload).parameters) == ["cres"]
    kept = {}
    kernel.add_overload = lambda made: kept.setdefault(tuple(made.signature.args), made)
    kernel.compile("(float64,)")
    ((arguments, made),) = kept.items()
    assert arguments == (numba.float64,)
    defined = made.library.get_defined_functions()
    names = [function.name for function in defined if not function.is_declaration]
    assert names
    assert not [name for name in names if "cpython" in name or name.startswith("cfunc")]
    assert callable(rtsys.initialize)
    assert kernel.targetoptions["no_cpython_wrapper"]
    assert isinstance(kernel.stats.cache_hits, dict)


@pytest.mark.parametrize("values", [[math.nan, 1.0], [1.0, math.nan], [math.nan, math.nan]])
def test_the_larger_of_a_number_and_nan_is_nan(values):
    assert math.isnan(arrays.largest(np.array([values])))
