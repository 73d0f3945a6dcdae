"""Statements as lines of Python: a pure function, the same bytes in every process."""

from collections.abc import Iterable

from sebody.derive.form.arrays import View
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
    Target,
    Update,
    Zero,
)
from sebody.derive.form.whole import Count, Number
from sebody.derive.printing.lines import INDENT, assigned, filled, listed, words
from sebody.derive.printing.numba.expressions import code, operand_code, whole_code


def lines(statements: Iterable[Statement], level: int = 0) -> list[str]:
    """Lines at an indentation."""
    return [line for statement in statements for line in _lines(statement, level)]


def _lines(statement: Statement, level: int) -> list[str]:
    pad = INDENT * level
    match statement:
        case Remark(text):
            return filled(f"{pad}# ", words(text), "", f"{pad}# ")
        case Set((target,), (value,)):
            return assigned(f"{pad}{code(target)} = ", words(code(value)), pad + INDENT)
        case Set(targets, values):
            return assigned(f"{pad}{_names(targets)} = ", listed(map(code, values)), pad + INDENT)
        case Zero(symbols):
            return [pad + " = ".join(map(code, symbols)) + " = 0.0"]
        case Update(target, change, value):
            return assigned(f"{pad}{code(target)} {change.value} ", words(code(value)),
                            pad + INDENT)
        case Let(names, values):
            return assigned(f"{pad}{_names(names)} = ", listed(map(whole_code, values)),
                            pad + INDENT)
        case Point(array, place):
            return _pointed(pad, array.name, place)
        case For(index, first, end, body):
            begin = "" if first == Number(0) else whole_code(first) + ", "
            return [f"{pad}for {index.name} in range({begin}{whole_code(end)}):",
                    *lines(body, level + 1)]
        case If(holds, body, otherwise):
            other = [f"{pad}else:", *lines(otherwise, level + 1)] if otherwise else []
            return [f"{pad}if {_comparison(holds)}:", *lines(body, level + 1), *other]
        case Invoke():
            return _invoked(pad, statement)
        case Return(status):
            return [f"{pad}return {whole_code(status)}"]
    raise TypeError(f"{statement!r} is no statement")


def _pointed(pad: str, name: str, place) -> list[str]:
    head = f"{pad}{name} = "
    if not isinstance(place, View):
        return [head + place.name]
    return filled(f"{head}at(", [f"{place.array.name}, ", *words(whole_code(place.first))], ")",
                  pad + INDENT)


def _invoked(pad: str, call: Invoke) -> list[str]:
    """A call; its operands line up where there are no outputs before it."""
    given = f"{_names(call.outputs)} = " if call.outputs else ""
    head = f"{pad}{given}{call.function.name}("
    indent = pad + INDENT if given else " " * len(head)
    return filled(head, listed(map(operand_code, call.operands)), ")", indent)


def _names(targets: Iterable[Target | Count]) -> str:
    return ", ".join(t.name if isinstance(t, Count) else code(t) for t in targets)


def _comparison(holds: Comparison) -> str:
    first, *others = map(whole_code, holds.numbers)
    return " ".join([first, *(f"{sign} {other}" for sign, other in zip(holds.signs, others,
                                                                      strict=True))])
