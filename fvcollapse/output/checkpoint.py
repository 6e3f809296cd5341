"""checkpoint.h5: state and record of a run, from which it continues bit for bit.

Same groups as in a result, and /state with every entry of the tables `FIELDS` and `SCALARS`.
"""

from typing import NamedTuple

from fvcollapse.case.case import case_from_text
from fvcollapse.errors import CaseError, InputError
from fvcollapse.files.storage import build_image, reading, text_attribute, write_dataset
from fvcollapse.output.recorder import Recorder
from fvcollapse.step.state import EFFECT_FIELDS, FIELDS, SCALARS, State, location_shape
from fvcollapse.version import __version__

FORMAT = "fvcollapse-checkpoint"
FORMAT_VERSION = 1


class Checkpoint(NamedTuple):
    """State and record from which a run continues; nothing else influences its further course."""

    state: State
    recorder: Recorder
    case_text: str
    code_version: str


def write_header(file, kind, case):
    """Root attributes common to results and checkpoints."""
    file.attrs["format"] = kind
    file.attrs["format_version"] = FORMAT_VERSION
    file.attrs["case"] = case.to_toml()
    file.attrs["code_version"] = __version__


def checkpoint_image(case, state, recorder):
    """The checkpoint as bytes."""

    def fill(file):
        write_header(file, FORMAT, case)
        recorder.write(file)
        write_state(file.create_group("state"), state)

    return build_image(fill)


def write_state(group, state):
    """Every field as a dataset, every scalar as an attribute (float64 and int64 keep every bit)."""
    for name, (_, units, description, *_) in FIELDS.items():
        write_dataset(group, name, getattr(state, name), units, description)
    for name in state.effect_fields():
        _, _, units, description = EFFECT_FIELDS[name]
        write_dataset(group, name, getattr(state, name), units, description)
    for name in SCALARS:
        group.attrs[name] = getattr(state, name)


def read_state(group):
    """The state that `write_state` stored."""
    locations = {name: location for name, (location, *_) in FIELDS.items()}
    locations |= {name: EFFECT_FIELDS[name][1] for name in EFFECT_FIELDS if name in group}
    fields = {name: group[name][:] for name in locations}
    nodes = fields["level_set"].shape
    for name, location in locations.items():
        if fields[name].shape != location_shape(location, nodes[0] - 1, nodes[1] - 1):
            raise ValueError(f"{name} has the wrong shape")
    return State(**fields, **{name: group.attrs[name].item() for name in SCALARS})


def read_checkpoint(path):
    """The checkpoint at `path`; a missing, broken or inconsistent one is one InputError."""
    with reading(path, FORMAT) as file:
        text, version = text_attribute(file, "case"), text_attribute(file, "code_version")
        stored = Checkpoint(read_state(file["state"]), Recorder.read(file), text, version)
        if stored.recorder.series["time"][-1] != stored.state.time:
            raise ValueError("the record does not end at the state")
    try:
        case = case_from_text(text, path)
    except CaseError as error:
        raise InputError(path, "case", str(error), "a case that this version reads") from None
    carried = {name for name, about in EFFECT_FIELDS.items() if getattr(case.effects, about[0])}
    if carried != set(stored.state.effect_fields()):
        found = ", ".join(stored.state.effect_fields()) or "none"
        raise InputError(path, "fields of the effects", found, ", ".join(sorted(carried)) or "none")
    return stored
