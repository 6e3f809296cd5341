"""Which runs a diagnosis needs: cases without effects, levels of the effects, draws of the calibrated parameters."""

import dataclasses
from math import inf

import numpy as np
import pytest
from msgspec.structs import replace

from fvcollapse.case.case import GRAVITY
from fvcollapse.diagnosis.baseline import LONGEST_STEP, baseline_cases, refined, run_end
from fvcollapse.diagnosis.emulator import monomials, richest_trend
from fvcollapse.diagnosis.levels import applicable_effects, closures_of, design
from fvcollapse.diagnosis.nuisances import Nuisance, draw, nuisances, with_nuisances
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import NUISANCE, OBSERVATION
from fvcollapse.errors import InputError
from fvcollapse.measure.experiment_keys import Common
from fvcollapse.measure.observation import flow_case

# -- cases ---------------------------------------------------------------------------------------


def test_baseline_is_the_set_up_without_effects(experiments, cases):
    case = cases["s16_w0.2"]
    assert case.geometry.slope_angle_deg == 16.0
    assert case.geometry.channel_width == 0.2
    assert case.effects == type(case.effects)()
    assert case.grid.cell_size == pytest.approx(0.14 / 12)
    assert case.time.step_max == pytest.approx(LONGEST_STEP * (0.14 / GRAVITY) ** 0.5)
    assert baseline_cases(experiments, cell_size=0.02)["s16_w0.1"].grid.cell_size == 0.02


def test_finer_grid_has_smaller_cells_and_steps(cases):
    coarse = cases["s10_w0.1"]
    fine = refined(coarse)
    assert fine.grid.cell_size == pytest.approx(0.75 * coarse.grid.cell_size)
    assert fine.time.step_max == pytest.approx(0.5 * coarse.time.step_max)
    stretched = coarse.replace(**{"grid.cell_size_z": 0.01})
    assert refined(stretched).grid.cell_size_z == pytest.approx(0.0075)


def test_runs_end_after_the_last_frame_at_a_round_time(experiments):
    assert experiments[0].time_end == pytest.approx(1.6)
    assert run_end(experiments[0]) == 2.0


def test_what_is_only_seen_is_not_run_again(cases):
    base = cases["s16_w0.1"]
    section = {"velocity_ratio": 1.3, "view": "wall"}
    wall = base.replace(**{"effects.transverse_profile": section})
    centre = base.replace(**{"effects.transverse_profile": section | {"view": "centre"}})
    assert wall != centre
    assert flow_case(wall) == flow_case(centre)
    assert flow_case(base) is base
    for name, effect in CATALOGUE.items():
        if effect.kind == OBSERVATION:
            seen = base.replace(**{f"effects.{name}": closures_of(name)[0].section([0.7, 0.7])})
            assert flow_case(seen) == base


# -- effects -------------------------------------------------------------------------------------


def test_every_closure_of_the_catalogue_can_be_run(cases):
    """All levels of all effects are cases that the solver accepts."""
    base = cases["s16_w0.1"]
    for name, effect in CATALOGUE.items():
        if effect.kind == NUISANCE:
            continue
        closures = closures_of(name)
        assert len(closures) == len(effect.variants)
        for closure in closures:
            assert set(closure.parameters) <= set(effect.priors)
            for u in closure.levels():
                case = base.replace(**{f"effects.{name}": closure.section(u)})
                section = getattr(case.effects, name)
                for key, value in closure.section(u).items():
                    assert getattr(section, key) == value


def test_a_parameter_of_another_closure_is_left_out():
    sink, weakening, increase = closures_of("lateral_friction")
    assert sink.parameters == increase.parameters == ("mu_wall", "pressure_ratio")
    assert set(weakening.parameters) == {*sink.parameters, "deep_ratio", "weakening_depth"}
    assert sink.keys == {"closure": "sink"}
    assert closures_of("viscosity")[1].parameters == ("eta_constant",)


def test_values_are_quantiles_of_the_prior():
    (closure,) = closures_of("bed_friction")
    assert closure.values([0.5])["mu_bed"] == pytest.approx(0.33)
    assert closure.values([0.0])["mu_bed"] == pytest.approx(0.18)


@pytest.mark.parametrize("dimension", [1, 2, 3, 4, 5])
def test_design_fills_the_cube_and_determines_a_trend(dimension):
    points = design(dimension)
    assert points.shape == (4 if dimension == 1 else 2 * dimension + 3, dimension)
    assert points.min(axis=0) == pytest.approx(np.full(dimension, points.min()))
    assert points.min() < 0.12
    assert points.max() > 0.9
    terms = richest_trend(points)
    assert len(np.unique(points, axis=0)) == len(points)
    assert np.linalg.matrix_rank(monomials(points, terms)) == len(terms)


def test_walls_need_a_width_and_a_baseline_effect_is_no_candidate(experiments, cases):
    chosen, left_out = applicable_effects(cases)
    assert "lateral_friction" in chosen
    assert not left_out
    wide = {"a": cases["s16_w0.1"].replace(**{"geometry.channel_width": inf})}
    chosen, left_out = applicable_effects(wide)
    assert "lateral_friction" not in chosen
    assert left_out["lateral_friction"] == "no experiment states a channel width"
    with_gate = {"a": cases["s16_w0.1"].replace(**{"effects.gate": {"delay": 0.01}})}
    assert applicable_effects(with_gate)[1] == {"gate": "the baseline has it already"}
    assert applicable_effects(cases, ["gate", "cohesion"])[0] == ["gate", "cohesion"]


def test_unknown_effect_is_refused(cases):
    with pytest.raises(InputError, match="--effects: found 'walls'; allowed: .*lateral_friction"):
        applicable_effects(cases, ["walls"])


# -- calibrated parameters and set-up ------------------------------------------------------------


def test_material_is_shared_and_set_up_is_not(experiments, cases):
    found = nuisances(experiments, cases)
    keys = [each.key for each in found]
    assert keys.count("rheology.mu_1") == 1
    assert found[0].experiments == tuple(one.name for one in experiments)
    assert found[0].sd == 0.012  # stated
    assert keys.count("geometry.slope_angle_deg") == 3
    assert keys.count("gate.speed") == 3
    assert "boundary.mu_bed" not in keys  # no slip


def test_a_common_error_of_the_set_up_is_one_quantity_of_all_experiments(experiments):
    tank = [
        dataclasses.replace(
            one, settings=replace(one.settings, common=Common(speed=True, height_0=True))
        )
        for one in experiments
    ]
    cases = baseline_cases(tank)
    found = {each.key: each for each in nuisances(tank, cases) if each.others}
    assert set(found) == {"gate.speed", "geometry.height_0"}
    names = tuple(one.name for one in tank)
    assert all(each.experiments == names for each in found.values())
    quantities = nuisances(tank, cases)
    z = [1.0 if quantity.key == "geometry.height_0" else 0.0 for quantity in quantities]
    drawn = [with_nuisances(cases[name], name, quantities, z).geometry.height_0 for name in names]
    assert all(
        height > case.geometry.height_0 for height, case in zip(drawn, cases.values(), strict=True)
    )
    alone = nuisances(tank[1:2], {names[1]: cases[names[1]]})
    own = [n for n, each in enumerate(quantities) if names[1] in each.experiments]
    assert np.array_equal(draw(quantities, 10)[:, own], draw(alone, 10))


def test_laws_without_inertial_number_have_no_mu_2(experiments):
    base = baseline_cases(experiments)["s16_w0.1"].replace(
        **{"rheology.law": "drucker_prager", "boundary.mu_bed": 0.4}
    )
    found = {each.key for each in nuisances(experiments[1:2], {"s16_w0.1": base})}
    assert {"rheology.mu_1", "boundary.mu_bed"} <= found
    assert not {"rheology.mu_2", "rheology.I_0"} & found


def test_draws_are_standard_normal_and_do_not_depend_on_the_company(experiments, cases):
    together, alone = nuisances(experiments, cases), nuisances(experiments[1:2], cases)
    z = draw(together, 40)
    assert z.shape == (40, len(together))
    assert z.mean(axis=0) == pytest.approx(np.zeros(len(together)), abs=1e-9)
    assert z.std(axis=0) == pytest.approx(np.ones(len(together)), abs=0.05)
    own = [n for n, each in enumerate(together) if "s16_w0.1" in each.experiments]
    assert np.array_equal(z[:, own], draw(alone, 40))
    assert not np.array_equal(draw(alone, 40, seed=1), draw(alone, 40))
    twins = [n for n, each in enumerate(together) if each.key == "geometry.slope_angle_deg"]
    assert not np.array_equal(z[:, twins[1]], z[:, twins[2]])  # 16 degrees twice


def test_a_case_with_drawn_quantities(experiments, cases):
    found, base = nuisances(experiments, cases), cases["s10_w0.1"]
    z = np.zeros(len(found))
    assert with_nuisances(base, "s10_w0.1", found, z).rheology == base.rheology
    column = {each.key: n for n, each in enumerate(found) if "s10_w0.1" in each.experiments}
    z[column["rheology.mu_1"]], z[column["geometry.length_0"]] = 2.0, -1.0
    case = with_nuisances(base, "s10_w0.1", found, z)
    assert case.rheology.mu_1 == pytest.approx(0.45 * np.exp(2 * 0.012 / 0.45))
    ratio = case.geometry.length_0 / base.geometry.length_0
    assert ratio < 1.0
    assert case.grid.cell_size / base.grid.cell_size == pytest.approx(ratio)
    assert case.grid.cell_size_z == pytest.approx(base.grid.cell_size)
    other = with_nuisances(cases["s16_w0.1"], "s16_w0.1", found, z)
    assert other.rheology.mu_1 == case.rheology.mu_1  # one material
    assert other.geometry.length_0 == 0.2


def test_mu_2_stays_above_mu_1(experiments, cases):
    base = cases["s10_w0.1"].replace(**{"rheology.mu_2": 0.451})
    found = nuisances(experiments[:1], {"s10_w0.1": base})
    z = np.array([3.0 if each.key == "rheology.mu_1" else 0.0 for each in found])
    case = with_nuisances(base, "s10_w0.1", found, z)
    assert case.rheology.mu_2 == case.rheology.mu_1 > 0.451


def test_a_slope_is_never_negative():
    level = Nuisance("geometry.slope_angle_deg", ("a",), 0.0, 0.2)
    assert level.value(-1.0) == pytest.approx(0.2)
    assert level.realised(-1.0) == pytest.approx(1.0)
    steep = level._replace(mean=29.9, sd=1.0)
    assert steep.value(3.0) == 30.0
    assert steep.realised(3.0) == pytest.approx(0.1)
