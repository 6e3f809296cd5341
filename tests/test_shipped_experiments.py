"""The experiments that are shipped: all can be read, and how they were made from published tables."""

from pathlib import Path

import pytest

from fvcollapse import load_experiment
from runs.experiments import convert

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
    assert {scalar.name for scalar in experiment.scalars} <= {"runout", "final_height"}
    for scalar in experiment.scalars:
        size = case.geometry.length_0 if scalar.name == "runout" else 0.0
        assert scalar.value > size
        assert 0.0 < scalar.sigma < 0.2 * scalar.value


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
