"""The printed facts of a published study as experiments, and the check of what they can decide."""

import numpy as np
import pytest
from report_example import example

from fvcollapse import load_case, load_experiment
from runs.paper_case import study

SEEN = {"runout": 1.3, "final_height": 0.05, "time_stop": 2.4, "peak_front_velocity": 1.3}


def test_the_baseline_has_no_walls_and_the_facts_are_bounds():
    base = load_case(study.HERE / "baseline.toml")
    for name in study.FACTS:
        experiment = load_experiment(study.EXPERIMENTS / name)
        case = experiment.case(base)
        assert case.effects.lateral_friction is None
        assert (case.rheology, case.boundary) == (base.rheology, base.boundary)
        assert not experiment.curves
        kinds = {scalar.kind for scalar in experiment.scalars}
        assert kinds == ({"value"} if case.geometry.slope_angle_deg == 0.0 else {"upper"})


def test_what_is_measured_grows_and_is_near_the_truth(tmp_path):
    source = study.EXPERIMENTS / "example_16deg_w10cm"
    texts = {path.name: path.read_text(encoding="utf-8") for path in source.glob("*.csv")}
    for number, (title, (kinds, curves)) in enumerate(study.MEASURED.items()):
        folder = tmp_path / str(number)
        one = study.write_experiment(folder, title, SEEN, texts, kinds, curves)
        assert set(one.curves) == set(curves)
        for scalar in one.scalars:
            assert scalar.kind == kinds[scalar.name]
            if scalar.kind == "value":
                assert abs(scalar.value - SEEN[scalar.name]) < 3.0 * scalar.sigma
            else:
                assert scalar.value == {"runout": 1.6, "time_stop": 1.76}[scalar.name]


def test_a_row_tells_the_answer():
    report = example()
    row = study.row_of("all curves", report)
    assert row["measured"] == "all curves"
    assert row["verdict"].startswith(report.verdict.kind)
    assert row["lateral_friction"] == pytest.approx(
        report.verdict.probability["lateral_friction"], abs=1e-3
    )
    assert np.isfinite(row["p_none"])
