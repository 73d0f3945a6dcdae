"""Uses of some statements: arrays, functions and numbers, each once and in the order of use."""

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import sympy as sp

from sebody.derive.form.arrays import Array, Entry, View
from sebody.derive.form.functions import Function
from sebody.derive.form.statements import (
    Comparison,
    For,
    If,
    Invoke,
    Let,
    Point,
    Return,
    Set,
    Statement,
    Update,
)
from sebody.derive.form.whole import Agreed, Applied, Count, Whole

ROOT = sp.Rational(1, 2)


class Uses(NamedTuple):
    """Arrays, functions and numbers that a target must provide."""

    arrays: tuple[Array, ...]
    views: tuple[View, ...]
    functions: tuple[Function, ...]
    agreed: tuple[Agreed, ...]          # numbers of the layout
    counts: tuple[Count, ...]
    mathematics: tuple[str, ...]        # functions of the standard library, by their names


def uses(statements: Iterable[Statement]) -> Uses:
    """Collect what statements read, write and call."""
    kinds = Array, View, Function, Agreed, Count, str
    used: dict[type, dict] = {kind: {} for kind in kinds}
    for part in _parts(tuple(statements)):
        used[type(part)].setdefault(part)
    return Uses(*(tuple(used[kind]) for kind in kinds))


def _parts(node: Any) -> Iterator[Any]:
    """Everything that is named in a node: what is read before what is written."""
    match node:
        case Set(targets, values):
            yield from _all(*values, *targets)
        case Update(target, _, value):
            yield from _all(value, target)
        case Let(_, values):
            yield from _all(*values)
        case Point(_, place):
            yield from _parts(place)
        case For(_, first, end, body):
            yield from _all(first, end, *body)
        case If(holds, body, otherwise):
            yield from _all(*holds.numbers, *body, *otherwise)
        case Comparison(numbers, _):
            yield from _all(*numbers)
        case Invoke(function, operands, outputs):
            yield function
            yield from _all(*operands, *(o for o in outputs if isinstance(o, Entry)))
        case Return(status):
            yield from _parts(status)
        case View(array, first):
            yield node
            yield from _all(array, first)
        case Entry():
            yield from _all(node.array, node.place)
        case sp.Expr():
            yield from _in_expression(node)
        case Array() | Agreed() | Count():
            yield node
        case Applied(function, arguments):
            yield function
            yield from _all(*arguments)
        case Whole():
            yield from _all(*node.parts())
        case tuple() if type(node) is tuple:
            yield from _all(*node)


def _all(*nodes: Any) -> Iterator[Any]:
    for node in nodes:
        yield from _parts(node)


def _in_expression(expression: sp.Expr) -> Iterator[Any]:
    for node in sp.preorder_traversal(expression):
        if isinstance(node, Entry):
            yield from _parts(node)
        elif hasattr(node, "calls"):
            yield node.calls
            yield from _parts(node.table)
        elif isinstance(node, sp.Function) and not hasattr(node, "written_out"):
            yield type(node).__name__
        elif isinstance(node, sp.Pow) and abs(node.exp) == ROOT:
            yield "sqrt"
