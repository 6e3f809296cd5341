"""Curves of another code as films of a laboratory, and the table of what a diagnosis says of them."""

import json

import numpy as np
import pytest
from report_example import example

from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.diagnosis.question import Question
from fvcollapse.measure.quantities import CURVES
from runs.cross_code import films, study
from runs.cross_code.films import ERRORS, PEERS, Seen
from runs.study import parse
from runs.table import read_table

PEER = PEERS["flat_3mm"]


def front(time):
    """Position of the front [m]."""
    return 0.2 + 0.21 * np.tanh(np.asarray(time) / 0.2) ** 2


def thickness(time, x):
    """A wedge with the volume of the column [m]."""
    return np.maximum(2.0 * 0.028 / front(time) * (1.0 - x / front(time)), 0.0)


@pytest.fixture
def data(tmp_path):
    """A folder of curves as the other code leaves them."""
    folder = tmp_path / f"{films.PREFIX}_{PEER.folder}"
    folder.mkdir()
    time, x = np.arange(0.0, 1.005, 0.01), np.arange(0.001, 0.8, 0.003)
    rows = [f"{t:.5f},{front(t):.6f},{1e-5 * t:.3e}" for t in time]
    text = "\n".join(["t_s,x_cont5mm_m,volume_rel_err", *rows, "# steps 910", ""])
    (folder / "front.csv").write_text(text, encoding="utf-8")
    for t in (0.18, 0.32, 0.48, 0.96, 1.2):
        lines = [f"{a:.6f},{b:.6f}" for a, b in zip(x, thickness(t, x), strict=True)]
        path = folder / f"profile_t{t:.2f}.csv"
        path.write_text("\n".join(["x_m,h_m", *lines, ""]), encoding="utf-8")
    return tmp_path


def test_without_errors_a_film_is_the_curves_themselves(data, tmp_path):
    one = films.write_experiment(tmp_path / "exact", data, PEER, 0, study.EXACT)
    curve = one.curves["profiles"]
    assert np.unique(curve.time) == pytest.approx(
        [0.18, 0.32, 0.48, 0.96]
    )  # 1.2 s is after the end
    truth = np.concatenate([thickness(t, curve.x[curve.time == t]) for t in np.unique(curve.time)])
    assert np.abs(curve.value - truth).max() < 5e-4  # half a pixel, and the stored spacing
    assert one.curves["front"].value == pytest.approx(front(one.curves["front"].time), abs=1e-3)
    assert one.curves["front"].time[0] > 0.0


def test_noise_has_the_stated_size_and_differs_from_seed_to_seed(data, tmp_path):
    exact = films.write_experiment(tmp_path / "exact", data, PEER, 0, study.EXACT)
    seen = [films.write_experiment(tmp_path / f"n{n}", data, PEER, n) for n in range(1, 13)]
    whole = np.array([one.curves["profiles"].value for one in seen])
    on_grains = exact.curves["profiles"].value > 0.03
    scatter = (whole - exact.curves["profiles"].value)[:, on_grains].std()
    assert scatter == pytest.approx(np.hypot(ERRORS.thickness, 0.05 * ERRORS.scale), rel=0.3)
    assert len({one.curves["profiles"].value.tobytes() for one in seen}) == len(seen)
    clocks = np.array([one.curves["profiles"].time[0] - 0.18 for one in seen])
    assert 0.3 * ERRORS.time < clocks.std() < 2.0 * ERRORS.time
    again = films.write_experiment(tmp_path / "again", data, PEER, 1)
    assert again.curves["front"].value.tobytes() == seen[0].curves["front"].value.tobytes()


@pytest.mark.parametrize("name", PEERS)
def test_the_right_model_is_believed(name, tmp_path, monkeypatch):
    """What the experiment states is what the other code was given."""
    peer, time = PEERS[name], np.arange(0.0, 2.0, 0.02)
    x = np.arange(0.005, 2.4, 0.01)
    profiles = {t: (x, thickness(t, x)) for t in (0.18, 0.32, 0.48)}
    seen = Seen(np.column_stack([time, front(time)]), np.column_stack([time, 0 * time]), profiles)
    monkeypatch.setattr(films, "seen_of", lambda data, peer: seen)
    one = films.write_experiment(tmp_path / name, tmp_path, peer, 1)
    case = Question((one,)).baseline
    law, bed = case.rheology, case.boundary
    assert (law.mu_1, law.mu_2, law.I_0, bed.mu_back_wall) == (0.48, 0.73, 0.279, 0.0)
    assert bed.mu_bed == (np.inf if peer.mu_bed is None else peer.mu_bed)
    assert case.geometry.channel_width == case.gate.speed == np.inf
    assert case.geometry.slope_angle_deg == peer.slope
    assert set(one.curves) == set(CURVES) - {"interface"}


def test_a_missing_collapse_is_named(tmp_path, capsys):
    status = study.main(
        ["null", "--data", str(tmp_path), "--only", "flat_3mm", "--tables", str(tmp_path)]
    )
    assert status == 2
    assert "basilisk_a0_l6_e4_ns" in capsys.readouterr().err
    assert study.main(["null", "--data", str(tmp_path), "--only", "flat"]) == 2
    assert "--only: found flat" in capsys.readouterr().err


def test_the_questions_are_enough_and_known():
    """At least twelve, with both slopes, another bed, finer and coarser cells, series and several noises."""
    assert len(study.QUESTIONS) >= 12
    for name, posed in study.QUESTIONS.items():
        assert set(posed.peers) <= set(PEERS), name
    assert len({(posed.peers, posed.noise) for posed in study.QUESTIONS.values()}) == len(
        study.QUESTIONS
    )
    used = {peer for posed in study.QUESTIONS.values() for peer in posed.peers}
    assert used == set(PEERS)
    assert {PEERS[peer].slope for peer in used} == {0.0, 22.0}
    assert any(len(posed.peers) > 1 for posed in study.QUESTIONS.values())


def asked(tmp_path, *more):
    return parse(study.STUDY, ["null", "--data", str(tmp_path), "--tables", str(tmp_path), *more])


def test_answers_are_kept_and_given_once(tmp_path, monkeypatch, capsys):
    """Each as soon as it is there; with another diagnosis they are given again."""
    given = []

    def diagnosed(name, options):
        given.append(name)
        if len(given) == 3:
            raise KeyboardInterrupt
        return example("unknown" if name == "steep_3mm" else "none", probable=0.8)

    monkeypatch.setattr(study, "diagnosed", diagnosed)
    with pytest.raises(KeyboardInterrupt):
        study.null(asked(tmp_path))
    stored = json.loads((tmp_path / study.ANSWERS).read_text(encoding="utf-8"))
    assert list(stored) == given[:2]
    study.null(asked(tmp_path))
    assert sorted(given) == sorted([*study.QUESTIONS, given[2]])
    rows = {row["question"]: row for row in read_table(tmp_path / "answers.csv")}
    assert set(rows) == set(study.QUESTIONS)
    assert rows["steep_3mm"]["called"] == UNKNOWN
    assert rows["flat_3mm"]["called"] == NONE
    assert float(rows["steep_3mm"]["probability"]) == pytest.approx(0.8)
    count = len(study.QUESTIONS)
    told = capsys.readouterr().out.splitlines()[-1]
    assert told == (
        f"{count} of {count} answered: none {count - 1}, unknown 1, an effect 0; "
        "largest probability of a wrong answer 0.80"
    )
    layer = tmp_path / "diagnosis" / "verdict_model.json"
    layer.parent.mkdir()
    layer.write_text("{}", encoding="utf-8")
    monkeypatch.setattr(study, "DIAGNOSIS", layer.parent)
    study.null(asked(tmp_path, "--only", "flat_3mm"))
    assert given[-1] == "flat_3mm"
    assert len(given) == count + 2


def test_an_effect_is_called_by_its_name(tmp_path):
    answer = study.answer_of(example("effect", probable=0.7), study.QUESTIONS["series_3mm"])
    row = study.row_of("series_3mm", answer)
    assert row["called"] == "+".join(sorted(answer["effects"]))
    assert row["probability"] == pytest.approx(0.7)
    assert row["experiments"] == "flat_3mm steep_3mm"
    assert "an effect 1" in study.summary({"series_3mm": answer})


def test_hints_do_not_void_answers_and_statements_do(tmp_path):
    path = tmp_path / "part.py"
    path.write_text("import math\n\ndef half(x):\n    y = x / 2\n    return y\n", encoding="utf-8")
    plain = study.digest_of(tmp_path)
    path.write_text(
        "import math\nfrom typing import TYPE_CHECKING\n\nif TYPE_CHECKING:\n    import numpy\n\n"
        'def half(x: float) -> float:\n    """Half."""\n    y: float = x / 2  # of it\n    return y\n',
        encoding="utf-8",
    )
    assert study.digest_of(tmp_path) == plain
    path.write_text("def half(x):\n    y = x / 3\n    return y\n", encoding="utf-8")
    assert study.digest_of(tmp_path) != plain


def test_films_with_less_noise_state_less_and_scatter_less(data, tmp_path):
    half = films.Errors(*(0.5 * error for error in ERRORS))
    exact, whole, less = (
        films.write_experiment(tmp_path / name, data, PEER, 3, errors)
        for name, errors in (("exact", study.EXACT), ("whole", ERRORS), ("less", half))
    )
    stated = [one.settings.uncertainty.thickness for one in (exact, whole, less)]
    assert stated == pytest.approx([ERRORS.thickness, ERRORS.thickness, half.thickness])
    truth = exact.curves["profiles"].value
    scatter = [(one.curves["profiles"].value - truth).std() for one in (whole, less)]
    assert scatter[1] == pytest.approx(0.5 * scatter[0], rel=0.2)


def test_precision_asks_each_question_with_each_noise(tmp_path, monkeypatch):
    given = []
    report = example("none", probable=0.8)
    monkeypatch.setattr(study, "diagnosed", lambda *asked: given.append(asked) or report)
    options = parse(study.STUDY, ["precision", "--data", str(tmp_path), "--tables", str(tmp_path)])
    study.precision(options)
    assert [(name, factor) for name, _, factor in given] == [
        (name, factor) for factor in study.FACTORS for name in study.PRECISE
    ]
    rows = read_table(tmp_path / "precision.csv")
    assert [float(row["noise_factor"]) for row in rows] == [0.5] * 3 + [0.25] * 3
    assert {row["called"] for row in rows} == {NONE}
