"""Cases of the particle laboratory whose causes are told, beside what a diagnosis says of them."""

import json

import pytest
from report_example import example

from fvcollapse.errors import InputError
from runs.particle_laboratory import opened, study
from runs.study import parse


def test_a_row_ranks_the_cause():
    verdict = example("effect", probable=0.7).verdict
    ranked = sorted(verdict.probability, key=verdict.probability.get, reverse=True)
    row = opened.row_of(verdict, ranked[1])
    assert (row["first"], row["second"], row["rank_of_cause"]) == (*ranked[:2], 2)
    assert row["probability"] == pytest.approx(0.7)
    assert row["in_the_set"] == (ranked[1] in verdict.set)
    missing = opened.row_of(verdict, "flood")
    assert missing["rank_of_cause"] == ""
    assert missing["probability_of_cause"] == 0.0


@pytest.mark.parametrize("text", ["{", "[1]", '{"b01": {}}'])
def test_broken_causes_are_refused(tmp_path, text):
    (tmp_path / opened.LABELS).write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match="no causes"):
        opened.read_causes(tmp_path)


def test_the_part_needs_the_causes(tmp_path, capsys):
    assert study.main(["opened", "--data", str(tmp_path), "--tables", str(tmp_path)]) == 2
    assert opened.LABELS in capsys.readouterr().err


def test_each_case_is_diagnosed_with_the_controls(tmp_path, monkeypatch):
    asked = []

    def fake(experiments, baseline, **options):
        asked.append((experiments[0].name, options["controls"]))
        return example("effect", probable=0.7)

    causes = {"b01": {"truth": "none"}, "b04": {"truth": "lateral_friction"}}
    (tmp_path / opened.LABELS).write_text(json.dumps(causes), encoding="utf-8")
    monkeypatch.setattr(opened, "diagnose", fake)
    call = ["opened", "--data", str(tmp_path), "--tables", str(tmp_path), "--out", str(tmp_path)]
    opened.opened(parse(study.STUDY, call), study.BASELINE, lambda data: ["control"])
    assert asked == [("b01", ["control"]), ("b04", ["control"])]
    assert (tmp_path / "opened.csv").read_text(encoding="utf-8").count("\n") == 3
