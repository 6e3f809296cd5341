"""What loses right names: labels that keep their cause while what makes them hard is taken out."""

import copy
import re
from collections import Counter

import pytest

from fvcollapse.blind.causes import BLIND, known_effects
from fvcollapse.blind.forms import label_problems
from fvcollapse.blind.generator import draw_label, drawn_world
from fvcollapse.blind.set_ups import BELIEVED, MATERIAL_SD, STATEMENTS, set_up_of, settings_text
from fvcollapse.blind.worlds import STRONG
from fvcollapse.case.case import case_from_text
from fvcollapse.diagnosis.baseline import baseline_cases, refined
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.files.atomic import write_atomic
from fvcollapse.measure.comparison import value_of
from fvcollapse.measure.experiment import load_experiment
from runs.blind import losses, removals

STYLE = BLIND._replace(slight_share=0.0, other_closures=1.0)  # all that can be taken out is there


def label_of(cause="cohesion", seed=3):
    world = drawn_world("world_01", STYLE, seed)
    assert world["strength"] == STRONG
    assert cause not in world["effects"]
    return draw_label(cause, STYLE, seed, world)


def cases_of(label):
    return {name: case_from_text(run["case"]) for name, run in removals.runs_of(label)}


@pytest.mark.parametrize("cause", [NONE, UNKNOWN, "cohesion", "lateral_friction+viscosity"])
def test_every_rung_is_a_label_of_the_same_cause_and_leaves_its_own_label_alone(cause):
    label = label_of(cause)
    before = copy.deepcopy(label)
    for remove in removals.LADDER.values():
        easier = remove(label) if remove else label
        entry = {"salt": "0" * 32, "seed": 1, "world_seed": 1, "attempt": 0, "label": easier}
        assert list(label_problems(entry)) == []
        for part in ("cause", "unknown_kind", "effects", "outside"):
            assert easier[part] == label[part]
        assert {name: run["noise"] for name, run in removals.runs_of(easier)} == {
            name: run["noise"] for name, run in removals.runs_of(label)
        }
        if easier is label:
            continue
        nothing_to_take = remove is removals.catalogue_closures and label["form"] is None
        assert (easier == label) == nothing_to_take
        assert label == before
        label, before = easier, copy.deepcopy(easier)


def test_effects_act_by_their_closures_of_the_catalogue():
    label = label_of()
    assert all("without" in run for run in label["experiments"].values())
    easier = removals.catalogue_closures(label)
    assert easier["form"] is None
    assert not any({"without", "form"} & set(run) for run in easier["experiments"].values())
    assert cases_of(easier) == cases_of(label)


def test_the_believed_physics_has_no_effects_but_the_hidden_ones():
    label = removals.believed_physics(label_of())
    for name, run in removals.runs_of(label):
        effects = case_from_text(run["case"]).effects
        present = {effect for effect in known_effects() if getattr(effects, effect) is not None}
        assert present == (set() if name in label["world"]["controls"] else {"cohesion"})
        assert run["forces"] == run["readings"] == []
    unknown = label_of(UNKNOWN)
    easier = removals.believed_physics(unknown)
    for name, run in easier["experiments"].items():
        own = [*unknown["outside"].get("forces", ()), *unknown["outside"].get("readings", ())]
        assert run["forces"] + run["readings"] == own, name


def test_the_usual_numerics_are_those_of_the_finer_runs_of_a_diagnosis(tmp_path):
    label = removals.usual_numerics(label_of("lateral_friction"))
    for name, case in cases_of(label).items():
        folder = tmp_path / name
        folder.mkdir()
        text = settings_text(set_up_of(name), label["world"]["statement"])
        write_atomic(folder / "experiment.toml", text.encode())
        write_atomic(folder / "front.csv", b"t_s,x_front_m\n0.0,0.2\n0.5,0.5\n")
        experiment = load_experiment(folder)
        finer = refined(baseline_cases([experiment])[experiment.name])
        assert case.grid.cell_size == case.grid.cell_size_z == finer.grid.cell_size
        assert case.numerics == finer.numerics
        stated = case.replace(**{"geometry.height_0": finer.geometry.height_0})
        assert stated.time.step_max == pytest.approx(finer.time.step_max)
        friction = case.effects.lateral_friction
        assert friction is None or friction.scheme == type(friction)().scheme


def test_an_exact_laboratory_has_a_quarter_of_the_errors_and_says_so():
    label = label_of()
    easier = removals.exact_measurement(label)
    before, after = STATEMENTS[label["world"]["statement"]], STATEMENTS["exact"]
    shares = {key: after.sd[key] / sd for key, sd in before.sd.items()}
    shares |= dict.fromkeys(MATERIAL_SD, 0.25)
    for name, case in cases_of(easier).items():
        stated = set_up_of(name).stated()
        for key, share in shares.items():
            far = value_of(cases_of(label)[name], key) - stated[key]
            assert value_of(case, key) - stated[key] == pytest.approx(share * far), key
    world = easier["world"]
    assert world["quality"] == 0.25 * label["world"]["quality"]
    assert world["material"]["rheology.mu_1"] == case.rheology.mu_1
    text = settings_text(set_up_of("slope13_width14"), world["statement"], world["quality"])
    believed = BELIEVED["rheology.mu_1"], MATERIAL_SD["rheology.mu_1"]
    numbers = [float(number) for number in re.findall(r"^mu_1 = (\S+)$", text, re.M)]
    assert numbers == [believed[0], 0.25 * believed[1]]


def test_a_slumped_column_keeps_the_form_of_its_surface():
    style = STYLE._replace(unknowns=("slumped_column",))
    label = draw_label(UNKNOWN, style, 3, drawn_world("world_01", style, 3))
    easier = removals.exact_measurement(label)
    for name, case in cases_of(easier).items():
        if name in label["experiments"]:
            geometry, column = case.geometry, cases_of(label)[name].geometry
            sizes = geometry.length_0 / column.length_0, geometry.height_0 / column.height_0
            for corner, was in zip(geometry.polygon, column.polygon, strict=True):
                assert corner == pytest.approx([s * at for s, at in zip(sizes, was, strict=True)])


def test_causes_are_dealt_alike():
    counts = Counter(losses.causes(120, 41))
    single = [counts[name] for name in known_effects()]
    assert sum(counts.values()) == 120
    assert max(single) - min(single) <= 1
    assert counts[NONE] == counts[UNKNOWN] > 3 * min(single)
    assert losses.causes(120, 41) == losses.causes(120, 41)


def test_only_cases_that_every_rung_has_answered_from_the_same_draw_are_compared():
    rows = [
        {"case": name, "attempt": 0, "rung": rung} for rung in removals.LADDER for name in "abc"
    ]
    rows[0]["attempt"] = 1
    del rows[-1]
    assert {row["case"] for row in losses.paired(rows)} == {"b"}
