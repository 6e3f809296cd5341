"""The text of an `experiment.toml`: what is known, and every other key as a comment with its default and range."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fvcollapse.case.case import parse_value
from fvcollapse.case.grammar import show, toml_value
from fvcollapse.errors import InputError
from fvcollapse.measure.experiment_keys import REQUIRED, describe_keys, settings_from_table

WIDTH = 30  # columns before the comment of a key


def settings_text(settings: Sequence[str], path: str | Path) -> str:
    """Text of a new `experiment.toml`: what is known, and as comments the keys that are not."""
    table: dict[str, Any] = {}
    for setting in settings:
        if not is_utf8(setting):
            raise InputError(
                path, "--set", f"a byte that is not UTF-8 in {setting!r}", "UTF-8 text"
            )
        name, equals, value = (part.strip() for part in setting.partition("="))
        if not (name and equals):
            raise InputError(
                path, f"--set {setting}", "no key or no '='", "--set section.key=VALUE"
            )
        section, _, last = name.rpartition(".")
        inner = table.setdefault(section, {}) if section else table
        if not isinstance(inner, dict):
            raise InputError(path, section, show(inner), "a table")
        inner[last] = parse_value(value)
    settings_from_table(table, path)
    lines, header = [], ""
    for info in describe_keys():
        section, _, name = info.name.rpartition(".")
        if section != header:
            lines += ["", f"[{section}]"]
            header = section
        inner = table.get(section, {}) if section else table
        lines.append(key_line(info, inner, name))
    return "# What was not measured stays a comment.\n\n" + "\n".join(lines) + "\n"


def key_line(info: Any, known: Mapping[str, Any], name: str) -> str:
    """The line of a key: its value, or as a comment its default; then unit, meaning and range."""
    if name in known:
        stated = f"{name} = {toml_value(known[name])}"
    else:
        is_value = info.default != "absent" and not info.default.endswith("%")
        stated = f"# {name} = {info.default}" if is_value else f"# {name} ="
    words = [
        "required" if info.name in REQUIRED and name not in known else "",
        "" if info.unit in ("-", "1") else info.unit,
        f"default {info.default}" if info.default.endswith("%") else "",
        info.description,
        info.allowed,
    ]
    return f"{stated:<{WIDTH}}  # {'; '.join(filter(None, words))}"


def is_utf8(text: str) -> bool:
    """Whether a word of the command line was UTF-8: other bytes arrive as lone surrogates."""
    return not any("\ud800" <= letter <= "\udfff" for letter in text)
