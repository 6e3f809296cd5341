"""What is hidden in a synthetic case: cause, strength and closure, in the world that it belongs to; drawn, not run.

A label is a tree of plain numbers from which the case can be made again. It is a function of a seed, a
class, a style and a world, so that a suite can be continued.
"""

from collections.abc import Mapping, Sequence
from copy import deepcopy
from typing import Any

import numpy as np

from fvcollapse.blind.causes import Style, draw_effect, draw_pair
from fvcollapse.blind.other_closure import draw_form
from fvcollapse.blind.outside import UNKNOWNS
from fvcollapse.blind.plain_values import Drawn, Form, Keys, Label, Outside, Run, World
from fvcollapse.blind.set_ups import CONTROL, STATEMENTS, SetUp, set_up_of
from fvcollapse.blind.worlds import draw_world, folded, numerics_keys
from fvcollapse.case.case import Case
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.errors import CaseError

TRIES = 200  # of values that fit together
PROFILE_INTERVAL = 0.015  # s
END_MARGIN = 0.03  # s after the last frame
CLOCK_MARGIN = 1.15  # factor on the end where a clock may be slow


class NoDrawError(ValueError):
    """No draw of a cause or of a world fits together."""


def drawn_world(
    name: str, style: Style, seed: int, cells: tuple[float, float] | None = None
) -> World:
    """A world (see `worlds.draw_world`) with its `controls`: {name: run}, as the experiments of a label.

    Raises
    ------
    NoDrawError
    """
    for attempt in range(TRIES):
        world = draw_world(name, style, [seed, attempt], cells)
        rng = np.random.default_rng([seed, attempt, 1])
        try:
            return world | {
                "controls": {
                    CONTROL + place: draw_run(set_up_of(place), {}, {}, world, rng)
                    for place in world["set_ups"]
                }
            }
        except CaseError:  # values that cannot be together
            continue
    raise NoDrawError(f"{TRIES} draws of {name} do not fit together")


def draw_label(
    cause: str, style: Style, seed: int, world: World, design: Sequence[str] | None = None
) -> Label:
    """The label of a case.

    Parameters
    ----------
    cause : str
        "none", "unknown", an effect, or two joined by "+".
    style : Style
    seed : int
    world : dict
        See `drawn_world`; it has no effect of the cause.
    design : sequence of str, optional
        Keys of `SET_UPS`; default: drawn of `style.designs`.

    Returns
    -------
    dict
        `cause`, `unknown_kind` (None unless unknown), `effects` {name: `draw_effect`}, `form` (of the response to
        them; None: that of the catalogue), `outside`, `world`, and `draw_run` for each of the `experiments`.

    Raises
    ------
    NoDrawError
    """
    for attempt in range(TRIES):
        rng = np.random.default_rng([seed, attempt])
        try:
            return try_label(cause, style, rng, world, design)
        except CaseError:  # values that cannot be together
            continue
    raise NoDrawError(f"{TRIES} draws for {cause} do not fit together")


def draw_fitting_label(cause: str, style: Style, seed: int, world: World) -> Label:
    """As `draw_label`; where every draw of two effects is refused in a world, two others are drawn.

    Raises
    ------
    NoDrawError
        A cause that is not two effects, or no two effects, fit.
    """
    others = np.random.default_rng([seed, TRIES])  # no attempt of `draw_label` has it
    for _ in range(TRIES):
        try:
            return draw_label(cause, style, seed, world)
        except NoDrawError:
            if "+" not in cause:
                raise
        cause = draw_pair(others)
        while set(cause.split("+")) & set(world["effects"]):
            cause = draw_pair(others)
    raise NoDrawError(f"no two effects fit in {world['name']}")


def try_label(
    cause: str, style: Style, rng: np.random.Generator, world: World, design: Sequence[str] | None
) -> Label:
    """One draw of a label.

    Raises
    ------
    CaseError
    """
    names = design or style.designs[rng.integers(len(style.designs))]
    geometry = Case().replace(**set_up_of(names[0]).stated()).geometry
    kind = str(rng.choice(style.unknowns)) if cause == UNKNOWN else None
    outside = UNKNOWNS[kind](rng, geometry) if kind else {}
    chosen = () if cause in (NONE, UNKNOWN) else cause.split("+")
    effects = {name: draw_effect(name, style, rng) for name in chosen}
    form = None
    if effects and rng.random() < style.other_closures:
        form = draw_form(rng, style.form_waves, style.error_lengths)
    runs = {name: draw_run(set_up_of(name), effects, outside, world, rng, form) for name in names}
    return {
        "cause": cause,
        "unknown_kind": kind,
        "effects": effects,
        "form": form,
        "outside": outside,
        "world": world,
        "experiments": runs,
    }


def draw_added(label: Label, set_up: SetUp, seed: Sequence[int]) -> Run:
    """One more run of a case whose label is drawn: the same cause in the same world, in another `SetUp`.

    Raises
    ------
    NoDrawError
    """
    for attempt in range(TRIES):
        rng = np.random.default_rng([*seed, attempt])
        try:
            hidden = label["effects"], label["outside"], label["world"]
            return draw_run(set_up, *hidden, rng, label["form"])
        except CaseError:  # values that cannot be together
            continue
    raise NoDrawError(f"{TRIES} draws of {set_up} do not fit together")


def draw_run(
    set_up: SetUp,
    effects: Mapping[str, Drawn],
    outside: Outside,
    world: World,
    rng: np.random.Generator,
    form: Form | None = None,
) -> Run:
    """One run of a world: `case`, `forces`, `readings` and `noise`; with a form of the response, `without` and `form`.

    Parameters
    ----------
    set_up : SetUp
    effects : dict
        Effect -> `draw_effect`, beside those of the world.
    outside : dict
        A cause outside the catalogue; see `outside.UNKNOWNS`.
    world : dict
    rng : numpy.random.Generator
    form : dict, optional
        Form of the response to the effects; default: that of the catalogue.

    Raises
    ------
    CaseError
    """
    sections = {name: drawn["section"] for name, drawn in effects.items()}
    plain = deepcopy(rng)  # the same errors of the set-up
    run: Run = {
        "case": draw_truth(set_up, sections, outside, world, rng).to_toml(),
        "forces": [*world["forces"], *outside.get("forces", ())],
        "readings": [*world["readings"], *outside.get("readings", ())],
        "noise": int(rng.integers(2**63)),
    }
    if form is not None:
        run["without"] = draw_truth(set_up, {}, outside, world, plain).to_toml()
        run["form"] = form
    return run


def draw_truth(
    set_up: SetUp,
    sections: dict[str, Keys],
    outside: Outside,
    world: World,
    rng: np.random.Generator,
) -> Case:
    """The `Case` of one run: the set-up as it really was."""
    stated, common = set_up.stated(), world["common"]
    slow_clock = any(reading["kind"] == "clock" for reading in outside.get("readings", ()))
    end = (CLOCK_MARGIN if slow_clock else 1.0) * set_up.end + END_MARGIN
    changes: dict[str, Any] = stated | world["material"] | numerics_keys(world["numerics"], set_up)
    for key, sd in STATEMENTS[world["statement"]].sd.items():
        if key in common:
            changes[key] = abs(stated[key] + sd * common[key])
        else:
            changes[key] = folded(rng, stated[key], sd)
    changes |= {f"effects.{name}": keys for name, keys in (world["effects"] | sections).items()}
    changes |= {
        "geometry.channel_width": set_up.width,
        "time.end": end,
        "time.output_interval": PROFILE_INTERVAL,
        "time.field_interval": end,
    }
    if "channel_end" in outside:
        changes |= {
            "boundary.right_end": "open",
            "boundary.domain_length": outside["channel_end"],
        }
    if "polygon" in outside:
        changes["geometry.polygon"] = stretched(outside["polygon"], changes)
    return Case().replace(**changes)


def stretched(
    polygon: Sequence[Sequence[float]], changes: Mapping[str, float]
) -> list[list[float]]:
    """A polygon, drawn for a column, for the column that was set up."""
    length = max(x for x, _ in polygon)
    area = sum(
        0.5 * (x * next_z - next_x * z)
        for (x, z), (next_x, next_z) in zip(polygon, [*polygon[1:], polygon[0]], strict=True)
    )
    height = abs(area) / length
    size = changes["geometry.length_0"] / length, changes["geometry.height_0"] / height
    return [[size[0] * x, size[1] * z] for x, z in polygon]
