"""The XDMF file beside a result: opens the grains in ParaView and meshio, each time with its own mesh.

XDMF 3, a temporal collection of meshes of quadrilaterals (`meshes`). Nothing is copied into it.
"""

from xml.etree import ElementTree as xml

import h5py

from fvcollapse.output.meshes import CELLS, GROUP, POINTS, SURFACE, VELOCITY

XDMF_TYPES = {"f": "Float", "i": "Int", "u": "UInt"}


def has_meshes(file: h5py.File) -> bool:
    """Whether a result holds meshes; those of earlier versions do not."""
    return all(CELLS in group for group in file[GROUP].values())


def xdmf_text(file: h5py.File, h5_name: str) -> bytes:
    """XDMF document for the meshes of an open result, stored as `h5_name` beside it."""
    root = xml.Element("Xdmf", Version="3.0")
    series = xml.SubElement(
        xml.SubElement(root, "Domain"),
        "Grid",
        Name="fields",
        GridType="Collection",
        CollectionType="Temporal",
    )
    for index in sorted(file[GROUP], key=int):
        add_grid(series, float(file[f"fields/{index}"].attrs["time"]), file[GROUP][index], h5_name)
    xml.indent(root)
    return xml.tostring(root, encoding="utf-8", xml_declaration=True)


def add_grid(parent: xml.Element, time: float, mesh: h5py.Group, h5_name: str) -> None:
    """One time [s] of the collection: mesh, and values of its points and cells."""
    grid = xml.SubElement(parent, "Grid", Name="grains", GridType="Uniform")
    xml.SubElement(grid, "Time", Value=repr(time))
    count = str(len(mesh[CELLS]))
    topology = {"TopologyType": "Quadrilateral", "NumberOfElements": count}
    add_data(xml.SubElement(grid, "Topology", topology), mesh[CELLS], h5_name)
    add_data(xml.SubElement(grid, "Geometry", GeometryType="XYZ"), mesh[POINTS], h5_name)
    for name, dataset in mesh.items():
        if name in (CELLS, POINTS):
            continue
        centre = "Node" if name == SURFACE else "Cell"
        kind = "Vector" if name == VELOCITY else "Scalar"
        about = {"Name": name, "AttributeType": kind, "Center": centre}
        add_data(xml.SubElement(grid, "Attribute", about), dataset, h5_name)


def add_data(parent: xml.Element, dataset: h5py.Dataset, h5_name: str) -> None:
    """Reference to a dataset of the HDF5 file."""
    item = xml.SubElement(
        parent,
        "DataItem",
        Format="HDF",
        Dimensions=" ".join(map(str, dataset.shape)),
        NumberType=XDMF_TYPES[dataset.dtype.kind],
        Precision=str(dataset.dtype.itemsize),
    )
    item.text = f"{h5_name}:{dataset.name}"
