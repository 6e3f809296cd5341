"""`python -m fvcollapse` and the script `fvcollapse`: see `commands.command_line`."""

import sys

from fvcollapse.commands.command_line import main

__all__ = ["main"]

if __name__ == "__main__":
    sys.exit(main())
