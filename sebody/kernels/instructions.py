"""Products in vector instructions, and calls of them without Numba's convention.

A function that Numba compiles has a place for its result and one for an exception, both cleared
where the caller begins, and its status is looked at after every call: with dozens of short calls
this costs a kernel as much as some of the products. Loops are marked as short, as those of kernels
are: see `sebody.compiler.short_loops`.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from llvmlite import ir
from numba import types

from sebody.compiler.short_loops import mark_short
from sebody.contract.counts import LANES

FLOATS, WORDS = types.CPointer(types.float64), types.CPointer(types.int64)
WORD = ir.IntType(64)
VECTOR = ir.VectorType(ir.DoubleType(), LANES)
POINTER = ir.DoubleType().as_pointer()

_lanes: dict[Callable, Callable] = {}       # writers of products in lanes, by those of numbers


def in_lanes(write: Callable) -> Callable:
    """Decorator of the function that writes, of lanes, what `write` writes of numbers."""
    def remember(own):
        _lanes[write] = own
        return own
    return remember


def called(write: Callable, *kinds: types.Type) -> tuple:
    """Type and instructions of an intrinsic that calls a function of the module: see `call`.

    `write` gets a builder and the arguments, whose types are `kinds`: pointers to floats, or to
    lanes, or to whole numbers, then whole numbers.
    """
    return _written(write, kinds, call)


def inlined(write: Callable, *kinds: types.Type) -> tuple:
    """The same where instructions are written wherever they are used."""
    return _written(write, kinds, lambda builder, chosen, args: chosen(builder, *args))


def _written(write, kinds, put):
    pointers = [kind for kind in kinds if isinstance(kind, types.CPointer)]
    chosen = write if all(kind in (FLOATS, WORDS) for kind in pointers) else _lanes[write]

    def codegen(context, builder, sig, args):
        put(builder, chosen, args)
        return context.get_dummy_value()

    return types.void(*pointers, *[types.int64] * (len(kinds) - len(pointers))), codegen


def call(builder: ir.IRBuilder, write: Callable, args: Sequence[ir.Value]) -> None:
    """Call a function whose instructions are written where a module calls it first."""
    kinds = [argument.type for argument in args]
    floats = "".join(str(k) for k, kind in enumerate(kinds) if kind == ir.DoubleType().as_pointer())
    name = f"{write.__module__}.{write.__name__}{floats}"    # lanes may meet numbers
    function = builder.module.globals.get(name)
    if function is None:
        function = ir.Function(builder.module, ir.FunctionType(ir.VoidType(), kinds), name)
        function.linkage = "internal"
        function.attributes.add("noinline")
        inside = ir.IRBuilder(function.append_basic_block())
        write(inside, *function.args)
        inside.ret_void()
    builder.call(function, args)


@contextmanager
def short_loop(builder: ir.IRBuilder, first: ir.Value, end: ir.Value, step: int = 1
               ) -> Iterator[ir.Value]:
    """A loop over ``range(first, end, step)``; yields its index."""
    head, body, after = (builder.append_basic_block(name) for name in ("head", "body", "after"))
    before = builder.block
    builder.branch(head)
    builder.position_at_end(head)
    index = builder.phi(WORD)
    builder.cbranch(builder.icmp_signed("<", index, end), body, after)
    builder.position_at_end(body)
    yield index
    index.add_incoming(first, before)
    index.add_incoming(builder.add(index, WORD(step)), builder.block)
    mark_short(builder.module, builder.branch(head))
    builder.position_at_end(after)


def load_vector(builder, pointer, first):
    """Instructions that read `LANES` numbers of a pointer from the place `first` on."""
    value = builder.load(builder.bitcast(builder.gep(pointer, [first]), VECTOR.as_pointer()))
    value.align = 8
    return value


def store_vector(builder, value, pointer, first):
    """Instructions that write a vector to a pointer from the place `first` on."""
    builder.store(value, builder.bitcast(builder.gep(pointer, [first]),
                                         VECTOR.as_pointer())).align = 8


def load_broadcast(builder, pointer, place):
    """A vector of one number, read at a place of a pointer."""
    return broadcast(builder, builder.load(builder.gep(pointer, [place])))


def broadcast(builder, number):
    """Instructions that set every number of a vector to one value."""
    undefined = ir.Constant(VECTOR, ir.Undefined)
    lane = builder.insert_element(undefined, number, ir.IntType(32)(0))
    lanes = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    return builder.shuffle_vector(lane, undefined, lanes)


def totals(builder, count):
    """Places of vectors that stay in registers."""
    return [stack_vectors(builder, 1) for _ in range(count)]


def stack_vectors(builder, count, kind=VECTOR):
    """Place of some vectors, made once where a function begins."""
    with builder.goto_entry_block():
        return builder.alloca(kind, WORD(count))


def no_sum():
    """A vector of zeros."""
    return ir.Constant(VECTOR, [0.0] * LANES)


def add_product(builder, total, a, b):
    """Add the product of two vectors to what is kept at a place."""
    product = builder.fmul(a, b, flags=("contract",))
    builder.store(builder.fadd(builder.load(total), product, flags=("contract",)), total)


def added_up(builder, numbers):
    """Sum of the numbers of a vector."""
    parts = [builder.extract_element(numbers, ir.IntType(32)(lane)) for lane in range(LANES)]
    while len(parts) > 1:
        parts = [builder.fadd(a, b) for a, b in zip(parts[::2], parts[1::2], strict=True)]
    return parts[0]


def sums_of_lanes(builder, vectors):
    """The sums of the numbers of `LANES` vectors, as a vector."""
    halves = [_pairs(builder, a, b, [0, LANES, 2, LANES + 2], [1, LANES + 1, 3, LANES + 3])
              for a, b in zip(vectors[::2], vectors[1::2], strict=True)]
    return _pairs(builder, *halves, [0, 1, LANES, LANES + 1], [2, 3, LANES + 2, LANES + 3])


def _pairs(builder, a, b, first, second):
    """The sum of two selections from the numbers of two vectors."""
    chosen = [builder.shuffle_vector(a, b, ir.Constant(ir.VectorType(ir.IntType(32), LANES), lanes))
              for lanes in (first, second)]
    return builder.fadd(*chosen)


def whole_vectors(builder, rows):
    """Rows rounded up to whole vectors."""
    return builder.and_(builder.add(rows, WORD(LANES - 1)), WORD(-LANES))
