"""From steps to statements: loads, common subexpressions, loops; the same in every process."""

from collections.abc import Iterable
from functools import cache

import sympy as sp

from sebody.derive.form import counts
from sebody.derive.form.arrays import pointed
from sebody.derive.form.functions import ARROW_TIMES, COLUMNS_TIMES, INVERSE_3
from sebody.derive.form.loops import DOF_BLOCKS, ELEMENT, LOOPS, size_of
from sebody.derive.form.spaces import Quantity, Space
from sebody.derive.form.statements import (
    Change,
    For,
    If,
    Let,
    Remark,
    Return,
    Set,
    Statement,
    Target,
    Update,
    Zero,
    compared,
    invoked,
)
from sebody.derive.form.steps import (
    Call,
    Damping,
    Entry,
    Invert,
    Product,
    Repeat,
    Scaling,
    Search,
    Shift,
    Solve,
    Stage,
    Step,
    Sum,
    Values,
)
from sebody.derive.form.whole import Count, Number, Whole, replaced, whole
from sebody.derive.symbolic.rotations import stumpff, tangent_inverse

Names = dict[sp.Expr, sp.Symbol]    # opaque functions -> symbols that hold their values
STATUS = Count("status")
FRAME, NODES = pointed("frame", 9), pointed("nodes", counts.ROTATIONS, whole=True)
ROTATION_MATRICES = pointed("R")
INVERSION = 40          # operations


class Lowering:
    """Makes statements of the steps of one kernel.

    Parameters
    ----------
    space : Space
    names : dict
        Opaque functions and the symbols that hold their values.
    arrows : bool
        Square matrices of the body are multiplied without their zeros, `counts.filled`: else the
        products are written out, as where sizes are constants.
    """

    def __init__(self, space: Space, names: Names, arrows: bool = True):
        self.space, self.names, self.arrows = space, names, arrows
        self.inverses: dict[str, sp.Matrix] = {}
        self.temporaries = 0

    def statements(self, steps: Iterable[Step]) -> tuple[Statement, ...]:
        """Statements of some steps, a comment before those of each."""
        lowered = {Stage: self._stage, Product: self._product, Solve: self._solve,
                   Invert: self._invert, Search: self._search, Values: self._values,
                   Shift: self._shift, Scaling: self._scaling, Damping: self._damping,
                   Call: self._call, Repeat: self._repeat}
        listed: list[Statement] = []
        for step in steps:
            own = lowered[type(step)](step)
            listed += [Remark(step.title), *own] if own else []
        return tuple(listed)

    def _stage(self, step: Stage) -> list[Statement]:
        before = [] if step.continues else [Zero(tuple(q.kept)) for q, _ in step.adds]
        return before + self._loop(step.over, step.entries(self.space))

    def _loop(self, over: str, entries: list[Entry]) -> list[Statement]:
        stored = self._named(entries)
        if not stored:
            return []
        temporaries, reduced = _shared(tuple(e.value for e in stored), self.temporaries)
        self.temporaries += len(temporaries)    # names used once keep Numba's SSA pass short
        used = set().union(*(e.value.free_symbols for e in stored))
        loads, indexed = self._loads(over, used)
        body = loads + [Set((name,), (value,)) for name, value in temporaries]
        for entry, value in zip(stored, reduced, strict=True):
            target = self.target(entry.quantity, entry.symbol)
            body.append(Update(target, Change.ADD, value) if entry.adds else
                        Set((target,), (value,)))
        return self._wrap(over, body, indexed or any(_by_dof_block(e.quantity) for e in stored))

    def _named(self, entries: Iterable[Entry]) -> list[Entry]:
        """Entries with named functions, without those that add nothing."""
        named = [e._replace(value=name_functions(sp.sympify(e.value), self.names))
                 for e in entries]
        return [e for e in named if not (e.adds and e.value == 0)]

    def _wrap(self, over: str, body: list[Statement], indexed: bool) -> list[Statement]:
        """A loop over what carries the values; `indexed`: its first coordinate is used."""
        if over == ELEMENT:
            return body
        if over in DOF_BLOCKS and indexed:
            of = DOF_BLOCKS[over]
            place = of.begin + size_of(over, self.space.planar) * of.index
            body = [Let((of.place,), (place,)), *body]
        return [For(*LOOPS[over], tuple(body), over)]

    def _loads(self, over: str, used: set) -> tuple[list[Statement], bool]:
        """Local variables of what is used, and whether the first coordinate is needed."""
        loads, indexed, values = [], False, set(self.names.values())
        for quantity in sorted(self.space.known.values(), key=lambda q: q.kept[0] in values):
            if quantity.home in (over, ELEMENT) and quantity.array and used & set(quantity.kept):
                loads.append(self.load(quantity))
                indexed |= _by_dof_block(quantity)
        return loads, indexed

    def load(self, quantity: Quantity) -> Set:
        """A quantity of an array in local variables."""
        kept = tuple(quantity.kept)
        return Set(kept, tuple(self.target(quantity, s) for s in kept))

    def target(self, quantity: Quantity, symbol: sp.Symbol) -> Target:
        """The place of a component: a local variable, or an entry of an array."""
        if not quantity.array:
            return symbol
        return quantity.array[self.place(quantity, quantity.kept.index(symbol))]

    def place(self, quantity: Quantity, k: int) -> Whole:
        """The place of a component in its array."""
        if quantity.place:
            return quantity.place.of(k)
        if quantity.home == ELEMENT:
            return Number(k)
        if quantity.kind == "rotation":
            node = NODES[counts.j] if quantity.array == ROTATION_MATRICES else counts.j
            return 9 * node + k
        if quantity.kind == "scalar":
            return LOOPS[quantity.home].index
        return DOF_BLOCKS[quantity.home].place + k

    def _product(self, step: Product) -> list[Statement]:
        square = step.rows == step.columns
        arrow = square and self.arrows
        return [invoked(ARROW_TIMES if arrow else COLUMNS_TIMES, (
            step.matrix, step.vector, step.out, step.rows,
            counts.filled if arrow else step.columns), products=int(square))]

    def _solve(self, step: Solve) -> list[Statement]:
        unknown = step.unknown
        parts = [sp.Symbol(f"rhs_{axis}") for axis in self._axes(unknown)]
        cleared = self._cleared(step) if step.invert else []
        cleared.append(Zero(tuple(parts)))
        for part in step.sums:
            entries = self._matrix(step, part) if step.invert else []
            right = zip(parts, step.right_side(part, self.space), strict=True)
            cleared += self._loop(part.over, [*entries, *(_sum(s, e) for s, e in right)])
        if step.invert:
            cleared += self._inversion(step)
        constant = self.space.components("axial", step.constant)
        total = [p - c for p, c in zip(parts, constant, strict=True)]
        inverse = self.inverses[step.inverse]
        values = (inverse.T if step.transposed else inverse) * sp.Matrix(total)
        return cleared + self._loop(ELEMENT, [Entry(unknown, s, False, value) for s, value in
                                              zip(unknown.kept, values, strict=True)])

    def _invert(self, step: Invert) -> list[Statement]:
        equation = step.equation
        cleared = self._cleared(equation)
        for part in equation.sums:
            cleared += self._loop(part.over, self._matrix(equation, part))
        return cleared + self._inversion(equation)

    def _cleared(self, step: Solve) -> list[Statement]:
        """The sum of the matrix before the first summand."""
        entries = self._matrix(step, step.sums[0])
        return [Zero(tuple(e.symbol for e in entries))] if entries else []

    def _matrix(self, step: Solve, part: Sum) -> list[Entry]:
        """The summand in the matrix, where its sum is not known beforehand."""
        if step.known_matrix(self.space) is not None:
            return []
        matrix = step.matrix(part, self.space)
        return [_sum(sp.Symbol(f"B_{r}{c}"), matrix[r, c]) for r in range(matrix.rows)
                for c in range(matrix.cols)]

    def _inversion(self, step: Solve) -> list[Statement]:
        """The inverse of the sum, kept for later equations."""
        known = step.known_matrix(self.space)
        if known is not None:
            self.inverses[step.inverse] = known.inv()
            return []
        axes = self._axes(step.unknown)
        names = [[sp.Symbol(f"B{r}{c}") for c in axes] for r in axes]
        self.inverses[step.inverse] = sp.Matrix(names)
        sums = [sp.Symbol(f"B_{r}{c}") for r in range(len(axes)) for c in range(len(axes))]
        if len(axes) == 1:
            return [Set((names[0][0],), (1.0 / sums[0],))]
        return [invoked(INVERSE_3, tuple(sums), tuple(name for row in names for name in row),
                        operations=INVERSION)]

    def _axes(self, quantity: Quantity) -> str:
        """The axes of the components of a vector of rotation."""
        return AXES[quantity.kind, self.space.planar]

    def _search(self, step: Search) -> list[Statement]:
        lowered: list[Statement] = [
            invoked(step.function, step.operands, (STATUS,), operations=step.operations),
            If(compared(STATUS, "!=", 0), (Return(STATUS),))]
        return lowered + (self._frame(step.finds) if step.finds else [])

    def _frame(self, rotation: Quantity) -> list[Statement]:
        """Entries of the frame's rotation into local variables."""
        if self.space.planar:
            return [Set(tuple(rotation.kept), (FRAME[0], FRAME[3]))]
        return [Set(tuple(rotation.symbols[r, :]), tuple(FRAME[3 * r + c] for c in range(3)))
                for r in range(3)]

    def _call(self, step: Call) -> list[Statement]:
        return [invoked(step.function, step.operands, products=step.products)]

    def _repeat(self, step: Repeat) -> list[Statement]:
        return [For(step.index, Number(0), step.count, self.statements(step.steps))]

    def _values(self, step: Values) -> list[Statement]:
        outputs = tuple(self.target(q, s) for q in step.outputs for s in q.kept)
        square = sum(s**2 for s in step.of.kept)
        body = [self.load(step.of)] if step.of.array else []
        return self._wrap(step.of.home, [*body, invoked(
            step.function, (square,), outputs, operations=step.operations)], _by_dof_block(step.of))

    def _shift(self, step: Shift) -> list[Statement]:
        change = Change.ADD if step.adds else Change.SUBTRACT
        return [self.over_coordinates(Update(step.to[counts.i], change, step.what[counts.i]))]

    def _scaling(self, step: Scaling) -> list[Statement]:
        return [self.over_coordinates(*(Update(row[counts.i], Change.MULTIPLY, step.factor)
                                        for row in step.rows)),
                *(Update(s, Change.MULTIPLY, step.factor)
                  for q in step.quantities for s in q.kept)]

    def over_coordinates(self, *body: Statement) -> For:
        """Statements for every local coordinate."""
        return For(*LOOPS["coordinate"], body, "coordinate")

    def _damping(self, step: Damping) -> list[Statement]:
        return list(self.statements(step.steps))


AXES = {("axial", False): "xyz", ("axial", True): "z", ("vector", False): "xyz",
        ("vector", True): "xy"}


@cache
def _shared(expressions: tuple, start: int) -> tuple[list, list]:
    """Common subexpressions of some expressions, named from t<start> on."""
    return sp.cse(expressions, sp.numbered_symbols("t", start=start), order="canonical")


def _by_dof_block(quantity: Quantity) -> bool:
    """Tell if its values stand in blocks (or pairs), node after node, or follow their places."""
    if not quantity.array or quantity.home not in DOF_BLOCKS:
        return False
    if quantity.place is None:
        return quantity.kind in ("vector", "axial")
    start = whole(quantity.place.start)
    return replaced(start, {DOF_BLOCKS[quantity.home].place: Number(0)}) != start


def _sum(symbol: sp.Symbol, value: sp.Expr) -> Entry:
    """A local variable that is added to."""
    return Entry(Quantity(str(symbol), "scalar", ELEMENT, None, sp.Matrix([symbol])), symbol, True,
                 value)


def name_functions(expression: sp.Expr, names: Names) -> sp.Expr:
    """Replace evaluated opaque functions by the quantities that hold their values."""
    replaced = {f: names[f] for f in expression.atoms(stumpff, tangent_inverse) if f in names}
    return expression.xreplace(replaced)
