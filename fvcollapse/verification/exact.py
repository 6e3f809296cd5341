"""Exact solutions of the model, each with its derivation or its source.

Uniform flow of a layer of depth H down a bed inclined by a: u(z) along the bed, w = 0, and across
the layer

    p = rho g cos(a) (H - z),
    rho u_t = rho g sin(a) + d tau/dz - (2/w) mu_w p u/|u|,     tau(H) = 0.

Steady and without lateral walls tau = T p with T = tan(a): the layer has the same stress ratio
everywhere. Every function takes the case that the solver runs; z is the height above the bed, m,
and u is in m/s.
"""

import math

import numpy as np
from scipy.integrate import quad
from scipy.linalg import solve_banded

from fvcollapse.case import GRAVITY


def slope_ratio(case):
    """T = tan(slope), the stress ratio of a steady uniform layer."""
    return math.tan(math.radians(case.geometry.slope_angle_deg))


def gravity_normal(case):
    """Gravity normal to the bed, g cos(slope), m/s2."""
    return GRAVITY * math.cos(math.radians(case.geometry.slope_angle_deg))


def wall_ratio(case):
    """mu_w / w, 1/m: the walls carry the part (mu_w / w) y of the weight above depth y, or none."""
    walls = case.effects.lateral_friction
    return 0.0 if walls is None else walls.mu_wall / case.geometry.channel_width


def pressure_hydrostatic(case, z, depth=None):
    """Hydrostatic p = rho g cos(a) (H - z), Pa; zero above the surface."""
    depth = case.geometry.height_0 if depth is None else depth
    return case.rheology.density_bulk * gravity_normal(case) * np.maximum(depth - np.asarray(z), 0)


# -- steady flow on a bed that holds the grains ------------------------------------------------


def bagnold(case, z):
    """Bagnold flow of mu(I): u = (2/3) (I_a/d) sqrt(phi g cos a) (H^1.5 - (H - z)^1.5).

    mu(I) = T everywhere, so I = I_a = I_0 (T - mu_1)/(mu_2 - T) is constant, and du/dz = I
    sqrt(p/rho_s)/d with phi = rho/rho_s is integrated from the bed. Exists for mu_1 < T < mu_2. GDR
    MiDi (2004), Eur. Phys. J. E 14, 341.
    """
    depth, law = case.geometry.height_0, case.rheology
    inertial = inertial_number_at(slope_ratio(case), law)
    solid_fraction = law.density_bulk / law.density_grain
    factor = (
        2 / 3 * inertial / law.grain_diameter * math.sqrt(solid_fraction * gravity_normal(case))
    )
    return factor * (depth**1.5 - np.maximum(depth - z, 0.0) ** 1.5)


def inertial_number_at(mu, law):
    """I at which mu(I) = mu, for mu_1 <= mu < mu_2."""
    return law.I_0 * (mu - law.mu_1) / (law.mu_2 - mu)


def incline_drucker_prager(case, z):
    """Inclined layer above yield: u = (rho g cos a/eta) (T - mu_1) (H z - z^2/2).

    tau = mu_1 p + eta du/dz = T p is integrated from the bed; zero for T <= mu_1. mu_1 = 0: the
    Nusselt film.
    """
    law = case.rheology
    excess = max(slope_ratio(case) - law.mu_1, 0.0)
    return _parabola(case, z, law.density_bulk * gravity_normal(case) * excess / law.viscosity)


def film_newtonian(case, z):
    """Nusselt film, one half of a plane Poiseuille flow: u = (rho g sin a/eta) (H z - z^2/2)."""
    law = case.rheology
    return _parabola(
        case, z, law.density_bulk * gravity_normal(case) * slope_ratio(case) / law.viscosity
    )


def _parabola(case, z, curvature):
    return curvature * (case.geometry.height_0 * z - 0.5 * z**2)


def film_bingham(case, z):
    """Sheared below, a plug of thickness tau_y/(rho g sin a) on top: half a Poiseuille flow.

    eta du/dz = rho g sin a (H - z) - tau_y where that is positive; Bird, Dai & Yarusso (1983), Rev.
    Chem. Eng. 1.
    """
    law = case.rheology
    drive = law.density_bulk * gravity_normal(case) * slope_ratio(case)
    sheared = case.geometry.height_0 - law.cohesion / drive
    height = np.minimum(z, max(sheared, 0.0))
    return drive / law.viscosity * (sheared * height - 0.5 * height**2)


def film_imposed_bed_stress(case, z):
    """Newtonian film on a sliding bed: u - u(0) = (mu_b rho g cos a/eta) (H z - z^2/2).

    The bed gives tau(0) = mu_b p(0) whatever the speed; tau(H) = 0. The film gains g cos(a) (T -
    mu_b) as a whole, so with mu_b = T it slides steadily: a Couette flow with imposed wall stress.
    """
    law = case.rheology
    curvature = law.density_bulk * gravity_normal(case) * case.boundary.mu_bed / law.viscosity
    return _parabola(case, z, curvature)


# -- lateral walls -----------------------------------------------------------------------------


def flowing_depth(case):
    """h_f = w (T - mu_1)/mu_w, where the walls carry the excess drive; Taberlet et al. (2003)."""
    return (slope_ratio(case) - case.rheology.mu_1) / wall_ratio(case)


def chute_drucker_prager(case, z):
    """Flow between lateral walls: eta du/dz = rho g cos a ((T - mu_1) y - (mu_w/w) y^2), y = H - z.

    Momentum above depth y: tau = rho g cos a (T y - (mu_w/w) y^2). At rest below h_f, if the layer
    is that deep.
    """
    law = case.rheology
    y, bottom = _depths(case, z)
    excess = slope_ratio(case) - law.mu_1

    def integral(depth):
        return excess * depth**2 / 2 - wall_ratio(case) * depth**3 / 3

    factor = law.density_bulk * gravity_normal(case) / law.viscosity
    return factor * (integral(bottom) - integral(np.minimum(y, bottom)))


def chute_mu_I(case, z):
    """mu(I(y)) = T - (mu_w/w) y; u = integral of (I/d) sqrt(phi g cos a y) from the depth of rest.

    Jop, Forterre & Pouliquen (2005), J. Fluid Mech. 541, 167, width-averaged.
    """
    law = case.rheology
    y, bottom = _depths(case, z)
    scale = (
        math.sqrt(law.density_bulk / law.density_grain * gravity_normal(case)) / law.grain_diameter
    )

    def shear(depth):
        mu = slope_ratio(case) - wall_ratio(case) * depth
        return scale * inertial_number_at(mu, law) * math.sqrt(depth)

    return np.array([quad(shear, min(depth, bottom), bottom, epsabs=1e-12)[0] for depth in y])


def _depths(case, z):
    """Depths y = H - z >= 0 of the points, and the depth of rest: h_f or the bed."""
    depth = case.geometry.height_0
    return np.maximum(depth - np.asarray(z, float), 0.0), min(flowing_depth(case), depth)


# -- in time -----------------------------------------------------------------------------------


def incline_start_up(case, z, time, terms=200):
    """Drucker-Prager layer (T > mu_1) from rest: the steady parabola less decaying modes.

    u_t = A + nu u_zz with A = g cos a (T - mu_1), nu = eta/rho, u(0) = 0, u_z(H) = 0, since du/dz >
    0 throughout: u = A/nu (H z - z^2/2) - sum_n 2A/(nu H k_n^3) sin(k_n z) exp(-nu k_n^2 t), k_n =
    (2n + 1) pi/(2H).
    """
    law, depth = case.rheology, case.geometry.height_0
    drive = gravity_normal(case) * (slope_ratio(case) - law.mu_1)
    nu = law.viscosity / law.density_bulk
    k = (2 * np.arange(terms) + 1) * math.pi / (2 * depth)
    modes = 2 * drive / (nu * depth * k**3) * np.exp(-nu * k**2 * time)
    return _parabola(case, z, drive / nu) - np.sin(np.outer(z, k)) @ modes


def stopping_inviscid(case, u_0, z, time):
    """Layer below yield (T < mu_1) without viscosity: u = max(0, u_0(z) - S t), u_0 rising with z.

    Where the layer moves tau = mu_1 p, so every depth loses S = g cos a (mu_1 - T + 2 (mu_w/w) y)
    per unit time; the static-flowing interface rises as S t = u_0. Bouchut, Ionescu & Mangeney
    (2016), Commun. Math. Sci. 14, 2101.
    """
    y = case.geometry.height_0 - np.asarray(z)
    loss = case.rheology.mu_1 - slope_ratio(case) + 2 * wall_ratio(case) * y
    return np.maximum(0.0, u_0 - gravity_normal(case) * loss * time)


def stopping_viscous(case, u_0, z, time, cells=400, steps=800):
    """Drucker-Prager layer below yield that stops from the bed upwards; u_0(z) rising, flat at H.

    Where the layer moves tau = mu_1 p + eta u_z, so u_t = -S + nu u_zz with S = g cos a (mu_1 - T),
    u_z(H) = 0; it ends at a height b(t) where u = u_z = 0, and below it rests: the obstacle problem
    min(u_t + S - nu u_zz, u) = 0. Lusso, Bouchut, Ern & Mangeney (2017), Appl. Sci. 7, 386. There is
    no closed form: finite differences on `cells` cells, in `steps` implicit steps (extrapolated from
    first order in time), the resting cells being found anew in every step; converged to 2e-6 u_0.
    """
    coarse = _obstacle(case, u_0, time, cells, steps)
    fine = _obstacle(case, u_0, time, cells, 2 * steps)
    centres = (np.arange(cells) + 0.5) * case.geometry.height_0 / cells
    return np.interp(z, centres, np.maximum(2 * fine - coarse, 0.0))


def _obstacle(case, u_0, time, cells, steps):
    law, h, dt = case.rheology, case.geometry.height_0 / cells, time / steps
    loss = gravity_normal(case) * (law.mu_1 - slope_ratio(case)) * dt
    diffusion = law.viscosity / law.density_bulk * dt / h**2
    band = np.zeros((3, cells))
    band[0, 1:] = band[2, :-1] = -diffusion
    band[1] = 1.0 + 2.0 * diffusion
    band[1, 0] += diffusion  # the bed is half a cell below the first centre
    band[1, -1] -= diffusion
    u = u_0((np.arange(cells) + 0.5) * h)
    resting = 0
    for _ in range(steps):
        while resting < cells:
            solution = solve_banded((1, 1), _above(band, resting, diffusion), u[resting:] - loss)
            if solution[0] >= 0.0:
                break
            resting += 1
        u = np.zeros(cells)
        u[resting:] = solution if resting < cells else 0.0
    return u


def _above(band, resting, diffusion):
    """The equations of the cells from `resting` on, with u = 0 in the cell below."""
    part = band[:, resting:].copy()
    if resting:
        part[1, 0] = 1.0 + 2.0 * diffusion - (diffusion if part.shape[1] == 1 else 0.0)
    return part


def block_acceleration(case, depth=None):
    """A rigid block that slides down: g cos a (T - mu_b - (mu_w/w) H), m/s2."""
    depth = case.geometry.height_0 if depth is None else depth
    loss = case.boundary.mu_bed + wall_ratio(case) * depth
    return gravity_normal(case) * (slope_ratio(case) - loss)


def block_speed(case, u_0, time):
    """A rigid block, braked (acceleration < 0): stops at u_0/|a| and stays, max(0, u_0 + a t)."""
    return max(0.0, u_0 + block_acceleration(case) * time)


def creep(case, z):
    """Creep of a layer below yield on a bed that holds it: u = z gd, gd = gd_min r/sqrt(1 - r^2).

    r = T/mu_1: mu_1 p gd/sqrt(gd^2 + gd_min^2) = T p has the same gd at every depth. An upper bound
    for the laws that add a viscous part.
    """
    ratio = slope_ratio(case) / case.rheology.mu_1
    return z * case.numerics.shear_rate_min * ratio / math.sqrt(1 - ratio**2)


def pressure_tilted_box(case, x):
    """Bed pressure under a level surface: rho g (H cos a + (x - L/2) sin a), Pa."""
    slope = math.radians(case.geometry.slope_angle_deg)
    depth = case.geometry.height_0 * math.cos(slope) + (
        x - 0.5 * case.geometry.length_0
    ) * math.sin(slope)
    return case.rheology.density_bulk * GRAVITY * depth


# -- surfaces ----------------------------------------------------------------------------------


def disc(x, z, x_centre, z_centre, radius):
    """Signed distance to a circle, negative inside; m."""
    return np.hypot(x - x_centre, z - z_centre) - radius


def slotted_disc(x, z):
    """Zalesak's disc in the unit square: radius 0.15 at (0.5, 0.75), slot 0.05 wide, 0.25 high.

    Signed distance. Zalesak (1979), J. Comput. Phys. 31, 335 (there in units of a hundredth).
    """
    x, z = x - 0.5, z - 0.75
    radius, half_width, top = 0.15, 0.025, 0.10
    bottom = -math.sqrt(radius**2 - half_width**2)
    corner = np.hypot(np.abs(x) - half_width, z - bottom)
    to_slot = np.maximum(np.abs(x) - half_width, z - top)  # negative in the slot, open downwards
    outside_slot = np.hypot(np.maximum(np.abs(x) - half_width, 0), np.maximum(z - top, 0))
    circle = np.hypot(x, z) - radius
    side = np.hypot(np.abs(x) - half_width, np.maximum(bottom - z, 0))
    roof = np.hypot(np.maximum(np.abs(x) - half_width, 0), z - top)
    in_slot = (to_slot < 0) & (z < top)
    inside = (circle < 0) & ~in_slot
    depth = np.minimum(-circle, np.where(z < bottom, corner, outside_slot))
    above_chord = np.where(np.abs(x) < half_width, z > bottom, True)
    away = np.where(
        in_slot & above_chord,
        np.minimum(side, roof),
        np.where((np.abs(x) < half_width) & (z < 0), corner, circle),
    )
    return np.where(inside, -depth, away)


def rotation(x, z, time):
    """Solid-body rotation about the middle of the unit square, one turn per second; (u, w), m/s."""
    return 2 * math.pi * (0.5 - z), 2 * math.pi * (x - 0.5)


def single_vortex(period):
    """Velocity (x, z, time) -> (u, w) that stretches a disc into a spiral and back within `period`.

    Stream function sin^2(pi x) sin^2(pi z)/pi times cos(pi t/period); LeVeque (1996), SIAM J.
    Numer. Anal. 33, 627.
    """

    def velocity(x, z, time):
        swing = math.cos(math.pi * time / period)
        u = -(np.sin(math.pi * x) ** 2) * np.sin(2 * math.pi * z) * swing
        w = np.sin(math.pi * z) ** 2 * np.sin(2 * math.pi * x) * swing
        return u, w

    return velocity


# -- boxes and channels full of a Newtonian fluid ----------------------------------------------


def taylor_green(x, z, time, viscosity_kinematic, wave_number, speed):
    """Vortices in a free-slip box: u = U sin kx cos kz F, w = -U cos kx sin kz F, F = exp(-2 nu k^2 t).

    The advection is the gradient of -(U F)^2 (cos 2kx + cos 2kz)/4 and only adds to the pressure;
    the viscous force is -2 nu k^2 u. Taylor & Green (1937), Proc. R. Soc. A 158, 499. (u, w), m/s.
    """
    k = wave_number
    fade = speed * math.exp(-2 * viscosity_kinematic * k**2 * time)
    return (
        fade * np.sin(k * x) * np.cos(k * z),
        -fade * np.cos(k * x) * np.sin(k * z),
    )


def poiseuille(case, z):
    """Between two walls that hold the fluid, driven along the bed: u = g sin(a)/(2 nu) z (H - z)."""
    law = case.rheology
    drive = GRAVITY * math.sin(math.radians(case.geometry.slope_angle_deg))
    return drive * law.density_bulk / (2 * law.viscosity) * z * (case.geometry.height_0 - z)


def couette_start_up(case, z, time, speed, terms=200):
    """Bed set in motion at t = 0 below a lid at rest.

    u = U (1 - z/H) - sum_n 2U/(n pi) sin(n pi z/H) exp(-nu (n pi/H)^2 t).
    """
    law, depth = case.rheology, case.geometry.height_0
    n = np.arange(1, terms + 1) * math.pi
    fade = np.exp(-law.viscosity / law.density_bulk * (n / depth) ** 2 * time)
    return speed * (1 - z / depth - np.sin(np.outer(z / depth, n)) @ (2 / n * fade))


# Lid-driven cavity, Re = 100: velocity along the moving wall on the line through the middle normal
# to it, against the distance from the opposite wall; and the velocity normal to it along the
# parallel line through the middle; in units of the wall's speed and the side.
# Ghia, Ghia & Shin (1982), J. Comput. Phys. 48, 387, tables I and II (129 x 129 grid).
GHIA_U = np.array(
    [
        (0.0547, -0.03717), (0.0625, -0.04192), (0.0703, -0.04775), (0.1016, -0.06434),
        (0.1719, -0.10150), (0.2813, -0.15662), (0.4531, -0.21090), (0.5000, -0.20581),
        (0.6172, -0.13641), (0.7344, 0.00332), (0.8516, 0.23151), (0.9531, 0.68717),
        (0.9609, 0.73722), (0.9688, 0.78871), (0.9766, 0.84123),
    ]
)  # fmt: skip
GHIA_V = np.array(
    [
        (0.0625, 0.09233), (0.0703, 0.10091), (0.0781, 0.10890), (0.0938, 0.12317),
        (0.1563, 0.16077), (0.2266, 0.17507), (0.2344, 0.17527), (0.5000, 0.05454),
        (0.8047, -0.24533), (0.8594, -0.22445), (0.9063, -0.16914), (0.9453, -0.10313), (0.9531, -0.08864),
        (0.9609, -0.07391), (0.9688, -0.05906),
    ]
)  # fmt: skip
# Marchi, Suero & Araki (2009), J. Braz. Soc. Mech. Sci. Eng. 31, 186 (1024 x 1024, extrapolated), at
# 1/16, 2/16, ..., 15/16.
MARCHI_U = np.array(
    [
        -0.041974991, -0.077125399, -0.109816214, -0.141930064, -0.172712391, -0.198470859,
        -0.212962392, -0.209149142, -0.182080595, -0.131256301, -0.060245594, 0.027874448,
        0.140425325, 0.310557090, 0.597466694,
    ]
)  # fmt: skip
MARCHI_V = np.array(
    [
        0.094807616, 0.149243000, 0.174342933, 0.179243328, 0.169132064, 0.145730201,
        0.108775865, 0.057536559, -0.007748504, -0.084066715, -0.163010143, -0.227827313,
        -0.253768577, -0.218690812, -0.123318170,
    ]
)  # fmt: skip


# -- manufactured solutions --------------------------------------------------------------------


def viscosity(case, shear_rate, pressure):
    """Eta of the Drucker-Prager law, Pa s: mu_1 p/sqrt(gd^2 + gd_min^2) + viscosity."""
    law, rate_min = case.rheology, case.numerics.shear_rate_min
    return law.mu_1 * pressure / np.sqrt(shear_rate**2 + rate_min**2) + law.viscosity


def manufactured_force(case, flow, x, z):
    """Acceleration that makes `flow` a steady solution: div(u u + (p I - 2 eta D)/rho) - g.

    Parameters
    ----------
    flow : callable
        (x, z) -> u, w, p, u_x, u_z, w_x, analytic, with w_z = -u_x. The divergence is taken by
        complex steps, which are exact to round-off (Squire & Trapp 1998, SIAM Rev. 40, 110).

    Returns
    -------
    (f_x, f_z) : arrays
        m/s2, beside gravity.
    """

    def flux(x, z):
        u, w, p, u_x, u_z, w_x = flow(x, z)
        eta = (
            viscosity(case, np.sqrt(4 * u_x**2 + (u_z + w_x) ** 2), p) / case.rheology.density_bulk
        )
        p = p / case.rheology.density_bulk
        shear = u * w - eta * (u_z + w_x)
        return u * u + p - 2 * eta * u_x, shear, w * w + p + 2 * eta * u_x

    step = 1e-30
    along, across = flux(x + 1j * step, z + 0j), flux(x + 0j, z + 1j * step)
    slope = math.radians(case.geometry.slope_angle_deg)
    return (
        (along[0].imag + across[1].imag) / step - GRAVITY * math.sin(slope),
        (along[1].imag + across[2].imag) / step + GRAVITY * math.cos(slope),
    )


def manufactured_box(x, z):
    """Flow in the unit box with free slip: stream function 0.1 sin kx sin 2kz, k = pi, and p > 0.

    Shear and extension are both present (the Taylor-Green flow has no shear). Returns u, w, p, u_x,
    u_z, w_x.
    """
    k, a = math.pi, 0.1
    sin_x, cos_x, sin_z, cos_z = np.sin(k * x), np.cos(k * x), np.sin(2 * k * z), np.cos(2 * k * z)
    return (
        2 * k * a * sin_x * cos_z,
        -k * a * cos_x * sin_z,
        3000.0 * (1.0 + 0.5 * cos_x * np.cos(k * z)),
        2 * k**2 * a * cos_x * cos_z,
        -4 * k**2 * a * sin_x * sin_z,
        k**2 * a * sin_x * sin_z,
    )


def manufactured_surface(x):
    """Height of a curved free surface in the unit box, m; level at both walls."""
    return 0.6 + 0.1 * np.cos(math.pi * x)


def manufactured_below_surface(x, z):
    """Flow in the unit box below a curved free surface at rest, free slip on bed and walls.

    Stream function a sin(kx) (z y)^3 with the depth y below the surface: velocity, strain rate and
    pressure vanish on the surface, so that it bears no stress and does not move. Returns u, w, p,
    u_x, u_z, w_x.
    """
    k, a = math.pi, 15.0
    y, y_x, y_xx = (
        manufactured_surface(x) - z,
        -0.1 * k * np.sin(k * x),
        -0.1 * k**2 * np.cos(k * x),
    )
    s, s_x, s_xx = np.sin(k * x), k * np.cos(k * x), -(k**2) * np.sin(k * x)
    m, m_x, m_z, m_xx, m_xz, m_zz = z * y, z * y_x, y - z, z * y_xx, y_x, -2.0
    cube_x, cube_z = 3 * m**2 * m_x, 3 * m**2 * m_z
    cube_xx = 6 * m * m_x**2 + 3 * m**2 * m_xx
    cube_xz = 6 * m * m_x * m_z + 3 * m**2 * m_xz
    cube_zz = 6 * m * m_z**2 + 3 * m**2 * m_zz
    return (
        a * s * cube_z,
        -a * (s_x * m**3 + s * cube_x),
        10000.0 * y * (1.0 + 0.3 * np.cos(k * x)),
        a * (s_x * cube_z + s * cube_xz),
        a * s * cube_zz,
        -a * (s_xx * m**3 + 2 * s_x * cube_x + s * cube_xx),
    )


# -- collapses in the limit of a long, shallow flow --------------------------------------------


def huppert_front(area, viscosity_kinematic, time):
    """Front of a viscous current on a level bed that holds it: x_N = 1.411 (g q^3/(3 nu))^(1/5) t^(1/5).

    q is the area in x > 0. Asymptote for t -> infinity, whatever the start. Huppert (1982), J. Fluid
    Mech. 121, 43.
    """
    return 1.411 * (GRAVITY * area**3 / (3 * viscosity_kinematic) * time) ** 0.2


def huppert_depth(area, front, x):
    """Its depth: h = (q/x_N) (1 - (x/x_N)^2)^(1/3) / B, B = integral over [0, 1] = 0.8413.

    The shape solves h_t = g/(3 nu) (h^3 h_x)_x; B = sqrt(pi)/2 Gamma(4/3)/Gamma(11/6).
    """
    mean = 0.5 * math.sqrt(math.pi) * math.gamma(4 / 3) / math.gamma(11 / 6)
    return area / front / mean * np.maximum(1 - (np.asarray(x) / front) ** 2, 0.0) ** (1 / 3)


def dam_break_depth(case, x, time):
    """Depth of an inviscid, frictionless layer released at x = length_0; shallow-water theory.

    In the frame that falls with g sin a the bed is level: h = (2 c - s)^2/(9 g cos a) for -c < s <
    2 c, with s = (x - length_0 - g sin(a) t^2/2)/t and c = sqrt(g cos(a) H). Valid until the
    disturbance from the back wall arrives. Ritter (1892), Z. VDI 36, 947; Mangeney, Heinrich &
    Roche (2000), Pure Appl. Geophys. 157, 1081.
    """
    normal = gravity_normal(case)
    c = math.sqrt(normal * case.geometry.height_0)
    along = GRAVITY * math.sin(math.radians(case.geometry.slope_angle_deg))
    s = (np.asarray(x) - case.geometry.length_0 - 0.5 * along * time**2) / time
    return (2 * c - np.clip(s, -c, 2 * c)) ** 2 / (9 * normal)


def growth_rate(wave, shear_rate, tau, exponent, stress_slope, density):
    """Growth rate, 1/s, of a plane disturbance of a simple shear, for short waves.

    With the wave vector at angle theta to the flow, x = sin 2 theta, n = d ln tau / d ln shear_rate
    and t = d tau / d p, the momentum balance along and across the wave crests gives

        rate = k^2 tau / (rho shear_rate) ((1 - n)(1 - x^2) - 1 + t x) / (1 - t x),

    where the shear of the basic flow, which turns the wave, is left out (rate >> shear_rate). It is
    positive for some x exactly where `fvcollapse.step.ill_posedness` says so.

    Parameters
    ----------
    wave : (float, float)
        Wave vector, 1/m.
    shear_rate, tau, density : float
        1/s, Pa, kg/m3.
    """
    square = wave[0] ** 2 + wave[1] ** 2
    x = 2.0 * wave[0] * wave[1] / square
    bracket = (1.0 - exponent) * (1.0 - x * x) - 1.0 + stress_slope * x
    return square * tau / (density * shear_rate) * bracket / (1.0 - stress_slope * x)


def growth_rate_bagnold(case, wave, z, depth):
    """Growth rate of a plane disturbance at height z of a Bagnold flow; and the shear rate there; 1/s."""
    law = case.rheology
    mu = slope_ratio(case)
    inertial = inertial_number_at(mu, law)
    pressure = pressure_hydrostatic(case, np.array([z]), depth)[0]
    shear_rate = inertial * math.sqrt(pressure / law.density_grain) / law.grain_diameter
    exponent = inertial * (law.mu_2 - law.mu_1) * law.I_0 / (inertial + law.I_0) ** 2 / mu
    stress_slope = mu * (1.0 - 0.5 * exponent)
    rate = growth_rate(wave, shear_rate, mu * pressure, exponent, stress_slope, law.density_bulk)
    return rate, shear_rate
