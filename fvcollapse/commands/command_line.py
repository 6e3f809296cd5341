"""The command line: parses, calls one command, turns errors into an exit status.

0 done; 1 the computation failed (what was computed is kept); 2 bad input; 130, 143, 129 ended by Ctrl-C,
SIGTERM, SIGHUP. Errors are one line on stderr. Each command imports what it needs when it is called, so
that `--help` is instant and bad input is refused before the kernels are loaded. `output.question` states
where results may be written, `console.interruption` what a signal does, `console.streams` what is done
where nothing can be printed.
"""

import os
import sys
from collections.abc import Sequence

from fvcollapse.commands import (
    bench,
    blind,
    cache,
    compare,
    converge,
    diagnose,
    examples,
    import_curves,
    keys,
    new,
    plot,
    run,
    sweep,
    verify,
)
from fvcollapse.commands.arguments import RULE
from fvcollapse.commands.parser import Parser, add_commands
from fvcollapse.console.interruption import ended_at_once, exit_status
from fvcollapse.console.streams import guarded_streams
from fvcollapse.errors import FvcollapseError, one_line
from fvcollapse.version import __version__

# in the order of `--help`
COMMANDS = (
    run,
    new,
    examples,
    plot,
    compare,
    verify,
    converge,
    bench,
    sweep,
    blind,
    diagnose,
    import_curves,
    keys,
    cache,
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; return its exit status."""
    with ended_at_once(), guarded_streams() as final:
        try:
            status = outcome(argv)
        except SystemExit as end:  # --help and --version
            status = int(end.code or 0)
        return final(status)


def outcome(argv: Sequence[str] | None) -> int:
    """Exit status of one command; an error is one line on stderr."""
    # no command opens a window, whatever the notebooks of the user need
    os.environ["MPLBACKEND"] = "agg"
    try:
        arguments = make_parser().parse_args(argv)
        return arguments.command(arguments)
    except FvcollapseError as error:
        print(error, file=sys.stderr)
        return error.exit_status
    except MemoryError as error:
        print(f"out of memory: {one_line(error)}; larger cells need less", file=sys.stderr)
        return 1
    except KeyboardInterrupt as error:
        print("interrupted", file=sys.stderr)
        return exit_status(error)


def make_parser() -> Parser:
    """The parser of all commands; the arguments that it reads hold the function to call as `command`."""
    parser = Parser(
        prog="fvcollapse", description="Granular column collapse on a slope.", epilog=RULE
    )
    parser.add_argument("--version", action="version", version=__version__)
    commands = add_commands(parser)
    for command in COMMANDS:
        command.add_parser(commands)
    return parser
