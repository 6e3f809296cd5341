"""What a result holds, by name: units and meaning of series, profiles, step log and fields."""

from fvcollapse.step.state import EFFECT_FIELDS

# name: (units, description); one value per step and one at t = 0
SERIES = {
    "time": ("s", "time since the gate starts to rise"),
    "front_position": (
        "m",
        "first X, connected to the pile, where the thickness falls below front.thickness",
    ),
    "front_velocity": ("m/s", "least-squares slope of front_position over a centred 40 ms window"),
    "runout": ("m", "running maximum of front_position, from X = 0"),
    "runout_1mm": ("m", "running maximum of the front at 1 mm thickness"),
    "runout_10mm": ("m", "running maximum of the front at 10 mm thickness"),
    "x_99": ("m", "X behind which 99 % of the volume lies"),
    "max_thickness": ("m", "largest thickness normal to the bed"),
    "detached_volume": (
        "1",
        "fraction of the volume beyond the first X where the thickness is below 1 mm",
    ),
    "relative_volume": (
        "1",
        "V(t)/V(0) - 1; material that left through an open end counts as kept",
    ),
    "volume_correction": ("1", "running sum of |volume corrections| / V(0), unsigned"),
    "kinetic_energy": ("J/m", "kinetic energy per unit width"),
    "potential_energy": (
        "J/m",
        "potential energy per unit width, zero at the foot of the back wall",
    ),
    "work_bulk": ("J/m", "energy dissipated inside the grains since t = 0"),
    "work_bed": ("J/m", "energy dissipated by slip along the bed since t = 0"),
    "work_back_wall": ("J/m", "energy dissipated by slip along the back wall since t = 0"),
    "work_lateral": ("J/m", "energy dissipated at the lateral walls since t = 0"),
    "work_gate": (
        "J/m",
        "energy dissipated along the gate less what its motion gives the grains, since t = 0",
    ),
    "loss_time": ("J/m", "energy lost to the first-order time step since t = 0"),
    "loss_advection": (
        "J/m",
        "kinetic energy lost by advection, and by continuing the velocity beyond the surface, since t = 0",
    ),
    "loss_surface": (
        "J/m",
        "potential energy lost (negative: gained) by the motion and correction of the surface since t = 0",
    ),
    "energy_outflow": (
        "J/m",
        "energy that left through an open end since t = 0, less what came with an erodible layer",
    ),
    "numerical_loss": (
        "J/m",
        "what closes the energy budget: all that is lost to the discretisation since t = 0",
    ),
    "max_speed": ("m/s", "largest speed at the centre of a cell that holds grains"),
    "ill_posed_fraction": (
        "1",
        "part of the flowing volume (faster than 0.01 m/s) where the model is ill-posed, at the last landing",
    ),
    "negative_pressure_cells": ("1", "number of cells in suction"),
}
SINCE_RELEASED = ("work_gate",)  # zero in a file written before there was such a series
PROFILES = {
    "thickness": ("m", "thickness h(X, t) normal to the bed; above an erodible layer, if any"),
    "static_height": (
        "m",
        "height of the static-flowing interface (speed 0.01 m/s); 0 = moving down to the bed "
        "(or to the surface of an erodible layer, negative within it)",
    ),
}
STEPS = {
    "time": ("s", "time at the end of the step"),
    "dt": ("s", "length of the step"),
    "sweeps": ("1", "nonlinear iterations"),
    "linear_iterations": ("1", "linear solves, one in each sweep (as `sweeps`)"),
    "residual": (
        "1",
        "relative residual of the nonlinear iteration at the end of the step, infinity norm",
    ),
    "divergence": ("1", "largest divergence left, times the step"),
    "capped": ("1", "1 where the iteration stopped at its cap, above the tolerance"),
    "volume_correction": ("m2", "volume correction of the step, signed, per unit width"),
    "wall_time": ("s", "wall-clock time of the step"),
}
FIELDS = {
    "level_set": ("m", "signed distance to the free surface at the nodes, negative in the grains"),
    "u": ("m/s", "velocity along the bed on the x-faces"),
    "w": ("m/s", "velocity normal to the bed on the z-faces"),
    "pressure": ("Pa", "pressure at the cell centres"),
    "shear_rate": ("1/s", "sqrt(2 D:D) at the cell centres"),
    "viscosity": ("Pa s", "effective viscosity at the cell centres"),
    "inertial_number": ("1", "inertial number at the cell centres"),
}


def about_field(name: str) -> tuple[str, str]:
    """(units, description) of a field of the flow or of an effect."""
    if name in EFFECT_FIELDS:
        return EFFECT_FIELDS[name][2:]
    return FIELDS.get(name, ("SI", name.replace("_", " ")))
