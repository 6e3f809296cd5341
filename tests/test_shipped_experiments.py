"""The experiments that are shipped: all can be read, and how they were made from published tables."""

from pathlib import Path

import pytest

from fvcollapse import load_experiment
from fvcollapse.measure.quantities import CURVES
from runs.experiments import convert, make_examples

SHIPPED = Path(convert.__file__).parent
FOLDERS = sorted(path.parent for path in SHIPPED.rglob("experiment.toml"))


def test_there_are_some():
    assert len(FOLDERS) > 20
    assert all(load_experiment(folder).settings.source for folder in FOLDERS)


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_shipped_experiment_has_a_baseline(folder):
    experiment = load_experiment(folder)
    case = experiment.case()
    assert case.effects.lateral_friction is None
    for scalar in experiment.scalars:
        assert scalar.name in ("runout", "final_height", "time_stop")
        size = case.geometry.length_0 if scalar.name == "runout" else 0.0
        assert scalar.value > size
        most = 1.0 if scalar.name == "time_stop" else 0.2
        assert 0.0 < scalar.sigma < most * scalar.value


def test_runout_is_from_the_back_wall():
    runout, height = load_experiment(SHIPPED / "mangeney2010_0deg").scalars
    assert (runout.value, height.value) == (0.475, 0.14)  # 0.275 m from the gate


def test_ratios_become_lengths_and_near_points_one_experiment(tmp_path):
    (tmp_path / "runout_planestrain.csv").write_text(
        "a_H0_over_L0,dL_over_L0,quality\n1.0,1.8,single\n4.0,6.0,merged\n"
    )
    (tmp_path / "height_planestrain.csv").write_text(
        'a_H0_over_L0,Hf_over_L0,quality\n1.01,0.9,"merged, eye"\n2.0,1.1,single\n'
    )
    convert.lajeunesse(tmp_path, tmp_path / "out")
    folder = tmp_path / "out" / "lajeunesse2005"
    assert {path.name for path in folder.iterdir()} == {"a1.00", "a2.00", "a4.00"}
    both = load_experiment(folder / "a1.00")
    geometry = both.settings.geometry
    assert geometry.height_0 == geometry.length_0 == pytest.approx(0.08)
    assert [scalar.value for scalar in both.scalars] == pytest.approx([0.08 * 2.8, 0.08 * 0.9])
    (alone,) = load_experiment(folder / "a2.00").scalars
    assert alone.name == "final_height"


@pytest.mark.parametrize("name", make_examples.EXAMPLES)
def test_example_hides_a_cause_that_is_not_read(name):
    experiment = load_experiment(SHIPPED / name)
    assert set(experiment.curves) == set(CURVES)
    true = make_examples.truth(name, make_examples.CELL_SIZE)
    stated = experiment.case()
    assert true.effects.lateral_friction is not None
    assert true.geometry == stated.geometry
    assert true.rheology.mu_1 != stated.rheology.mu_1
    sigma = experiment.standard_deviation("mu_1")
    assert abs(true.rheology.mu_1 - stated.rheology.mu_1) < sigma
    settings = (SHIPPED / name / "experiment.toml").read_text(encoding="utf-8")
    hidden = settings.partition("[truth]")[2]
    assert f"mu_wall = {true.effects.lateral_friction.mu_wall}" in hidden


def test_examples_are_small():
    files = [path for name in make_examples.EXAMPLES for path in (SHIPPED / name).iterdir()]
    assert sum(path.stat().st_size for path in files) < 100_000


def test_settings_of_an_example_are_made_again_alike(tmp_path):
    for name in make_examples.EXAMPLES:
        make_examples.write_settings(tmp_path / name, name, make_examples.CELL_SIZE)
        text = (tmp_path / name / "experiment.toml").read_text(encoding="utf-8")
        assert text == (SHIPPED / name / "experiment.toml").read_text(encoding="utf-8")


def test_thinned_film_keeps_whole_frames():
    rows = [f"{time},{place},0" for time in (0.0, 0.1, 0.2, 0.3) for place in range(4)]
    text = make_examples.thinned("\n".join(["t_s,x_m,h_m", *rows]) + "\n", "profiles")
    assert text.splitlines()[1:] == ["0.0,0,0", "0.0,2,0", "0.3,0,0", "0.3,2,0"]
