"""Forces and readings that no catalogue knows, against what they should do."""

import numpy as np
import pytest
from scipy.integrate import trapezoid

from fvcollapse.blind.outside import BRAKE_MAX, REST, UNKNOWNS, brake, read_wrongly
from fvcollapse.blind.truth import View
from fvcollapse.case.case import GRAVITY, Case

DX, DT = 0.01, 1.0e-3


def velocity(u=1.0, w=0.0, nx=40, nz=5):
    return np.full((nx + 1, nz), u), np.full((nx, nz + 1), w)


def braked(force, u=1.0, w=0.0, slope=0.0):
    fields = velocity(u, w)
    brake([force], *fields, DT, DX, slope)
    return fields


def test_linear_drag_takes_the_same_part_of_every_velocity():
    u, w = braked({"kind": "linear_drag", "rate": 2.0}, w=0.3)
    assert u == pytest.approx(1.0 - 2.0 * DT)
    assert w == pytest.approx(0.3 * (1.0 - 2.0 * DT))


def test_quadratic_drag_grows_with_the_speed():
    slow, _ = braked({"kind": "quadratic_drag", "length": 0.5}, u=0.1)
    fast, _ = braked({"kind": "quadratic_drag", "length": 0.5}, u=1.0)
    assert 1.0 - slow[20, 2] / 0.1 == pytest.approx(DT * 0.1 / 0.5)
    assert 1.0 - fast[20, 2] == pytest.approx(DT * 1.0 / 0.5)


@pytest.mark.parametrize("friction", [0.2, -0.1])
def test_a_strip_is_coulomb_friction_within_its_ends(friction):
    u, _ = braked({"kind": "strip", "friction": friction, "first": 0.1, "last": 0.2}, slope=20.0)
    place = DX * np.arange(len(u))
    inside = (place >= 0.1) & (place <= 0.2)
    expected = friction * GRAVITY * np.cos(np.radians(20.0)) * DT / np.hypot(1.0, REST)
    assert 1.0 - u[inside] == pytest.approx(expected)
    assert np.all(u[~inside] == 1.0)


def test_what_is_at_rest_stays_so_and_no_force_turns_a_velocity_round():
    force = {"kind": "strip", "friction": 1.0e6, "first": 0.0, "last": 1.0}
    u, w = braked(force, u=0.0)
    assert not u.any()
    assert not w.any()
    u, _ = braked(force, u=1.0)
    assert u == pytest.approx(1.0 - BRAKE_MAX)


def test_uneven_friction_has_the_standard_deviation_that_it_says():
    rng = np.random.default_rng(1)
    loss = []
    for _ in range(300):
        waves, phases = rng.standard_normal(8) / 0.08, rng.uniform(0.0, 2.0 * np.pi, 8)
        force = {"kind": "uneven_friction", "friction": 0.01, "waves": waves, "phases": phases}
        loss.append(1.0 - braked(force)[0][:, 0])
    deviation = np.std(loss) * np.hypot(1.0, REST) / (GRAVITY * DT)
    assert deviation == pytest.approx(0.01, rel=0.1)


def a_view():
    time, x = np.linspace(0.0, 1.0, 11), np.linspace(0.0, 1.0, 101)
    thickness = np.tile(np.maximum(0.1 - 0.2 * x, 0.0), (11, 1))
    curve = np.column_stack([time, np.full(11, 0.4)])
    return View(curve, curve * [1.0, 0.0], time, x, thickness, 0.5 * thickness)


def test_magnification_and_clock_stretch_their_axes():
    view = read_wrongly([{"kind": "magnification", "error": 0.1}], 0.02, a_view())
    assert view.x[-1] == pytest.approx(1.1)
    assert view.front[:, 1] == pytest.approx(0.44)
    view = read_wrongly([{"kind": "clock", "error": -0.1}], 0.02, a_view())
    assert view.time[-1] == pytest.approx(0.9)
    assert view.front[-1] == pytest.approx([0.9, 0.4])


def test_lost_grains_are_missing_in_thickness_volume_and_front():
    view = read_wrongly([{"kind": "grain_loss", "lost": 0.1}], 0.02, a_view())
    assert view.volume[-1, 1] == pytest.approx(-0.1)
    assert view.thickness[-1, 0] == pytest.approx(0.09)
    assert view.static_height[-1, 0] == pytest.approx(0.045)
    exact = (0.1 - 0.02 / 0.9) / 0.2  # where 0.9 (0.1 - 0.2 x) = 0.02
    assert view.front[-1, 1] == pytest.approx(exact, abs=1e-3)
    assert view.front[0, 1] == 0.4


def test_fallen_grains_are_the_area_that_is_missing():
    view = a_view()
    view.thickness[-1, view.x > 0.25] = 0.0
    seen = read_wrongly([{"kind": "fallen_grains"}], 0.02, view)
    area = trapezoid(view.thickness[-1], view.x) / trapezoid(view.thickness[0], view.x)
    assert seen.volume[-1, 1] == pytest.approx(area - 1.0)
    assert seen.volume[-1, 1] == pytest.approx(-0.25, abs=0.02)


@pytest.mark.parametrize("kind", ["sloping_surface", "slumped_column"])
def test_another_column_has_the_same_volume(kind):
    geometry = Case().geometry
    for seed in range(5):
        polygon = np.array(UNKNOWNS[kind](np.random.default_rng(seed), geometry)["polygon"])
        x, z = polygon.T
        area = 0.5 * abs(x @ np.roll(z, -1) - z @ np.roll(x, -1))
        assert area == pytest.approx(geometry.height_0 * geometry.length_0)
        Case().replace(**{"geometry.polygon": polygon})
