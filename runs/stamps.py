"""Stamps of the tables and figures of the studies: which solver made them, and whether they are still as it left them.

`stamps.json` holds for each file, by its path below the repository, the digest of its content and

- of a table that runs make: the version of the solver (`fvcollapse.output.fingerprint.solver_version`) with the effects
  that are on in these runs, that with all effects (`code`), and the CPU time they took;
- of a table or figure that follows from other tables: the digest of those.

A stamp says nothing of a file that has changed since. Two versions of Python may disagree on the version of a solver.
"""

import json
from hashlib import sha256
from pathlib import Path

from fvcollapse.files.atomic import write_atomic
from runs.table import RUNS

ROOT = RUNS.parent
STAMPS = "runs/stamps.json"
PRESENT, STALE, CHANGED = "present", "stale", "changed since its stamp"
UNSTAMPED, MISSING = "no stamp", "missing"
STATES = (PRESENT, STALE, CHANGED, UNSTAMPED, MISSING)


def digest(path):
    """Digest of the content of a file."""
    return sha256(Path(path).read_bytes()).hexdigest()[:16]


def digest_of_all(root, names):
    """Digest of the contents of several files, and of their names."""
    lines = [f"{name} {digest(root / name)}" for name in sorted(names)]
    return sha256("\n".join(lines).encode()).hexdigest()[:16]


def read_stamps(root=ROOT):
    """{path: stamp}; empty before the first."""
    path = root / STAMPS
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def write_stamps(root, made, about):
    """Stamp files that were just made.

    Parameters
    ----------
    root : Path
    made : iterable of str
        Their paths below it.
    about : dict
        `solver`, `code` and `cpu_s`, or `tables`.

    Raises
    ------
    OutputError
    """
    stamps = read_stamps(root) | {name: about | {"content": digest(root / name)} for name in made}
    keep_stamps(root, stamps)


def keep_stamps(root, stamps):
    """Replace the stamps by these, those of files that are gone left out."""
    kept = {name: stamp for name, stamp in sorted(stamps.items()) if (root / name).exists()}
    write_atomic(root / STAMPS, (json.dumps(kept, indent=1) + "\n").encode())


def state(root, name, now):
    """State of a file, one of `STATES`.

    Parameters
    ----------
    root : Path
    name : str
    now : dict
        What its stamp would be if it were made today: {"solver": …} or {"tables": …}.
    """
    if not (root / name).exists():
        return MISSING
    stamp = read_stamps(root).get(name)
    if stamp is None:
        return UNSTAMPED
    if stamp["content"] != digest(root / name):
        return CHANGED
    return PRESENT if all(stamp.get(key) == value for key, value in now.items()) else STALE
