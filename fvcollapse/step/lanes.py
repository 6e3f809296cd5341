"""Sums and differences of rows, eight numbers at once, as LLVM vector instructions.

The rows of a band are short (5 to 100 numbers) and lie in one array, so that a compiler which sees a
plain loop checks for overlap and peels the remainder before it uses vector instructions: these
operations leave that out. They work on whole groups of `LANES` numbers: up to LANES - 1 numbers
behind the end of a row are read and written too. The caller pads the arrays, and keeps zeros behind
every source row, so that what is written there is what stood there.
"""

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

LANES = 8
VECTOR = ir.VectorType(ir.DoubleType(), LANES)
MASK = ir.VectorType(ir.IntType(1), LANES)
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
def scale_rows(typingctx, scaled, flat, start, step, pivot, skip, count):
    """scaled[LANES p + t] = flat[start + p step + t] flat[pivot + p skip], p < count, t < LANES."""
    signature = types.void(scaled, flat, *[types.int64] * 5)

    def generate(context, builder, signature, args):
        scaled, flat = (_data(context, builder, signature, args, n) for n in (0, 1))
        start, step, pivot, skip, count = args[2:]
        with cgutils.for_range(builder, count) as loop:
            place = builder.add(start, builder.mul(loop.index, step))
            row = builder.load(_group(builder, flat, place), align=8)
            at = builder.gep(flat, [builder.add(pivot, builder.mul(loop.index, skip))])
            goal = _group(builder, scaled, builder.mul(loop.index, INDEX(LANES)))
            builder.store(builder.fmul(row, _spread(builder, builder.load(at))), goal, align=8)
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def subtract_block(typingctx, flat, start, step, source, count, scaled, rows):
    """flat[start + t step + m] -= sum_p scaled[LANES p + t] flat[source + p step + m], t <= m < rows.

    For LANES columns t at once and `count` source rows p: a group of the target is read and written
    once, and stays in registers between. In the first group what lies above the diagonal is kept.
    """
    signature = types.void(flat, *[types.int64] * 4, scaled, types.int64)

    def generate(context, builder, signature, args):
        flat, scaled = (_data(context, builder, signature, args, n) for n in (0, 5))
        start, step, source, count, rows = (args[n] for n in (1, 2, 3, 4, 6))
        starts = [start]
        while len(starts) < LANES:
            starts.append(builder.add(starts[-1], step))

        def subtract(m, keep_above):
            goals = [_group(builder, flat, builder.add(begin, m)) for begin in starts]
            before = [builder.load(goal, align=8) for goal in goals]
            sums = [cgutils.alloca_once_value(builder, value) for value in before]
            with cgutils.for_range(builder, count) as loop:
                place = builder.add(source, builder.mul(loop.index, step))
                row = builder.load(_group(builder, flat, builder.add(place, m)), align=8)
                first = builder.mul(loop.index, INDEX(LANES))
                for t, so_far in enumerate(sums):
                    at = builder.gep(scaled, [builder.add(first, INDEX(t))])
                    product = builder.fmul(_spread(builder, builder.load(at)), row, flags=CONTRACT)
                    rest = builder.fsub(builder.load(so_far), product, flags=CONTRACT)
                    builder.store(rest, so_far)
            for t, goal in enumerate(goals):
                value = builder.load(sums[t])
                if keep_above and t > 0:
                    below = [ir.IntType(1)(int(lane >= t)) for lane in range(LANES)]
                    value = builder.select(ir.Constant(MASK, below), value, before[t])
                builder.store(value, goal, align=8)

        subtract(INDEX(0), True)
        others = cgutils.for_range_slice(builder, INDEX(LANES), rows, INDEX(LANES), inc=True)
        with others as (m, _):
            subtract(m, False)
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
