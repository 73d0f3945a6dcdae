"""Whole numbers and operands as text: the same in all targets but for some words."""

from collections.abc import Callable
from typing import NamedTuple

import sympy as sp

from sebody.derive.form.arrays import Array, Entry, View
from sebody.derive.form.statements import Operand
from sebody.derive.form.whole import (
    Agreed,
    Applied,
    Count,
    Largest,
    Number,
    Quotient,
    Stored,
    Times,
    Total,
    Truncated,
    Whole,
)


class Words(NamedTuple):
    """Differences between targets."""

    quotient: str               # of two numbers, as a format
    largest: str                # likewise
    truncated: str              # of an entry
    behind: str                 # a place in an array
    real: Callable[[sp.Expr | Entry], str]


def whole_text(number: Whole, words: Words) -> str:
    """A whole number in the words of a target."""
    def text(part: Whole) -> str:
        return whole_text(part, words)

    def factor(part: Whole) -> str:
        return f"({text(part)})" if isinstance(part, Total) else text(part)
    match number:
        case Number(value):
            return str(value)
        case Count(name) | Agreed(name):
            return name
        case Total(((sign, head), *terms)):
            return ("-" if sign < 0 else "") + text(head) + "".join(
                f" {'-' if sign < 0 else '+'} {text(term)}" for sign, term in terms)
        case Times(factors):
            return "*".join(map(factor, factors))
        case Quotient(dividend, divisor):
            return words.quotient.format(factor(dividend), factor(divisor))
        case Largest(one, other):
            return words.largest.format(text(one), text(other))
        case Applied(function, arguments):
            return f"{function.name}({', '.join(map(text, arguments))})"
        case Stored(array, place):
            return f"{array.name}[{text(place)}]"
        case Truncated(entry):
            return words.truncated.format(words.real(entry))
    raise TypeError(f"{number!r} is no whole number")


def operand_text(operand: Operand, words: Words) -> str:
    """An operand of a call in the words of a target."""
    match operand:
        case Array(name):
            return name
        case View(array, first):
            return words.behind.format(array.name, whole_text(first, words))
        case Whole():
            return whole_text(operand, words)
    return words.real(operand)
