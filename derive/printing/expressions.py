"""Expressions and lines of Python: the same bytes in every process."""

from collections.abc import Iterable

import sympy as sp
from sympy.printing.precedence import precedence
from sympy.printing.pycode import PythonCodePrinter

WIDTH = 100


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

    def _print_near_angle(self, expr):
        """A function of the runtime."""
        return f"near_angle({self._print(expr.args[0])}, {self._print(expr.args[1])})"

    def _print_Rational(self, expr):
        return repr(float(expr))


_PRINTER = _CodePrinter({"fully_qualified_modules": False})


def code(expression: sp.Expr) -> str:
    """An expression as Python."""
    return _PRINTER.doprint(expression)


def offset(name: str, k: int) -> str:
    """A place, k numbers after another."""
    return f"{name} + {k}" if k else name


def nested(lines: Iterable[str]) -> list[str]:
    """Lines inside a loop or condition."""
    return ["    " + line for line in lines]


def indented(lines: Iterable[str], levels: int) -> str:
    """Lines of code at an indentation, long ones broken after an operator."""
    pad = "    " * levels
    return "\n".join(_broken(pad + line) for line in lines)


def _broken(line: str) -> str:
    """A long assignment in parentheses over several lines; other lines are left alone."""
    operator = " = " if " = " in line else " += "
    head, _, tail = line.partition(operator)
    if len(line) <= WIDTH or line.lstrip().startswith("#") or not tail or (
            head.count("(") != head.count(")")):
        return line
    indent = len(line) - len(line.lstrip())
    rows, row = [], head + operator + "("
    for word in tail.split(" "):
        if len(row) + len(word) + 2 > WIDTH:
            rows.append(row.rstrip())
            row = " " * (indent + 4)
        row += word + " "
    return "\n".join([*rows, row.rstrip() + ")"])
