"""Data sets of one length as the rows of one table: a file with six data sets in place of forty.

HDF5 takes a millisecond for every two data sets, to write and to read, however small they are. A file of this layout
has `/series/table`, `/steps/table` and `/profiles/table`, whose attribute `names` tells what each row is, beside the
data sets that no table can hold. `tabled` shows it as a file with a data set for each name, so that all checks of
`record_layout` hold for both.
"""

import json
from collections.abc import Mapping
from typing import Any

import h5py
import numpy as np

from fvcollapse.files.hdf5 import write_dataset
from fvcollapse.output.stored_numbers import NUMBERS, group_of, numbers_of, refuse

LAYOUT, TABLES = "layout", "tables"  # root attribute of such a file, and its value
GROUPS = {
    "series": 2,
    "steps": 2,
    "profiles": 3,
}  # dimensions of the tables; the first counts the names
ROWS, NAMES = "table", "names"


def write_table(group: h5py.Group, columns: Mapping[str, np.ndarray], description: str) -> None:
    """Store arrays of one shape and type as the table of a group of an open file.

    Parameters
    ----------
    group : h5py.Group
    columns : dict
        Name -> array.
    description : str
    """
    write_dataset(group, ROWS, np.array([*columns.values()]), "SI", description)
    group[ROWS].attrs[NAMES] = json.dumps([*columns])


def tabled(file: h5py.File) -> Any:
    """An open file, or, if its data sets stand in tables, a `TabledFile` in its place.

    Raises
    ------
    InputError
    """
    return TabledFile(file) if file.attrs.get(LAYOUT) == TABLES else file


class TabledFile:
    """Reads as an open HDF5 file with a data set for every row of a table.

    Parameters
    ----------
    file : h5py.File

    Raises
    ------
    InputError
        A table is missing or damaged, or its names are not those of its rows.
    """

    def __init__(self, file: h5py.File) -> None:
        self.file, self.driver, self.filename = file, file.driver, file.filename
        self.groups = {name: rows_of(file, name, ndim) for name, ndim in GROUPS.items()}

    def __getitem__(self, path):
        group, _, name = path.partition("/")
        if group not in self.groups:
            return self.file[path]
        return self.groups[group][name] if name else self.groups[group]

    def __contains__(self, path):
        return self.get(path) is not None

    def get(self, path: str) -> Any:
        """The array or group at a path; None if there is none."""
        group, _, name = path.partition("/")
        if group not in self.groups:
            return self.file.get(path)
        return self.groups[group].get(name) if name else self.groups[group]


def rows_of(file: h5py.File, group: str, ndim: int) -> dict[str, Any]:
    """{name: array} of a group: the rows of its table, and its other data sets."""
    group_of(file, group)
    path = f"{group}/{ROWS}"
    table = numbers_of(file, path, (None,) * ndim, kinds=NUMBERS)
    others = {name: file[group][name] for name in file[group] if name != ROWS}
    names = names_of(file, path)
    if len(names) != len(table) or set(names) & set(others):
        refuse(file, path, f"{len(table)} rows and the names {names}", "one name for each row")
    return dict(zip(names, table, strict=True)) | others


def names_of(file: h5py.File, path: str) -> list[str]:
    """Names of the rows of a table; InputError unless they are different texts."""
    text = file[path].attrs.get(NAMES)
    try:
        names = json.loads(text) if isinstance(text, str) else None
    except ValueError:
        names = None
    is_list = isinstance(names, list) and all(isinstance(name, str) for name in names)
    if names is None or not is_list or len(set(names)) < len(names):
        refuse(file, f"{path}.{NAMES}", "no names of its rows", "a list of different names")
    return names
