"""Hidden effects that act by another closure than those of the catalogue."""

import numpy as np
import pytest

from fvcollapse.blind.causes import BLIND, TRAINING
from fvcollapse.blind.generator import draw_added, draw_label, drawn_world
from fvcollapse.blind.make import WITHOUT, seen_of, texts_of
from fvcollapse.blind.other_closure import (
    HEIGHT_MOST,
    REACH_MOST,
    SHARES,
    draw_form,
    reformed,
    relative_response,
)
from fvcollapse.blind.set_ups import set_up_of
from fvcollapse.blind.truth import View
from fvcollapse.case.case import case_from_text
from fvcollapse.diagnosis.names import NONE, UNKNOWN

TIME, X = np.linspace(0.0, 0.8, 41), np.linspace(0.0, 1.0, 201)
FRONT = 0.005


def pile(reach, height):
    """The `View` of a wedge whose front runs from 0.14 m to `reach`."""
    front = 0.14 + (reach - 0.14) * (1.0 - np.exp(-TIME / 0.2))
    rows = height * np.maximum(1.0 - X[None, :] / front[:, None], 0.0)
    pairs = np.column_stack([TIME, front])
    return View(pairs, np.column_stack([TIME, 0.0 * TIME]), TIME, X, rows, 0.5 * rows)


def form_of(seed=1, share=0.4):
    """A form of the response with a share of its own."""
    return draw_form(np.random.default_rng(seed), 8, (0.15, 0.3)) | {"share": share}


def label_of(cause, style, seed=3):
    """A label whose effects act by another closure wherever there are any."""
    world = drawn_world("world_01", style, 5)
    return draw_label(cause, style._replace(other_closures=1.0), seed, world)


def test_the_error_is_in_proportion_to_the_response():
    plain = pile(0.5, 0.12)
    sizes = []
    for reach in (0.48, 0.44):
        view = pile(reach, 0.12)
        sizes.append(np.abs(reformed(view, plain, form_of(), FRONT).front - view.front).max())
    assert sizes[1] == pytest.approx(3.0 * sizes[0], rel=0.2)


def test_no_response_no_error():
    view = pile(0.5, 0.12)
    seen = reformed(view, view, form_of(), FRONT)
    for each, other in zip(seen, view, strict=True):
        np.testing.assert_allclose(each, other, atol=1e-15)


def test_the_error_of_a_large_response_is_limited():
    form = form_of(share=0.7)
    view, plain = pile(0.3, 0.2), pile(1.0, 0.06)
    assert max(relative_response(view, plain)) * form["share"] > HEIGHT_MOST
    moved = reformed(view, plain, form, FRONT).front[:, 1] / view.front[:, 1] - 1.0
    assert 0.01 < np.abs(moved).max() < 4.0 * REACH_MOST


def test_profiles_keep_their_area():
    view = pile(0.4, 0.12)
    seen = reformed(view, pile(0.5, 0.12), form_of(), FRONT)
    area, other = (np.trapezoid(each.thickness, X, axis=1) for each in (view, seen))
    np.testing.assert_allclose(other, area, rtol=1e-9)
    assert np.abs(seen.thickness - view.thickness).max() > 0.003


@pytest.mark.parametrize("style", [TRAINING, BLIND], ids=["training", "blind"])
def test_about_two_in_five_of_the_cases_with_effects_have_a_form(style):
    world = drawn_world("world_01", style, 5)
    forms = [draw_label("gate", style, seed, world)["form"] for seed in range(100)]
    drawn = [form for form in forms if form]
    assert 25 <= len(drawn) <= 55
    assert all(SHARES[0] <= form["share"] <= SHARES[1] for form in drawn)
    assert {len(form["waves"]) for form in drawn} == {style.form_waves}


def test_training_and_blind_suites_have_other_forms():
    assert TRAINING.form_waves != BLIND.form_waves


@pytest.mark.parametrize("cause", [NONE, UNKNOWN])
def test_where_no_effect_is_hidden_nothing_is_reformed(cause):
    label = label_of(cause, TRAINING)
    assert label["form"] is None
    assert all("without" not in run for run in label["experiments"].values())


def test_the_run_without_the_effects_differs_in_them_alone():
    label = label_of("cohesion", BLIND)
    for run in label["experiments"].values():
        case, plain = case_from_text(run["case"]), case_from_text(run["without"])
        assert plain.effects.cohesion is None
        assert case.replace(**{"effects.cohesion": None}) == plain


def test_an_added_experiment_has_the_form_of_its_case():
    label = label_of("cohesion", BLIND)
    name = next(iter(label["experiments"]))
    assert draw_added(label, set_up_of(name), (1, 2))["form"] == label["form"]


def test_both_truths_are_run_and_what_is_seen_is_reformed(tmp_path, monkeypatch):
    run = next(iter(label_of("cohesion", BLIND)["experiments"].values()))
    assert list(texts_of("a", run)) == ["a", "a" + WITHOUT]
    views = {"a.h5": pile(0.4, 0.12), f"a{WITHOUT}.h5": pile(0.5, 0.12)}
    monkeypatch.setattr("fvcollapse.blind.make.view_of", lambda path, case, label: views[path.name])
    threshold = case_from_text(run["case"]).front.thickness
    wanted = reformed(*views.values(), run["form"], threshold)
    for each, other in zip(seen_of("a", run, tmp_path), wanted, strict=True):
        np.testing.assert_array_equal(each, other)
