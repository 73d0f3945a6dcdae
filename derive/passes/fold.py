"""Counts that are known in place of their names."""

from collections.abc import Mapping
from typing import Any

import sympy as sp

from sebody.derive.form.arrays import Entry, View
from sebody.derive.form.functions import Function
from sebody.derive.form.statements import Let, Statement
from sebody.derive.form.whole import Count, Whole, replaced


def folded(statements: tuple[Statement, ...], known: Mapping[Count, int]
           ) -> tuple[Statement, ...]:
    """The statements with numbers for counts; what would give these names a value is left out."""
    parts = (_folded(statement, known) for statement in statements)
    return tuple(statement for statement in parts if statement != Let((), ()))


def _folded(node: Any, known: Mapping[Count, int]) -> Any:
    match node:
        case Let(names, values):
            left = [(name, _folded(value, known)) for name, value in zip(names, values, strict=True)
                    if name not in known]
            return Let(*map(tuple, zip(*left, strict=True))) if left else Let((), ())
        case Whole():
            return replaced(node, known)
        case View(array, first):
            return array.at(replaced(first, known))
        case sp.Expr():
            return node.xreplace({entry: Entry(entry.array, replaced(entry.place, known))
                                  for entry in node.atoms(Entry)})
        case tuple() if type(node) is tuple:
            return folded(node, known)
        case Function():
            return node
        case tuple():                   # any other statement
            return type(node)(*(_folded(part, known) for part in node))
    return node
