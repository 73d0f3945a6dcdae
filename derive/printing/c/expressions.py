"""Expressions of C99: the same bytes in every process."""

import sympy as sp
from sympy.printing.c import C99CodePrinter

from sebody.derive.form.statements import Operand
from sebody.derive.form.whole import Whole
from sebody.derive.printing.places import Words, operand_text, whole_text
from sebody.derive.printing.powers import Powers


class _CodePrinter(Powers, C99CodePrinter):
    """C expressions with entries of arrays."""

    def _print_Entry(self, expr):
        return f"{expr.array.name}[{whole_code(expr.place)}]"

    def _print_choose(self, expr):
        x, yes, no = map(self._print, expr.args)
        return f"({x} > 0.0 ? {yes} : {no})"

    def _print_tabled(self, expr):
        u, order, _ = expr.args
        return f"{expr.calls.name}({operand_code(expr.table)}, {self._print(u)}, {int(order)})"


_PRINTER = _CodePrinter()


def code(expression: sp.Expr) -> str:
    """A real number as C."""
    return _PRINTER.doprint(expression) if expression != 0 else "0.0"


WORDS = Words("{}/{}", "({0} > {1} ? {0} : {1})", "(int64_t){}", "{} + {}", code)


def whole_code(number: Whole) -> str:
    """A whole number as C."""
    return whole_text(number, WORDS)


def operand_code(operand: Operand) -> str:
    """An operand of a call as C."""
    return operand_text(operand, WORDS)
