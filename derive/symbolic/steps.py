"""Named quantities and the steps that compute one from another: what a kernel is made of.

A kernel is a list of steps in the order of computation. Its linearization is the differential
of each, by the chain rule over the *named* quantities, in the same order. Titles are comments of
the kernel and nothing else. Every step reports the arrays and the runtime's functions it uses.
"""

from collections.abc import Iterable
from enum import Enum, auto
from typing import NamedTuple

import sympy as sp

from sebody.derive.symbolic.rotations import skew, stumpff, tangent_inverse
from sebody.derive.symbolic.spaces import Quantity, Space

Names = dict[sp.Expr, sp.Symbol]    # opaque functions -> symbols that hold their values


class Role(Enum):
    """How the linearization treats a stage."""

    PLAIN = auto()          # by the chain rule
    BY_RULE = auto()        # its differential is among the rules: nothing to compute
    NODE_FORCE = auto()     # its differential stays in the axes of the frame


class Uses(NamedTuple):
    """Arrays, in the order of use, and functions of the runtime."""

    arrays: tuple[str, ...]
    calls: tuple[str, ...] = ()


class Entry(NamedTuple):
    """One component that is set or added to."""

    quantity: Quantity
    symbol: sp.Symbol
    adds: bool
    value: sp.Expr


class Stage(NamedTuple):
    """Explicit formulas: quantities set, or summed over the nodes."""

    title: str
    over: str                                   # element | position | rotation | mode
    sets: tuple[tuple[Quantity, sp.Matrix], ...] = ()
    adds: tuple[tuple[Quantity, sp.Matrix], ...] = ()
    short: tuple[sp.Matrix, ...] = ()           # hand-shortened differentials of `sets`, proved
    continues: bool = False                     # `adds` goes on with the sum of an earlier stage
    role: Role = Role.PLAIN

    def entries(self, space: Space) -> list[Entry]:
        """Its formulas component by component."""
        return [Entry(quantity, symbol, adds, value)
                for group, adds in ((self.sets, False), (self.adds, True))
                for quantity, values in group
                for symbol, value in zip(quantity.kept, space.components(quantity.kind, values),
                                         strict=True)]

    def uses(self, space: Space, names: Names) -> Uses:
        """Arrays of what it reads and writes."""
        entries = named(self.entries(space), names)
        written = dict.fromkeys(e.quantity.array for e in entries)
        return Uses((*_arrays(space, (e.value for e in entries)), *written))


class Product(NamedTuple):
    """``out = matrix vector`` with a matrix of the body's constants, by padded columns."""

    title: str
    matrix: str
    vector: str
    out: str
    shape: tuple[str, str] = ("n", "n")

    def differential(self) -> "Product":
        """The same product of the vector's differential: the matrix is constant."""
        return self._replace(title="differential: " + self.title, vector="d" + self.vector,
                             out="d" + self.out)

    def uses(self, space: Space, names: Names) -> Uses:
        """The matrix and both vectors."""
        return Uses((self.matrix, self.vector, self.out), (self.call,))

    @property
    def call(self) -> str:
        """The function of the runtime: reduced matrices are mostly zeros between modes."""
        rows, columns = self.shape
        return "arrow_times" if rows == columns else "columns_times"


class Solve(NamedTuple):
    """A linear 3-vector equation ``sum_j summand_j(unknown) + constant = 0`` over `over` nodes.

    The inverse of its matrix is kept in `inverse`, made where `invert` says so.
    """

    title: str
    unknown: Quantity
    over: str
    summand: sp.Matrix
    constant: sp.Matrix
    inverse: str
    transposed: bool = False
    invert: bool = False
    weight: sp.Symbol | None = None     # of a node, adding up to one over the nodes
    role: Role = Role.PLAIN

    def matrix(self, space: Space) -> sp.Matrix:
        """Matrix of one summand, without the axes that a plane drops."""
        matrix = solve_matrix(self)
        return matrix[2:, 2:] if space.planar else matrix

    def known_matrix(self, space: Space) -> sp.Matrix | None:
        """The sum over the nodes, where it is known beforehand: weights add up to one."""
        if self.weight is None:
            return None
        value = (self.matrix(space) / self.weight).applyfunc(sp.cancel)
        return None if value.free_symbols else value

    def right_side(self, space: Space) -> list[sp.Expr]:
        """What the nodes add to the right-hand side."""
        zero = {s: 0 for s in self.unknown.kept}
        return [-e for e in space.components("axial", self.summand.subs(zero))]

    def uses(self, space: Space, names: Names) -> Uses:
        """Arrays of what is summed, and the inversion where there is one to be done."""
        inverted = self.invert and self.known_matrix(space) is None
        values = [*self.right_side(space), *space.components("axial", self.constant),
                  *(self.matrix(space) if inverted else ())]
        return Uses(_arrays(space, (name_functions(sp.sympify(v), names) for v in values)),
                    ("inverse_3",) * (inverted and not space.planar))


class Invert(NamedTuple):
    """The inverse of the matrix of an equation, for others that have the same."""

    equation: Solve

    @property
    def title(self) -> str:
        """What the matrix belongs to."""
        return "matrix of: " + self.equation.title

    def uses(self, space: Space, names: Names) -> Uses:
        """Arrays of the matrix, and the inversion where there is one to be done."""
        if self.equation.known_matrix(space) is not None:
            return Uses(())
        values = [name_functions(sp.sympify(v), names) for v in self.equation.matrix(space)]
        return Uses(_arrays(space, values), ("inverse_3",) * (not space.planar))


class Tail(NamedTuple):
    """An array from a place on, as an argument of a search."""

    array: str
    first: str


class Search(NamedTuple):
    """A call of a search of the runtime that may fail: then its status is the kernel's."""

    title: str
    function: str
    arguments: tuple[str | Tail, ...]
    operations: int                     # arithmetic, for the operation count
    finds: Quantity | None = None       # the rotation it leaves in the array of the frame

    def uses(self, space: Space, names: Names) -> Uses:
        """The function and the arrays among its arguments."""
        return Uses(tuple(a.array if isinstance(a, Tail) else a for a in self.arguments),
                    (self.function,))


class Call(NamedTuple):
    """A call of a function of the runtime; arguments are text, arrays those it reads or writes."""

    title: str
    function: str
    arguments: tuple[str, ...]
    arrays: tuple[str, ...]
    products: int = 0                   # with n x n matrices, for the operation count

    def uses(self, space: Space, names: Names) -> Uses:
        """The function and its arrays."""
        return Uses(self.arrays, (self.function,))


class Repeat(NamedTuple):
    """Steps once for each value of an index that their calls and quantities use."""

    title: str
    index: str
    count: str
    steps: tuple

    def uses(self, space: Space, names: Names) -> Uses:
        """What its steps use."""
        return united(step.uses(space, names) for step in self.steps)


class Values(NamedTuple):
    """Values of a function of the runtime of the square of a vector."""

    title: str
    outputs: tuple[Quantity, ...]
    function: str
    of: Quantity
    operations: int                     # arithmetic of one evaluation, for the operation count

    @property
    def over(self) -> str:
        """Where there is one value each."""
        return self.of.home

    def uses(self, space: Space, names: Names) -> Uses:
        """The function, the vector and the values."""
        return Uses((self.of.array, *(q.array for q in self.outputs)), (self.function,))


class Shift(NamedTuple):
    """``to += what`` of whole rows of local coordinates, ``to -= what`` or ``to = what``."""

    title: str
    to: str
    what: str
    sign: str

    def differential(self) -> "Shift":
        """The same of the differentials."""
        return self._replace(to="d" + self.to, what="d" + self.what)

    def uses(self, space: Space, names: Names) -> Uses:
        """Both rows."""
        return Uses((self.to, self.what))


class Scaling(NamedTuple):
    """Rows of local coordinates, and quantities of the element, times a factor."""

    title: str
    rows: tuple[str, ...]
    quantities: tuple[Quantity, ...]
    factor: str

    def uses(self, space: Space, names: Names) -> Uses:
        """The rows."""
        return Uses(self.rows)


class Damping(NamedTuple):
    """Steps that only layouts with structural damping have."""

    title: str
    steps: tuple

    def uses(self, space: Space, names: Names) -> Uses:
        """What its steps use."""
        return united(step.uses(space, names) for step in self.steps)


Step = (Stage | Product | Solve | Invert | Search | Call | Repeat | Values | Shift | Scaling
        | Damping)


def united(uses: Iterable[Uses]) -> Uses:
    """Everything that some steps use, each thing once and in the order of first use."""
    found = list(uses)
    return Uses(tuple(dict.fromkeys(a for u in found for a in u.arrays if a)),
                tuple(dict.fromkeys(c for u in found for c in u.calls)))


def named(entries: Iterable[Entry], names: Names) -> list[Entry]:
    """Entries with named functions, without those that add nothing."""
    found = [e._replace(value=name_functions(sp.sympify(e.value), names)) for e in entries]
    return [e for e in found if not (e.adds and e.value == 0)]


def _arrays(space: Space, values: Iterable[sp.Expr]) -> tuple[str, ...]:
    """Arrays of the quantities in some expressions, in the order of the quantities."""
    used = set().union(*(value.free_symbols for value in values))
    return tuple(q.array for q in space.known.values() if q.array and used & set(q.kept))


def solve_matrix(step: Solve) -> sp.Matrix:
    """Matrix of one summand of a linear equation in its unknown."""
    columns = [step.summand.diff(u) if isinstance(u, sp.Symbol) else sp.zeros(3, 1)
               for u in step.unknown.symbols]
    return sp.Matrix.hstack(*columns)


def name_functions(expression: sp.Expr, names: Names) -> sp.Expr:
    """Replace evaluated opaque functions by the quantities that hold their values."""
    found = {f: names[f] for f in expression.atoms(stumpff, tangent_inverse) if f in names}
    return expression.xreplace(found)


def cross(a: sp.Matrix, b: sp.Matrix) -> sp.Matrix:
    """``a x b`` of two columns."""
    return skew(a) * b
