"""The sections under `[effects]` whose effect carries a field of its own, and what physics says of their keys."""

from typing import Annotated

from fvcollapse.case_keys import Section, key


class Dilatancy(Section):
    """Sheared grains expand or contract towards nu_eq = max - slope min(I, 1); mass is conserved."""

    dilatancy_factor: Annotated[
        float, key("-", "K of tan(psi) = K (nu - nu_eq); 0 = incompressible", ge=0, le=20)
    ] = 4.0
    solid_fraction_max: Annotated[
        float, key("-", "nu_eq of slow shear, I = 0", ge=0.3, le=0.74)
    ] = 0.60
    solid_fraction_slope: Annotated[
        float, key("-", "decrease of nu_eq from I = 0 to I = 1", ge=0, le=0.25)
    ] = 0.15
    solid_fraction_0: (
        Annotated[
            float,
            key(
                "-",
                "solid fraction at the start, loose or dense; absent = density_bulk / density_grain",
                ge=0.3,
                le=0.74,
            ),
        ]
        | None
    ) = None


# effect: {key: (distribution, first, second, grade, source)}; uniform and loguniform from first to
# second. Grade A2: read in somebody else's files or text, C: general knowledge, not verified.
PRIORS = {
    "dilatancy": {
        "dilatancy_factor": (
            "loguniform",
            1.0,
            5.0,
            "A2",
            "4.0 in SedFoam; 4.09 of Pailha & Pouliquen (2009) and order 1 of Roux & Radjai (1998) (C)",
        ),
        "solid_fraction_max": (
            "uniform",
            0.585,
            0.62,
            "A2",
            "critical solid fraction 0.60 (dry) and 0.585 (immersed) in SedFoam; 0.62 of the beads as poured",
        ),
        "solid_fraction_slope": (
            "uniform",
            0.1,
            0.2,
            "C",
            "linear nu_eq(I) of dry discs and beads",
        ),
        "solid_fraction_0": (
            "uniform",
            0.58,
            0.64,
            "A2",
            "0.62 (Mangeney et al. 2010), 0.59 from the bulk density of other beads",
        ),
    },
}
