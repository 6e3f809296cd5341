"""Measured quantities: what an experimenter would read off the grains, apart from the dynamics.

On an erodible bed all heights and the column volumes are measured from the initial surface of the
layer: a run reports the pile, and an eroded place has a negative height. See `pile` for one instant.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.draw.html import html_table
from fvcollapse.files.labelled import tree
from fvcollapse.measure.labels import labelled_rows
from fvcollapse.measure.observation import seen_front, seen_place, seen_time_origin
from fvcollapse.measure.pile import front_position
from fvcollapse.measure.quantities import CURVES, SCALAR_UNITS, observable_words
from fvcollapse.measure.series_readings import arrest_time, front_velocity, peak_front_velocity

if TYPE_CHECKING:
    import xarray

    from fvcollapse.case.case import Case
    from fvcollapse.draw.drawing import Picture
    from fvcollapse.output.result import Result


@dataclass(frozen=True)
class Observations:
    """Simulated quantities in the form of an experiment folder; SI units.

    `front` (n, 2) is time and position; `profiles` and `interface` (n, 3) are time, x and height;
    `volume` (n, 2) is time and relative change; `scalars` maps the names of `quantities.SCALAR_UNITS`
    to a number (time_stop None: still moving).
    """

    front: np.ndarray
    profiles: np.ndarray
    volume: np.ndarray
    interface: np.ndarray
    scalars: dict

    def plot(self) -> "Picture":
        """Front, volume, profiles and interface as a figure, which a notebook shows."""
        from fvcollapse.draw.curves import draw_observables  # loads matplotlib

        return draw_observables(self)

    def to_xarray(self) -> "xarray.DataTree":
        """The curves as labelled arrays with units, one group each; the numbers as attributes.

        Raises
        ------
        ImportError
            xarray is not installed.
        """
        groups = {name: labelled_rows(name, getattr(self, name)) for name in CURVES}
        return tree(
            groups, {name: value for name, value in self.scalars.items() if value is not None}
        )

    def __repr__(self) -> str:
        end, runout = self.front[-1, 0], self.scalars["runout"]
        return f"<Observations: front of {len(self.front)} times to {end:.4g} s, runout {runout:.4g} m>"

    def _repr_html_(self) -> str:
        rows = [
            (observable_words(name), "-" if value is None else f"{value:.4g} {SCALAR_UNITS[name]}")
            for name, value in self.scalars.items()
        ]
        return html_table("observed", rows)

    def rows(self) -> list[tuple[str, float | None, float | None, float | None, str]]:
        """The same as rows (name, time, position, value, units); None where meaningless."""
        rows = []
        for name, quantity in CURVES.items():
            label = quantity.reading or name
            for time, *place, value in getattr(self, name):
                rows.append((label, time, place[0] if place else None, value, quantity.unit))
        return rows + [
            (name, None, None, value, SCALAR_UNITS[name]) for name, value in self.scalars.items()
        ]


def observe(
    result: "Result",
    experiment: Any = None,
    *,
    front_thickness: float | None = None,
    time_origin: float | None = None,
    case: "Case | None" = None,
) -> Observations:
    """Read `Observations` off a result, with the front threshold and time origin of an experiment.

    The effects of the case that change what is seen and not what flows act here
    (`fvcollapse.measure.observation`); the series of the result itself are without them.

    Parameters
    ----------
    result : Result
        As returned by `open_result` or `run`.
    experiment : object, optional
        Its `front_thickness` [m] and `time_origin` [s] are used unless given here.
    front_thickness : float, optional
        Thickness that defines the front [m]; default: the one of the case, from the series of every
        step. Another one is read off the stored profiles.
    time_origin : float, optional
        Simulated time that counts as t = 0 [s]; default 0. The effect `time_origin` adds to it.
    case : Case, optional
        Case whose effects of the observation act; default: that of the result. The result must be
        of the same flow (`observation.flow_case`).
    """
    if front_thickness is None:
        front_thickness = getattr(experiment, "front_thickness", None)
    if time_origin is None:
        time_origin = getattr(experiment, "time_origin", 0.0)
    case = result.case if case is None else case
    profiles, series = result.profiles, result.series
    if front_thickness is None or front_thickness == result.case.front.thickness:
        front = np.column_stack([series["time"], series["front_position"]])
        velocity = series["front_velocity"]
    else:
        position = [front_position(profiles.x, h, front_thickness) for h in profiles.thickness]
        front = np.column_stack([profiles.time, position])
        velocity = front_velocity(profiles.time, position)
    seen = seen_front(*front.T, case)  # type: ignore[call-arg]
    if not np.array_equal(seen, front[:, 1]):
        velocity = front_velocity(front[:, 0], seen)
    front[:, 1] = seen
    profiles = profiles._replace(x=seen_place(profiles.x, case))
    time_origin += seen_time_origin(case)
    stop = arrest_time(series["time"], series["max_speed"])
    scalars = {
        "runout": float(front[:, 1].max()),
        "final_height": float(series["max_thickness"][-1]),
        "time_stop": None if stop is None else stop - time_origin,
        "peak_front_velocity": peak_front_velocity(front[:, 0], velocity)[0],
    }
    volume = np.column_stack([series["time"], series["relative_volume"]])
    shift = np.array([time_origin, 0.0])
    return Observations(
        front - shift,
        _long_form(profiles, profiles.thickness, time_origin),
        volume - shift,
        _long_form(profiles, profiles.static_height, time_origin),
        scalars,
    )


def _long_form(profiles, values, time_origin):
    """Rows (time, x, value) of a (m, nx) array of profiles."""
    time = np.repeat(profiles.time - time_origin, len(profiles.x))
    return np.column_stack([time, np.tile(profiles.x, len(profiles.time)), values.ravel()])
