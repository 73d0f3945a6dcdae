"""Products with the packed matrices of a body as straight code: an instruction for each entry.

Matrices of option C are mostly zeros. Where the same few bodies serve thousands of runs, code for
the entries that are there takes a third of the instructions of strips, and no list is read. It is
compiled for a pattern of zeros, in hundredths of a second, when an ensemble begins. Entries that
all members share are constants of the code: eight bytes are read in place of 64. The code of a row
takes some megabytes: it is freed once nobody keeps it, and the last ones are kept for the next
ensemble.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import groupby

import numpy as np
from llvmlite import binding, ir
from numpy.typing import NDArray

from sebody.compiler.choice import way
from sebody.compiler.inside.lanes import VECTOR, same
from sebody.contract.counts import LANES, MEMBERS
from sebody.kernels.instructions import WORD, short_loop
from sebody.kernels.packed import diagonals_of, multiples, strips

# lanes of the first number of a row that have the addresses of its straight code, where there is
# some: of what writes products, and of what adds to them; the number of groups stands in all others
AT_ADDRESS, AT_MORE = 1, 3
AT_LANES = 2        # of what the first number of a shared row points to: address of its lanes
MOST_GROUPS = 1 << 20       # of a row; a larger number is an address
# place of an entry, vector and place of its factor, place of its sum; its value, if all members
# share it
Entries = tuple[tuple[int, int, int, int, float | None], ...]
MADE = 2        # in place of a vector: the factor is another sum, of which this one is a multiple

KEPT = 16           # codes that are kept when their ensembles are gone
MOST_FACTORS = 24           # that registers hold beside sums
_KIND = ir.FunctionType(ir.VoidType(), [*[VECTOR.as_pointer()] * 4, WORD])


def entries_of(row: NDArray, varied: NDArray) -> Entries:
    """The entries of a row of packed matrices that are not zero, by their sums."""
    found = []
    for uses, below, first, at, entries in strips(row):
        for i, k in np.argwhere(entries).tolist():
            place = at + LANES * k + i
            value = None if varied[place] else float(row[place])
            for use in uses:
                column, to = (below + i, k) if use.transposed else (first + k, i)
                found.append((place, use.vector, column, use.place + to, value))
    for one in diagonals_of(row):
        for i in np.flatnonzero(one.numbers).tolist():
            value = None if varied[one.at + i] else float(row[one.at + i])
            found.append((one.at + i, 0, i, one.place + i, value))
    sums = {entry[3] for entry in found}
    for one in multiples(row):
        for i in np.flatnonzero(one.factors).tolist():
            if one.other + i not in sums:
                continue
            at = one.at + i
            value = None if varied[at] else float(row[at])
            found.append((at, MADE, one.other + i, one.place + i, value))
    return tuple(sorted(found, key=lambda entry: (_sum_of(entry), entry[1] == MADE,
                                                  *entry[3::-1])))


def _sum_of(entry: tuple) -> int:
    """The sum that an entry belongs to: that of its products, or that which it multiplies."""
    return entry[2] if entry[1] == MADE else entry[3]


class Straight:
    """Straight code: functions of a row, two vectors, products, and how many of these there are.

    Attributes
    ----------
    address, more : int
        Of what writes products, zeros where no entry is, and of what adds to them, for as long as
        this object lives.
    """

    def __init__(self, entries: Entries):
        name, features = way().processor()
        target = binding.Target.from_triple(binding.get_process_triple()).create_target_machine(
            cpu=name, features=features, opt=2)
        module = binding.parse_assembly(str(_functions(entries)))
        self._engine = binding.create_mcjit_compiler(module, target)
        self._engine.finalize_object()
        self.address, self.more = map(self._engine.get_function_address, ("straight", "more"))
        self._engine.remove_module(module)      # what it was made of takes more than the code


@lru_cache(maxsize=KEPT)
def straight_code(entries: Entries) -> Straight:
    """The code for some entries, of an earlier ensemble if that is still kept."""
    return Straight(entries)


def _functions(entries: Entries) -> ir.Module:
    module = ir.Module("straight")
    module.triple = binding.get_process_triple()
    _write_more(module, *_write(module, entries))
    return module


def _write(module: ir.Module, entries: Entries) -> tuple[ir.Function, int]:
    """The function that writes products; returned with how many there are up to the last one."""
    function = ir.Function(module, _KIND, "straight")
    builder = ir.IRBuilder(function.append_basic_block())
    A, *vectors, out, count = function.args
    out.add_attribute("noalias")        # of what is read
    # few factors are read once, before all sums, and stay in registers: entries are what is read
    places = sorted({entry[1:3] for entry in entries if entry[1] != MADE})
    factors = {one: _read(builder, vectors[one[0]], one[1])
               for one in places if len(places) <= MOST_FACTORS}
    shared, written = _Shared(module, builder, entries), set()

    def write(number, to):
        builder.store(number, builder.gep(out, [WORD(to)]))
        written.add(to)
    for place_of_sum, terms in groupby(entries, key=_sum_of):
        total = None
        for place, vector, column, to, value in terms:
            entry = _read(builder, A, place) if value is None else shared.next()
            if vector == MADE:
                write(builder.fmul(entry, total), to)
                continue
            factor = factors.get((vector, column)) or _read(builder, vectors[vector], column)
            product = builder.fmul(entry, factor, flags=("contract",))
            total = product if total is None else builder.fadd(total, product, flags=("contract",))
        write(total, place_of_sum)
    last = max(written, default=-1) + 1
    zeros = ir.Constant(VECTOR, [0.0] * VECTOR.count)
    for unused in set(range(last)) - written:
        builder.store(zeros, builder.gep(out, [WORD(unused)]))
    with short_loop(builder, WORD(last), count) as place:
        builder.store(zeros, builder.gep(out, [place]))
    builder.ret_void()
    return function, last


def _write_more(module: ir.Module, products: ir.Function, count: int) -> None:
    """The function that adds products, which the other one writes: code is compiled once."""
    function = ir.Function(module, _KIND, "more")
    builder = ir.IRBuilder(function.append_basic_block())
    *given, out, _ = function.args
    made = builder.alloca(VECTOR, WORD(max(count, 1)))
    builder.call(products, [*given, made, WORD(count)])
    with short_loop(builder, WORD(0), WORD(count)) as place:
        old, new = (builder.load(builder.gep(one, [place])) for one in (out, made))
        builder.store(builder.fadd(old, new), builder.gep(out, [place]))
    builder.ret_void()


class _Shared:
    """Values that all members share, one after the other."""

    def __init__(self, module: ir.Module, builder: ir.IRBuilder, entries: Entries):
        values = [entry[-1] for entry in entries if entry[-1] is not None]
        kind = ir.ArrayType(ir.DoubleType(), len(values))
        self._values = ir.GlobalVariable(module, kind, "shared")
        self._values.initializer = ir.Constant(kind, values)
        self._values.linkage = "internal"       # not a constant: LLVM would write out eight of each
        # hidden from LLVM, which would write out the whole address of each value
        address = self._values.type
        self._first = builder.asm(ir.FunctionType(address, [address]), "", "=r,0", [self._values],
                                  False)
        self._builder, self._next = builder, 0

    def next(self) -> ir.Value:
        """The next value, in all lanes."""
        place = self._builder.gep(self._first, [ir.IntType(32)(0), ir.IntType(32)(self._next)])
        self._next += 1
        return same(self._builder, self._builder.load(place))


def _read(builder, pointer, place):
    return builder.load(builder.gep(pointer, [WORD(place)]))


def write_address(row: NDArray, varied: NDArray, lanes: NDArray) -> Straight:
    """Compile straight code of a row of packed matrices, and put its addresses into lanes.

    What is returned is to be kept.

    Parameters
    ----------
    row : (size,)
        As of `packed.pack`.
    varied : (size,)
        Whether members differ in a number.
    lanes : (size, MEMBERS)
        The same in lanes.
    """
    assert lanes.shape == (len(row), MEMBERS)
    code = straight_code(entries_of(row, varied))
    lanes.view(np.int64)[0, [AT_ADDRESS, AT_MORE]] = code.address, code.more
    return code


def write_shared_address(row: NDArray, varied: NDArray, lanes: NDArray
                         ) -> tuple[NDArray, Straight]:
    """The same of a row that members share but for some entries, which are read from lanes.

    Its first number is replaced by the address of an array: the number itself, and addresses of
    straight code and of the lanes. This array and the code are returned, and to be kept.

    Parameters
    ----------
    row, varied, lanes : ndarray
        As of `write_address`.
    """
    own, code = row.view(np.int64), straight_code(entries_of(row, varied))
    found = np.array([own[0], code.address, lanes.ctypes.data, code.more])
    own[0] = found.ctypes.data
    return found, code


def write_matrix_address(matrix: NDArray, shared: NDArray) -> tuple[NDArray, Straight]:
    """Compile straight code of a matrix that members share, see `constant_products`.

    Parameters
    ----------
    matrix : (rows, columns)
        Its entries.
    shared : (size,)
        The matrix among the constants: its first number is replaced by the address of an array of
        addresses. This array and the code are returned, and to be kept.
    """
    entries = tuple((0, 0, column, row, float(matrix[row, column]))
                    for row, column in np.argwhere(matrix).tolist())
    code = straight_code(entries)
    found = np.array([code.address, code.more])
    shared.view(np.int64)[0] = found.ctypes.data
    return found, code
