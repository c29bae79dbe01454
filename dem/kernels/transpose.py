"""Transposes records of a few doubles to rows of 64 and back, eight at a time, in registers.

Eight contacts read records of eight partners in no regular order; a compiler that cannot analyse such indices copies
them double by double. The functions of this module read the record of each disc, and of each kind of pair, two doubles
at a time, and write it as two rows of eight. Values are only copied, so that results do not depend on the method.
"""

from typing import Any

from llvmlite import ir
from numba import config, types
from numba.core import cgutils
from numba.extending import intrinsic

LANE_GROUP = 8  # lanes at a time
SHARED = 8  # doubles in the record of a disc: the fields of a partner that a contact reads, one cache line
CONSTANT_RECORD = 24  # doubles from one record of constants to the next
_ROW = 64

_double = ir.DoubleType()
_pair = ir.VectorType(_double, 2)
_eight = ir.VectorType(_double, LANE_GROUP)


def _order(*lanes: int) -> ir.Constant:
    return ir.Constant(ir.VectorType(ir.IntType(32), len(lanes)), list(lanes))


_LOW, _HIGH = _order(0, 8, 2, 10, 4, 12, 6, 14), _order(1, 9, 3, 11, 5, 13, 7, 15)


def _data(context: Any, builder: Any, kind: Any, array: Any) -> Any:
    return context.make_array(kind)(context, builder, array).data


def _at(builder: Any, data: Any, place: Any, vector: ir.Type) -> Any:
    return builder.bitcast(builder.gep(data, [place]), vector.as_pointer())


def _join(builder: Any, parts: list[Any]) -> Any:
    """Concatenate vectors."""
    while len(parts) > 1:
        order = _order(*range(2 * parts[0].type.count))
        parts = [builder.shuffle_vector(a, b, order) for a, b in zip(parts[0::2], parts[1::2], strict=True)]
    return parts[0]


def _all(builder: Any, value: Any) -> Any:
    """Return a vector of eight equal entries."""
    single = builder.insert_element(
        ir.Constant(ir.VectorType(value.type, LANE_GROUP), ir.Undefined), value, ir.IntType(32)(0)
    )
    return builder.shuffle_vector(single, single, _order(*[0] * LANE_GROUP))


def _turn(builder: Any, source: Any, begin: list[Any], fields: int, target: Any, to: Any) -> None:
    """Transpose the first `fields` of the eight records that begin at these places of `source` into rows of
    `target`."""
    word = ir.IntType(64)
    for field in range(0, fields, 2):
        parts = [builder.load(_at(builder, source, builder.add(start, word(field)), _pair), align=8) for start in begin]
        even, odd = _join(builder, parts[0::2]), _join(builder, parts[1::2])
        for row, order in enumerate((_LOW, _HIGH)):
            place = builder.add(to, word((field + row) * _ROW))
            builder.store(builder.shuffle_vector(even, odd, order), _at(builder, target, place, _eight), 8)


@intrinsic(prefer_literal=True)
def gather(context: Any, records: Any, apart: Any, fields: Any, places: Any, first: Any, rows: Any, to: Any) -> Any:
    """Copy the first `fields` of eight records into rows[to : to + 8], rows[to + 64 : to + 72] and so on.

    context: typing context of Numba; records: array of records; the records places[first] to places[first + 7] are
    read; `apart` is the distance of one record to the next. `apart` and `fields`, an even number, are constants where
    this is called.
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        source = _data(context, builder, signature.args[0], arguments[0])
        index = _data(context, builder, signature.args[3], arguments[3])
        target = _data(context, builder, signature.args[5], arguments[5])
        word = ir.IntType(64)
        begin = []
        for lane in range(LANE_GROUP):
            place = builder.load(builder.gep(index, [builder.add(arguments[4], word(lane))]))
            begin.append(builder.mul(builder.zext(place, word), word(apart.literal_value)))
        _turn(builder, source, begin, fields.literal_value, target, arguments[6])
        return context.get_dummy_value()

    return types.none(records, apart, fields, places, types.uintp, rows, types.uintp), generate


@intrinsic
def unfold(context: Any, records: Any, at: Any, rows: Any, to: Any) -> Any:
    """Copy eight consecutive records of discs, from records[at] on, into eight rows: the inverse of `spread`.

    context: typing context of Numba; the rows begin at rows[to].
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        source = _data(context, builder, signature.args[0], arguments[0])
        target = _data(context, builder, signature.args[2], arguments[2])
        word = ir.IntType(64)
        begin = [builder.add(arguments[1], word(lane * SHARED)) for lane in range(LANE_GROUP)]
        _turn(builder, source, begin, SHARED, target, arguments[3])
        return context.get_dummy_value()

    return types.none(records, types.uintp, rows, types.uintp), generate


@intrinsic
def spread(context: Any, rows: Any, at: Any, records: Any, to: Any) -> Any:
    """Copy eight rows of eight, rows[at : at + 8], rows[at + 64 : at + 72] and so on, into eight records at
    records[to].

    context: typing context of Numba.
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        source = _data(context, builder, signature.args[0], arguments[0])
        target = _data(context, builder, signature.args[2], arguments[2])
        word = ir.IntType(64)
        for field in range(0, SHARED, 2):
            low, high = (
                builder.load(_at(builder, source, builder.add(arguments[1], word((field + k) * _ROW)), _eight), align=8)
                for k in (0, 1)
            )
            for odd, order in enumerate((_LOW, _HIGH)):
                both = builder.shuffle_vector(low, high, order)
                for k in range(0, LANE_GROUP, 2):
                    place = builder.add(arguments[3], word((k + odd) * SHARED + field))
                    part = builder.shuffle_vector(both, both, _order(k, k + 1))
                    builder.store(part, _at(builder, target, place, _pair), 8)
        return context.get_dummy_value()

    return types.none(rows, types.uintp, records, types.uintp), generate


@intrinsic
def add_gathered(context: Any, values: Any, places: Any, first: Any, rows: Any, to: Any) -> Any:
    """Add eight values from arbitrary places to each of three rows: rows[to : to + 8], rows[to + 64 : to + 72], ...

    The first row gets the values at places[first] to places[first + 7], the second and third row get the values 64 and
    128 places further. LLVM decides whether the processor gathers them with one instruction. context: typing context of
    Numba.
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        source = _data(context, builder, signature.args[0], arguments[0])
        index = _data(context, builder, signature.args[1], arguments[1])
        target = _data(context, builder, signature.args[3], arguments[3])
        word, number = ir.IntType(64), ir.VectorType(index.type.pointee, LANE_GROUP)
        wide, mask = ir.VectorType(word, LANE_GROUP), ir.VectorType(ir.IntType(1), LANE_GROUP)
        begin = builder.load(_at(builder, index, arguments[2], number), align=index.type.pointee.width // 8)
        begin = builder.zext(begin, wide)
        pointers = ir.VectorType(_double.as_pointer(), LANE_GROUP)
        read = cgutils.get_or_insert_function(
            builder.module,
            ir.FunctionType(_eight, [pointers, ir.IntType(32), mask, _eight]),
            "llvm.masked.gather.v8f64.v8p0",
        )
        for row in range(3):
            place = builder.add(begin, ir.Constant(wide, [row * _ROW] * LANE_GROUP))
            there = builder.inttoptr(
                builder.add(
                    builder.mul(place, ir.Constant(wide, [8] * LANE_GROUP)),
                    _all(builder, builder.ptrtoint(source, word)),
                ),
                pointers,
            )
            gathered = builder.call(
                read, [there, ir.IntType(32)(8), ir.Constant(mask, [1] * LANE_GROUP), ir.Constant(_eight, ir.Undefined)]
            )
            sums = _at(builder, target, builder.add(arguments[4], word(row * _ROW)), _eight)
            builder.store(builder.fadd(builder.load(sums, align=8), gathered), sums, 8)
        return context.get_dummy_value()

    return types.none(values, places, types.uintp, rows, types.uintp), generate


if config.DISABLE_JIT:

    def gather(records: Any, apart: int, fields: int, places: Any, first: Any, rows: Any, to: Any) -> None:
        """Do the same as `gather` without vector instructions, one double at a time."""
        for lane in range(LANE_GROUP):
            for field in range(fields):
                rows[int(to) + field * _ROW + lane] = records[int(places[int(first) + lane]) * apart + field]

    def unfold(records: Any, at: Any, rows: Any, to: Any) -> None:
        """Do the same as `unfold` without vector instructions, one double at a time."""
        for lane in range(LANE_GROUP):
            for field in range(SHARED):
                rows[int(to) + field * _ROW + lane] = records[int(at) + lane * SHARED + field]

    def spread(rows: Any, at: Any, records: Any, to: Any) -> None:
        """Do the same as `spread` without vector instructions, one double at a time."""
        for lane in range(LANE_GROUP):
            for field in range(SHARED):
                records[int(to) + lane * SHARED + field] = rows[int(at) + field * _ROW + lane]

    def add_gathered(values: Any, places: Any, first: Any, rows: Any, to: Any) -> None:
        """Do the same as `add_gathered` without vector instructions, one double at a time."""
        for lane in range(LANE_GROUP):
            for row in range(3):
                rows[int(to) + row * _ROW + lane] += values[int(places[int(first) + lane]) + row * _ROW]
