"""Effects that carry a field: together, in the files, through a checkpoint, and where they are refused."""

import h5py
import pytest
from effect_runs import COLUMN, collapse
from same_result import differences

from fvcollapse.case.case import Case
from fvcollapse.errors import CaseError, InputError
from fvcollapse.output import run as output
from fvcollapse.output.checkpoint import read_checkpoint
from fvcollapse.step.state import EFFECT_FIELDS

EFFECTS = {
    "dilatancy": {"dilatancy_factor": 4.0},
    "friction_hysteresis": {"delta_mu": 0.04},
    "nonlocal": {"A": 0.5},
}
ALL = {f"effects.{name}": keys for name, keys in EFFECTS.items()}


def case_with(effects, **changes):
    return Case().replace(**COLUMN, **effects, **{"effects.lateral_friction": {}}, **changes)


def test_resumed_run_with_all_of_them_is_the_same_to_the_last_bit_and_shows_their_fields(tmp_path):
    case = case_with(ALL, **{"time.end": 0.1})
    output.run_case(case, tmp_path / "whole", quiet=True)
    output.run_case(case.replace(**{"time.end": 0.04}), tmp_path / "parts", quiet=True)
    output.run_case(case, tmp_path / "parts", resume=True, quiet=True)
    for name in ("result.h5", "checkpoint.h5"):
        assert differences(tmp_path / "whole" / name, tmp_path / "parts" / name) == []
    with h5py.File(tmp_path / "whole" / "result.h5") as file:
        for name, (_, _, units, description) in EFFECT_FIELDS.items():
            field = file["fields/1"][name]
            assert field.attrs["units"] == units
            assert field.attrs["description"] == description
            assert field.shape == file["fields/1/pressure"].shape
        assert file["fields/0/solid_fraction"][0, 0] == 0.62
        assert file["fields/1/fluidity"][:].max() > 1.0


def test_each_of_them_changes_the_flow_of_the_others():
    def run(*names):
        return collapse(0.1, **{f"effects__{name}": EFFECTS[name] for name in names}).state.u

    both = run("dilatancy", "friction_hysteresis")
    all_three = run(*EFFECTS)
    assert abs(both - run("dilatancy")).max() > 1e-4
    assert abs(both - run("friction_hysteresis")).max() > 1e-4
    assert abs(all_three - both).max() > 1e-4


def test_a_checkpoint_of_other_effects_is_refused(tmp_path):
    output.run_case(case_with({}, **{"time.end": 0.002}), tmp_path, quiet=True)
    with h5py.File(tmp_path / "checkpoint.h5", "r+") as file:
        file["state"].create_dataset("solid_fraction", data=file["state/pressure_filled"][:])
    with pytest.raises(InputError, match="fields of the effects"):
        read_checkpoint(tmp_path / "checkpoint.h5")


@pytest.mark.parametrize("name", EFFECTS)
@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("numerics.method", "projection"),
        ("rheology.law", "newtonian"),
        ("rheology.law", "mu_I_regularised"),
    ],
)
def test_refused_where_it_cannot_act(name, key, value):
    with pytest.raises(CaseError) as caught:
        Case().replace(**{f"effects.{name}": EFFECTS[name], key: value})
    assert caught.value.key == key
