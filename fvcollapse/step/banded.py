"""LAPACK's banded Cholesky factorisation, callable from compiled code.

scipy ships the addresses of its LAPACK routines; they are handed to the kernels as integers,
because a kernel that holds a function pointer as a constant cannot be cached on disk.
"""

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.core import cgutils
from numba.extending import get_cython_function_address, intrinsic


def lapack_addresses():
    """Addresses of dpbtrf (factorise) and dpbtrs (solve) as an int64 array of two."""
    names = ("dpbtrf", "dpbtrs")
    return np.array(
        [get_cython_function_address("scipy.linalg.cython_lapack", name) for name in names],
        np.int64,
    )


def _call_by_address(n_arguments):
    """Intrinsic calling `void f(void*, ...)` with `n_arguments` pointers at an integer address."""

    @intrinsic
    def call(typingctx, address, pointers):
        signature = types.void(types.int64, types.UniTuple(types.int64, n_arguments))

        def codegen(context, builder, signature, args):
            address_value, pointer_tuple = args
            pointer = ir.IntType(8).as_pointer()
            function_type = ir.FunctionType(ir.VoidType(), [pointer] * n_arguments)
            function = builder.inttoptr(address_value, function_type.as_pointer())
            values = [
                builder.inttoptr(v, pointer) for v in cgutils.unpack_tuple(builder, pointer_tuple)
            ]
            builder.call(function, values)
            return context.get_dummy_value()

        return signature, codegen

    return call


_call_7 = _call_by_address(7)
_call_10 = _call_by_address(10)


@njit(cache=True)
def factorise(band, integers, addresses):
    """Cholesky factor of the band in place; return LAPACK's info (0 = done, j > 0 = pivot j not positive).

    Parameters
    ----------
    band : (n, kd + 1) float array
        Lower band, band[c, r - c] = A[r, c]; overwritten by the factor.
    integers : (8,) int32 array
        Scratch for LAPACK's integer arguments.
    addresses : (2,) int64 array
        From `lapack_addresses`.
    """
    n, width = band.shape
    integers[0] = ord("L")
    integers[1] = n
    integers[2] = width - 1
    integers[3] = width
    base = integers.ctypes.data
    _call_7(
        addresses[0], (base, base + 4, base + 8, band.ctypes.data, base + 12, base + 16, base + 16)
    )
    return integers[4]


@njit(cache=True)
def solve_factorised(rhs, band, integers, addresses):
    """Overwrite `rhs` (n,) with the solution, from the factor left by `factorise`."""
    n, width = band.shape
    integers[0] = ord("L")
    integers[1] = n
    integers[2] = width - 1
    integers[3] = width
    integers[5] = 1
    base = integers.ctypes.data
    _call_10(
        addresses[1],
        (
            base,
            base + 4,
            base + 8,
            base + 20,
            band.ctypes.data,
            base + 12,
            rhs.ctypes.data,
            base + 4,
            base + 16,
            base + 16,
        ),
    )
