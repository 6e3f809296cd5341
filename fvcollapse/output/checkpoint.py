"""checkpoint.h5: state and record of a run, from which it continues bit for bit.

Same groups as in a result, and /state with every entry of the tables `FIELDS` and `SCALARS`.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import h5py

from fvcollapse.case.case import case_from_text
from fvcollapse.errors import CaseError, InputError
from fvcollapse.files.hdf5 import build_image, reading, text_attribute, write_dataset
from fvcollapse.output.record_layout import FORMAT_VERSION, check_header, read_record
from fvcollapse.output.recorder import Recorder
from fvcollapse.output.stored_numbers import group_of, number_of, numbers_of, refuse
from fvcollapse.step.state import EFFECT_FIELDS, FIELDS, SCALARS, State, location_shape
from fvcollapse.version import __version__

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


FORMAT = "fvcollapse-checkpoint"
WHOLE = ("step",)  # scalars that count; the others are measured
NOT_NEGATIVE = ("time", "step", "dt", "volume_0", "volume_correction", "travel")


class Checkpoint(NamedTuple):
    """State and record from which a run continues; nothing else influences its further course."""

    state: State
    recorder: Recorder
    case_text: str
    code_version: str


def write_header(file: h5py.File, kind: str, case: "Case") -> None:
    """Root attributes common to results and checkpoints."""
    file.attrs["format"] = kind
    file.attrs["format_version"] = FORMAT_VERSION
    file.attrs["case"] = case.to_toml()
    file.attrs["code_version"] = __version__


def checkpoint_image(case: "Case", state: State, recorder: Recorder) -> bytes:
    """The checkpoint as bytes."""

    def fill(file):
        write_header(file, FORMAT, case)
        recorder.write(file)
        write_state(file.create_group("state"), state)

    return build_image(fill)


def write_state(group: h5py.Group, state: State) -> None:
    """Every field as a dataset, every scalar as an attribute (float64 and int64 keep every bit)."""
    for name, (_, units, description, *_) in FIELDS.items():
        write_dataset(group, name, getattr(state, name), units, description)
    for name in state.effect_fields():
        _, _, units, description = EFFECT_FIELDS[name]
        write_dataset(group, name, getattr(state, name), units, description)
    for name in SCALARS:
        group.attrs[name] = getattr(state, name)


def read_state(file: h5py.File) -> State:
    """The state that `write_state` stored in an open file; InputError names what is wrong in it."""
    group = group_of(file, "state")
    locations = {name: location for name, (location, *_) in FIELDS.items()}
    locations |= {name: EFFECT_FIELDS[name][1] for name in EFFECT_FIELDS if name in group}
    nodes = numbers_of(file, "state/level_set", (None, None), kinds="f").shape
    if min(nodes) < 2:
        refuse(file, "state/level_set", f"an array of the shape {nodes}", "at least one cell")
    fields = {}
    for name, location in locations.items():
        shape = location_shape(location, nodes[0] - 1, nodes[1] - 1)
        fields[name] = numbers_of(file, f"state/{name}", shape, kinds="f").astype(float, copy=False)
    return State(**fields, **{name: read_scalar(file, name) for name in SCALARS})


def read_scalar(file: h5py.File, name: str) -> Any:
    """A scalar of the state."""
    limits = (0.0, float("inf")) if name in NOT_NEGATIVE else (-float("inf"), float("inf"))
    value = number_of(file, "state", name, limits, kinds="iu" if name in WHOLE else "f")
    if name == "volume_0" and value == 0.0:
        refuse(file, "state.volume_0", "0", "a volume > 0")
    return value


def read_checkpoint(path: str | Path) -> Checkpoint:
    """The checkpoint at `path`; a missing, broken or inconsistent one is one InputError."""
    with reading(path, FORMAT) as file:
        check_header(file)
        text, version = text_attribute(file, "case"), text_attribute(file, "code_version")
        case = stored_case(text, path)
        read_record(file, case, complete_fields=True)
        stored = Checkpoint(read_state(file), Recorder.read(file), text, version)
        refuse_other_end(file, stored)
    carried = {name for name, about in EFFECT_FIELDS.items() if getattr(case.effects, about[0])}
    if carried != set(stored.state.effect_fields()):
        found = ", ".join(stored.state.effect_fields()) or "none"
        raise InputError(path, "fields of the effects", found, ", ".join(sorted(carried)) or "none")
    return stored


def stored_case(text: str, path: str | Path) -> "Case":
    """The case in a checkpoint."""
    try:
        return case_from_text(text, path)
    except CaseError as error:
        raise InputError(path, "case", str(error), "a case that this version reads") from None


def refuse_other_end(file: h5py.File, stored: Checkpoint) -> None:
    """Refuse a record that does not end at the state."""
    state, recorder = stored.state, stored.recorder
    rows, last, width = len(recorder.series["time"]), recorder.series["time"][-1], len(recorder.x)
    if last != state.time:
        refuse(file, "state.time", f"{state.time:g}", f"{last:g}, where the record ends")
    if rows - 1 != state.step:
        refuse(file, "state.step", f"{state.step}", f"{rows - 1}, the steps of the record")
    if width > len(state.level_set):
        nodes = len(state.level_set)
        refuse(file, "profiles/x", f"{width} places", f"at most {nodes}, as the state has")
