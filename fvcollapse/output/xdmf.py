"""The XDMF file beside a result: opens its fields in ParaView, each time with its own grid size.

The arrays are [i, k] with k fastest, so the grid is given by its node coordinates (a structured
mesh); an XDMF grid of origin and spacing would exchange x and z. Nothing is copied but these
coordinates and the cell-centred velocity. Each time is a collection of one grid: VTK's reader
takes the extent of a bare grid from the first time.
"""

from xml.etree import ElementTree as xml

XDMF_TYPES = {"f": "Float", "i": "Int", "u": "UInt"}


def xdmf_text(file, h5_name):
    """XDMF document (bytes) for the fields of an open file, stored as `h5_name` beside it."""
    root = xml.Element("Xdmf", Version="2.0")
    series = xml.SubElement(
        xml.SubElement(root, "Domain"),
        "Grid",
        Name="fields",
        GridType="Collection",
        CollectionType="Temporal",
    )
    for index in sorted(file["fields"], key=int):
        add_grid(series, file["fields"][index], file["paraview"][index], h5_name)
    xml.indent(root)
    return xml.tostring(root, encoding="utf-8", xml_declaration=True)


def add_grid(parent, fields, paraview, h5_name):
    """One time of the collection: coordinates, velocity, fields at nodes or centres."""
    step = xml.SubElement(
        parent, "Grid", Name="step", GridType="Collection", CollectionType="Spatial"
    )
    xml.SubElement(step, "Time", Value=repr(float(fields.attrs["time"])))
    grid = xml.SubElement(step, "Grid", Name="grains", GridType="Uniform")
    nodes = paraview["coordinates"].shape[:2]
    cells = (nodes[0] - 1, nodes[1] - 1)
    xml.SubElement(grid, "Topology", TopologyType="2DSMesh", Dimensions=f"{nodes[0]} {nodes[1]}")
    add_data(xml.SubElement(grid, "Geometry", GeometryType="XYZ"), paraview["coordinates"], h5_name)
    add_attribute(grid, paraview["velocity"], "Vector", "Cell", h5_name)
    for dataset in fields.values():
        if dataset.shape == nodes:
            add_attribute(grid, dataset, "Scalar", "Node", h5_name)
        elif dataset.shape == cells:
            add_attribute(grid, dataset, "Scalar", "Cell", h5_name)


def add_attribute(grid, dataset, kind, center, h5_name):
    """A scalar or vector field of the grid."""
    name = dataset.name.rsplit("/", 1)[1]
    add_data(
        xml.SubElement(grid, "Attribute", Name=name, AttributeType=kind, Center=center),
        dataset,
        h5_name,
    )


def add_data(parent, dataset, h5_name):
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
