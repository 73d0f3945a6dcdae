"""From stages to the text of a kernel: a pure function, the same bytes in every process."""

import re
from collections.abc import Iterable
from functools import cache

import sympy as sp
from sympy.printing.precedence import precedence
from sympy.printing.pycode import PythonCodePrinter

from sebody.derive.kernels.layouts import Layout
from sebody.derive.symbolic.spaces import Quantity, Space
from sebody.derive.symbolic.steps import (
    Damping,
    Product,
    Solve,
    Stage,
    Step,
    Text,
    name_functions,
    solve_matrix,
)

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

    def _print_Rational(self, expr):
        return repr(float(expr))


_PRINTER = _CodePrinter({"fully_qualified_modules": False})
_LOOPS = {"position": ("i", "i3", "N_POSITIONS"), "rotation": ("j", "j3", "N_ROTATIONS")}


class StepPrinter:
    """Prints the steps of one kernel and counts their arithmetic."""

    def __init__(self, space: Space, layout: Layout, names: dict):
        self.space, self.layout, self.names = space, layout, names
        self.weights = [space.known[w].symbols[0] for w in ("alpha", "alpha_r")
                        if w in space.known]
        self.inverses: dict[str, sp.Matrix | None] = {}
        self.operations = 0
        self.products = 0
        self.temporaries = 0

    def lines(self, steps: Iterable[Step]) -> list[str]:
        """Text of some steps, one comment line a step."""
        out = []
        for step in steps:
            text = {Stage: self._stage, Product: self._product, Solve: self._solve,
                    Text: self._text, Damping: self._damping}[type(step)](step)
            if text:
                out += [f"# {step.title}", *text]
        return out

    def _stage(self, step: Stage) -> list[str]:
        targets, expressions = [], []
        for group, op in ((step.sets, "="), (step.adds, "+=")):
            for quantity, value in group:
                kept = self.space.components(quantity.kind, value)
                targets += [(quantity, s, op) for s in quantity.kept]
                expressions += kept
        before = []
        for quantity, _ in step.adds:
            before += [] if step.continues else [_zero(quantity.kept)]
        return before + self._loop(step.over, targets, expressions)

    def _loop(self, over, targets, expressions) -> list[str]:
        expressions = [name_functions(sp.sympify(e), self.names) for e in expressions]
        stored = [(q, s, op, e) for (q, s, op), e in zip(targets, expressions, strict=True)]
        stored = [entry for entry in stored if not (entry[2] == "+=" and entry[3] == 0)]
        temporaries, reduced = _shared(tuple(e for *_, e in stored), self.temporaries)
        self.temporaries += len(temporaries)    # names used once keep Numba's SSA pass short
        used = set().union(*(e.free_symbols for *_, e in stored)) if stored else set()
        body = self._loads(over, used)
        body += [f"{name} = {code(value)}" for name, value in temporaries]
        body += [f"{self._place(q, s)} {op} {code(e)}"
                 for (q, s, op, _), e in zip(stored, reduced, strict=True)]
        self._count(over, [v for _, v in temporaries] + list(reduced))
        if not stored:
            return []
        return self._wrap(over, body)

    def _wrap(self, over: str, body: list[str]) -> list[str]:
        if over == "element":
            return body
        if over == "mode":
            return ["for k in range(MODES, n):", *_indent(body)]
        index, first, count = _LOOPS[over]
        size = self.layout.position_size if over == "position" else self.layout.rotation_size
        start = "" if over == "position" else "ROTATIONS + "
        offset = [f"{first} = {start}{size}*{index}"] if size > 1 else [f"{first} = {start}{index}"]
        text = "\n".join(body)
        used = offset if re.search(rf"\b{first}\b", text) else []
        return [f"for {index} in range({count}):", *_indent(used + body)]

    def _loads(self, over: str, used: set) -> list[str]:
        lines = []
        for quantity in self.space.known.values():
            if quantity.home in (over, "element") and quantity.array and used & set(quantity.kept):
                names = ", ".join(map(str, quantity.kept))
                places = ", ".join(self._place(quantity, s) for s in quantity.kept)
                lines.append(f"{names} = {places}")
        return lines

    def _place(self, quantity: Quantity, symbol: sp.Symbol) -> str:
        if not quantity.array:
            return str(symbol)
        k = quantity.kept.index(symbol)
        if quantity.name == "R":
            return f"R[9*nodes[j] + {k}]"
        if quantity.home == "element":
            return f"{quantity.array}[{k}]"
        if quantity.kind == "rotation":
            return f"{quantity.array}[9*j + {k}]"
        if quantity.kind == "scalar":
            index = {"position": "i", "rotation": "j", "mode": "k"}[quantity.home]
            return f"{quantity.array}[{index}]"
        first = _LOOPS[quantity.home][1]
        return f"{quantity.array}[{first} + {k}]" if k else f"{quantity.array}[{first}]"

    def _product(self, step: Product) -> list[str]:
        rows, columns = step.shape
        if rows == columns:
            self.products += 1
        return [f"columns_times({step.matrix}, {step.vector}, {step.out}, {rows}, {columns})"]

    def _solve(self, step: Solve) -> list[str]:
        unknown = step.unknown
        zero = {s: 0 for s in unknown.kept}
        parts = [sp.Symbol(f"rhs_{str(s)[-1]}") for s in unknown.kept]
        rhs = [-e for e in self.space.components("axial", step.summand.subs(zero))]
        matrix = self._kept_matrix(solve_matrix(step))
        entries = [(sp.Symbol(f"B_{r}{c}"), matrix[r, c]) for r in range(matrix.rows)
                   for c in range(matrix.cols)] if step.invert else []
        known = _constant_sum(matrix, self.weights)
        if step.invert:
            self.inverses[step.inverse] = known
        entries = [] if known is not None else entries
        accumulated = entries + list(zip(parts, rhs, strict=True))
        lines = [_zero([s for s, _ in entries])] if entries else []
        lines.append(_zero(parts))
        quantities = [(Quantity(str(s), "scalar", "element", "", sp.Matrix([s])), s, "+=")
                      for s, _ in accumulated]
        lines += self._loop(step.over, quantities, [e for _, e in accumulated])
        if entries:
            names = ", ".join(f"B{r}{c}" for r in "xyz" for c in "xyz")
            lines.append(f"{names} = inverse_3(B_00, B_01, B_02, B_10, B_11, B_12, "
                         "B_20, B_21, B_22)" if len(entries) == 9 else "Bzz = 1.0/B_00")
            self.operations += 40
        constant = self.space.components("axial", step.constant)
        total = [p - c for p, c in zip(parts, constant, strict=True)]
        values = self._inverse(step) * sp.Matrix(total)
        results = [(unknown, s, "=") for s in unknown.kept]
        return lines + self._loop("element", results, list(values))

    def _inverse(self, step: Solve) -> sp.Matrix:
        known = self.inverses[step.inverse]
        axes = [str(s)[-1] for s in step.unknown.kept]
        inverse = known.inv() if known is not None else sp.Matrix(
            len(axes), len(axes), lambda r, c: sp.Symbol(f"B{axes[r]}{axes[c]}"))
        return inverse.T if step.transposed else inverse

    def _kept_matrix(self, matrix: sp.Matrix) -> sp.Matrix:
        return matrix[2:, 2:] if self.layout.planar else matrix

    def _text(self, step: Text) -> list[str]:
        self.operations += step.operations * (1 if step.over == "element" else
                                              self.layout.rotations)
        return self._wrap(step.over, list(step.lines))

    def _damping(self, step: Damping) -> list[str]:
        return self.lines(step.steps)

    def _count(self, over: str, expressions: list) -> None:
        times = {"element": 1, "mode": 0, "position": self.layout.positions,
                 "rotation": self.layout.rotations}[over]
        self.operations += times * sum(int(sp.count_ops(e)) for e in expressions)


@cache
def _shared(expressions: tuple, start: int) -> tuple[list, list]:
    """Common subexpressions of some expressions, named from t<start> on."""
    return sp.cse(expressions, sp.numbered_symbols("t", start=start), order="canonical")


def _constant_sum(matrix: sp.Matrix, weights: list) -> sp.Matrix | None:
    """Sum of the matrices over the nodes where it is known beforehand: weights add up to one."""
    for weight in weights:
        value = (matrix / weight).applyfunc(sp.cancel)
        if not value.free_symbols:
            return value
    return None


def _zero(symbols: list) -> str:
    return " = ".join(map(str, symbols)) + " = 0.0"


def code(expression: sp.Expr) -> str:
    return _PRINTER.doprint(expression)


def _indent(lines: Iterable[str]) -> list[str]:
    return ["    " + line for line in lines]


def indented(lines: Iterable[str], levels: int) -> str:
    """Lines of code at an indentation, long ones broken after an operator."""
    pad = "    " * levels
    return "\n".join(_broken(pad + line) for line in lines)


def _broken(line: str) -> str:
    if len(line) <= WIDTH or line.lstrip().startswith("#"):
        return line
    indent = len(line) - len(line.lstrip())
    head, _, tail = line.partition(" = ") if " = " in line else line.partition(" += ")
    operator = " = " if " = " in line else " += "
    words, rows, row = tail.split(" "), [], head + operator + "("
    if not tail or "(" in head:
        return line
    if head.count(",") and tail.count(","):
        row = head + operator + "("
    for word in words:
        if len(row) + len(word) + 2 > WIDTH:
            rows.append(row.rstrip())
            row = " " * (indent + 4)
        row += word + " "
    return "\n".join([*rows, row.rstrip() + ")"])
