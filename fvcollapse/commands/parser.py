"""The parser of the command line: complaints are one line with the nearest name, no arguments show the help."""

import argparse
import sys
from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any

from fvcollapse.errors import InputError, one_line

LEAST_ALIKE = 0.7  # of two names without dashes in front, below which none is proposed
REQUIRED = "the following arguments are required: "  # of argparse


class MissingArguments(InputError):
    """Arguments that a command needs and that are not there."""

    def __str__(self) -> str:
        return one_line(f"{self.file}: {self.key}: missing: {self.found}; {self.allowed}")


class Parser(argparse.ArgumentParser):
    """A parser whose complaints are one line, as all others."""

    given: tuple[str, ...] = ()  # the words that are being read

    def error(self, message):
        """Refuse the arguments, after the help where none is given.

        An option that is none is perhaps why another one is missing.
        """
        if not self.given:
            self.print_help()
        known = self._option_string_actions
        words = [word.partition("=")[0] for word in self.given if word.startswith("--")]
        strange = [word for word in words if not any(name.startswith(word) for name in known)]
        self.refuse(message, self.meant(strange[0]) if strange else "")

    def meant(self, option: str) -> str:
        """The option most like one that is none; empty where that is given already, and counts once."""
        found = nearest(option, self._option_string_actions)
        repeated = isinstance(self._option_string_actions.get(found), argparse._AppendAction)
        given = any(word.partition("=")[0] == found for word in self.given)
        return "" if given and not repeated else found

    def refuse(self, found: str, meant: str = "") -> None:
        """Refuse the arguments, with what was perhaps meant.

        Raises
        ------
        InputError
        """
        hint = f"; did you mean {meant}?" if meant else ""
        if found.startswith(REQUIRED):
            missing, where = found.removeprefix(REQUIRED), f"see `{self.prog} --help`{hint}"
            raise MissingArguments("command line", self.prog, missing, where)
        usage = f"the arguments listed by `{self.prog} --help`"
        raise InputError("command line", self.prog, one_line(found), f"{usage}{hint}")

    def parse_known_args(self, args=None, namespace=None):
        """Arguments that are read; what is left over is refused, by the command that it was given to."""
        self.given = tuple(sys.argv[1:] if args is None else args)
        found, extra = super().parse_known_args(args, namespace)
        if extra:
            option = next((word for word in extra if word.startswith("-")), extra[0])
            meant = self.meant(option.partition("=")[0])
            self.refuse(f"unrecognized arguments: {' '.join(extra)}", meant)
        return found, extra

    def _check_value(self, action, value):
        """Refuse a value that is none of the choices; the hook of `argparse` for it."""
        if action.choices is not None and value not in action.choices:
            name = "/".join(action.option_strings) or action.metavar or action.dest
            choices = ", ".join(str(choice) for choice in action.choices)
            found = f"argument {name}: invalid choice: {value!r} (choose from {choices})"
            self.refuse(found, nearest(str(value), map(str, action.choices)))


def nearest(word: str, names: Iterable[str]) -> str:
    """The name most like a word, dashes in front apart; empty where none is."""
    bare = {name.lstrip("-"): name for name in names}
    found = get_close_matches(word.lstrip("-"), list(bare), n=1, cutoff=LEAST_ALIKE)
    return bare[found[0]] if found else ""


def add_commands(parser: Any) -> Any:
    """The place for the commands of a parser, which without any prints its help."""
    parser.set_defaults(command=lambda arguments: show_help(parser))
    return parser.add_subparsers(title="commands", metavar="COMMAND", dest="name")


def show_help(parser: Any) -> int:
    """Print the help; exit status 0."""
    parser.print_help()
    return 0
