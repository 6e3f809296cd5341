"""Films of the next experiment: as long as its collapse takes, with the hidden cause in it, and silent about it."""

import json
from math import inf

import pytest
from blind_suite import CLASSES, keep_wedge, make_wedges, wedge

from fvcollapse.blind import make as making
from fvcollapse.blind import next_films
from fvcollapse.blind.labels import read_labels
from fvcollapse.blind.next_films import film_next
from fvcollapse.blind.set_ups import SET_UPS, film_of, settings_text, varied
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.errors import InputError, NumericalError
from fvcollapse.measure.experiment import load_experiment

FIRST = "slope16_width10"
NARROW = {"geometry.channel_width": 0.05}
STEEP = {"geometry.slope_angle_deg": 22.0}
AT_ONCE = {"gate.speed": inf, "gate.time_constant": 0.0}
TALL = {"geometry.height_0": 0.21}


def test_another_set_up_is_filmed_as_long_as_its_collapse_takes():
    first = SET_UPS["slope13_width14"]
    assert varied(first, {"geometry.channel_width": 0.07}) == first._replace(width=0.07)
    assert varied(first, {"geometry.slope_angle_deg": 18.0})[:4] == SET_UPS["slope18_width14"][:4]
    steep = varied(SET_UPS["slope20_width10"], {"geometry.slope_angle_deg": 24.0})
    assert (steep.end, steep.reach) == (2.08, 2.0)  # beyond the steepest film, in proportion
    tall = varied(first, TALL)
    assert tall.end == pytest.approx(1.2 * 1.5**0.5, abs=0.01)
    assert tall.reach == pytest.approx(0.2 + 1.5 * 0.85, abs=0.01)
    assert varied(first, AT_ONCE) == first._replace(speed=inf)
    for one in SET_UPS.values():
        if one.height == 0.14:
            assert film_of(one.slope, one.height) == pytest.approx((one.end, one.reach - 0.2))


def test_what_is_stated_of_another_set_up_is_an_experiment(tmp_path):
    (tmp_path / "front.csv").write_text("t_s,x_front_m\n0,0.2\n0.1,0.3\n")
    set_up = varied(SET_UPS[FIRST], NARROW | STEEP | AT_ONCE | TALL)
    (tmp_path / "experiment.toml").write_text(settings_text(set_up, "careful"))
    case = load_experiment(tmp_path).case()
    geometry = case.geometry
    assert (geometry.channel_width, geometry.slope_angle_deg, geometry.height_0) == (0.05, 22, 0.21)
    assert case.gate.speed == inf


@pytest.fixture
def wedges(tmp_path, monkeypatch):
    """A sealed suite, a plan of every case, and the calls for truths."""
    make_wedges(monkeypatch, tmp_path / "suite")
    calls = []

    def keep(case_text, forces, path):
        calls.append((case_text, forces, path))
        keep_wedge(case_text, forces, path)

    monkeypatch.setattr(next_films, "keep_truth", keep)
    monkeypatch.setattr(making, "view_of", wedge)
    (tmp_path / "plans").mkdir()
    plan = {"candidates": {"width_0.05": {"changes": NARROW}, "speed_inf": {"changes": AT_ONCE}}}
    for number in range(1, len(CLASSES) + 1):
        (tmp_path / "plans" / f"case_{number:03d}.json").write_text(json.dumps(plan))
    return tmp_path, calls


def film_wedges(folder):
    return film_next(
        folder / "suite", folder / "suite.labels.json", folder / "plans", folder / "films"
    )


def test_the_sealed_world_measures_what_was_planned(wedges):
    folder, calls = wedges
    assert film_wedges(folder) == {}
    films = {path.parent for path in (folder / "films").rglob("experiment.toml")}
    assert len(films) == len(calls) == 2 * len(CLASSES)
    for one in films:
        experiment = load_experiment(one)
        assert set(experiment.curves) == {"front", "profiles", "volume", "interface"}
        case = experiment.case()
        narrow = one.name == "width_0.05"
        assert case.geometry.channel_width == (0.05 if narrow else case.geometry.channel_width)
        assert (case.gate.speed == inf) != narrow
    assert not (folder / "suite.labels.json.next").exists()
    film_wedges(folder)
    assert len(calls) == 2 * len(CLASSES)  # what is there stays


def test_the_cause_and_the_world_of_the_case_are_in_its_next_experiment(wedges):
    folder, calls = wedges
    film_wedges(folder)
    entries = read_labels(folder / "suite.labels.json")["cases"]
    noise = set()
    for text, forces, path in calls:
        label = entries[path.parent.name]["label"]
        hidden = {*label["effects"], *label["world"]["effects"]}
        assert {name for name in CATALOGUE if f"[effects.{name}]" in text} == hidden
        added = label["outside"].get("forces", [])
        assert len(forces) == len(label["world"]["forces"]) + len(added)
        noise.add(text)
    assert len(noise) == len(calls)  # every run has errors of its set-up of its own


def test_no_film_tells_the_cause(wedges):
    folder, _ = wedges
    film_wedges(folder)
    shown = "".join(p.read_text() for p in (folder / "films").rglob("*") if p.is_file())
    for word in (*CATALOGUE, "none", "unknown", "truth", "quantile", "cell_size"):
        if word not in ("gate", "tilt"):  # [gate] is a section of every experiment
            assert word not in shown, word


def test_a_truth_that_cannot_be_computed_is_told(wedges, monkeypatch):
    folder, _ = wedges

    def fail(case_text, forces, path):
        if path.parent.name == "case_002":
            raise NumericalError("no pivot", time=0.1)
        keep_wedge(case_text, forces, path)

    monkeypatch.setattr(next_films, "keep_truth", fail)
    assert {case for case, _ in film_wedges(folder)} == {"case_002"}
    assert not (folder / "films" / "case_002").exists()


def test_other_labels_than_the_sealed_ones_measure_nothing(wedges):
    folder, calls = wedges
    path = folder / "suite.labels.json"
    text = path.read_text().replace('"cause": "gate"', '"cause": "viscosity"')
    path.write_text(text)
    with pytest.raises(InputError, match="not the sealed one"):
        film_wedges(folder)
    assert not calls
