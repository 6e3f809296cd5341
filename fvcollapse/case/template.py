"""A case file to fill in: every key is a comment with its default, unit, meaning and range."""

from fvcollapse.case.case import describe_keys

OFF = ("off", "absent")
HEAD = """\
# A case: what differs from the defaults below, which are those of an empty file. Remove the # in front of a key to
# set it (one without a value is absent by default), and in front of a section [effects.<name>] to switch that effect
# on. SI units; degrees where a key ends in _deg.
"""
WIDTH = 44  # columns before the comment of a key


def case_template() -> str:
    """The text of a case file that is the default case, with every key as a comment (TOML)."""
    lines, section = [HEAD.rstrip()], None
    for info in describe_keys():
        place, _, name = info.name.rpartition(".")
        if place != section:
            mark = "# " if place.startswith("effects.") else ""
            lines += ["", f"{mark}[{place}]"]
            section = place
        unit = "" if info.unit in ("-", "1") else f"{info.unit}; "
        allowed = f"; {info.allowed}" if info.allowed else ""
        default = "" if info.default in OFF else f" {info.default}"
        stated = f"# {name} ={default}"
        lines.append(f"{stated:<{WIDTH}}  # {unit}{info.description}{allowed}")
    return "\n".join(lines) + "\n"
