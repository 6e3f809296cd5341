"""The second half of the kernels of a step, compiled by one process while another compiles the first half.

A process compiles the kernels in the order in which a step reaches them, one at a time: the solve comes in the middle.
A second process begins with those after it. Each takes from the disk what the other has kept there
(`files/kernel_cache.py`), so that none has to wait for the other.

    python -m fvcollapse.output.second_half TOML

compiles the second half for the case whose text is given. It ends when its standard input ends, which the process that
started it holds open.
"""

import os
import sys
import threading
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
from numba import typeof

from fvcollapse.case.case import case_from_text
from fvcollapse.files.kernel_cache import kept_types
from fvcollapse.march import march
from fvcollapse.step.advance import COMPILED, balance_of
from fvcollapse.step.constants import constants_of
from fvcollapse.step.domain import allocate
from fvcollapse.step.flow import flow_of, packing_of
from fvcollapse.step.guards import broken_law, watch_of
from fvcollapse.step.initial import initial_grid, initial_state
from fvcollapse.step.terms import terms_of

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


def simulation_types(case: "Case") -> tuple:
    """Numba's types of the `Flow` and the `Watch` of a case; they depend on its effects alone.

    They are those of a `Simulation` before its first step, for which nothing is compiled but what allocates it.
    """
    case = case.resolved
    state, constants = initial_state(case, initial_grid(case)), constants_of(case)
    for _, start in terms_of(case).start:
        start(state, case)
    bare = SimpleNamespace(state=state, halo=0)
    allocate(bare)
    arrays = np.zeros(2), bare.carrier, bare.geometry, bare.work, bare.unit_packing
    return typeof(flow_of(state, state.copy(), arrays, constants)), typeof(watch_of(case, 0.0))


def is_kept(flow: Any) -> bool:
    """Whether a march with this type of `Flow` is on the disk, or was compiled here; True where none is kept."""
    kept = kept_types(march)
    return kept is None or any(types[0] == flow for types in (*kept, *march.overloads))


def compile_second_half(flow: Any, watch: Any) -> None:
    """Compile what follows the solve in a step, and what precedes it but needs none of its kernels.

    What the first process reaches last is compiled first.

    Parameters
    ----------
    flow, watch : numba.types.Type
        See `simulation_types`.
    """
    number, field = typeof(0.0), typeof(np.empty((1, 1)))
    compiled(COMPILED.continue_velocity, flow)
    compiled(broken_law, flow, watch, number, number)
    balance = compiled(balance_of, flow, number)
    impulse, _ = compiled(COMPILED.act_before_solve, flow, field, field, balance)
    compiled(COMPILED.finish_terms, flow, number)
    packing = compiled(packing_of, flow)
    compiled(COMPILED.carry_momentum, flow, packing, number)
    moved = compiled(COMPILED.move_surface, flow, number)
    compiled(COMPILED.book_energy, flow, moved, field, field, impulse, balance)
    compiled(COMPILED.choose_step, flow, number)
    compiled(COMPILED.room_needed, flow)


def compiled(kernel: Any, *types: Any) -> Any:
    """Compile a kernel for these types of its arguments, or read it from the disk; return the type of its result."""
    kernel.compile(types)
    return kernel.overloads[types].signature.return_type


def end_with_the_starter() -> None:
    """Wait for the end of standard input, then end this process."""
    while os.read(0, 1):  # standard input itself: its buffer would be locked when this process ends
        pass
    os._exit(1)


def main(text: str) -> None:
    """Compile the second half for the case of this text."""
    threading.Thread(target=end_with_the_starter, daemon=True).start()
    compile_second_half(*simulation_types(case_from_text(text)))


if __name__ == "__main__":
    main(sys.argv[1])
