"""Sums and differences of rows, eight numbers at once, as LLVM vector instructions.

The rows of a band are short (5 to 100 numbers) and lie in one array, so that a compiler which sees a
plain loop checks for overlap and peels the remainder before it uses vector instructions: these
two operations leave that out. They work on whole groups of `LANES` numbers: up to LANES - 1 numbers
behind the end of a row are read and written too. The caller pads the arrays, and keeps zeros behind
every source row, so that what is written there is what stood there.
"""

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

LANES = 8
VECTOR = ir.VectorType(ir.DoubleType(), LANES)
INDEX = ir.IntType(64)
CONTRACT = ("contract",)  # a product and a sum may become one fused instruction


def _data(context, builder, signature, args, n):
    """Pointer to the first number of the array that is argument n."""
    return context.make_array(signature.args[n])(context, builder, args[n]).data


def _group(builder, data, place):
    """Pointer to the group of numbers that begins at `place`."""
    return builder.bitcast(builder.gep(data, [place]), VECTOR.as_pointer())


def _spread(builder, number):
    """A group that holds `number` in every lane."""
    nothing = ir.Constant(VECTOR, ir.Undefined)
    first = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    one = builder.insert_element(nothing, number, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(one, nothing, first)


def _total(builder, group):
    """Sum over the lanes, in pairs."""
    parts = [builder.extract_element(group, ir.Constant(ir.IntType(32), n)) for n in range(LANES)]
    while len(parts) > 1:
        half = len(parts) // 2
        parts = [builder.fadd(parts[n], parts[n + half]) for n in range(half)]
    return parts[0]


def _groups(builder, count):
    """Loop over the beginnings of the groups that cover `count` numbers."""
    return cgutils.for_range_slice(builder, INDEX(0), count, INDEX(LANES), inc=True)


@intrinsic
def subtract_rows(typingctx, target, starts, source, places, factors, count):
    """target[s + m] -= sum_p factors[s][p] source[places[p] + m], m < count, for each start s.

    `target` and `source` are one-dimensional float64 arrays and may be the same one; `starts` (T,),
    `places` (P,) and `factors` (T, P) are tuples. Every source row is read once for all targets.
    """
    signature = types.void(target, starts, source, places, factors, types.int64)

    def generate(context, builder, signature, args):
        target, source = (_data(context, builder, signature, args, n) for n in (0, 2))
        starts, places, rows = (cgutils.unpack_tuple(builder, args[n]) for n in (1, 3, 4))
        factors = [[_spread(builder, f) for f in cgutils.unpack_tuple(builder, r)] for r in rows]
        with _groups(builder, args[5]) as (m, _):
            goals = [_group(builder, target, builder.add(start, m)) for start in starts]
            values = [builder.load(goal, align=8) for goal in goals]
            for p, place in enumerate(places):
                row = builder.load(_group(builder, source, builder.add(place, m)), align=8)
                for t, factor in enumerate(factors):
                    product = builder.fmul(factor[p], row, flags=CONTRACT)
                    values[t] = builder.fsub(values[t], product, flags=CONTRACT)
            for value, goal in zip(values, goals, strict=True):
                builder.store(value, goal, align=8)
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def row_products(typingctx, vector, start, source, places, count):
    """Tuple of sum_m vector[start + m] source[place + m], m < count, one for each of `places`."""
    result = types.UniTuple(types.float64, len(places))
    signature = result(vector, types.int64, source, places, types.int64)

    def generate(context, builder, signature, args):
        vector, source = (_data(context, builder, signature, args, n) for n in (0, 2))
        places = cgutils.unpack_tuple(builder, args[3])
        nought = ir.Constant(VECTOR, [0.0] * LANES)
        sums = [cgutils.alloca_once_value(builder, nought) for _ in places]
        with _groups(builder, args[4]) as (m, _):
            value = builder.load(_group(builder, vector, builder.add(args[1], m)), align=8)
            for place, so_far in zip(places, sums, strict=True):
                row = builder.load(_group(builder, source, builder.add(place, m)), align=8)
                product = builder.fmul(value, row, flags=CONTRACT)
                builder.store(builder.fadd(builder.load(so_far), product, flags=CONTRACT), so_far)
        totals = [_total(builder, builder.load(so_far)) for so_far in sums]
        return context.make_tuple(builder, signature.return_type, totals)

    return signature, generate
