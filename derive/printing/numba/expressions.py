"""Expressions of Python: the same bytes in every process."""

import sympy as sp
from sympy.printing.pycode import PythonCodePrinter

from sebody.derive.form.statements import Operand
from sebody.derive.form.whole import Whole
from sebody.derive.formulas.elements import choose
from sebody.derive.printing.places import Words, operand_text, whole_text
from sebody.derive.printing.powers import Powers


class _CodePrinter(Powers, PythonCodePrinter):
    """Python expressions with entries of arrays."""

    def _print_Entry(self, expr):
        return f"{expr.array.name}[{whole_code(expr.place)}]"

    def _print_choose(self, expr):
        x, yes, no = map(self._print, expr.args)
        return f"({yes} if {x} > 0.0 else {no})"

    def _print_tabled(self, expr):
        u, order, _ = map(self._print, expr.args)
        return f"{expr.calls.name}({operand_code(expr.table)}, {u}, {order})"


_PRINTER = _CodePrinter({"fully_qualified_modules": False})


def code(expression: sp.Expr) -> str:
    """A real number as Python; a choice without the parentheses it has in others."""
    if expression == 0:
        return "0.0"
    text = _PRINTER.doprint(expression)
    return text[1:-1] if isinstance(expression, choose) else text


WORDS = Words("{}//{}", "max({}, {})", "int({})", "at({}, {})", code)


def whole_code(number: Whole) -> str:
    """A whole number as Python."""
    return whole_text(number, WORDS)


def operand_code(operand: Operand) -> str:
    """An operand of a call as Python."""
    return operand_text(operand, WORDS)
