"""XDMF files name what is in the result, and the mesh they lead to is that of the cells with grains."""

import xml.etree.ElementTree as xml

import h5py
import numpy as np
import pytest
from fake_simulation import FakeSimulation

from fvcollapse import open_result
from fvcollapse.case.case import Case
from fvcollapse.output import run as output
from fvcollapse.step.geometry import cell_fractions

FIELDS = ["level_set", "u", "w", "pressure", "shear_rate", "viscosity", "inertial_number"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A run by formula, which tests only read."""
    folder = tmp_path_factory.mktemp("made")
    case = Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.3})
    output.run_case(case, folder, quiet=True, simulate=FakeSimulation)
    return folder


def test_xdmf_matches_the_shapes_of_the_file(folder):
    root = xml.parse(folder / "result.xdmf").getroot()
    assert root.get("Version") == "3.0"
    grids = root.findall("./Domain/Grid/Grid")
    times = [float(grid.find("Time").get("Value")) for grid in grids]
    assert times == open_result(folder).field_times.tolist()
    with h5py.File(folder / "result.h5") as file:
        for grid in grids:
            assert grid.get("GridType") == "Uniform"
            assert grid.find("Topology").get("TopologyType") == "Quadrilateral"
            cells = int(grid.find("Topology").get("NumberOfElements"))
            points = dimensions(grid.find("Geometry/DataItem"))[0]
            assert dimensions(grid.find("Topology/DataItem")) == (cells, 4)
            for item in grid.iter("DataItem"):
                name, path = item.text.split(":")
                assert name == "result.h5"
                assert dimensions(item) == file[path].shape
                assert int(item.get("Precision")) == file[path].dtype.itemsize
                assert (item.get("NumberType") == "Float") == (file[path].dtype.kind == "f")
            for attribute in grid.findall("Attribute"):
                count = dimensions(attribute.find("DataItem"))[0]
                assert count == {"Node": points, "Cell": cells}[attribute.get("Center")]
            names = {attribute.get("Name") for attribute in grid.findall("Attribute")}
            assert names == {"velocity", *FIELDS} - {"u", "w"}


def dimensions(element):
    """The Dimensions of an XDMF element as a tuple."""
    return tuple(int(number) for number in element.get("Dimensions").split())


def test_the_mesh_is_the_cells_with_grains_and_its_values_are_those_of_the_fields(folder):
    field = open_result(folder).field(2)
    filled = cell_fractions(field["level_set"]) > 0.0
    assert 0.1 < filled.mean() < 0.9
    with h5py.File(folder / "result.h5") as file:
        mesh = {name: values[:] for name, values in file["paraview/2"].items()}
    corners = mesh["points"][mesh["cells"]]  # (cells, 4, 3)
    sizes = np.array([field["dx"], field["dz"]])
    i, k = np.round(corners[:, 0, :2] / sizes).astype(int).T
    seen = np.zeros_like(filled)
    seen[i, k] = True
    np.testing.assert_array_equal(seen, filled)
    assert len(i) == filled.sum()
    u, w = field["u"], field["w"]
    means = 0.5 * (u[:-1] + u[1:]), 0.5 * (w[:, :-1] + w[:, 1:])
    for component, mean in enumerate(means):
        np.testing.assert_allclose(mesh["velocity"][:, component], mean[i, k], rtol=1e-6)
    for name in ("pressure", "viscosity", "shear_rate", "inertial_number"):
        np.testing.assert_allclose(mesh[name], field[name][i, k], rtol=1e-6)
    x, z = corners[..., 0], corners[..., 1]
    area = 0.5 * (x * np.roll(z, -1, 1) - np.roll(x, -1, 1) * z).sum(axis=1)
    np.testing.assert_allclose(area, sizes.prod(), rtol=1e-5)  # counted round each cell
    nodes = np.round(mesh["points"][:, :2] / sizes).astype(int).T
    np.testing.assert_allclose(mesh["level_set"], field["level_set"][tuple(nodes)], rtol=1e-6)


def test_meshio_reads_the_grains_of_each_time(folder):
    meshio = pytest.importorskip("meshio")
    result = open_result(folder)
    with meshio.xdmf.TimeSeriesReader(folder / "result.xdmf") as reader:
        assert reader.num_steps == len(result.field_times)
        for index in range(reader.num_steps):
            reader.mesh_grid = reader.collection[index]  # each time has its own mesh
            points, cells = reader.read_points_cells()
            time, point_data, cell_data = reader.read_data(index)
            assert time == result.field_times[index]
            field = result.field(index)
            grains = cell_fractions(field["level_set"]) > 0.0
            assert len(cells[0].data) == grains.sum() == len(cell_data["velocity"][0])
            assert cell_data["pressure"][0].max() == pytest.approx(
                field["pressure"][grains].max(), rel=1e-6
            )
            assert len(points) == len(point_data["level_set"])
