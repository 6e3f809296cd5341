"""The seal of a suite: for every case a hash of its salted label and one of its data.

Nothing is scored unless every label, and every case that is still there, agrees with the seal.
"""

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fvcollapse.blind.forms import Seal, read_form, refuse_names
from fvcollapse.blind.plain_values import Entry, Plan
from fvcollapse.errors import InputError
from fvcollapse.output.forms import form_problems

SEAL = "SEAL.json"
SEAL_FORMAT = "fvcollapse-seal"
FORMAT_VERSION = 1
CASES_MAX = 100_000


def refuse_count(count: int) -> None:
    """Refuse a number of cases that no suite has.

    Raises
    ------
    InputError
    """
    if not 1 <= count <= CASES_MAX:
        raise InputError("command line", "--cases", f"{count}", f"a number from 1 to {CASES_MAX}")


def canonical(value: object) -> bytes:
    """The one JSON text of a value, as bytes."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()


def label_digest(entry: Entry) -> str:
    """Hash of an entry behind its salt: whoever knows all labels but the salt learns nothing from it."""
    salted = {key: value for key, value in entry.items() if key != "salt"}
    return hashlib.sha256(bytes.fromhex(entry["salt"]) + canonical(salted)).hexdigest()


def data_digest(folder: Path) -> str:
    """Hash of the names and contents of all files of a case."""
    digest = hashlib.sha256()
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        content = hashlib.sha256(path.read_bytes()).hexdigest()
        digest.update(f"{path.relative_to(folder).as_posix()} {content}\n".encode())
    return digest.hexdigest()


def seal_digest(cases: Mapping[str, Mapping[str, str]]) -> str:
    """The overall hash of the cases of a seal."""
    return hashlib.sha256(canonical(cases)).hexdigest()


def seal_text(plan: Plan, folder: Path) -> str:
    """Text of `SEAL.json`."""
    cases = {
        name: {"label": label_digest(entry), "data": data_digest(folder / name)}
        for name, entry in plan["cases"].items()
    }
    about = {"format": SEAL_FORMAT, "format_version": FORMAT_VERSION}
    content = about | {"seal": seal_digest(cases), "cases": cases}
    return json.dumps(content, indent=1) + "\n"


def read_seal(path: str | Path) -> dict[str, Any]:
    """The content of a seal.

    Raises
    ------
    InputError
    """
    seal = read_form(path, SEAL_FORMAT)
    refuse_names(path, seal["cases"])
    for refusal in form_problems(seal, Seal):
        raise InputError(path, *refusal)
    return seal


def check_seal(folder: Path, plan: Plan, labels: str | Path) -> tuple[str, int]:
    """(overall hash, number of cases whose data were compared with the seal).

    Raises
    ------
    InputError
        Labels or data are not those that were sealed.
    """
    seal = read_seal(folder / SEAL)
    overall, cases = seal["seal"], seal["cases"]
    if set(cases) != set(plan["cases"]):
        raise InputError(labels, "cases", "other cases than the seal", f"those of {folder / SEAL}")
    checked = 0
    for name, entry in plan["cases"].items():
        if label_digest(entry) != cases[name]["label"]:
            broken = "a label that is not the sealed one"
            raise InputError(labels, f"cases.{name}", broken, f"the one of {folder / SEAL}")
        if os.path.isdir(folder / name):
            checked += 1
            if readable_digest(folder / name) != cases[name]["data"]:
                raise InputError(folder / name, "folder", "other data than sealed", "as sealed")
    if seal_digest(cases) != overall:
        raise InputError(folder / SEAL, "seal", "a hash that is not of its cases", "as written")
    return overall, checked


def readable_digest(folder: Path) -> str:
    """The `data_digest` of a folder; InputError if something in it cannot be read."""
    try:
        return data_digest(folder)
    except OSError as error:
        found = (error.strerror or str(error)).lower()
        raise InputError(error.filename or folder, "file", found, "data that can be read") from None
