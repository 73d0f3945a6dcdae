"""Steps that compute one quantity from another: what formulas make a kernel of.

A kernel is a list of steps in the order of computation. Its linearization is the differential of
each, by the chain rule over the *named* quantities, in the same order. Titles are comments of the
kernel and nothing else. Operands are typed: arrays, views and whole numbers.
"""

from enum import Enum, auto
from typing import NamedTuple

import sympy as sp

from sebody.derive.form.arrays import Array, View
from sebody.derive.form.counts import n
from sebody.derive.form.functions import Function
from sebody.derive.form.spaces import Quantity, Space
from sebody.derive.form.statements import Operand, checked
from sebody.derive.form.whole import Count, Whole


class Role(Enum):
    """Treatments of a stage by the linearization."""

    PLAIN = auto()          # by the chain rule
    BY_RULE = auto()        # its differential is among the rules: nothing to compute
    NODE_FORCE = auto()     # its differential stays in the axes of the frame


class Entry(NamedTuple):
    """One component that is set or added to."""

    quantity: Quantity
    symbol: sp.Symbol
    adds: bool
    value: sp.Expr


class Stage(NamedTuple):
    """Explicit formulas: quantities set, or summed over the nodes."""

    title: str
    over: str                                   # a home, see `loops`
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


class Product(NamedTuple):
    """``out = matrix vector`` with a matrix of the body's constants, by padded columns."""

    title: str
    matrix: Array
    vector: Array
    out: Array
    rows: Whole = n
    columns: Whole = n

    def differential(self) -> "Product":
        """The same product of the vector's differential: the matrix is constant."""
        return self._replace(title="differential: " + self.title, vector=self.vector.d,
                             out=self.out.d)


class Sum(NamedTuple):
    """A sum over carriers that is added to a vector."""

    over: str                           # a home, see `loops`
    summand: sp.Matrix


class Solve(NamedTuple):
    """A linear 3-vector equation: sums of what is linear in the unknown, and a constant, vanish.

    The inverse of its matrix is kept in `inverse`, made where `invert` says so.
    """

    title: str
    unknown: Quantity
    sums: tuple[Sum, ...]
    constant: sp.Matrix
    inverse: str
    transposed: bool = False
    invert: bool = False
    weight: sp.Symbol | None = None     # of a node, adding up to one over the nodes of the only sum
    role: Role = Role.PLAIN

    def matrix(self, part: Sum, space: Space) -> sp.Matrix:
        """Matrix of one summand, without the axes that a plane drops."""
        matrix = solve_matrix(self, part)
        return matrix[2:, 2:] if space.planar else matrix

    def known_matrix(self, space: Space) -> sp.Matrix | None:
        """The sum over the nodes, where it is known beforehand: weights add up to one."""
        if self.weight is None:
            return None
        value = (self.matrix(self.sums[0], space) / self.weight).applyfunc(sp.cancel)
        return None if value.free_symbols else value

    def right_side(self, part: Sum, space: Space) -> list[sp.Expr]:
        """The part of one summand in the right-hand side."""
        zero = {s: 0 for s in self.unknown.kept}
        return [-e for e in space.components("axial", part.summand.subs(zero))]


class Invert(NamedTuple):
    """The inverse of the matrix of an equation, for others that have the same."""

    equation: Solve

    @property
    def title(self) -> str:
        """The name of the matrix, by its equation."""
        return "matrix of: " + self.equation.title


class Search(NamedTuple):
    """A call of a search of the runtime that may fail: then its status is the kernel's."""

    title: str
    function: Function
    operands: tuple[Operand, ...]
    operations: int                     # arithmetic, for the operation count
    finds: Quantity | None = None       # the rotation it leaves in the array of the frame


class Call(NamedTuple):
    """A call of a function of the runtime; what it reads and writes the function says."""

    title: str
    function: Function
    operands: tuple[Operand, ...]
    products: int = 0                   # with n x n matrices, for the operation count


class Repeat(NamedTuple):
    """Steps once for each value of an index that their calls and quantities use."""

    title: str
    index: Count
    count: Whole
    steps: tuple


class Values(NamedTuple):
    """Values of a function of the runtime of the square of a vector."""

    title: str
    outputs: tuple[Quantity, ...]
    function: Function
    of: Quantity
    operations: int                     # arithmetic of one evaluation, for the operation count

    @property
    def over(self) -> str:
        """The home of the values: each of its carriers has one."""
        return self.of.home


class Shift(NamedTuple):
    """``to += what`` of whole rows of local coordinates, or ``to -= what``."""

    title: str
    to: Array
    what: Array
    adds: bool = True

    def differential(self) -> "Shift":
        """The same of the differentials."""
        return self._replace(to=self.to.d, what=self.what.d)


class Scaling(NamedTuple):
    """Rows of local coordinates, and quantities of the element, times a factor."""

    title: str
    rows: tuple[Array, ...]
    quantities: tuple[Quantity, ...]
    factor: sp.Symbol


class Damping(NamedTuple):
    """Steps that only layouts with structural damping have."""

    title: str
    steps: tuple


Step = (Stage | Product | Solve | Invert | Search | Call | Repeat | Values | Shift | Scaling
        | Damping)


def call(title: str, function: Function, *operands: Array | View | Whole | int, products: int = 0
         ) -> Call:
    """A call with operands in the order of the function.

    Raises
    ------
    TypeError
        Operands of another number or kind than the function's.
    """
    return Call(title, function, checked(function, operands), products)


def search(title: str, function: Function, *operands: Array | View | Whole | int, operations: int,
           finds: Quantity | None = None) -> Search:
    """A search, likewise."""
    return Search(title, function, checked(function, operands), operations, finds)


def solve_matrix(step: Solve, part: Sum) -> sp.Matrix:
    """Matrix of one summand of a linear equation in its unknown."""
    columns = [part.summand.diff(u) if isinstance(u, sp.Symbol) else sp.zeros(3, 1)
               for u in step.unknown.symbols]
    return sp.Matrix.hstack(*columns)
