"""Kernel of elements that choose by their numbers, or keep some: one member after the other.

It is called as kernels for lanes are. The numbers of a member that an element reads, whose places
are behind its index row, are copied to the same places of a buffer of a single run, where the
element's own kernel finds them. Its forces, and the numbers that it keeps or sets, are put back.
Members that are not running keep theirs: what they have does not depend on others. If the kernel
refuses the numbers of a member, the forces of this member become NaN.
"""

import math

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from sebody.contract.counts import MEMBERS
from sebody.contract.layout import ENERGY, OK
from sebody.contract.member_row import (
    ALONE,
    BEHIND,
    ENERGIES,
    IN_LANES,
    KEPT,
    KERNEL,
    PLACES,
    RUNNING,
    TABLE,
)
from sebody.kernels.abi import Arguments, at, call_kernel

_WORD = ir.IntType(64)


@intrinsic
def _whole_numbers_at(typingctx, address):
    """A pointer to the whole numbers at an address."""
    def codegen(context, builder, sig, args):
        return builder.inttoptr(args[0], _WORD.as_pointer())
    return types.CPointer(types.int64)(types.int64), codegen


@intrinsic
def _floats_at(typingctx, address):
    """A pointer to the floats at an address."""
    def codegen(context, builder, sig, args):
        return builder.inttoptr(args[0], ir.DoubleType().as_pointer())
    return types.CPointer(types.float64)(types.int64), codegen


@intrinsic
def _numbers_of(typingctx, pointer):
    """A pointer to lanes as one to their numbers, one after the other."""
    def codegen(context, builder, sig, args):
        return builder.bitcast(args[0], ir.DoubleType().as_pointer())
    return types.CPointer(types.float64)(pointer), codegen


@intrinsic
def _same_place(typingctx, pointer, table):
    """A pointer into the buffer of lanes as one to the same number of a single run."""
    def codegen(context, builder, sig, args):
        in_lanes, alone = (builder.load(builder.gep(args[1], [_WORD(k)]))
                           for k in (IN_LANES, ALONE))
        bytes_before = builder.sub(builder.ptrtoint(args[0], _WORD), in_lanes)
        place = builder.add(alone, builder.sdiv(bytes_before, _WORD(MEMBERS)))
        return builder.inttoptr(place, ir.DoubleType().as_pointer())
    return types.CPointer(types.float64)(pointer, table), codegen


def kernel(task, count, stride, width, index, constants, q, R, v, a, references, frames, T, loads,
           coefficients, forces, matrices, work, energies):
    table = _whole_numbers_at(index[stride - TABLE])
    places_of_row, kept, sums = index[stride - PLACES], index[stride - KEPT], table[ENERGIES]
    first_place = stride - BEHIND - places_of_row
    every, one = _floats_at(table[IN_LANES]), _floats_at(table[ALONE])
    g, energy = _numbers_of(forces), _numbers_of(energies)
    given = Arguments(
        index=index, constants=_same_place(constants, table), q=_same_place(q, table),
        R=_same_place(R, table), v=_same_place(v, table), a=_same_place(a, table),
        references=_same_place(references, table), frames=_same_place(frames, table),
        T=_same_place(T, table), loads=_same_place(loads, table),
        coefficients=_same_place(coefficients, table), forces=_same_place(forces, table),
        matrices=_same_place(matrices, table), work=_same_place(work, table),
        energies=_same_place(energies, table))
    for member in range(MEMBERS):
        if (table[RUNNING] >> member) & 1 == 0:
            continue
        for element in range(count):
            places = at(index, element*stride + first_place)
            for k in range(places_of_row):
                one[places[k]] = every[MEMBERS*places[k] + member]
        if task == ENERGY:
            for k in range(sums):
                given.energies[k] = energy[MEMBERS*k + member]
        good = call_kernel(index[stride - KERNEL], task, count, stride, width, given) == OK
        for k in range(count*width):
            g[MEMBERS*k + member] = given.forces[k] if good else math.nan
        if task == ENERGY:
            for k in range(sums):
                energy[MEMBERS*k + member] = given.energies[k]
        for element in range(count):
            places = at(index, element*stride + first_place)
            for k in range(kept):
                every[MEMBERS*places[k] + member] = one[places[k]]
    return OK
