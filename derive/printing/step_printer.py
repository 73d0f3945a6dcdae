"""From steps to lines of a kernel: a pure function, the same bytes in every process."""

from collections import Counter
from collections.abc import Iterable
from functools import cache
from textwrap import wrap

import sympy as sp

from sebody.derive.kernels.layouts import Layout
from sebody.derive.printing.expressions import code, nested, offset
from sebody.derive.symbolic.spaces import Quantity, Space
from sebody.derive.symbolic.steps import (
    Call,
    Damping,
    Entry,
    Invert,
    Names,
    Product,
    Repeat,
    Scaling,
    Search,
    Shift,
    Solve,
    Stage,
    Step,
    Tail,
    Values,
    named,
)

LOOPS = {"position": ("i", "i3", "N_POSITIONS"), "rotation": ("j", "j3", "N_ROTATIONS")}
CALL_WIDTH = 76     # inside the loops of a kernel, so that lines keep to the width
SINGLE = {"mode": ("k", "range(MODES, n)"), "coordinate": ("i", "range(n)"),
          "shape": ("i", "range(N)"), "slaved": ("b", "range(slaved)"),
          "resultant": ("e", "range(resultants)")}


class StepPrinter:
    """Prints the steps of one kernel and counts their arithmetic."""

    def __init__(self, space: Space, layout: Layout, names: Names):
        self.space, self.layout, self.names = space, layout, names
        self.inverses: dict[str, sp.Matrix] = {}
        self.operations: Counter[str] = Counter()   # of the element, of each position or rotation
        self.products = 0
        self.temporaries = 0

    def lines(self, steps: Iterable[Step]) -> list[str]:
        """Text of some steps, one comment line a step."""
        printers = {Stage: self._stage, Product: self._product, Solve: self._solve,
                    Invert: self._invert, Search: self._search, Values: self._values,
                    Shift: self._shift, Scaling: self._scaling, Damping: self._damping,
                    Call: self._call, Repeat: self._repeat}
        out = []
        for step in steps:
            text = printers[type(step)](step)
            if text:
                out += [f"# {step.title}", *text]
        return out

    def _stage(self, step: Stage) -> list[str]:
        before = [] if step.continues else [_zero(quantity.kept) for quantity, _ in step.adds]
        return before + self._loop(step.over, step.entries(self.space))

    def _loop(self, over: str, entries: list[Entry]) -> list[str]:
        stored = named(entries, self.names)
        if not stored:
            return []
        temporaries, reduced = _shared(tuple(e.value for e in stored), self.temporaries)
        self.temporaries += len(temporaries)    # names used once keep Numba's SSA pass short
        used = set().union(*(e.value.free_symbols for e in stored))
        loads, indexed = self._loads(over, used)
        body = loads + [f"{name} = {code(value)}" for name, value in temporaries]
        body += [f"{self._place(e.quantity, e.symbol)} {'+=' if e.adds else '='} {code(value)}"
                 for e, value in zip(stored, reduced, strict=True)]
        self._count(over, [v for _, v in temporaries] + list(reduced))
        indexed |= any(_by_triplet(e.quantity) for e in stored)
        return self._wrap(over, body, indexed)

    def _wrap(self, over: str, body: list[str], indexed: bool) -> list[str]:
        """A loop over what carries the values; `indexed`: its first coordinate is used."""
        if over == "element":
            return body
        if over in SINGLE:
            index, values = SINGLE[over]
            return [f"for {index} in {values}:", *nested(body)]
        index, first, count = LOOPS[over]
        size = self.layout.position_size if over == "position" else self.layout.rotation_size
        start = "" if over == "position" else "ROTATIONS + "
        place = f"{first} = {start}{size}*{index}" if size > 1 else f"{first} = {start}{index}"
        return [f"for {index} in range({count}):", *nested([place] * indexed + body)]

    def _loads(self, over: str, used: set) -> tuple[list[str], bool]:
        """Local variables of what is used, and whether the first coordinate is needed."""
        lines, indexed, values = [], False, set(self.names.values())
        for quantity in sorted(self.space.known.values(), key=lambda q: q.kept[0] in values):
            if quantity.home in (over, "element") and quantity.array and used & set(quantity.kept):
                names = ", ".join(map(str, quantity.kept))
                places = ", ".join(self._place(quantity, s) for s in quantity.kept)
                lines.append(f"{names} = {places}")
                indexed |= _by_triplet(quantity)
        return lines, indexed

    def _place(self, quantity: Quantity, symbol: sp.Symbol) -> str:
        if not quantity.array:
            return str(symbol)
        k = quantity.kept.index(symbol)
        if quantity.place:
            return f"{quantity.array}[{_index(quantity.place, quantity.first + k)}]"
        if quantity.home == "element":
            return f"{quantity.array}[{k}]"
        if quantity.kind == "rotation":
            node = "9*nodes[j]" if quantity.array == "R" else "9*j"
            return f"{quantity.array}[{node} + {k}]"
        if quantity.kind == "scalar":
            index = (LOOPS | SINGLE)[quantity.home][0]
            return f"{quantity.array}[{index}]"
        return f"{quantity.array}[{offset(LOOPS[quantity.home][1], k)}]"

    def _product(self, step: Product) -> list[str]:
        rows, columns = step.shape
        if rows == columns:
            self.products += 1
            columns = "filled" if self.layout.modes is None else rows
        call = product_name(step.call, self.layout)
        return [f"{call}({step.matrix}, {step.vector}, {step.out}, {rows}, {columns})"]

    def _solve(self, step: Solve) -> list[str]:
        unknown = step.unknown
        parts = [sp.Symbol(f"rhs_{_axis(s)}") for s in unknown.kept]
        lines, entries = [], []
        if step.invert:
            lines, entries = self._matrix(step)
        lines.append(_zero(parts))
        entries = entries + [_sum(s, e) for s, e in zip(parts, step.right_side(self.space),
                                                        strict=True)]
        lines += self._loop(step.over, entries)
        if step.invert:
            lines += self._inversion(step)
        constant = self.space.components("axial", step.constant)
        total = [p - c for p, c in zip(parts, constant, strict=True)]
        inverse = self.inverses[step.inverse]
        values = (inverse.T if step.transposed else inverse) * sp.Matrix(total)
        return lines + self._loop("element", [Entry(unknown, s, False, value) for s, value in
                                              zip(unknown.kept, values, strict=True)])

    def _invert(self, step: Invert) -> list[str]:
        lines, entries = self._matrix(step.equation)
        return lines + self._loop(step.equation.over, entries) + self._inversion(step.equation)

    def _matrix(self, step: Solve) -> tuple[list[str], list[Entry]]:
        """What the nodes add to the matrix, where its sum is not known beforehand."""
        if step.known_matrix(self.space) is not None:
            return [], []
        matrix = step.matrix(self.space)
        entries = [_sum(sp.Symbol(f"B_{r}{c}"), matrix[r, c]) for r in range(matrix.rows)
                   for c in range(matrix.cols)]
        return [_zero([e.symbol for e in entries])], entries

    def _inversion(self, step: Solve) -> list[str]:
        """The inverse of the sum, kept for later equations."""
        known = step.known_matrix(self.space)
        if known is not None:
            self.inverses[step.inverse] = known.inv()
            return []
        axes = [_axis(s) for s in step.unknown.kept]
        names = [[f"B{r}{c}" for c in axes] for r in axes]
        self.inverses[step.inverse] = sp.Matrix([[sp.Symbol(n) for n in row] for row in names])
        self.operations["element"] += 40
        if len(axes) == 1:
            return [f"{names[0][0]} = 1.0/B_00"]
        sums = ", ".join(f"B_{r}{c}" for r in range(3) for c in range(3))
        return [f"{', '.join(n for row in names for n in row)} = inverse_3({sums})"]

    def _search(self, step: Search) -> list[str]:
        self.operations["element"] += step.operations
        arguments = ", ".join(f"at({a.array}, {a.first})" if isinstance(a, Tail) else a
                              for a in step.arguments)
        lines = [f"status = {step.function}({arguments})", "if status != 0:", "    return status"]
        return lines + (self._axes(step.finds) if step.finds else [])

    def _axes(self, frame: Quantity) -> list[str]:
        """Entries of the frame's rotation into local variables."""
        if self.space.planar:
            cosine, sine = frame.kept
            return [f"{cosine}, {sine} = frame[0], frame[3]"]
        return [f"{', '.join(str(s) for s in frame.symbols[r, :])} = "
                f"{', '.join(f'frame[{3 * r + c}]' for c in range(3))}" for r in range(3)]

    def _call(self, step: Call) -> list[str]:
        self.products += step.products
        head = f"{step.function}("
        return wrap(f"{head}{', '.join(step.arguments)})", CALL_WIDTH, break_long_words=False,
                    subsequent_indent=" " * len(head))

    def _repeat(self, step: Repeat) -> list[str]:
        return [f"for {step.index} in range({step.count}):", *nested(self.lines(step.steps))]

    def _values(self, step: Values) -> list[str]:
        self.operations[step.of.home] += step.operations
        outputs = ", ".join(self._place(q, s) for q in step.outputs for s in q.kept)
        square = " + ".join(f"{p} * {p}" for p in (self._place(step.of, s)
                                                   for s in step.of.kept))
        return self._wrap(step.of.home, [f"{outputs} = {step.function}({square})"], True)

    def _shift(self, step: Shift) -> list[str]:
        return ["for i in range(n):", f"    {step.to}[i] {step.sign}= {step.what}[i]"]

    def _scaling(self, step: Scaling) -> list[str]:
        return ["for i in range(n):", *(f"    {row}[i] *= {step.factor}" for row in step.rows),
                *(f"{s} *= {step.factor}" for q in step.quantities for s in q.kept)]

    def _damping(self, step: Damping) -> list[str]:
        return self.lines(step.steps)

    def _count(self, over: str, expressions: list) -> None:
        self.operations[over] += sum(int(sp.count_ops(e)) for e in expressions)


@cache
def _shared(expressions: tuple, start: int) -> tuple[list, list]:
    """Common subexpressions of some expressions, named from t<start> on."""
    return sp.cse(expressions, sp.numbered_symbols("t", start=start), order="canonical")


def _by_triplet(quantity: Quantity) -> bool:
    """Whether its values stand in triplets (or pairs), node after node."""
    return bool(quantity.array) and quantity.home in LOOPS and quantity.kind in ("vector", "axial")


def _index(place: str, k: int) -> str:
    """An index without products and sums with zero."""
    index = place.format(k=k)
    return index if k else index.replace("0*hN + ", "").removesuffix(" + 0")


def _sum(symbol: sp.Symbol, value: sp.Expr) -> Entry:
    """A local variable that is added to."""
    return Entry(Quantity(str(symbol), "scalar", "element", "", sp.Matrix([symbol])), symbol, True,
                 value)


def _axis(symbol: sp.Symbol) -> str:
    return str(symbol)[-1]


def _zero(symbols: list) -> str:
    return " = ".join(map(str, symbols)) + " = 0.0"


def product_name(name: str, layout: Layout) -> str:
    """The function for a product: where n is a constant the product is inlined, zeros and all."""
    return "columns_times" if name == "arrow_times" and layout.modes is not None else name
