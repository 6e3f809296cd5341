"""What each picture of a result shows, in words: the text files beside the pictures."""

from math import isclose
from textwrap import fill
from typing import Any

import numpy as np

from fvcollapse.case.words import set_up_words
from fvcollapse.draw.animation import FRAME_TIME, slow_motion
from fvcollapse.draw.drawing import chosen_times
from fvcollapse.draw.figures import (
    EXAGGERATION,
    FIELD_PROGRESS,
    PROFILE_PROGRESS,
    RETREAT,
    retreat,
)
from fvcollapse.draw.grains import DECADES, scale_of
from fvcollapse.draw.look import Look
from fvcollapse.step.grid import spacing

LINE = 100  # characters
COLOURS = {
    "linear": "Colours are linear from 0 to the largest value in the grains",
    "root": "Colours follow the root of the value, so that small values show, from 0 to the largest",
    "logarithmic": f"Colours are logarithmic over {DECADES} decades below the largest value",
}


def caption(result: Any, what: str, look: Look) -> str:
    """The caption of a picture: what it shows, when, at which scales, of which run."""
    sentences = {
        "profiles": profiles_words,
        "interface": interface_words,
        "front": front_words,
        "volume": volume_words,
        "animation": animation_words,
    }.get(what, lambda result, look: field_words(result, what, look))
    text = " ".join([*sentences(result, look), run_words(result)])
    return fill(text, LINE) + "\n"


def run_words(result: Any) -> str:
    """The run in a sentence."""
    case = result.case
    dx, dz = (1000.0 * size for size in spacing(case.resolved))
    size = f"{dx:.4g} mm" if isclose(dx, dz) else f"{dx:.4g} x {dz:.4g} mm"
    return f"Run: {set_up_words(case)}, cells of {size}. Trust: {result.trust.words}."


def frame_words(look: Look) -> str:
    """The frame in a sentence."""
    if look.upright:
        return "Lengths and heights have equal scales; gravity points down and the bed is inclined."
    return "Lengths and heights have equal scales; x is along the bed, the arrow g is gravity."


def times_words(times: np.ndarray) -> str:
    """Times in words."""
    return f"t = {', '.join(f'{time:.3g}' for time in times)} s"


def reason_words(progress: tuple[float, ...], look: Look) -> str:
    """Why the picture shows these times."""
    if look.times:
        return "They are the stored times nearest to those that were asked for."
    parts = ", ".join(f"{100.0 * part:g}" for part in progress[:-1])
    return f"They are the times at which the front has gone {parts} % of its way, and the last."


def profiles_words(result: Any, look: Look) -> list[str]:
    """Of the thickness profiles."""
    times = result.profiles.time
    chosen = chosen_times(result, times, PROFILE_PROGRESS, look.times)
    return [
        f"Thickness normal to the bed at {times_words(times[chosen])}, dark to light.",
        reason_words(PROFILE_PROGRESS, look),
        f"Heights are exaggerated {EXAGGERATION:g} times.",
    ]


def interface_words(result: Any, look: Look) -> list[str]:
    """Of the static and flowing parts."""
    times = result.profiles.time
    chosen = chosen_times(result, times, FIELD_PROGRESS, look.times)
    return [
        f"Static (grey) and flowing (light, faster than 0.01 m/s) grains at {times_words(times[chosen])}.",
        reason_words(FIELD_PROGRESS, look),
        "The orange line is the gate.",
        frame_words(look),
    ]


def front_words(result: Any, look: Look) -> list[str]:
    """Of the front; why it runs back, where it does."""
    limit = 1000.0 * result.case.front.thickness
    words = [
        f"Above: front (first x where the layer is thinner than {limit:g} mm), the farthest places that"
        " layers of 1 and 10 mm have reached, and the place behind which 99 % of the volume lies.",
        "Below: slope of the front over a window of 40 ms.",
    ]
    if retreat(result) >= RETREAT:
        words.append(
            f"The front ends {1000.0 * retreat(result):.0f} mm behind its farthest place: the tip goes on"
            f" and thins below {limit:g} mm. No grain runs back."
        )
    return words


def volume_words(result: Any, look: Look) -> list[str]:
    """Of the volume."""
    return [
        "Above: relative change of the volume of the grains.",
        "Below: running sum of the absolute corrections of the volume, and the part of the volume beyond"
        " the first place where the layer is thinner than 1 mm.",
    ]


def field_words(result: Any, name: str, look: Look) -> list[str]:
    """Of a field."""
    chosen = chosen_times(result, result.field_times, FIELD_PROGRESS, look.times)
    scale = scale_of(name)
    return [
        f"{scale.label[0].upper()}{scale.label[1:]} at {times_words(result.field_times[chosen])}.",
        reason_words(FIELD_PROGRESS, look),
        f"{COLOURS[scale.law]}.",
        "The black line is the free surface, the orange one the gate.",
        frame_words(look),
    ]


def animation_words(result: Any, look: Look) -> list[str]:
    """Of the animation."""
    return [
        f"Speed of the grains, {1.0 / FRAME_TIME:.1f} frames per second,"
        f" slowed down {slow_motion(result):.2g} times.",
        "Each frame is a stored profile of the thickness.",
        "The speed is stored less often; between two stored fields it is interpolated.",
        f"{COLOURS['root']}.",
        frame_words(look),
    ]
