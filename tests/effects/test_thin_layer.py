"""Thin layers: which layers flow, the thickness of a column, the fluidity above a rough bed, what is refused."""

import math

import numpy as np
import pytest
from effect_runs import centre_of_mass, collapse
from scipy.integrate import solve_bvp
from scipy.optimize import brentq

from fvcollapse.case.case import Case
from fvcollapse.errors import CaseError
from fvcollapse.step.fluidity_relaxation import Cooperation, relax_fluidity
from fvcollapse.step.geometry import allocate_geometry, fill_reach
from fvcollapse.step.nonlocal_fluidity import fluidity
from fvcollapse.step.rheology import material
from fvcollapse.step.thin_layer import strengthen, thin_layer_law
from fvcollapse.verification import exact
from fvcollapse.verification.flows import layer, layer_case, run_until, run_until_steady
from fvcollapse.verification.problems.thin_layers import flows

BEADS = {"rheology__mu_1": 0.382, "rheology__mu_2": 0.643, "boundary__mu_bed": math.inf}
# the particle laboratory: mu(I) measured in shear, layers of 18 diameters stop at 26 deg
PARTICLES = {
    "rheology__mu_1": 0.448,
    "rheology__mu_2": 0.797,
    "rheology__I_0": 0.5,
    "rheology__grain_diameter": 0.007,
    "rheology__density_bulk": 1403.0,
    "boundary__mu_bed": math.inf,
}
LENGTH = 2.31  # diameters: mu_stop = tan 26 deg at 18 diameters


# -- what flows ----------------------------------------------------------------------------------


@pytest.mark.parametrize("angle", [25.0, 25.5, 27.0])
def test_layers_of_eighteen_particles(angle):
    """They stop at 25-26 deg and flow at 27 deg; mu(I) alone has all of them flow."""
    depth = 18 * 0.007
    changes = {**PARTICLES, "geometry__slope_angle_deg": angle}
    assert flows(layer_case(depth / 8, depth, **changes), depth)
    case = layer_case(depth / 8, depth, **changes, effects__thin_layer={"length": LENGTH})
    assert flows(case, depth) == (angle > 26.0)


def stops_at(closure, length):
    """Slope (deg) at which 18 diameters of the particles stop."""

    def above(slope):
        changes = {**PARTICLES, "geometry__slope_angle_deg": slope}
        effect = {"length": length, "closure": closure}
        case = layer_case(0.01, 1.0, **changes, effects__thin_layer=effect)
        return exact.stopping_thickness(case) - 18 * 0.007

    return brentq(above, 24.2, 30.0)


def test_lengths_that_the_chute_of_the_particles_allows():
    """It stops at 26 and flows at 27 deg: 2.31 to 3.85 d with `thickness`, of which 2.31 d is the least."""
    assert stops_at("thickness", LENGTH) == pytest.approx(26.0, abs=0.01)
    assert stops_at("thickness", 3.85) == pytest.approx(27.0, abs=0.01)
    assert stops_at("thickness", 3.05) == pytest.approx(26.5, abs=0.01)
    beyond = {3.6: 26.85, 4.0: 27.09, 5.0: 27.65}
    for length, slope in beyond.items():
        assert stops_at("thickness", length) == pytest.approx(slope, abs=0.01)


def test_the_nonlocal_closure_needs_a_length_of_its_own_in_that_chute():
    """With 2.31 d 18 diameters stop at 24.3 deg in place of 26 to 27; that takes 8.6 to 10.7 d."""
    assert stops_at("nonlocal", LENGTH) == pytest.approx(24.27, abs=0.01)
    assert stops_at("nonlocal", 8.59) == pytest.approx(26.0, abs=0.01)
    assert stops_at("nonlocal", 10.69) == pytest.approx(27.0, abs=0.01)
    depth = 18 * 0.007
    changes = {**PARTICLES, "geometry__slope_angle_deg": 25.5}
    for length, flowing in ((LENGTH, True), (10.0, False)):
        effect = {"length": length, "closure": "nonlocal"}
        assert (
            flows(layer_case(depth / 8, depth, **changes, effects__thin_layer=effect), depth)
            == flowing
        )


@pytest.mark.parametrize("mu_bed", [math.inf, 0.382])
@pytest.mark.parametrize(("effect", "error"), [({}, 0.03), ({"closure": "nonlocal"}, 0.12)])
def test_stopping_thickness_of_beads(effect, error, mu_bed):
    """At 24 deg, on 8 cells; a bed on which grains slide stops the same layers."""
    changes = {**BEADS, "boundary__mu_bed": mu_bed, "geometry__slope_angle_deg": 24.0}
    changes |= {"effects__thin_layer": effect, "numerics__film_thickness": 0.0}
    depth = exact.stopping_thickness(layer_case(0.01, 1.0, **changes))
    case = layer_case(depth / 8, 1.5 * depth, **changes)
    assert not flows(case, (1.0 - error) * depth)
    assert flows(case, (1.0 + error) * depth)


def test_both_closures_agree_where_the_layer_is_as_thick_as_the_length():
    middle = math.degrees(math.atan(0.5 * (0.382 + 0.643)))
    changes = {**BEADS, "geometry__slope_angle_deg": middle}
    by_thickness, by_fluidity = (
        exact.stopping_thickness(
            layer_case(0.01, 1.0, **changes, effects__thin_layer={"closure": closure})
        )
        for closure in ("thickness", "nonlocal")
    )
    assert by_thickness == pytest.approx(1.65 * 7e-4)
    assert by_fluidity == pytest.approx(by_thickness)


def test_beside_nonlocal_its_length_holds():
    case = Case().replace(
        **{"effects.thin_layer": {"closure": "nonlocal"}, "effects.nonlocal": {"A": 0.5}}
    )
    assert thin_layer_law(case).cooperation == pytest.approx(0.5 * case.rheology.grain_diameter)


def test_a_layer_that_flows_is_that_of_mu_I():
    """Above mu_stop the friction is mu(I), to the last digit of the sweeps."""
    changes = {**BEADS, "geometry__slope_angle_deg": 24.0}
    plain, thin = (
        run_until_steady(layer(case, lambda z, case=case: exact.bagnold(case, z), dt=10.0))
        for case in (
            layer_case(0.02 / 12, 0.02, **changes),
            layer_case(0.02 / 12, 0.02, **changes, effects__thin_layer={}),
        )
    )
    assert thin.profile()[1] == pytest.approx(plain.profile()[1], rel=1e-6)


def test_block_that_slides_has_the_friction_of_its_thickness():
    """du/dt = g cos a (tan a - mu_b - (mu_2 - mu_1)/(1 + h/L)): 2e-5 off."""
    depth, mu_bed = 0.03, 0.25
    case = layer_case(
        0.005,
        depth,
        geometry__slope_angle_deg=22.0,
        rheology__mu_1=0.9,
        rheology__mu_2=1.2,
        boundary__mu_bed=mu_bed,
        effects__thin_layer={"length": 10.0},
    )
    flow = run_until(layer(case, lambda z: 0.5 + 0.0 * z, dt=2e-3, slip=0.5), 0.1)
    friction = mu_bed + 0.3 / (1.0 + depth / 0.007)
    gain = 0.1 * exact.gravity_normal(case) * (exact.slope_ratio(case) - friction)
    assert flow.mean_velocity() - 0.5 == pytest.approx(gain, rel=1e-3)


def test_a_collapse_is_shortened_the_more_the_longer_the_length():
    # from 8 grains of 0.7 mm on: less is a fifth of a cell, and 2 grains move the centre by 0.1 % either way
    lengths = ({"effects__thin_layer": {"length": length}} for length in (8.0, 16.0, 32.0))
    reached = [
        centre_of_mass(collapse(0.3, boundary__mu_bed=math.inf, **keys)) for keys in ({}, *lengths)
    ]
    assert np.all(np.diff(reached) < 0.0)


# -- thickness of a column -----------------------------------------------------------------------


def test_thickness_of_each_piece_of_a_column():
    """Columns: a layer of 2.5 cells; half a cell wide under a steep side; a drop above a gap; nothing."""
    geometry = allocate_geometry(4, 8)
    geometry.filled[0, :3] = 1.0, 1.0, 0.5
    geometry.filled[1, :4] = 0.5
    geometry.filled[2, 0], geometry.filled[2, 5:7] = 1.0, 1.0
    geometry.bed_cover[:] = 1.0, 0.5, 1.0, 0.0
    fill_reach(geometry.reach, geometry.filled)
    case = Case().replace(**{"effects.thin_layer": {}})
    law, dz = thin_layer_law(case), 0.002
    friction, bed = np.zeros((4, 8)), np.full(4, 9.0)
    still = np.zeros((4, 8)), np.zeros((5, 9))
    strengthen(friction, bed, *still, 10.0 * geometry.filled, geometry, material(case), law, dz)

    def excess(cells):
        return law.contrast / (1.0 + cells * dz / law.length)

    assert bed == pytest.approx([excess(2.5), excess(4.0), excess(1.0), 0.0])
    expected = np.zeros((4, 8))
    expected[0, :3], expected[1, :4] = excess(2.5), excess(4.0)
    expected[2, 0], expected[2, 5:7] = excess(1.0), excess(2.0)
    assert friction == pytest.approx(expected)


# -- fluidity ------------------------------------------------------------------------------------


def test_relaxation_solves_the_equation_of_the_elimination():
    """In a pile with a ragged surface, behind a gate that is half open."""
    random = np.random.default_rng(3)
    geometry = allocate_geometry(12, 9)
    for i, rows in enumerate(random.integers(0, 8, 12)):
        geometry.filled[i, :rows] = 1.0
        geometry.filled[i, rows] = random.uniform(0.1, 1.0)
    geometry.bed_cover[:] = 1.0
    geometry.aperture[5, :4] = 0.5
    fill_reach(geometry.reach, geometry.filled)
    rates, mu = random.uniform(0.0, 5.0, (12, 9)), random.uniform(0.3, 0.7, (12, 9))
    for rough in (False, True):
        expected, g = np.zeros((12, 9)), np.zeros((12, 9))
        fluidity(expected, rates, mu, geometry, 0.02, rough, 0.02, 0.02)
        law = Cooperation(0.02, rough, math.inf, 1e-10)
        assert relax_fluidity(g, rates, mu, geometry, law, 0.02, 0.02) < 60
        assert g == pytest.approx(expected, rel=1e-9)


def rough_profile(case, z):
    """U(z) of a steady layer with tau/p = tan(slope): (mu(I) - tan(slope)) g = (A d)^2 g'', g = 0 on the bed."""
    law, slope, depth = case.rheology, exact.slope_ratio(case), case.geometry.height_0
    length, scale = (
        thin_layer_law(case).cooperation,
        law.grain_diameter * math.sqrt(law.density_grain),
    )
    weight = law.density_bulk * exact.gravity_normal(case)

    def change(height, values):
        root = np.sqrt(np.maximum(weight * (depth - height), 1.0))
        inertial = slope * values[0] * scale / root
        mu = law.mu_1 + (law.mu_2 - law.mu_1) * inertial / (law.I_0 + inertial)
        return np.stack([values[1], (mu - slope) * values[0] / length**2, slope * values[0]])

    heights = np.linspace(0.0, depth, 400)
    guess = np.gradient(exact.bagnold(case, heights), heights) / slope
    solution = solve_bvp(
        change,
        lambda low, high: np.array([low[0], high[1], low[2]]),
        heights,
        np.stack([guess, np.gradient(guess, heights), exact.bagnold(case, heights)]),
        tol=1e-5,
        max_nodes=20000,
    )
    assert solution.success
    return solution.sol(z)[2]


def test_velocity_of_a_layer_above_a_rough_bed():
    """Measured 1.5e-2 on 24 cells; the bed takes a fifth of the speed of the local law."""
    case = layer_case(
        0.02 / 24,
        0.02,
        **{**BEADS, "geometry__slope_angle_deg": 24.0},
        effects__thin_layer={"length": 4.0, "closure": "nonlocal"},
        numerics__tolerance=1e-7,
        numerics__max_sweeps=100,
    )
    z, u = run_until_steady(
        layer(case, lambda z: exact.bagnold(case, z), 1.0), change=1e-5
    ).profile()
    expected = rough_profile(case, z)
    print(
        np.abs(u - expected).max() / expected.max(), expected.max() / exact.bagnold(case, z).max()
    )
    assert u == pytest.approx(expected, abs=0.02 * expected.max())
    assert expected.max() < 0.9 * exact.bagnold(case, z).max()


@pytest.mark.parametrize(("slope", "factor"), [(22.0, 5.0), (24.0, 3.2), (27.0, 2.6)])
def test_a_thick_nonlocal_layer_is_slowed_by_length_over_thickness(slope, factor):
    """Its mean speed is 1 - factor L/h of that of mu(I), so 1 % takes 260 to 500 L: 0.3 to 0.6 m of beads."""
    for ratio in (64.0, 256.0):
        depth = ratio * 1.65 * 7e-4
        case = layer_case(
            depth / 8,
            depth,
            **{**BEADS, "geometry__slope_angle_deg": slope},
            effects__thin_layer={"closure": "nonlocal"},
        )
        z = np.linspace(0.0, depth, 801)
        slower = 1.0 - np.trapezoid(rough_profile(case, z), z) / np.trapezoid(
            exact.bagnold(case, z), z
        )
        assert slower * ratio == pytest.approx(factor, rel=0.02)
        assert slower > 0.01


# -- what is refused -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"effects.thin_layer": {"length": 0.0}}, "effects.thin_layer.length"),
        ({"effects.thin_layer": {"length": -1.0}}, "effects.thin_layer.length"),
        ({"effects.thin_layer": {"closure": "thick"}}, "effects.thin_layer.closure"),
        ({"effects.thin_layer": {}, "rheology.law": "bingham"}, "rheology.law"),
        ({"effects.thin_layer": {}, "numerics.method": "projection"}, "numerics.method"),
    ],
)
def test_what_is_refused(changes, key):
    with pytest.raises(CaseError, match=key.replace(".", r"\.")) as caught:
        Case().replace(**changes)
    assert "\n" not in str(caught.value)
