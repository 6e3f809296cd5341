"""The folder of the cache of runs: that of the user, or the one that is named."""

import os
from pathlib import Path

from platformdirs import user_cache_path

from fvcollapse.errors import InputError
from fvcollapse.files.atomic import locked_temporary, remove_stale

VARIABLE = "FVCOLLAPSE_CACHE"


def default_folder() -> Path:
    """Folder of the cache of this user: $FVCOLLAPSE_CACHE, else where the system keeps caches."""
    if named := os.environ.get(VARIABLE):
        return Path(named)
    try:
        folder = user_cache_path("fvcollapse", appauthor=False)
        if folder.is_absolute():
            return folder
    except RuntimeError:  # what older versions answer with "~"
        pass
    found = "no home folder of this user"
    raise InputError("environment", VARIABLE, found, "a folder that may be written") from None


def ready_folder(folder: str | Path | None = None) -> Path:
    """A folder for a cache, made if need be; default that of this user.

    Raises
    ------
    InputError
        It cannot be written; the line names what to set.
    """
    folder = Path(folder or default_folder()).absolute()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        remove_stale(folder)
        handle, name = locked_temporary(folder)
        os.close(handle)
        os.unlink(name)
    except OSError as error:
        found = f"a folder that cannot be written ({(error.strerror or str(error)).lower()})"
        allowed = f"one that can: set {VARIABLE} or --cache"
        raise InputError(folder, "cache of runs", found, allowed) from None
    return folder
