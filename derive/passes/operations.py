"""Arithmetic of some statements, by what carries the values."""

from collections import Counter
from collections.abc import Iterable

import sympy as sp

from sebody.derive.form.kernel import Operations
from sebody.derive.form.loops import ELEMENT
from sebody.derive.form.statements import For, If, Invoke, Set, Statement, Update

HOMES = ELEMENT, "position", "rotation"


def operations(statements: Iterable[Statement]) -> Operations:
    """Count them; loops over modes and coordinates are left out, as are gathering and sums."""
    counts: Counter[str] = Counter()
    _count(statements, ELEMENT, counts)
    return Operations(*(counts[home] for home in HOMES), counts["products"])


def _count(statements: Iterable[Statement], home: str, found: Counter[str]) -> None:
    for statement in statements:
        match statement:
            case Set(_, values):
                found[home] += sum(int(sp.count_ops(value)) for value in values)
            case Update(_, _, value):
                found[home] += int(sp.count_ops(value))
            case For(body=body, home=own):
                _count(body, own or home, found)
            case If(body=body, otherwise=otherwise):
                _count((*body, *otherwise), home, found)
            case Invoke(operations=own, products=products):
                found[home] += own
                found["products"] += products
