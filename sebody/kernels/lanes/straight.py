"""Products with the packed matrices of a body as straight code: an instruction for each entry.

Matrices of option C are mostly zeros. Where the same few bodies serve thousands of runs, code for
the entries that are there takes a third of the instructions of strips, and no list is read. It is
compiled for a pattern of zeros, in hundredths of a second, when an ensemble begins. Entries that
all members share are constants of the code: eight bytes are read in place of 64. The code of a row
takes some megabytes: it is freed once nobody keeps it, and the last ones are kept for the next
ensemble.
"""

from functools import lru_cache
from itertools import groupby

import numpy as np
from llvmlite import binding, ir
from numpy.typing import NDArray

from sebody.compiler.inside.lanes import VECTOR, same
from sebody.contract.counts import LANES, MEMBERS
from sebody.kernels.packed import COUPLED, NARROW, WIDE, strips

# lane of the first number of a row that has the address of its straight code, where there is some;
# the number of groups stands in all others
AT_ADDRESS = 1
AT_LANES = 2        # of what the first number of a shared row points to: address of its lanes
MOST_GROUPS = 1 << 20       # of a row; a larger number is an address
# place of an entry, vector and place of its factor, place of its sum; its value, if all members
# share it
Entries = tuple[tuple[int, int, int, int, float | None], ...]

KEPT = 16           # codes that are kept when their ensembles are gone


def entries_of(row: NDArray, varied: NDArray) -> Entries:
    """The entries of a row of packed matrices that are not zero, by their sums."""
    found = []
    for kind, vector, places, _, below, first, at, entries in strips(row):
        for i, k in np.argwhere(entries).tolist():
            place = at + LANES * k + i
            value = None if varied[place] else float(row[place])
            if kind in (NARROW, WIDE):
                found.append((place, vector, first + k, places[0] + i, value))
                continue
            coupled = kind == COUPLED
            found += [(place, y, first + k, places[y] + below + i, value)
                      for y in range(1 + coupled)]
            found.append((place, int(coupled), below + i, places[-1] + first + k, value))
    return tuple(sorted(found, key=lambda entry: entry[3::-1]))


class Straight:
    """Straight code of a row: a function of the row, two vectors and products, to which it adds.

    Attributes
    ----------
    address : int
        Of the function, for as long as this object lives.
    """

    def __init__(self, entries: Entries):
        triple, features = binding.get_process_triple(), binding.get_host_cpu_features().flatten()
        target = binding.Target.from_triple(triple).create_target_machine(
            cpu=binding.get_host_cpu_name(), features=features, opt=2)
        module = binding.parse_assembly(str(_function(entries)))
        self._engine = binding.create_mcjit_compiler(module, target)
        self._engine.finalize_object()
        self.address = self._engine.get_function_address("straight")
        self._engine.remove_module(module)      # what it was made of takes more than the code


@lru_cache(maxsize=KEPT)
def straight_code(entries: Entries) -> Straight:
    """The code for some entries, of an earlier ensemble if that is still kept."""
    return Straight(entries)


def _function(entries: Entries) -> ir.Module:
    kind = ir.FunctionType(ir.VoidType(), [VECTOR.as_pointer()] * 4)
    module = ir.Module("straight")
    module.triple = binding.get_process_triple()
    function = ir.Function(module, kind, "straight")
    builder = ir.IRBuilder(function.append_basic_block())
    A, *vectors, out = function.args
    out.add_attribute("noalias")        # of what is read
    shared = _Shared(module, builder, entries)
    for to, terms in groupby(entries, key=lambda entry: entry[3]):
        total = _read(builder, out, to)
        for place, vector, column, _, value in terms:
            entry = _read(builder, A, place) if value is None else shared.next()
            product = builder.fmul(entry, _read(builder, vectors[vector], column),
                                   flags=("contract",))
            total = builder.fadd(total, product, flags=("contract",))
        builder.store(total, builder.gep(out, [ir.IntType(64)(to)]))
    builder.ret_void()
    return module


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
    return builder.load(builder.gep(pointer, [ir.IntType(64)(place)]))


def write_address(row: NDArray, varied: NDArray, lanes: NDArray) -> Straight:
    """Compile straight code of a row of packed matrices, and put its address into lanes.

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
    lanes.view(np.int64)[0, AT_ADDRESS] = code.address
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
    found = np.array([own[0], code.address, lanes.ctypes.data])
    own[0] = found.ctypes.data
    return found, code
