"""Statements as lines of C99, names declared where they get their first value."""

from collections.abc import Iterable

import sympy as sp

from sebody.derive.form.arrays import Array, Entry
from sebody.derive.form.statements import (
    Comparison,
    For,
    If,
    Invoke,
    Let,
    Point,
    Remark,
    Return,
    Set,
    Statement,
    Update,
    Zero,
)
from sebody.derive.form.whole import Count, Whole
from sebody.derive.printing.c.expressions import code, operand_code, whole_code
from sebody.derive.printing.lines import INDENT, filled, listed, words

REAL, WHOLE = "double ", "int64_t "      # types before a name


class Block:
    """A block of C: what is declared in it, and in the blocks around it.

    Parameters
    ----------
    known : iterable of str
        Names that are declared already.
    level : int
        Of the indentation.
    """

    def __init__(self, known: Iterable[str], level: int):
        self.known, self.level = set(known), level

    def lines(self, statements: Iterable[Statement]) -> list[str]:
        """Lines of some statements."""
        return [line for statement in statements for line in self._lines(statement)]

    def _lines(self, statement: Statement) -> list[str]:
        match statement:
            case Remark(text):
                return [f"{INDENT * self.level}// {text}"]
            case Set(targets, values):
                return [line for target, value in zip(targets, values, strict=True)
                        for line in self._real(target, code(value))]
            case Zero(symbols):
                return [line for symbol in symbols for line in self._real(symbol, "0.0")]
            case Update(target, change, value):
                return self._line(f"{code(target)} {change.value} ", words(code(value)))
            case Let(names, values):
                return [line for name, value in zip(names, values, strict=True)
                        for line in self._whole(name, value)]
            case Point(array, place):
                return self._line(self._declared(pointer(array), array.name) + " = ",
                                  words(operand_code(place)))
            case For(index, first, end, body):
                i = index.name
                head = (f"for ({WHOLE}{i} = {whole_code(first)}; {i} < {whole_code(end)}; "
                        f"++{i}) {{")
                return self._inner(head, body, i)
            case If(holds, body, otherwise):
                lines = self._inner(f"if ({_comparison(holds)}) {{", body)
                return lines[:-1] + self._inner("} else {", otherwise) if otherwise else lines
            case Invoke():
                return self._invoked(statement)
            case Return(status):
                return self._line("return ", [whole_code(status)])
        raise TypeError(f"{statement!r} is no statement")

    def _inner(self, head: str, body: tuple[Statement, ...], *names: str) -> list[str]:
        pad = INDENT * self.level
        return [pad + head, *Block(self.known | {*names}, self.level + 1).lines(body), pad + "}"]

    def _line(self, head: str, pieces: Iterable[str]) -> list[str]:
        pad = INDENT * self.level
        return filled(pad + head, pieces, ";", pad + INDENT)

    def _declared(self, kind: str, name: str) -> str:
        """A name, with its type where it is new."""
        new = name not in self.known
        self.known.add(name)
        return kind + name if new else name

    def _real(self, target: sp.Symbol | Entry, value: str) -> list[str]:
        name = code(target)
        head = name if isinstance(target, Entry) else self._declared(REAL, name)
        return self._line(head + " = ", words(value))

    def _whole(self, name: Count, value: Whole) -> list[str]:
        return self._line(self._declared(WHOLE, name.name) + " = ", [whole_code(value)])

    def _invoked(self, call: Invoke) -> list[str]:
        """A call; real outputs are places it writes to, a whole one is what it returns."""
        given = [f"{self._declared(WHOLE, o.name)} = " for o in call.outputs
                 if isinstance(o, Count)]
        places = [o for o in call.outputs if not isinstance(o, Count)]
        new = [o for o in places if not isinstance(o, Entry) and code(o) not in self.known]
        declared = [line for o in new
                    for line in self._line(self._declared(REAL, code(o)), [""])]
        operands = [*map(operand_code, call.operands), *(f"&{code(o)}" for o in places)]
        return declared + self._line(f"{''.join(given)}{call.function.name}(",
                                     [*listed(operands), ")"])


def pointer(array: Array) -> str:
    """Type of an array: whole numbers are never written."""
    return f"const {WHOLE}*" if array.whole else f"{REAL}*"


def _comparison(holds: Comparison) -> str:
    numbers = list(map(whole_code, holds.numbers))
    pairs = zip(numbers[:-1], holds.signs, numbers[1:], strict=True)
    return " && ".join(" ".join(pair) for pair in pairs)
