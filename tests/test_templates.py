"""`fvcollapse new`: the templates are read back, and what they hold is what the program takes anyway."""

import re
import tomllib

import pytest

from fvcollapse.__main__ import main
from fvcollapse.case.case import Case, describe_keys, load_case
from fvcollapse.case.grammar import key_table
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.measure.experiment import read_draft
from fvcollapse.measure.experiment_keys import Settings

SETTING = re.compile(r"# (\w+) = (\S.*?)  +# ")
HEADER = re.compile(r"# (\[effects\.\w+\])$")


def uncommented(text, with_effects):
    """The template with every key that has a value set to it."""
    lines = []
    for line in text.splitlines():
        if with_effects:
            line = HEADER.sub(r"\1", line)
        elif HEADER.match(line):
            break
        lines.append(SETTING.sub(r"\1 = \2  # ", line))
    return "\n".join(lines)


def test_a_case_template_is_the_default_case(tmp_path, capsys):
    path = tmp_path / "new" / "folder" / "case.toml"
    assert main(["new", "case", str(path)]) == 0
    assert capsys.readouterr().out == f"{path}\n"
    assert load_case(path) == Case()
    text = path.read_text(encoding="utf-8")
    for info in describe_keys():
        assert f"# {info.name.rpartition('.')[2]} =" in text
        assert info.description in text
    path.write_text(uncommented(text, with_effects=False), encoding="utf-8")
    assert load_case(path) == Case()
    assert "cell_size" in tomllib.loads(path.read_text(encoding="utf-8"))["grid"]


def test_every_effect_of_a_case_template_can_be_switched_on(tmp_path):
    path = tmp_path / "case.toml"
    main(["new", "case", str(path)])
    table = tomllib.loads(uncommented(path.read_text(encoding="utf-8"), with_effects=True))
    assert set(table["effects"]) == set(CATALOGUE)


def test_an_experiment_template_names_every_key_and_file(tmp_path, capsys):
    folder = tmp_path / "beads"
    assert main(["new", "experiment", str(folder)]) == 0
    path = folder / "experiment.toml"
    assert capsys.readouterr().out == f"{path}\n"
    assert read_draft(path) == Settings()
    text = path.read_text(encoding="utf-8")
    assert re.search(r"# height_0 = +# required; m; height of the column; a number > 0 and", text)
    assert "# speed =  " in text
    assert "# m/s; default 10 %; standard deviation of speed" in text
    assert "# front = 0.01  " in text
    assert re.search(r'# title = "" +# one line that names the experiment; text', text)
    for name in ("front.csv: t_s, x_front_m", "profiles.csv: t_s, x_m, h_m", "scalars.csv: name"):
        assert name in text
    for name in key_table(Settings):
        assert f"# {name.rpartition('.')[2]} =" in text


def test_an_effect_template_is_an_effect(tmp_path, capsys):
    assert main(["new", "effect", "rolling_friction", "--out", str(tmp_path)]) == 0
    assert "catalogue.py" in capsys.readouterr().out
    found = {}
    text = (tmp_path / "rolling_friction.py").read_text(encoding="utf-8")
    exec(compile(text, "rolling_friction.py", "exec"), found)
    effect = found["EFFECT"]
    assert (effect.name, effect.section.__name__) == ("rolling_friction", "RollingFriction")
    assert effect.section() == effect.section(strength=0.0)
    assert 0.0 < effect.keys(0.5)["strength"] < 0.1


@pytest.mark.parametrize("name", ["gate", "Big", "2fast", "a-b", "class", "_x"])
def test_a_name_that_no_effect_can_have(name, tmp_path, capsys):
    assert main(["new", "effect", name, "--out", str(tmp_path / "none")]) == 2
    assert f"NAME: found {name!r}" in capsys.readouterr().err
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize("kind", ["case", "experiment", "effect"])
def test_nothing_is_overwritten(kind, tmp_path, capsys):
    place = {
        "case": [str(tmp_path / "case.toml")],
        "experiment": [str(tmp_path / "beads")],
        "effect": ["drag", "--out", str(tmp_path)],
    }[kind]
    assert main(["new", kind, *place]) == 0
    assert main(["new", kind, *place]) == 2
    assert "already there" in capsys.readouterr().err
    assert main(["new", kind, *place, "--force"]) == 0
