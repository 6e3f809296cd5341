"""Transport by given fluxes of mass: what a quantity is after they have carried it, upwind and conservative.

The few places through which something flows are listed first, once for both stages of a step: the
loops that follow have no branches and visit no air.
"""

from typing import NamedTuple

import numpy as np

from .compiled import inner_jit, kernel_jit
from .stencils import upwind_weno3


class Passages(NamedTuple):
    """The fluxes of mass between the control volumes of one component, in a list: see `list_passages`.

    flux (n,): in cells, none is zero; here, there (n,): the faces it leaves and enters, if positive;
    first, middle, last (n,): the three velocities of its upwind reconstruction, as places in the
    padded component; end (nk,): what leaves through the far end; after (ni, nk): mass of each control
    volume after the step, in cells. Places are those in the flat arrays.
    """

    flux: np.ndarray
    here: np.ndarray
    there: np.ndarray
    first: np.ndarray
    middle: np.ndarray
    last: np.ndarray
    end: np.ndarray
    after: np.ndarray


@inner_jit()
def _new_passages(count, end, mass):
    return Passages(
        np.empty(count),
        np.empty(count, np.uint32),  # unsigned: no index can count from the end
        np.empty(count, np.uint32),
        np.empty(count, np.uint32),
        np.empty(count, np.uint32),
        np.empty(count, np.uint32),
        end,
        np.zeros_like(mass),
    )


@inner_jit()
def _list_one(passages, n, flux, here, hop, place, leap):
    """Put the flux from `here` to `here + hop` at n; `place` and `leap` are the same two in the padded array."""
    passages.flux[n] = flux
    passages.here[n] = here
    passages.there[n] = here + hop
    onward = flux > 0.0
    passages.first[n] = place - leap if onward else place + 2 * leap
    passages.middle[n] = place if onward else place + leap
    passages.last[n] = place + leap if onward else place


@kernel_jit()
def list_passages(along, across, end, mass, reach, di, dk):
    """The `Passages` of a component in direction (di, dk).

    Parameters
    ----------
    along, across : (nx, nz), (nx + 1, nz + 1) arrays
        From `mass_fluxes`.
    end : (nk,) array
        Flux through the far end.
    mass : (ni, nk) array
        Of every control volume before the step, in cells.
    reach : (nx + 1,) array
        From `rows_in_reach`.
    """
    nx, width = along.shape[0], mass.shape[1]
    wide = width + 4
    most = 0
    for i in range(nx + 1):
        most += 2 * (reach[i] + 1)
    passages = _new_passages(most, end, mass)
    n = 0
    hop, leap = di * width + dk, di * wide + dk
    for i in range(nx):
        for k in range(reach[i]):
            if along[i, k] != 0.0:
                here, place = i * width + k, (i + 2) * wide + k + 2
                _list_one(passages, n, along[i, k], here, hop, place, leap)
                n += 1
    hop, leap = dk * width + di, dk * wide + di
    for i in range(dk, across.shape[0] - dk):
        for k in range(di, min(reach[i] + 1, across.shape[1] - di)):
            if across[i, k] != 0.0:
                here, place = i * width + k - hop, (i + 2) * wide + k + 2 - leap
                _list_one(passages, n, across[i, k], here, hop, place, leap)
                n += 1
    listed = Passages(
        passages.flux[:n],
        passages.here[:n],
        passages.there[:n],
        passages.first[:n],
        passages.middle[:n],
        passages.last[:n],
        end,
        passages.after,
    )
    _mass_after(listed, mass)
    return listed


@inner_jit()
def _mass_after(passages, mass):
    """Mass of every control volume after the step.

    A control volume from which more flows out than stays keeps the momentum that this overdraws.
    """
    arriving, leaving = np.zeros(mass.size), np.zeros(mass.size)
    for n in range(passages.flux.size):
        flux, here, there = passages.flux[n], passages.here[n], passages.there[n]
        leaving[here] += max(flux, 0.0)
        arriving[there] += max(flux, 0.0)
        arriving[here] += max(-flux, 0.0)
        leaving[there] += max(-flux, 0.0)
    last = mass.size - passages.end.size
    for k in range(passages.end.size):
        leaving[last + k] += max(passages.end[k], 0.0)
        arriving[last + k] += max(-passages.end[k], 0.0)
    before, after = mass.reshape(-1), passages.after.reshape(-1)
    for n in range(mass.size):
        arrives, leaves = arriving[n], leaving[n]
        after[n] = max(before[n] + arrives - leaves, max(arrives, leaves))


@inner_jit()
def _let_out(gain, start, padded, end, di):
    """Book what leaves through the far end of the domain: from the last face itself (u), or beside it (w)."""
    i = start.shape[0] - 1
    for k in range(start.shape[1]):
        here = padded[i + 2, k + 2]
        if end[k] > 0.0 and di == 0:
            here = upwind_weno3(padded[i + 1, k + 2], here, padded[i + 3, k + 2])
        gain[i, k] -= end[k] * (here - start[i, k])


@inner_jit(error_model="numpy")
def _reconstruct(carried, padded, first, middle, last):
    """Velocity that each flux carries: a loop of its own, for vector instructions."""
    for n in range(carried.size):
        carried[n] = upwind_weno3(padded[first[n]], padded[middle[n]], padded[last[n]])


@kernel_jit(error_model="numpy")
def transport(moved, start, padded, passages, di, shape_factor):
    """One stage: moved = (mass * start + fluxes of `padded`) / (mass + fluxes), for a shape factor of 1.

    The momentum is conserved in the transported mass, from which the lever-rule mass of the solve
    differs at the surface. `di` is 1 for the component along the bed, or of cells, and 0 for the other.
    """
    carried = np.empty(passages.flux.size)
    values = padded.reshape(-1)
    _reconstruct(carried, values, passages.first, passages.middle, passages.last)
    gain = np.zeros_like(start)
    gained, old = gain.reshape(-1), start.reshape(-1)
    for n in range(carried.size):
        flux, here, there = passages.flux[n], passages.here[n], passages.there[n]
        gained[here] -= flux * (carried[n] - old[here])
        gained[there] += flux * (carried[n] - old[there])
    _let_out(gain, start, padded, passages.end, di)
    new, after = moved.reshape(-1), passages.after.reshape(-1)
    for n in range(new.size):
        new[n] = old[n]
        if after[n] > 0.0:
            new[n] = old[n] + shape_factor * (gained[n] / after[n])
