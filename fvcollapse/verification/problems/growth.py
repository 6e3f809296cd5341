"""Growth of a small disturbance of a uniform flow, against the linear theory of the local equations.

A wave packet of velocity, free of divergence and a few wavelengths from bed and surface, is laid on a
steady mu(I) layer. Two runs, with and without it, are subtracted, so that only what is linear in the
packet is left; its amplitude is read off by projection on the wave, which the shear turns. Large
grains make the rate of the packet large against that of the shear, which the theory leaves out.
"""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.step.initial import HALO
from fvcollapse.verification import exact, terms
from fvcollapse.verification.flows import layer, layer_case, run_until
from fvcollapse.verification.problem import Problem

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


DEPTH = 0.12  # m
WAVELENGTH = DEPTH / 6.0  # normal to the bed
ORIENTATION = 0.2  # sine of twice the angle between wave vector and bed: about the fastest
ASPECT = 4.0  # cells are longer than high, as the wave is
STEP = 0.04  # of the e-folding time


def growth_case(slope_angle_deg: float, cells: int, wave: Any) -> "Case":
    """A steady layer on `cells` per wavelength, one wavelength long."""
    height = WAVELENGTH / cells
    length = 2.0 * math.pi / wave[0]
    return layer_case(
        length / round(length / (ASPECT * height)),
        DEPTH,
        grid__cell_size_z=height,
        geometry__length_0=length,
        geometry__slope_angle_deg=slope_angle_deg,
        boundary__mu_bed=math.inf,
        rheology__mu_1=0.38,
        rheology__mu_2=0.64,
        rheology__grain_diameter=0.005,
        numerics__tolerance=1e-7,
    )


class Packet:
    """The same flow with and without a wave packet."""

    def __init__(self, case, wave, dt):
        self.wave, self.start = wave, layer(case, lambda z: exact.bagnold(case, z), dt=dt)
        self.flow = layer(case, lambda z: exact.bagnold(case, z), dt=dt)
        grid = self.flow.grid
        self.x, self.z = grid.dx * (np.arange(grid.nx + 1) - HALO), grid.z_centres
        phase = wave[0] * self.x[:, None] + wave[1] * grid.z_nodes
        strength = 1e-4 * exact.bagnold(case, np.array([DEPTH]))[0] / wave[1]
        stream = strength * np.cos(phase) * envelope(grid.z_nodes)
        self.flow.state.u += np.diff(stream, axis=1) / grid.dz
        self.flow.state.w -= np.diff(stream, axis=0) / grid.dx
        self.flow.state.w[:, 0] = 0.0

    def amplitude(self, time: float, shear_rate: float) -> Any:
        """Amplitude of the packet at `time`, its wave vector turned by the shear."""
        for flow in (self.start, self.flow):
            run_until(flow, time)
        here = slice(HALO, -HALO - 1)
        difference = (self.flow.state.u - self.start.state.u)[here]
        turned = self.wave[1] - self.wave[0] * shear_rate * time
        wave = np.exp(-1j * (self.wave[0] * self.x[here, None] + turned * self.z))
        return abs((difference * wave * envelope(self.z)).sum())


def envelope(z: Any) -> Any:
    """Gaussian about mid depth, one wavelength wide."""
    return np.exp(-0.5 * ((z - 0.5 * DEPTH) / WAVELENGTH) ** 2)


def growth_errors(slope_angle_deg: float) -> Callable:
    """Measured growth rate over the theoretical one, less 1, on a number of cells per wavelength."""

    def errors(cells):
        along = 2.0 * math.pi / WAVELENGTH
        wave = along * math.tan(0.5 * math.asin(ORIENTATION)), along
        case = growth_case(slope_angle_deg, cells, wave)
        rate, shear_rate = exact.growth_rate_bagnold(case, wave, 0.5 * DEPTH, DEPTH)
        dt = STEP / abs(rate)
        packet = Packet(case, wave, dt)
        times = np.array([0.2, 0.6, 1.0]) / abs(rate)
        amplitudes = [packet.amplitude(time, shear_rate) for time in times]
        found = np.polyfit(times, np.log(amplitudes), 1)[0]
        expected = -math.log(1.0 - rate * dt) / dt  # of the implicit step
        return found / expected - 1.0

    return errors


PROBLEMS = (
    Problem(
        "growth_ill_posed",
        terms.ILL_POSEDNESS,
        growth_errors(21.2),
        (8, 16, 24),
        2.0,
        0.05,
    ),
    Problem(
        "growth_well_posed",
        terms.ILL_POSEDNESS,
        growth_errors(23.0),
        (8, 16, 24),
        None,
        0.05,
        "validity of the theory: shear rate over rate of decay, 0.04",
    ),
)
