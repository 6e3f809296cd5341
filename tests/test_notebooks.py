"""The notebooks: stored without outputs, small, and every cell of them runs."""

import ast
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from readme_blocks import ROOT, checkout

nbformat = pytest.importorskip("nbformat")

FOLDER = ROOT / "runs" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
STORED_MAX = 20_000  # bytes
PICTURE = ROOT / "plots" / "figures" / "collapse_22deg_w10cm.png"
ALIKE = 6.0  # mean difference of pixels of 256 between two versions of matplotlib


def cells_of(path, kind):
    """The texts of the cells of a kind."""
    notebook = nbformat.read(path, as_version=4)
    return [cell for cell in notebook.cells if cell.cell_type == kind]


def test_there_are_notebooks_and_the_readme_lists_them():
    text = (FOLDER / "README.md").read_text(encoding="utf-8")
    assert len(NOTEBOOKS) == 5
    assert all(f"]({path.name})" in text for path in NOTEBOOKS)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_stored_small_and_without_outputs(path):
    nbformat.validate(nbformat.read(path, as_version=4))
    assert path.stat().st_size < STORED_MAX
    code = cells_of(path, "code")
    assert code
    assert all(not cell.outputs and cell.execution_count is None for cell in code)
    for cell in code:
        ast.parse(cell.source)
    assert cells_of(path, "markdown")[0].source.startswith("# ")


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path, tmp_path):
    nbclient = pytest.importorskip("nbclient")
    folder = tmp_path / "checkout"
    environment = checkout(folder)
    notebook = nbformat.read(path, as_version=4)
    where = folder / "runs" / "notebooks"
    options = {"timeout": 1200, "resources": {"metadata": {"path": str(where)}}}
    nbclient.NotebookClient(notebook, **options).execute(env=environment)
    shown = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    assert not [output for output in shown if output.output_type == "error"]
    assert [output for output in shown if "image/png" in output.get("data", {})]
    if path.stem == "first_run":
        made = folder / "out" / "notebooks" / PICTURE.name
        assert mean_difference(made, PICTURE) < ALIKE


def mean_difference(first: Path, second: Path) -> float:
    """Mean difference of the grey levels of two pictures, the second brought to the size of the first."""
    with Image.open(first) as one, Image.open(second) as other:
        grey = one.convert("L")
        pixels = [
            np.asarray(picture, float) for picture in (grey, other.convert("L").resize(grey.size))
        ]
    return float(np.abs(pixels[0] - pixels[1]).mean())
