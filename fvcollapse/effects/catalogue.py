"""The catalogue of effects: what each acts on, its parameters, and what physics says of their values.

An effect that is no more than a change of a key the user believes is applied here, in
`with_effects`, and nowhere else; the others are terms of the solver (`fvcollapse/step`) or act on what is
observed (`fvcollapse/measure/observation.py`).
"""

from typing import NamedTuple

from msgspec.structs import replace

PHYSICAL, OBSERVATION, NUISANCE = "physical", "observation", "nuisance"


class Prior(NamedTuple):
    """What is known of a parameter before any comparison.

    Attributes
    ----------
    kind : str
        "uniform" or "loguniform" between `first` and `second`; "normal" with mean and standard
        deviation; "halfnormal" from `first` upwards with the scale `second`. In the unit of the key.
    grade : str
        A: read in the authors' own files; A2: in somebody else's; comp: computed from these; C:
        general knowledge, not verified, good for a wide prior only.
    source : str
        Where the values come from.
    strong_end : str
        "high" or "low": at which end of the distribution the effect is strongest.
    """

    kind: str
    first: float
    second: float
    grade: str
    source: str
    strong_end: str = "high"

    def distribution(self):
        """The frozen distribution of scipy.stats; its `ppf` is the quantile coordinate."""
        from scipy import stats

        if self.kind == "uniform":
            return stats.uniform(self.first, self.second - self.first)
        names = {"loguniform": "loguniform", "normal": "norm", "halfnormal": "halfnorm"}
        return getattr(stats, names[self.kind])(self.first, self.second)

    def at(self, strength):
        """Value at a strength in (0, 1): the quantile, counted from the end of the weak effect."""
        quantile = strength if self.strong_end == "high" else 1.0 - strength
        return float(self.distribution().ppf(quantile))


class Effect(NamedTuple):
    """An effect of the catalogue; its keys are those of `[effects.<name>]`.

    Attributes
    ----------
    kind : str
        PHYSICAL (changes the flow), OBSERVATION (changes what is seen of it) or NUISANCE (an error of
        the set-up: marginalised, never a verdict; its standard deviation is that of the experiment
        where it states one, else that of the prior).
    priors : dict
        Parameter -> `Prior`.
    absorbed_in : tuple of str
        Keys of the case whose calibration can hide the effect.
    variants : tuple of dict
        Other keys of the section that select a closure, one dict for each; the first is the default.
        A parameter whose value is None in a variant belongs to the others.
    """

    kind: str
    priors: dict
    absorbed_in: tuple = ()
    variants: tuple = ({},)

    def keys(self, strength, variant=None):
        """Keys of the section with every parameter at one strength in (0, 1); default: the first variant."""
        variant = self.variants[0] if variant is None else variant
        values = {name: prior.at(strength) for name, prior in self.priors.items()}
        return {name: value for name, value in (values | variant).items() if value is not None}


CATALOGUE = {
    "lateral_friction": Effect(
        PHYSICAL,
        {
            "mu_wall": Prior(
                "uniform",
                0.15,
                0.30,
                "A",
                "0.18-0.25 for beads on plexiglas, 0.30 for gravel; the margin below is C, and 0.46 "
                "(Lajeunesse et al. 2005, one channel) lies outside",
            ),
            "pressure_ratio": Prior(
                "uniform",
                0.5,
                1.1,
                "C",
                "isotropic flow 1; a pile at rest about 0.75: horizontal over vertical stress is "
                "1 - sin(angle of repose) = 0.57, but p is their mean; and a margin",
            ),
            "deep_ratio": Prior(
                "uniform", 0.2, 1.0, "C", "weakening seen in experiments and simulations"
            ),
            "weakening_depth": Prior(
                "loguniform", 0.005, 0.05, "C", "7 to 70 grain diameters, the depth of flow"
            ),
        },
        absorbed_in=("rheology.mu_1", "boundary.mu_bed"),
        variants=(
            {"closure": "sink", "deep_ratio": None, "weakening_depth": None},
            {"closure": "sink_weakening"},
            {"closure": "friction_increase", "deep_ratio": None, "weakening_depth": None},
        ),
    ),
    "gate": Effect(
        PHYSICAL,
        {
            "speed": Prior(
                "loguniform", 0.5, 2.5, "A", "0.7 and 0.8 m/s; 2.3 m/s in the paper", "low"
            ),
            "time_constant": Prior("uniform", 0.0, 0.15, "A", "0.06 s (gravel), 0.13 s (beads)"),
            "mu_gate": Prior("uniform", 0.0, 0.3, "A", "0.18, 0.23; none in the paper's model"),
            "delay": Prior(
                "uniform", 0.0, 0.04, "C", "two frames at 50 Hz between trigger and motion"
            ),
        },
        absorbed_in=("gate.speed", "gate.time_constant"),
    ),
    "viscosity": Effect(
        PHYSICAL,
        {
            "factor": Prior(
                "loguniform",
                0.5,
                5.0,
                "comp",
                "eta_I goes as (mu_2 - mu_1)/I_0 at low I; 0.20-0.30 and 0.069-0.40 in the literature",
            ),
            "eta_constant": Prior(
                "loguniform", 0.1, 2.0, "A", "range of eta_I and trials of Martin et al. (2017)"
            ),
        },
        absorbed_in=("rheology.mu_2", "rheology.I_0"),
        variants=({"eta_constant": None}, {"factor": None}),
    ),
    "bed_friction": Effect(
        PHYSICAL,
        {
            "mu_bed": Prior(
                "uniform",
                0.18,
                0.48,
                "A",
                "smooth plate, as beads on a lateral wall (0.18-0.25), to the friction of the grains",
                "low",
            ),
        },
        absorbed_in=("rheology.mu_1", "boundary.mu_bed"),
    ),
    "dilatancy": Effect(
        PHYSICAL,
        {
            "dilatancy_factor": Prior(
                "loguniform",
                1.0,
                5.0,
                "A2",
                "4.0 in SedFoam; 4.09 of Pailha & Pouliquen (2009), order 1 of Roux & Radjai (1998) (C)",
            ),
            "solid_fraction_critical": Prior(
                "uniform", 0.585, 0.62, "A2", "0.60 (dry) and 0.585 (immersed) in SedFoam", "low"
            ),
            "solid_fraction_slope": Prior(
                "uniform", 0.1, 0.2, "C", "linear nu_eq(I) of dry discs and beads"
            ),
            "solid_fraction_0": Prior(
                "uniform",
                0.58,
                0.64,
                "A2",
                "0.62 (Mangeney et al. 2010), 0.59 from the bulk density of other beads",
            ),
        },
        absorbed_in=("rheology.mu_1", "rheology.mu_2", "rheology.density_bulk"),
    ),
    "friction_hysteresis": Effect(
        PHYSICAL,
        {
            "delta_mu": Prior(
                "uniform",
                0.01,
                0.06,
                "A2",
                "start angle 0.5-2.5 deg above the stop angle; 5.4 deg (Lajeunesse et al. 2005) and the "
                "0.05-0.20 tried in sand6 lie outside",
            ),
            "I_start": Prior("loguniform", 0.005, 0.01, "A", "values tried in sand6"),
            "strain": Prior("loguniform", 0.01, 0.1, "C", "some per cent of strain to the peak"),
        },
        absorbed_in=("rheology.mu_1",),
    ),
    "nonlocal": Effect(
        PHYSICAL,
        {"A": Prior("uniform", 0.4, 0.9, "A2", "0.5 in a code of the model; 0.48 for beads (C)")},
        absorbed_in=("rheology.mu_1", "rheology.I_0"),
    ),
    "cohesion": Effect(
        PHYSICAL,
        {
            "kappa_0": Prior(
                "loguniform",
                1.0,
                50.0,
                "C",
                "mu_1 times the tensile strength 6 nu F/(pi d2), F = 1-30 % of the capillary force pi gamma d",
            ),
        },
        absorbed_in=("rheology.mu_1",),
    ),
    "erodible_bed": Effect(
        PHYSICAL,
        {
            "thickness": Prior(
                "loguniform", 0.002, 0.014, "C", "3 to 20 grain diameters; 1.4 cm in one study (A)"
            ),
        },
        absorbed_in=("boundary.mu_bed",),
    ),
    "transverse_profile": Effect(
        PHYSICAL,
        {
            "velocity_ratio": Prior(
                "uniform", 1.0, 1.5, "A2", "1.2-1.4 at the surface of a collapse in a channel"
            ),
        },
        absorbed_in=("rheology.mu_1",),
        variants=({"view": "average"}, {"view": "wall"}, {"view": "centre"}),
    ),
    "front_saltation": Effect(
        OBSERVATION,
        {
            "bias": Prior("normal", 0.0, 0.02, "A", "error of the runout by saltation, +-2 cm"),
            "spread": Prior("halfnormal", 0.0, 0.01, "C", "half of that error, frame to frame"),
        },
    ),
    "tilt": Effect(
        NUISANCE,
        {"angle_deg": Prior("normal", 0.0, 0.3, "C", "a spirit level over a channel of 3 m")},
        absorbed_in=("rheology.mu_1", "boundary.mu_bed"),
    ),
    "column_size": Effect(
        NUISANCE,
        {
            "height": Prior("normal", 0.0, 0.002, "C", "three grain diameters"),
            "length": Prior("normal", 0.0, 0.002, "C", "three grain diameters"),
        },
    ),
    "time_origin": Effect(
        NUISANCE,
        {"offset": Prior("normal", 0.0, 0.01, "C", "half a frame at 50 Hz")},
    ),
}


def with_effects(case):
    """The case that the solver runs: effects that change a key are put into that key.

    They leave `[effects]` with it, so that a second call changes nothing; without such an effect the
    case itself is returned.
    """
    for apply in KEY_CHANGES:
        case = apply(case)
    return case


def _without(case, name):
    """The case with an effect switched off."""
    return replace(case, effects=replace(case.effects, **{name: None}))


def change_gate(case):
    """Speed law of the gate; its delay and friction remain for the solver."""
    effect = case.effects.gate
    if effect is None or effect.speed is effect.time_constant is None:
        return case
    speed = case.gate.speed if effect.speed is None else effect.speed
    tau = case.gate.time_constant if effect.time_constant is None else effect.time_constant
    rest = replace(effect, speed=None, time_constant=None)
    effects = replace(case.effects, gate=rest)
    return replace(case, gate=replace(case.gate, speed=speed, time_constant=tau), effects=effects)


def change_viscosity(case):
    """Viscosity: eta_I = (mu_2 - mu_1) p / (...) is scaled by scaling mu_2 - mu_1.

    With a constant eta_c in its place mu_I is the Drucker-Prager law (Martin et al. 2017, equation 8).
    """
    effect, law = case.effects.viscosity, case.rheology
    if effect is None:
        return case
    if effect.eta_constant is not None:
        kind = "drucker_prager" if law.law == "mu_I" else law.law
        law = replace(law, law=kind, viscosity=effect.eta_constant)
    elif law.law == "mu_I":
        law = replace(law, mu_2=law.mu_2 + (effect.factor - 1.0) * (law.mu_2 - law.mu_1))
    else:
        law = replace(law, viscosity=effect.factor * law.viscosity)
    return replace(_without(case, "viscosity"), rheology=law)


def change_bed_friction(case):
    """Friction of the bed; where it is below that of the grains they slide (equation 12)."""
    effect = case.effects.bed_friction
    if effect is None:
        return case
    boundary = case.boundary
    if effect.mu_bed is not None:
        boundary = replace(boundary, mu_bed=effect.mu_bed)
    return replace(_without(case, "bed_friction"), boundary=boundary)


def change_cohesion(case):
    """Cohesion: yield stress mu_1 p + kappa_0."""
    effect, law = case.effects.cohesion, case.rheology
    if effect is None:
        return case
    law = replace(law, cohesion=law.cohesion + effect.kappa_0)
    return replace(_without(case, "cohesion"), rheology=law)


def change_tilt(case):
    """Tilt: another slope."""
    effect, geometry = case.effects.tilt, case.geometry
    if effect is None:
        return case
    geometry = replace(geometry, slope_angle_deg=geometry.slope_angle_deg + effect.angle_deg)
    return replace(_without(case, "tilt"), geometry=geometry)


def change_column_size(case):
    """Size of the column: the same number of cells in another length, so that the response is smooth."""
    effect, geometry, grid = case.effects.column_size, case.geometry, case.grid
    if effect is None:
        return case
    if effect.length != 0.0:
        stretch = (geometry.length_0 + effect.length) / geometry.length_0
        height = grid.cell_size_z or grid.cell_size
        grid = replace(grid, cell_size=stretch * grid.cell_size, cell_size_z=height)
    geometry = replace(
        geometry,
        height_0=geometry.height_0 + effect.height,
        length_0=geometry.length_0 + effect.length,
    )
    return replace(_without(case, "column_size"), geometry=geometry, grid=grid)


KEY_CHANGES = (
    change_gate,
    change_viscosity,
    change_bed_friction,
    change_cohesion,
    change_tilt,
    change_column_size,
)
