"""Statements of a kernel: what a target prints, line by line.

Scalars are SymPy symbols, values expressions of them and of entries of arrays; whole numbers are
another kind. A kernel is called for some elements of a kind and returns a status.
"""

from enum import Enum
from typing import Any, NamedTuple

import sympy as sp

from sebody.derive.form.arrays import Array, Entry, View
from sebody.derive.form.functions import Function, Gives, Use
from sebody.derive.form.whole import Count, Whole, whole

Target = sp.Symbol | Entry
Operand = Array | View | Whole | sp.Expr


class Remark(NamedTuple):
    """A comment."""

    text: str


class Set(NamedTuple):
    """Scalars or entries get values; no value reads a target."""

    targets: tuple[Target, ...]
    values: tuple[sp.Expr, ...]


class Zero(NamedTuple):
    """Scalars that are added to from here on."""

    symbols: tuple[sp.Symbol, ...]


class Change(Enum):
    """Operators that change a target by a value."""

    ADD = "+="
    SUBTRACT = "-="
    MULTIPLY = "*="


class Update(NamedTuple):
    """A target is changed by a value."""

    target: Target
    change: Change
    value: sp.Expr


class Let(NamedTuple):
    """Whole numbers get names; none of the values reads one of these names."""

    names: tuple[Count, ...]
    values: tuple[Whole, ...]


class Point(NamedTuple):
    """An array gets its place."""

    array: Array
    place: Array | View


class For(NamedTuple):
    """Statements once for each value of an index."""

    index: Count
    first: Whole
    end: Whole
    body: tuple
    home: str = ""          # what carries the values, for the operation count


class Comparison(NamedTuple):
    """Comparisons that must all hold: ``numbers[0] signs[0] numbers[1] signs[1] ...``."""

    numbers: tuple[Whole, ...]
    signs: tuple[str, ...]      # == | != | < | <= | > | >=


class If(NamedTuple):
    """Statements where a comparison holds, and others where it does not."""

    holds: Comparison
    body: tuple
    otherwise: tuple = ()


class Invoke(NamedTuple):
    """A call of a function of the runtime."""

    function: Function
    operands: tuple[Operand, ...]
    outputs: tuple[Target | Count, ...] = ()
    operations: int = 0         # arithmetic, for the operation count
    products: int = 0           # with n x n matrices, likewise


class Return(NamedTuple):
    """The end, with a status."""

    status: Whole


Statement = Remark | Set | Zero | Update | Let | Point | For | If | Invoke | Return


def checked(function: Function, operands: tuple[Any, ...]) -> tuple[Operand, ...]:
    """Operands of a call, numbers of Python as whole numbers.

    Raises
    ------
    TypeError
        Another number of operands, or one of another kind than the function takes.
    """
    if len(operands) != len(function.operands):
        names = ", ".join(name for name, _ in function.operands)
        raise TypeError(f"{function.name} takes {len(function.operands)} operands ({names}), not "
                        f"{len(operands)}")
    values = tuple(whole(operand) if isinstance(operand, int) else operand for operand in operands)
    for (name, use), operand in zip(function.operands, values, strict=True):
        wanted = (Array | View if use.of_array else Whole if use is Use.WHOLE else sp.Expr)
        if not isinstance(operand, wanted):
            raise TypeError(f"operand {name} of {function.name} is {use.name}, not {operand!r}")
    return values


def invoked(function: Function, operands: tuple[Operand, ...], outputs: tuple = (),
            operations: int = 0, products: int = 0) -> Invoke:
    """A call whose operands and outputs are those of the function.

    Raises
    ------
    TypeError
        Operands or outputs that are not.
    """
    if bool(outputs) != (function.gives is not Gives.NOTHING):
        raise TypeError(f"{function.name} gives {function.gives.name}, not {len(outputs)} outputs")
    return Invoke(function, checked(function, operands), outputs, operations, products)


def compared(one: Whole, sign: str, other: Whole | int, *more: Any) -> Comparison:
    """A comparison, or a chain of them: ``compared(a, "<=", b, "<", c)``."""
    rest = (sign, other, *more)
    return Comparison((one, *map(whole, rest[1::2])), rest[::2])
