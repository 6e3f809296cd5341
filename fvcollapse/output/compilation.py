"""Whether the kernels are compiled already: the first start on a machine says that it waits for the compiler."""

import sys

from fvcollapse.console.bars import is_shown

NOTICE = "compiling the kernels: once on this machine, about a minute"
TOLD: list[bool] = []  # whether this process has said so


def is_compiled() -> bool:
    """Whether the kernel of the steps is on the disk, for these sources; True where none is kept."""
    from fvcollapse.march import march  # loads the compiler

    files = getattr(march._cache, "_cache_file", None)
    return files is None or bool(march.overloads) or bool(files._load_index())


def tell_compilation(quiet: bool) -> None:
    """Say once, where bars are shown, that the kernels will be compiled; nothing if they are, or if `quiet`."""
    if TOLD or not is_shown(quiet) or is_compiled():
        return
    TOLD.append(True)
    print(NOTICE, file=sys.stderr, flush=True)
