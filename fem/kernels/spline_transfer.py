"""Transfers between a material point and the nine nodes around it, in vector instructions: the records of a node are
added to and read as wholes.

A compiler that does not know that the fields of a node lie side by side for this purpose handles them one by one. The
order of all sums is that of the nodes, column by column, so that results do not depend on the width of the vectors.
"""

from typing import Any

from llvmlite import ir
from numba import config, types
from numba.core import cgutils
from numba.extending import intrinsic

NODE = 8  # doubles in the record of a node that points add to, one cache line
VELOCITIES = 4  # doubles in the record of the velocities of a node

_double, _word = ir.DoubleType(), ir.IntType(64)
_THREE, _COLUMNS = types.UniTuple(types.float64, 3), types.UniTuple(types.uintp, 3)


def _record(context: Any, builder: Any, kind: Any, array: Any, place: Any, size: int) -> Any:
    """Return a pointer to a record of an array as a vector."""
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [place]), ir.VectorType(_double, size).as_pointer())


def _vector(builder: Any, values: list[Any]) -> Any:
    """Return a vector of some values."""
    out = ir.Constant(ir.VectorType(_double, len(values)), ir.Undefined)
    for lane, value in enumerate(values):
        out = builder.insert_element(out, value, ir.IntType(32)(lane))
    return out


@intrinsic
def add_to_nodes(
    context: Any, nodes: Any, places: Any, across: Any, upwards: Any, dx: Any, dz: Any, at_point: Any, by_x: Any,
    by_z: Any,
) -> Any:  # fmt: skip
    """Add w (at_point + dx by_x + dz by_z) to nine records of NODE numbers; w is the product of two weights.

    context: typing context of Numba; nodes, places, across, upwards, dx, dz: as in `collect_nodes`; at_point, by_x,
    by_z: tuples of NODE numbers.
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        starts, along, up, right, above = (cgutils.unpack_tuple(builder, part) for part in arguments[1:6])
        constant, x_rate, z_rate = (_vector(builder, cgutils.unpack_tuple(builder, part)) for part in arguments[6:9])
        rises = [builder.fmul(_vector(builder, [value] * NODE), z_rate) for value in above]
        for a in range(3):
            column = builder.fadd(constant, builder.fmul(_vector(builder, [right[a]] * NODE), x_rate))
            for b in range(3):
                place = builder.add(starts[a], _word(b * NODE))
                record = _record(context, builder, signature.args[0], arguments[0], place, NODE)
                share = _vector(builder, [builder.fmul(along[a], up[b])] * NODE)
                added = builder.fmul(share, builder.fadd(column, rises[b]))
                builder.store(builder.fadd(builder.load(record, align=8), added), record, 8)
        return context.get_dummy_value()

    fields = types.UniTuple(types.float64, NODE)
    return types.none(nodes, _COLUMNS, _THREE, _THREE, _THREE, _THREE, fields, fields, fields), generate


@intrinsic
def collect_nodes(context: Any, nodes: Any, places: Any, across: Any, upwards: Any, dx: Any, dz: Any) -> Any:
    """Return Σ w V, Σ w V dx and Σ w V dz, one after the other, over nine records V of VELOCITIES numbers; w is the
    product of two weights.

    context: typing context of Numba; nodes: one-dimensional array; places: first place of the lowest node of each of
    three columns; across, upwards: weights of the columns and of the rows; dx, dz: distances of columns and rows.
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        starts, along, up, right, above = (cgutils.unpack_tuple(builder, part) for part in arguments[1:6])
        rights = [_vector(builder, [value] * VELOCITIES) for value in right]
        aboves = [_vector(builder, [value] * VELOCITIES) for value in above]
        zero = ir.Constant(ir.VectorType(_double, VELOCITIES), [0.0] * VELOCITIES)
        total = by_x = by_z = zero
        for a in range(3):
            column = zero
            for b in range(3):
                place = builder.add(starts[a], _word(b * VELOCITIES))
                record = _record(context, builder, signature.args[0], arguments[0], place, VELOCITIES)
                share = _vector(builder, [builder.fmul(along[a], up[b])] * VELOCITIES)
                part = builder.fmul(share, builder.load(record, align=8))
                column = builder.fadd(column, part)
                by_z = builder.fadd(by_z, builder.fmul(part, aboves[b]))
            total = builder.fadd(total, column)
            by_x = builder.fadd(by_x, builder.fmul(column, rights[a]))
        sums = [
            builder.extract_element(v, ir.IntType(32)(lane)) for v in (total, by_x, by_z) for lane in range(VELOCITIES)
        ]
        return context.make_tuple(builder, signature.return_type, sums)

    return types.UniTuple(types.float64, 3 * VELOCITIES)(nodes, _COLUMNS, _THREE, _THREE, _THREE, _THREE), generate


if config.DISABLE_JIT:

    def add_to_nodes(
        nodes: Any, places: Any, across: Any, upwards: Any, dx: Any, dz: Any, at_point: Any, by_x: Any, by_z: Any
    ) -> None:
        """Do the same as `add_to_nodes` without vector instructions."""
        for a in range(3):
            for b in range(3):
                for field in range(NODE):
                    value = at_point[field] + dx[a] * by_x[field] + dz[b] * by_z[field]
                    nodes[int(places[a]) + b * NODE + field] += across[a] * upwards[b] * value

    def collect_nodes(nodes: Any, places: Any, across: Any, upwards: Any, dx: Any, dz: Any) -> tuple[float, ...]:
        """Do the same as `collect_nodes` without vector instructions."""
        sums = [0.0] * (3 * VELOCITIES)
        for field in range(VELOCITIES):
            for a in range(3):
                column = 0.0
                for b in range(3):
                    part = across[a] * upwards[b] * nodes[int(places[a]) + b * VELOCITIES + field]
                    column += part
                    sums[2 * VELOCITIES + field] += part * dz[b]
                sums[field] += column
                sums[VELOCITIES + field] += column * dx[a]
        return tuple(sums)
