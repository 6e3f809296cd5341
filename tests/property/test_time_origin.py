"""The observation operator treats both sides alike."""

import hypothesis.strategies as st
import numpy as np
import pytest
from experiment_folder import SETTINGS, write_experiment
from fake_simulation import FakeSimulation
from hypothesis import given, settings

from fvcollapse import load_experiment, observe
from fvcollapse.case.case import Case
from fvcollapse.measure.align import align
from fvcollapse.output import run as output

TIMES = (0.0, 0.013, 0.1, 0.19)


@pytest.fixture(scope="module")
def result():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(output, "Simulation", FakeSimulation)
        return output.run(Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.4}))


def experiment_at(folder, shift):
    """The same measurements on a clock that started `shift` seconds later."""
    front = "t_s,x_front_m\n" + "".join(f"{t - shift!r},0.3\n" for t in TIMES)
    volume = "t_s,relative_volume_change\n" + "".join(f"{t - shift!r},0.01\n" for t in TIMES)
    rows = "".join(f"{t - shift!r},{x},0.1\n" for t in TIMES for x in (0.05, 0.31))
    return load_experiment(
        write_experiment(
            folder,
            SETTINGS + f"[time]\norigin = {shift!r}\n",
            front=front,
            volume=volume,
            profiles="t_s,x_m,h_m\n" + rows,
            interface="t_s,x_m,z_static_m\n" + rows,
            scalars=f"name,value\ntime_stop,{0.19 - shift!r}\nrunout,0.5\n",
        )
    )


@settings(max_examples=20)
@given(shift=st.floats(-0.5, 0.5))
def test_shifting_the_time_origin_shifts_both(result, tmp_path_factory, shift):
    folder = tmp_path_factory.mktemp("shifted")
    plain, shifted = experiment_at(folder / "a", 0.0), experiment_at(folder / "b", shift)
    before = align(observe(result, plain), plain)
    after = align(observe(result, shifted), shifted)
    assert [each.name for each in before] == [each.name for each in after]
    for one, other in zip(before, after, strict=True):
        np.testing.assert_allclose(one.gap, other.gap, atol=1e-9)
        np.testing.assert_allclose(one.time, other.time + shift, atol=1e-9)


@settings(max_examples=20)
@given(shift=st.floats(0.001, 0.1))
def test_origin_of_one_side_alone_moves_the_simulated_curve(result, tmp_path_factory, shift):
    """t = 0 of the experiment later: its first picture meets a later simulated state."""
    plain = experiment_at(tmp_path_factory.mktemp("plain"), 0.0)
    front = align(observe(result, plain, time_origin=shift), plain)[0]
    series = observe(result, plain).front
    np.testing.assert_allclose(
        front.simulated, np.interp(np.add(TIMES, shift), *series.T), atol=1e-9
    )


@settings(max_examples=20)
@given(thickness=st.floats(0.001, 0.05))
def test_thicker_threshold_reads_a_shorter_front(result, thickness):
    thin = observe(result, front_thickness=thickness).front
    thick = observe(result, front_thickness=1.5 * thickness).front
    assert (thick[:, 1] <= np.interp(thick[:, 0], *thin.T) + 1e-9).all()
    assert thick[-1, 1] < thin[-1, 1]
