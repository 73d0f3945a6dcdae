"""Transposes of the runtime's functions: what a call gives to the bars of what it read."""

from collections.abc import Callable
from typing import NamedTuple

from sebody.derive.form.arrays import Array, View, array_of, scratch
from sebody.derive.form.counts import n
from sebody.derive.form.functions import (
    ADD_BLOCK_TIMES,
    ADD_ROWS_TIMES,
    BLOCK_TIMES,
    FOLLOW_CHANGES,
    FROM_FREE,
    ROWS_TIMES,
    TO_FREE,
    Function,
)
from sebody.derive.form.steps import Shift, Step, call
from sebody.derive.form.whole import Whole

TEMPORARY = scratch("temporary")


def bar_array(array: Array | View) -> Array | View:
    """The bars of an array, or of a view of it."""
    of = array_of(array)
    bars = of.renamed("b" + of.name)
    return bars.at(array.first) if isinstance(array, View) else bars


def _block(A, x, out, rows, columns, height, _) -> tuple[Step, ...]:
    return (call("", ADD_ROWS_TIMES, A, bar_array(out), bar_array(x), rows, columns, height,
                 products=1),)


def _rows(A, x, out, rows, columns, height, _) -> tuple[Step, ...]:
    return (call("", ADD_BLOCK_TIMES, A, bar_array(out), bar_array(x), rows, columns, height),)


def _to_free(y, axes, order, moved, z, bound, bound_free, free, _, transposes) -> tuple[Step, ...]:
    return (call("", FROM_FREE, bar_array(z), transposes[axes], order, moved, TEMPORARY, bound,
                 bound_free, free), Shift("", bar_array(y), TEMPORARY))


def _from_free(z, back, order, moved, y, bound, bound_free, free, transposes) -> tuple[Step, ...]:
    """Zeros behind those that determine the others: rows of n numbers are added."""
    return (call("", TO_FREE, bar_array(y), transposes[back], order, moved, TEMPORARY, bound,
                 bound_free, free, n), Shift("", bar_array(z), TEMPORARY))


def _follow_changes(Zq, Zd, Za, dz, dzd, dzdd, free, slaved, height, _) -> tuple[Step, ...]:
    """Rates ``Zq . dzd + Zd . dz`` and second rates ``Zq . dzdd + 2 Zd . dzd + Za . dz``."""
    z, zd, zdd = map(bar_array, (dz, dzd, dzdd))
    rate, second = zd.at(free), zdd.at(free)
    return tuple(call("", ADD_BLOCK_TIMES, Z, bar, out, free, slaved, height)
                 for Z, bar, out in ((Zq, rate, zd), (Zd, rate, z), (Zq, second, zdd),
                                     (Zd, second, zd), (Zd, second, zd), (Za, second, z)))


class Transpose(NamedTuple):
    """The transposed calls of a function."""

    steps: Callable[..., tuple[Step, ...]]      # of the operands, and constants by their transposes
    length: Callable[..., Whole]                # how many numbers a call writes, of the operands


def _rows_of(A, x, out, rows, columns, height) -> Whole:
    return rows


def _columns_of(A, x, out, rows, columns, height) -> Whole:
    return columns


TRANSPOSES: dict[Function, Transpose] = {
    BLOCK_TIMES: Transpose(_block, _rows_of), ADD_BLOCK_TIMES: Transpose(_block, _rows_of),
    ROWS_TIMES: Transpose(_rows, _columns_of),
    TO_FREE: Transpose(_to_free, lambda *operands: operands[-1]),
    FROM_FREE: Transpose(_from_free, lambda *operands: n),
    FOLLOW_CHANGES: Transpose(_follow_changes, lambda *operands: n)}
