"""The folder of an experiment: its name, and what is none although it looks like one."""

import os
from collections import Counter
from pathlib import Path
from urllib.parse import quote

from fvcollapse.errors import InputError

SETTINGS = "experiment.toml"
MOST_NAMES = 8  # of experiments in a message
ENCODED_NAME_MAX = 200  # characters of the name of an experiment within the name of a file (255)


def refuse_parent(folder: Path) -> None:
    """Refuse a folder of experiments, which holds none itself, with the names of what is inside.

    A folder inside it that holds experiments counts as one name, with how many they are.

    Raises
    ------
    InputError
    """
    if (folder / SETTINGS).exists() or not folder.is_dir():
        return
    inside = sorted(path.parent.name for path in folder.glob(f"*/{SETTINGS}"))
    groups = Counter(path.parent.parent.name for path in folder.glob(f"*/*/{SETTINGS}"))
    names = [listed(inside), listed([f"{name}/ ({groups[name]} in it)" for name in sorted(groups)])]
    if inside or groups:
        found = f"no {SETTINGS}, but experiments in it"
        raise InputError(folder, "folder", found, "; ".join(filter(None, names)))


def listed(names: list[str]) -> str:
    """Names in a row, no more than `MOST_NAMES`."""
    others = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return ", ".join(names[:MOST_NAMES]) + others


def refuse_bad_name(folder: Path) -> None:
    """Refuse a folder whose name no report can show: it becomes part of file names, figures and pages.

    Raises
    ------
    InputError
    """
    name = os.path.basename(os.path.realpath(folder))
    if not name or not name.isprintable():
        allowed = "a folder with a name of printable characters in UTF-8"
        raise InputError(folder, "folder", f"the name {name!r}", allowed)
    length = len(quote(name, safe=""))  # as figures are named
    if length > ENCODED_NAME_MAX:
        allowed = f"at most {ENCODED_NAME_MAX}, where a byte that is no letter, digit or _.-~ counts three"
        raise InputError(folder, "folder", f"a name of {length} characters", allowed)
