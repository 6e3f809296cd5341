"""The README files: their code runs, their generated parts are those of today, their links lead somewhere."""

import os
import re
from importlib import import_module
from shlex import split

import pytest
from readme_blocks import (
    EXECUTED,
    ROOT,
    SAVED,
    SHOWN,
    Block,
    blocks_of,
    can_run_inside,
    checkout,
    fresh_clone,
    run_blocks,
    run_blocks_inside,
)

from fvcollapse.commands.command_line import make_parser
from runs.readme import COMMAND, PARTS, main, part, parts_of, readmes, remade
from runs.study import parse

FILES = readmes()
IN_STUDIES = [path for path in FILES if path.is_relative_to(ROOT / "runs")]
EXECUTABLE = [path for path in FILES if path not in IN_STUDIES and blocks_of(path)]
LINK = re.compile(r"\]\((?P<path>[^)#:]*)(#(?P<anchor>[^)]*))?\)")
HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)
# a whole command: a line of a block up to `&&`, or between backticks
CALL = re.compile(
    r"(?:^ *|`|&& )((?:fvcollapse \w+ (?=[\w/-])|python -m (?:runs|plots)\.)[^`&\n…]*?)(?=`|\n| &&)",
    re.MULTILINE,
)
PLACEHOLDERS = ("runs.<study>.study", "plots.<figure>")
LINES_MAX = {"README.md": 150, "runs/README.md": 60}
TEXTS = ("fvcollapse/CHANGELOG.md", "fvcollapse/CONTRIBUTING.md")
PICTURE_MAX = 150_000  # bytes


def name_of(path):
    """Path below the root."""
    return str(path.relative_to(ROOT))


# -- code ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", EXECUTABLE, ids=name_of)
def test_every_block_is_saved_run_or_shown(path):
    """A block of another language, or with a word that is not known, would be passed over."""
    for block in blocks_of(path):
        assert block.language in (*EXECUTED, *SAVED, *SHOWN), block
        if block.language in EXECUTED:
            assert not block.words, block
        else:
            assert len(block.words) == (1 if block.language in SAVED else 0), block


def test_all_fences_are_blocks():
    """An opening that the pattern misses would hide its code."""
    for path in FILES:
        fences = path.read_text(encoding="utf-8").count("```")
        assert fences == 2 * len(blocks_of(path)), path


@pytest.mark.parametrize("path", EXECUTABLE, ids=name_of)
def test_code_runs(path, tmp_path):
    """In processes of their own those of the first README, and what needs a shell."""
    quick = [block for block in blocks_of(path) if not block.is_slow]
    folder = tmp_path / "checkout"
    if any(block.language in EXECUTED for block in quick):
        inside = path != ROOT / "README.md" and can_run_inside(quick)
        (run_blocks_inside if inside else run_blocks)(quick, folder, checkout(folder))


@pytest.mark.slow
@pytest.mark.parametrize("path", EXECUTABLE, ids=name_of)
def test_all_code_runs(path, tmp_path):
    """What `-m slow` alone runs too; the first README installs the package in a fresh clone and runs its tests."""
    blocks = blocks_of(path)
    if any(block.is_slow for block in blocks):
        folder = tmp_path / "checkout"
        installs = any("pip install" in block.code for block in blocks)
        run_blocks(blocks, folder, (fresh_clone if installs else checkout)(folder))


@pytest.mark.parametrize("path", EXECUTABLE, ids=name_of)
def test_commands_of_slow_blocks_can_be_called(path):
    """They run with `-m slow`; by default their options are checked."""
    slow = [block.code for block in blocks_of(path) if block.is_slow and block.language == "sh"]
    lines = [line for code in slow for line in code.splitlines()]
    for line in lines:
        if line.startswith("fvcollapse "):
            make_parser().parse_args(split(line.partition(" && ")[0], comments=True)[1:])


def test_blocks_run_in_their_order_and_in_the_environment_that_they_make(tmp_path):
    made = "mkdir -p .venv/bin\nprintf '#!/bin/sh\\ncat a.toml' > .venv/bin/fvcollapse\nchmod +x .venv/bin/fvcollapse\n"
    python = "import pathlib; pathlib.Path('c').write_text(open('b.toml').read())"
    blocks = [
        Block("toml", ("a.toml",), "first = 1\n"),
        Block("sh", (), made, is_slow=True),
        Block("sh", (), "fvcollapse > b.toml\n"),
        Block("python", (), python),
        Block("text", (), "exit 1\n"),
    ]
    run_blocks(blocks, tmp_path, dict(os.environ))
    assert (tmp_path / "c").read_text(encoding="utf-8") == "first = 1\n"


def test_the_blocks_of_the_first_readme_are_those_of_a_newcomer():
    """Installation, tests, a case that is saved, its run, the same from Python: in this order, none left out."""
    blocks = blocks_of(ROOT / "README.md")
    languages = [block.language for block in blocks]
    assert languages[:5] == ["sh", "sh", "toml", "sh", "python"]
    assert "pip install . " in blocks[0].code
    assert blocks[2].words == ("case.toml",)
    assert "run case.toml" in blocks[3].code


def test_a_block_that_fails_is_seen(tmp_path):
    folder = tmp_path / "checkout"
    environment = checkout(folder)
    for code in ("false\ntrue\n", "fvcollapse run no.toml\n"):
        with pytest.raises(AssertionError):
            run_blocks([Block("sh", (), code)], folder, environment)


@pytest.mark.parametrize("path", IN_STUDIES, ids=name_of)
def test_commands_of_the_studies_can_be_called(path):
    """They take minutes to hours: modules, parts and options are checked, nothing is computed."""
    text = path.read_text(encoding="utf-8")
    for call in CALL.findall(text):
        program, *words = split(call.replace("FOLDER", str(ROOT)), comments=True)
        if program == "fvcollapse":
            make_parser().parse_args(words)
        elif words[1] not in PLACEHOLDERS:
            module = import_module(words[1])
            if hasattr(module, "STUDY"):
                parse(module.STUDY, words[2:])


def test_commands_of_the_studies_are_seen():
    calls = CALL.findall((ROOT / "runs" / "convergence" / "README.md").read_text(encoding="utf-8"))
    assert sum(call.startswith("fvcollapse converge ") for call in calls) == 4
    assert sum(call.startswith("python -m plots.") for call in calls) == 2


# -- generated parts -----------------------------------------------------------------------------


def test_generated_parts_are_those_of_their_commands():
    """`python -m runs.readme --write` remakes them."""
    for path in FILES:
        for command, body in parts_of(path.read_text(encoding="utf-8")):
            assert body == part(command), f"{path}: {command}"


def test_every_part_stands_in_one_file():
    commands = [
        command for path in FILES for command, _ in parts_of(path.read_text(encoding="utf-8"))
    ]
    assert sorted(commands) == sorted(f"{COMMAND} {name}" for name in PARTS)


def test_no_marker_is_without_its_counterpart():
    for path in FILES:
        text = path.read_text(encoding="utf-8")
        count = len(parts_of(text))
        assert text.count("<!-- begin: ") == text.count("<!-- end -->") == count, path


def test_a_changed_part_is_remade_and_the_rest_stays():
    text = f"before\n<!-- begin: {COMMAND} cost -->\nold\n<!-- end -->\nafter\n"
    assert remade(text) == (
        f"before\n<!-- begin: {COMMAND} cost -->\n{PARTS['cost']()}<!-- end -->\nafter\n"
    )


def test_a_part_is_printed_by_its_command(capsys):
    assert main(["cost-effects"]) == 0
    assert capsys.readouterr().out == PARTS["cost-effects"]()
    assert main(["no such part"]) == 2
    assert capsys.readouterr().err.startswith("command line: NAME: found no such part; allowed: ")


# -- text ----------------------------------------------------------------------------------------


def anchors(path):
    """Anchors of the headings of a file, as the pages of the repository have them."""
    headings = HEADING.findall(path.read_text(encoding="utf-8"))
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("path", [*FILES, *map(ROOT.joinpath, TEXTS)], ids=name_of)
def test_links_lead_somewhere(path):
    for match in LINK.finditer(path.read_text(encoding="utf-8")):
        target = (path.parent / match["path"]).resolve() if match["path"] else path
        assert target.exists(), match[0]
        if match["anchor"]:
            assert match["anchor"] in anchors(target), match[0]


@pytest.mark.parametrize(("name", "most"), LINES_MAX.items())
def test_the_first_pages_are_short(name, most):
    assert len((ROOT / name).read_text(encoding="utf-8").splitlines()) <= most


def test_the_readme_has_one_small_picture():
    (name,) = re.findall(
        r"!\[[^\]]*\]\(([^)]*)\)", (ROOT / "README.md").read_text(encoding="utf-8")
    )
    assert (ROOT / name).stat().st_size <= PICTURE_MAX
