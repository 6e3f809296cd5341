"""What is known at one instant, and the tables from which output, checkpoint and growth of the domain follow."""

import numpy as np

from fvcollapse.effects.catalogue import CATALOGUE

# name: (location, units, description, in_checkpoint)
FIELDS = {
    "level_set": ("node", "m", "signed distance to the free surface, negative in the grains", True),
    "u": ("xface", "m/s", "velocity along the bed", True),
    "w": ("zface", "m/s", "velocity normal to the bed", True),
    "pressure_filled": (
        "centre",
        "Pa",
        "filled fraction times pressure between the grains, p + p_c",
        True,
    ),
    "bed_slip": ("xnode", "m/s", "slip velocity at the bed", True),
    "u_before": ("xface", "m/s", "u at the start of the last step", True),
    "w_before": ("zface", "m/s", "w at the start of the last step", True),
}
# name: (effect that carries it, location, units, description); absent from a state without that effect
EFFECT_FIELDS = {
    name: (effect.name, *field)
    for effect in CATALOGUE.values()
    for name, field in effect.fields.items()
}
SCALARS = {
    "time": ("s", "time since the gate starts to rise"),
    "step": ("1", "number of completed steps"),
    "dt": ("s", "length of the last step"),
    "volume_0": ("m2", "volume per unit width at t = 0, and of the layer by which the domain grew"),
    "volume_correction": ("m2", "running sum of the absolute volume corrections"),
    "volume_outflow": ("m2", "volume that has left through an open end"),
    "work_bulk": ("J/m", "work against the viscous stress inside the grains since t = 0"),
    "work_bed": ("J/m", "work against the friction of the bed"),
    "work_back_wall": ("J/m", "work against the friction of the back wall"),
    "work_lateral": ("J/m", "work against the friction of the lateral walls"),
    "work_gate": ("J/m", "work against the friction of the gate, less what its motion gives"),
    "loss_time": ("J/m", "energy lost to the first-order time step since t = 0"),
    "loss_advection": ("J/m", "kinetic energy lost by the advection of momentum"),
    "loss_surface": ("J/m", "potential energy lost by the motion and correction of the surface"),
    "energy_outflow": ("J/m", "energy that has left through an open end, or come with a layer"),
    "travel": (
        "1",
        "cells the fastest point has moved since the signed distance was last restored",
    ),
}
COUNTS = ("step",)  # scalars that are whole numbers


class State:
    """Arrays on the staggered grid (`FIELDS`; `EFFECT_FIELDS` where their effect is on) and scalars (`SCALARS`).

    Every entry of the three tables is an attribute; a field of an effect that is off is None. The scalars are kept
    in one array, `numbers`, in the order of their table, which the kernels change in place.
    """

    def __init__(self, level_set, u, w, pressure_filled, bed_slip, **entries):
        self.level_set, self.u, self.w = level_set, u, w
        self.pressure_filled, self.bed_slip = pressure_filled, bed_slip
        self.u_before, self.w_before = u.copy(), w.copy()
        self.numbers = np.zeros(len(SCALARS))
        for name in EFFECT_FIELDS:
            setattr(self, name, None)
        for name, value in entries.items():
            if name not in (*SCALARS, *EFFECT_FIELDS, "u_before", "w_before"):
                raise TypeError(f"a state has no {name}")
            setattr(self, name, value)

    def effect_fields(self):
        """Names of the fields that the effects carry in this state."""
        return [name for name in EFFECT_FIELDS if getattr(self, name) is not None]

    def field_names(self):
        """Names of all fields of this state."""
        return [*FIELDS, *self.effect_fields()]

    def entries(self):
        """{name: array or number} of all that the state holds."""
        return {name: getattr(self, name) for name in [*self.field_names(), *SCALARS]}

    def copy(self):
        """Independent copy of the state, whose arrays are parts of one: `State.store`."""
        names = [*self.field_names(), "numbers"]
        ends = np.cumsum([getattr(self, name).size for name in names])
        made = State.__new__(State)
        made.store = np.empty(ends[-1])
        vars(made).update(dict.fromkeys(EFFECT_FIELDS))
        for name, part in zip(names, np.split(made.store, ends[:-1]), strict=True):
            values = getattr(self, name)
            setattr(made, name, part.reshape(values.shape))
            getattr(made, name)[...] = values
        return made


def _number(place, kind):
    """The property of a scalar at a place of `State.numbers`."""

    def get(state):
        return kind(state.numbers[place])

    def put(state, value):
        state.numbers[place] = value

    return property(get, put)


for _place, _name in enumerate(SCALARS):
    setattr(State, _name, _number(_place, int if _name in COUNTS else float))


def location_shape(location, nx, nz):
    """Array shape of a field at `location` on an nx by nz grid."""
    return {
        "node": (nx + 1, nz + 1),
        "xface": (nx + 1, nz),
        "zface": (nx, nz + 1),
        "centre": (nx, nz),
        "xnode": (nx + 1,),
    }[location]


def _shape_of(state, name, nx, nz):
    location = EFFECT_FIELDS[name][1] if name in EFFECT_FIELDS else FIELDS[name][0]
    return location_shape(location, nx, nz)


def crop(state, rows):
    """Keep the lowest `rows` rows of every field."""
    nx = state.pressure_filled.shape[0]
    for name in state.field_names():
        kept = tuple(slice(n) for n in _shape_of(state, name, nx, rows))
        setattr(state, name, getattr(state, name)[kept].copy())


def grow(state, extra_x, extra_z):
    """Enlarge every field by `extra_x` columns at the far end and `extra_z` rows at the top.

    The level set is continued with its last slope away from the grains, everything else with zero.
    """
    nx, nz = state.pressure_filled.shape
    for name in state.field_names():
        old = getattr(state, name)
        new = np.zeros(_shape_of(state, name, nx + extra_x, nz + extra_z))
        new[tuple(slice(n) for n in old.shape)] = old
        setattr(state, name, new)
    phi = state.level_set
    for i in range(nx + 1, nx + extra_x + 1):
        phi[i, : nz + 1] = phi[i - 1, : nz + 1] + np.maximum(
            phi[i - 1, : nz + 1] - phi[i - 2, : nz + 1], 0.0
        )
    for k in range(nz + 1, nz + extra_z + 1):
        phi[:, k] = phi[:, k - 1] + np.maximum(phi[:, k - 1] - phi[:, k - 2], 0.0)
