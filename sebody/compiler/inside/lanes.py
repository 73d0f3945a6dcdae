"""A number of eight members: a Numba type over vectors of LLVM, with operators and masks.

Compiled functions take it in place of a float: the same text is compiled for eight members of an
ensemble at a time. A comparison gives a `Mask`, one truth for each member, which `if` does not
take: functions that branch on numbers have versions for lanes, which choose by `where`.
"""

import math
import operator
from collections.abc import Callable

import numpy as np
from llvmlite import ir
from numba import from_dtype, types
from numba.extending import intrinsic, lower_builtin, lower_cast, models, overload, register_model

from sebody.compiler.inside.names import (
    AbstractTemplate,
    Conversion,
    RecordModel,
    get_or_insert_function,
    infer_global,
    lower_constant,
    signature,
)
from sebody.compiler.inside.remembered import remember_operations_on
from sebody.contract.counts import MEMBERS

NUMPY_KIND = np.dtype([("members", np.float64, (MEMBERS,))])     # of NumPy's arrays of lanes
_INDEX, _WORD, _FLOAT = ir.IntType(32), ir.IntType(64), ir.DoubleType()
VECTOR = ir.VectorType(_FLOAT, MEMBERS)
_BITS = ir.VectorType(ir.IntType(1), MEMBERS)
_ALL = ir.IntType(MEMBERS)


class Lanes(types.Type):
    """The type of a number of eight members."""

    def __init__(self):
        super().__init__("lanes")

    def can_convert_from(self, typingctx, other):
        """For Numba: a number is the same in all lanes."""
        return Conversion.safe if _is_number(other) else None

    def unify(self, typingctx, other):
        """For Numba: a variable that is a number on some ways and lanes on others is lanes."""
        return self if _is_number(other) else None


class Mask(types.Type):
    """The type of a truth for each of eight members."""

    def __init__(self):
        super().__init__("mask")


def takes_lanes(kinds: tuple[types.Type, ...]) -> bool:
    """Tell if a function with arguments of some types is given lanes, pointers to them or masks."""
    return any(isinstance(getattr(kind, "dtype", kind), (Lanes, Mask)) for kind in kinds)


def _is_number(kind):
    return isinstance(kind, (types.Float, types.Integer)) and not isinstance(kind, types.Boolean)


lanes, mask = Lanes(), Mask()
remember_operations_on(Lanes, Mask)


@register_model(Lanes)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, VECTOR)


@register_model(Mask)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, _BITS)


class RecordOfLanes(types.Record):
    """The type of a record of scalars, some of which are lanes."""

    def __init__(self, kind: np.dtype):
        self._kind = kind
        super().__init__([(name, {"type": lanes if own.subdtype else from_dtype(own),
                                  "offset": offset})
                          for name, (own, offset) in kind.fields.items()],
                         kind.itemsize, aligned=False)

    @property
    def dtype(self) -> np.dtype:
        """For Numba: the kind NumPy has."""
        return self._kind


register_model(RecordOfLanes)(RecordModel)


def same(builder: ir.IRBuilder, number: ir.Value) -> ir.Value:
    """A number of one value in all lanes."""
    if isinstance(number, ir.Constant):
        return ir.Constant(VECTOR, [number.constant] * MEMBERS)
    undefined = ir.Constant(VECTOR, ir.Undefined)
    first = builder.insert_element(undefined, number, _INDEX(0))
    zeros = ir.Constant(ir.VectorType(_INDEX, MEMBERS), [0] * MEMBERS)
    return builder.shuffle_vector(first, undefined, zeros)


@lower_constant(Lanes)
def _of_constant(context, builder, kind, number):
    return ir.Constant(VECTOR, [float(number)] * MEMBERS)


@lower_cast(types.Float, Lanes)
def _of_float(context, builder, kind, to, number):
    return same(builder, number)


@lower_cast(types.Integer, Lanes)
def _of_integer(context, builder, kind, to, number):
    return same(builder, builder.sitofp(number, _FLOAT))


@lower_cast(types.IntegerLiteral, Lanes)
def _of_literal(context, builder, kind, to, number):
    return ir.Constant(VECTOR, [float(kind.literal_value)] * MEMBERS)


# operators


def _given(kinds):
    return (any(isinstance(kind, Lanes) for kind in kinds)
            and all(isinstance(kind, Lanes) or _is_number(kind) for kind in kinds))


def _operator(operations: tuple, result: types.Type, operand: type[types.Type],
              write: Callable) -> None:
    """Give lanes or masks an operator of Python."""
    def fits(kinds):
        return (_given(kinds) if operand is Lanes else
                all(isinstance(kind, operand) for kind in kinds))

    for operation in operations:
        class Template(AbstractTemplate):
            key = operation

            def generic(self, args, kws):
                if args and fits(args) and not kws:
                    own = lanes if operand is Lanes else mask
                    return signature(result, *[own] * len(args))
                return None

        infer_global(operation)(Template)
        arguments = (operand,) * write.__code__.co_argcount
        lower_builtin(operation, *arguments[1:])(
            lambda context, builder, sig, args: write(builder, *args))


_operator((operator.add, operator.iadd), lanes, Lanes, lambda b, x, y: b.fadd(x, y))
_operator((operator.sub, operator.isub), lanes, Lanes, lambda b, x, y: b.fsub(x, y))
_operator((operator.mul, operator.imul), lanes, Lanes, lambda b, x, y: b.fmul(x, y))
_operator((operator.truediv, operator.itruediv), lanes, Lanes, lambda b, x, y: b.fdiv(x, y))
_operator((operator.neg,), lanes, Lanes, lambda b, x: b.fneg(x))
_operator((operator.lt,), mask, Lanes, lambda b, x, y: b.fcmp_ordered("<", x, y))
_operator((operator.le,), mask, Lanes, lambda b, x, y: b.fcmp_ordered("<=", x, y))
_operator((operator.gt,), mask, Lanes, lambda b, x, y: b.fcmp_ordered(">", x, y))
_operator((operator.ge,), mask, Lanes, lambda b, x, y: b.fcmp_ordered(">=", x, y))
_operator((operator.eq,), mask, Lanes, lambda b, x, y: b.fcmp_ordered("==", x, y))
_operator((operator.ne,), mask, Lanes, lambda b, x, y: b.fcmp_unordered("!=", x, y))
_operator((operator.and_,), mask, Mask, lambda b, x, y: b.and_(x, y))
_operator((operator.or_,), mask, Mask, lambda b, x, y: b.or_(x, y))
_operator((operator.invert,), mask, Mask, lambda b, x: b.not_(x))


# masks


@intrinsic
def where(typingctx, chosen, x, y):
    """In each lane x or y."""
    def codegen(context, builder, sig, args):
        return builder.select(*args)
    return lanes(mask, lanes, lanes), codegen


@intrinsic
def every(typingctx, chosen):
    """Tell if a mask is true in all lanes."""
    def codegen(context, builder, sig, args):
        return builder.icmp_unsigned("==", builder.bitcast(args[0], _ALL), _ALL(2**MEMBERS - 1))
    return types.boolean(mask), codegen


@intrinsic
def some(typingctx, chosen):
    """Tell if a mask is true in a lane."""
    def codegen(context, builder, sig, args):
        return builder.icmp_unsigned("!=", builder.bitcast(args[0], _ALL), _ALL(0))
    return types.boolean(mask), codegen


@intrinsic
def chosen_in(typingctx, chosen, member):
    """Tell if a mask is true in one lane."""
    def codegen(context, builder, sig, args):
        return builder.extract_element(args[0], args[1])
    return types.boolean(mask, types.int64), codegen


@intrinsic
def bits_of(typingctx, chosen):
    """A mask as a whole number, one bit for each lane."""
    def codegen(context, builder, sig, args):
        return builder.zext(builder.bitcast(args[0], _ALL), _WORD)
    return types.int64(mask), codegen


# lanes


@intrinsic
def spread(typingctx, x):
    """A number as lanes; lanes as they are."""
    if isinstance(x, Lanes):
        return lanes(lanes), lambda context, builder, sig, args: args[0]
    return lanes(types.float64), lambda context, builder, sig, args: same(builder, args[0])


@intrinsic
def number_of(typingctx, x, member):
    """The number of one lane."""
    def codegen(context, builder, sig, args):
        return builder.extract_element(*args)
    return types.float64(lanes, types.int64), codegen


@intrinsic
def with_number(typingctx, x, member, number):
    """Lanes with another number in one of them."""
    def codegen(context, builder, sig, args):
        return builder.insert_element(args[0], args[2], args[1])
    return lanes(lanes, types.int64, types.float64), codegen


def _of_llvm(name: str, count: int):
    """An operation that LLVM has for vectors."""
    kind = ir.FunctionType(VECTOR, [VECTOR] * count)

    def codegen(context, builder, sig, args):
        return builder.call(get_or_insert_function(
            builder.module, kind, f"llvm.{name}.v{MEMBERS}f64"), args)
    return lanes(*[lanes] * count), codegen


@intrinsic
def _root(typingctx, x):
    return _of_llvm("sqrt", 1)


@intrinsic
def _size(typingctx, x):
    return _of_llvm("fabs", 1)


@intrinsic
def rounded_up(typingctx, x):
    """The next whole numbers."""
    return _of_llvm("ceil", 1)


@intrinsic
def _larger(typingctx, x, y):
    def codegen(context, builder, sig, args):
        return builder.select(builder.fcmp_ordered(">", args[1], args[0]), args[1], args[0])
    return lanes(lanes, lanes), codegen


@intrinsic
def _smaller(typingctx, x, y):
    def codegen(context, builder, sig, args):
        return builder.select(builder.fcmp_ordered("<", args[1], args[0]), args[1], args[0])
    return lanes(lanes, lanes), codegen


@intrinsic
def _whole(typingctx, x):
    def codegen(context, builder, sig, args):
        return builder.fptosi(builder.extract_element(args[0], _INDEX(0)), _WORD)
    return types.int64(lanes), codegen


@overload(math.sqrt)
def _sqrt(x):
    return (lambda x: _root(x)) if isinstance(x, Lanes) else None


def _each(function: Callable) -> Callable:
    """A function of the standard library, lane by lane."""
    def implement(x):
        if not isinstance(x, Lanes):
            return None

        def each(x):
            found = x
            for member in range(MEMBERS):
                found = with_number(found, member, function(number_of(x, member)))
            return found
        return each
    return implement


for _function in (math.atan, math.floor):
    overload(_function)(_each(_function))


def _each_two(function: Callable) -> Callable:
    """The same of two arguments."""
    def implement(x, y):
        if not _given((x, y)):
            return None

        def each(x, y):
            found = a = spread(x)
            b = spread(y)
            for member in range(MEMBERS):
                found = with_number(found, member, function(number_of(a, member),
                                                            number_of(b, member)))
            return found
        return each
    return implement


for _function in (math.atan2, math.hypot, operator.pow):
    overload(_function)(_each_two(_function))


@overload(abs)
def _abs(x):
    return (lambda x: _size(x)) if isinstance(x, Lanes) else None


@overload(max)
def _max(x, y):
    """As of Python: the first where they are equal, or one is no number."""
    return (lambda x, y: _larger(x, y)) if _given((x, y)) else None


@overload(min)
def _min(x, y):
    return (lambda x, y: _smaller(x, y)) if _given((x, y)) else None


@overload(int)
def _int(x):
    """Whole numbers among constants are the same in all lanes."""
    return (lambda x: _whole(x)) if isinstance(x, Lanes) else None


@intrinsic
def as_lanes(typingctx, pointer):
    """Pointer to numbers, eight of each kind one after the other, as one to lanes."""
    def codegen(context, builder, sig, args):
        return builder.bitcast(args[0], VECTOR.as_pointer())
    return types.CPointer(lanes)(types.CPointer(types.float64)), codegen


@intrinsic
def lanes_at(typingctx, pointer):
    """Pointer to lanes, whose address is the bits of a number."""
    def codegen(context, builder, sig, args):
        address = builder.load(builder.bitcast(args[0], _WORD.as_pointer()))
        return builder.inttoptr(address, VECTOR.as_pointer())
    return types.CPointer(lanes)(types.CPointer(types.float64)), codegen
