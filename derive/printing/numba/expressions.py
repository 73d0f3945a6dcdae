"""Expressions of Python: the same bytes in every process."""

import sympy as sp
from sympy.printing.precedence import precedence
from sympy.printing.pycode import PythonCodePrinter

from sebody.derive.form.arrays import Array, View
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


class _CodePrinter(PythonCodePrinter):
    """Python expressions with small integer powers written as products."""

    def _print_Pow(self, expr, **kwargs):
        base, power = expr.as_base_exp()
        if power.is_Integer and 2 <= power <= 4:
            text = self.parenthesize(base, 100)
            return "*".join([text] * int(power))
        return super()._print_Pow(expr, **kwargs)

    def _print_Mul(self, expr):
        """Powers below a fraction line as products in parentheses."""
        below = [f for f in expr.args if f.is_Pow and f.exp.is_Integer and f.exp <= -2]
        if not below:
            return super()._print_Mul(expr)
        above = sp.Mul(*[f for f in expr.args if f not in below])
        text = self._print(sp.Mul(*[1 / f for f in below]))
        return f"{self.parenthesize(above, precedence(expr))}/({text})"

    def _print_Rational(self, expr):
        return repr(float(expr))

    _print_Float = _print_Rational

    def _print_Entry(self, expr):
        return f"{expr.array.name}[{whole_code(expr.place)}]"


_PRINTER = _CodePrinter({"fully_qualified_modules": False})


def code(expression: sp.Expr) -> str:
    """A real number as Python."""
    return _PRINTER.doprint(expression) if expression != 0 else "0.0"


def whole_code(number: Whole) -> str:
    """A whole number as Python."""
    match number:
        case Number(value):
            return str(value)
        case Count(name) | Agreed(name):
            return name
        case Total(((sign, head), *terms)):
            text = ("-" if sign < 0 else "") + whole_code(head)
            return text + "".join(f" {'-' if sign < 0 else '+'} {whole_code(term)}"
                                  for sign, term in terms)
        case Times(factors):
            return "*".join(map(_factor, factors))
        case Quotient(dividend, divisor):
            return f"{_factor(dividend)}//{_factor(divisor)}"
        case Largest(one, other):
            return f"max({whole_code(one)}, {whole_code(other)})"
        case Applied(function, arguments):
            return f"{function.name}({', '.join(map(whole_code, arguments))})"
        case Stored(array, place):
            return f"{array.name}[{whole_code(place)}]"
        case Truncated(entry):
            return f"int({code(entry)})"
    raise TypeError(f"{number!r} is no whole number")


def _factor(number: Whole) -> str:
    text = whole_code(number)
    return f"({text})" if isinstance(number, Total) else text


def operand_code(operand: Operand) -> str:
    """An operand of a call as Python."""
    match operand:
        case Array(name):
            return name
        case View(array, first):
            return f"at({array.name}, {whole_code(first)})"
        case Whole():
            return whole_code(operand)
    return code(operand)
