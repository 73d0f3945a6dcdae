"""Small integer powers as products, for the printers of all targets."""

import sympy as sp
from sympy.printing.precedence import precedence

LARGEST = 4         # power that is written out
TIGHT = 100         # a precedence above all others: everything but names gets parentheses


class Powers:
    """Part of a printer of SymPy."""

    def _print_Pow(self, expr, **kwargs):
        base, power = expr.as_base_exp()
        if power.is_Integer and 2 <= power <= LARGEST:
            text = self.parenthesize(base, TIGHT)
            return "*".join([text] * int(power))
        if power.is_Integer and -LARGEST <= power <= -2:    # with a zero below, whole powers raise
            return f"1/({self._print(1 / expr)})"
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
