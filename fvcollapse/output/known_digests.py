"""Digests of the solver that were computed before, kept on the disk: computing one takes longer than starting a run.

They are kept beside the compiled files of the package, for the bytes of all its files: where one byte has changed
nothing is known. Where the folder cannot be written nothing is kept.
"""

import hashlib
import json
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path

FILE = f"solver_digests.{sys.implementation.cache_tag}.json"  # one for each version of Python


@cache
def bytes_digest(package: Path) -> str:
    """A digest of the names and bytes of all files of a package, and of this Python, in hundredths of a second."""
    digest = hashlib.sha256(sys.version.encode())
    for path in sorted(package.rglob("*.py")):
        data = path.read_bytes()
        digest.update(f"\n{path.relative_to(package).as_posix()} {len(data)}\n".encode() + data)
    return digest.hexdigest()


def known_digest(package: Path, name: str, find: Callable[[], str]) -> str:
    """The digest of a name (of effects that are on), kept from before or made by `find()`.

    `find()` reads the files later than they were hashed; where they have changed in between nothing is kept.
    """
    path, before = package / "__pycache__" / FILE, bytes_digest(package)
    known = kept_digests(path, before)
    if name not in known:
        known[name] = find()
        if bytes_digest.__wrapped__(package) == before:
            keep(path, {"bytes": before, "digests": known})
    return known[name]


def kept_digests(path: Path, package_bytes: str) -> dict[str, str]:
    """What is kept in a file for these bytes of the package; nothing if the file is broken."""
    with suppress(OSError, ValueError, TypeError, KeyError):
        kept = json.loads(path.read_text(encoding="utf-8"))
        if kept["bytes"] == package_bytes:
            return dict(kept["digests"])
    return {}


def keep(path: Path, content: dict) -> None:
    """Replace the file, if the disk takes it."""
    own = path.with_suffix(f".{os.getpid()}.tmp")
    with suppress(OSError):
        path.parent.mkdir(exist_ok=True)
        own.write_text(json.dumps(content), encoding="utf-8")
        os.replace(own, path)
