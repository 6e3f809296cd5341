"""What a case says in TOML, it reads back; every key says what it is; overrides equal a file."""

import math
import pickle
from pathlib import Path

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given

from fvcollapse.case.case import Case, case_from_text, describe_keys, load_case
from fvcollapse.errors import CaseError

ROOT = Path(__file__).resolve().parents[2]


def refusal(call, *arguments, **options):
    """The error that refuses the arguments; None if they are accepted."""
    try:
        call(*arguments, **options)
    except CaseError as error:
        return error
    return None


def number(low, high, **options):
    """Numbers of a range, integers among them, as users write them."""
    return st.floats(low, high, **options) | st.integers(math.ceil(low), math.floor(high))


friction = number(0, 10) | st.just(math.inf)
CHANGES = st.fixed_dictionaries(
    {},
    optional={
        "geometry.slope_angle_deg": number(0, 30),
        "geometry.height_0": number(0.1, 2),
        "geometry.length_0": number(0.1, 2),
        "geometry.channel_width": number(1e-6, 5) | st.just(math.inf),
        "grid.cell_size": st.floats(0.002, 0.02),
        "grid.cell_size_z": st.floats(0.002, 0.02),
        "rheology.law": st.sampled_from(["mu_I", "drucker_prager", "bingham", "newtonian"]),
        "rheology.mu_1": number(0, 0.7),
        "rheology.density_bulk": number(1, 2500),
        "rheology.grain_diameter": st.floats(1e-9, 1),
        "boundary.mu_bed": friction,
        "boundary.mu_back_wall": friction,
        "boundary.right_end": st.sampled_from(["grow", "open", "error", "wall"]),
        "boundary.domain_length": number(3, 20),
        "gate.speed": friction,
        "time.output_times": st.lists(number(0, 100), max_size=4),
        "time.step_max": st.floats(2.5e-6, 0.1),
        "numerics.unilateral": st.booleans(),
        "numerics.max_sweeps": st.integers(1, 1000),
        "effects.lateral_friction": st.just({}),
        "effects.lateral_friction.mu_wall": number(0, 10),
        "effects.lateral_friction.closure": st.sampled_from(["sink", "friction_increase"]),
    },
).filter(lambda changes: refusal(Case().replace, **changes) is None)  # some make too many cells


@given(CHANGES)
def test_case_equals_what_its_toml_reads_back(changes):
    case = Case().replace(**changes)
    again = case_from_text(case.to_toml())
    assert again == case
    assert again.to_toml() == case.to_toml()
    assert pickle.loads(pickle.dumps(case)) == case


@given(CHANGES)
def test_overrides_equal_a_file(changes):
    changes.pop("effects.lateral_friction", None)
    case = Case().replace(**changes)
    spelled = {
        name: str(value).replace("True", "true").replace("False", "false")
        for name, value in changes.items()
    }
    overrides = [f"{name}={value}" for name, value in spelled.items()]
    assert case_from_text("", overrides=overrides) == case


@given(st.floats(0.1, 2), st.floats(0.1, 2), st.integers(3, 12), st.randoms())
def test_convex_polygon_is_accepted_and_reads_back(width, height, count, random):
    angles = sorted(random.uniform(0, 2 * math.pi) for _ in range(count))
    angles = [2 * math.pi * (n + 0.5 * angle / 7) / count for n, angle in enumerate(angles)]
    polygon = [[width * (1 + math.cos(a)), height * (1 + math.sin(a))] for a in angles]
    changes = {"geometry.polygon": polygon, "gate.speed": math.inf, "grid.cell_size": 0.01}
    case = Case().replace(**changes)
    assert case.geometry.polygon == tuple(map(tuple, polygon))
    assert case_from_text(case.to_toml()) == case
    star = polygon[::2] + polygon[1::2]  # the vertices in an order that crosses over, from 5 on
    if count >= 5:
        with pytest.raises(CaseError, match="edges"):
            Case().replace(**changes | {"geometry.polygon": star})


@given(st.text() | st.binary().map(lambda data: data.decode("latin-1")))
def test_any_text_is_a_case_or_one_line(text):
    assert "\n" not in str(refusal(case_from_text, text))


@given(st.text(), st.text())
def test_any_override_is_a_case_or_one_line(path, value):
    for override in (f"{path}={value}", f"geometry.{path}={value}", f"geometry.height_0={value}"):
        assert "\n" not in str(refusal(case_from_text, "", overrides=[override]))


def test_every_key_has_unit_range_default_and_meaning():
    keys = describe_keys()
    assert len({info.name for info in keys}) == len(keys) >= 40
    for info in keys:
        assert all(text and text == " ".join(text.split()) for text in info), info
        assert not info.description.endswith(".")
        assert len(info.description) <= 80, info


def test_every_default_of_the_table_is_the_default():
    overrides = [
        f"{info.name}={info.default}"
        for info in describe_keys()
        if info.default != "absent" and not info.name.startswith("effects.")
    ]
    assert len(overrides) > 30
    assert case_from_text("", overrides=overrides) == Case()


def test_empty_case_is_the_default_case():
    case = case_from_text("")
    assert case == Case()
    assert case.effects.lateral_friction is None
    assert (case.geometry.slope_angle_deg, case.geometry.channel_width) == (22, 0.10)


def test_empty_section_switches_the_effect_on():
    assert case_from_text("[effects.lateral_friction]").effects.lateral_friction.mu_wall == 0.18


def test_reference_case_is_the_default_with_lateral_friction():
    case = load_case(ROOT / "runs" / "collapse_22deg_w10cm.toml")
    assert case == Case().replace(**{"effects.lateral_friction": {}})


def test_byte_order_mark_is_no_error(tmp_path):
    path = tmp_path / "case.toml"
    path.write_bytes(b"\xef\xbb\xbf[time]\nend = 1\n")
    assert load_case(path).time.end == 1


def test_replace_takes_numpy_and_none():
    case = Case().replace(
        **{"grid.cell_size": np.float64(0.004), "time.output_times": np.arange(3)}
    )
    assert case.grid.cell_size == 0.004
    assert case.time.output_times == (0.0, 1.0, 2.0)
    assert "0.004\n" in case.to_toml()
    assert case.replace(**{"grid.cell_size": None, "time.output_times": None}) == Case()
    friction = case.replace(**{"effects.lateral_friction": {"mu_wall": 0.2}})
    assert friction.effects.lateral_friction.mu_wall == 0.2
    assert friction.replace(**{"effects.lateral_friction": None}) == case


def test_case_cannot_be_changed():
    with pytest.raises(AttributeError):
        Case().geometry.height_0 = 1.0


@pytest.mark.parametrize("key", ["geometry.hieght_0", "effects.friction", "grid"])
def test_replace_refuses(key):
    with pytest.raises(CaseError) as caught:
        Case().replace(**{key: 1})
    assert caught.value.key == key
