"""The statements of a superelement's kernel, from its steps."""

from collections.abc import Iterable

import sympy as sp

from sebody.contract.counts import MARGIN
from sebody.derive.form import counts
from sebody.derive.form.arrays import Array
from sebody.derive.form.counts import agreed
from sebody.derive.form.kernel import Kernel
from sebody.derive.form.spaces import AXES, Quantity
from sebody.derive.form.statements import (
    Change,
    For,
    If,
    Let,
    Point,
    Return,
    Set,
    Statement,
    Update,
    compared,
)
from sebody.derive.form.whole import Number, Truncated, Whole, whole
from sebody.derive.formulas import arrays
from sebody.derive.formulas.inertia.rates import LOST, SQUARES
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.kernels.arguments import ARGUMENTS
from sebody.derive.kernels.bodies import (
    DIRECTIONS,
    MATRIX,
    STATE,
    columns,
    gathered,
    known_counts,
    opaque,
    pointers,
    port,
    read_counts,
)
from sebody.derive.kernels.layouts import Layout
from sebody.derive.kernels.memory import Memory, chain, row_size
from sebody.derive.kernels.superelement import Superelement
from sebody.derive.passes.fold import folded
from sebody.derive.passes.lower import Lowering
from sebody.derive.passes.operations import operations
from sebody.derive.passes.uses import uses

COEFFICIENTS = ("c_mass", "C_MASS"), ("c_damping", "C_DAMPING"), ("c_stiffness", "C_STIFFNESS"), (
    "c_geo", "C_GEO")


def superelement_form(kernel: Superelement) -> Kernel:
    """The kernel as statements."""
    layout, n = kernel.layout, counts.n
    lowering = Lowering(kernel.space, kernel.names, arrows=layout.modes is None)
    residual = lowering.statements(kernel.residual)
    energy = (*_sums(kernel), *lowering.statements(kernel.energy), *_outputs(kernel))
    prepared = lowering.statements(kernel.prepared)
    tangent = lowering.statements(kernel.tangent)
    of_forces, of_matrix = (uses(part).arrays for part in ((*residual, *energy),
                                                           (*prepared, *tangent)))
    memory = Memory.of((*STATE, *of_forces, *DIRECTIONS, *of_matrix))
    always = [p for p in memory.points if p.array in (*STATE, *of_forces)]
    matrix = If(compared(counts.task, "==", agreed("TANGENT")), (
        *_coefficients(), Point(MATRIX, ARGUMENTS["matrices"].at(counts.element * n * n)),
        *([Let((counts.row,), (opaque(counts.row),))] if layout.modes is None else ()),
        *(point for point in memory.points if point not in always), *prepared,
        columns(layout.planar, DIRECTIONS, tangent)))
    constants = chain(kernel.constants, layout.planar, kernel.read)
    of_element = (
        *_sizes(kernel, memory), *always, *pointers(arrays.reference in of_forces), *constants,
        *filled((*residual, *tangent)),
        Point(arrays.g, ARGUMENTS["forces"].at(counts.element * n)), gathered(STATE), *residual,
        If(compared(counts.task, "==", agreed("ENERGY")), energy), matrix)
    body = (Point(arrays.field, ARGUMENTS["coefficients"].at(agreed("FIELD"))),
            *read_counts(layout), For(counts.element, Number(0), counts.count, of_element),
            Return(agreed("OK")))
    body = folded(body, _second_order(layout))
    return Kernel(kernel.name, body, known_of(layout), memory.rows, memory.squares,
                  operations(residual), operations(tangent),
                  sizes_known=layout.second_order is not None)


def known_of(layout: Layout) -> dict[counts.Count, int]:
    """Counts that are constants of a layout's kernels."""
    return {name: value for name, value in known_counts(layout).items() if value is not None}


def _second_order(layout: Layout) -> dict[counts.Count, int]:
    """Numbers of slaved coordinates and of stress resultants, where a layout pins them."""
    if layout.second_order is None:
        return {}
    return dict(zip((counts.slaved, counts.resultants), layout.second_order, strict=True))


def _sizes(kernel: Superelement, memory: Memory) -> tuple[Let, Let]:
    """The number of unknowns and the length of a row of scratch memory, in the loop over elements.

    The compiler does not know that they are the same for all elements, or in a matrix as in forces:
    otherwise it computes a hundred places in scratch memory before every loop.
    """
    layout = kernel.layout
    n = (opaque(counts.width) if layout.modes is None else
         whole(layout.first_mode + layout.modes))
    return Let((counts.n,), (n,)), Let((counts.row,), (row_size(memory.squares, MARGIN),))


def filled(statements: Iterable[Statement]) -> tuple[Let, ...]:
    """Counts of filled rows and columns, for products that leave out zeros."""
    if counts.filled not in uses(statements).counts:
        return ()
    return (Let((counts.filled,), (Truncated(arrays.full[0]),)),)


def _coefficients() -> tuple[Set, ...]:
    """Factors of the derivatives, two in a line."""
    pairs = [(sp.Symbol(name), ARGUMENTS["coefficients"][agreed(place)])
             for name, place in COEFFICIENTS]
    return tuple(Set(*map(tuple, zip(*two, strict=True))) for two in (pairs[:2], pairs[2:]))


def _sums(kernel: Superelement) -> tuple[Statement, ...]:
    """Energies that are sums over the coordinates, where they are; friction of damped layouts."""
    if not kernel.formulas.inertia.kinetic:
        return ()
    i, half = counts.i, sp.Float(0.5)
    kinetic, strain, lost = sp.symbols("kinetic strain lost")
    zero = sp.Float(0.0)

    def product(one: Array, other: Array) -> sp.Expr:
        return one[i] * other[i]

    def loop(*body: Statement) -> For:
        return For(i, Number(0), counts.n, body)
    statements: list[Statement] = [
        Set((kinetic,), (zero,)), Set((strain,), (zero,)),
        loop(Update(kinetic, Change.ADD, half * product(*kernel.formulas.inertia.kinetic)),
             Update(strain, Change.ADD, half * product(arrays.y, arrays.s)))]
    if kernel.layout.damped:
        statements += [
            Set((lost,), (zero,)),
            loop(Update(strain, Change.SUBTRACT, half * product(arrays.y, arrays.friction)),
                 Update(lost, Change.SUBTRACT, product(arrays.eta, arrays.friction))),
            Set((ARGUMENTS["energies"][port()],), (lost,))]
    return tuple(statements)


def _outputs(kernel: Superelement) -> tuple[Statement, ...]:
    """Energies and momenta added to the sums of all elements; the power of a damped body."""
    q, energies = kernel.formulas.q, ARGUMENTS["energies"]
    statements: list[Statement] = [
        Update(energies[place], Change.ADD, symbol) for quantity, first in _totals(q)
        for symbol, place in _places(quantity, agreed(first))]
    if kernel.options[1].traits.rates:      # a body tells whether it is damped
        statements.append(If(compared(counts.damped, ">", 0), (
            Set((energies[port()],), (-SQUARES[LOST],)),)))
    return tuple(statements)


def _totals(q: Quantities) -> tuple[tuple[Quantity, str], ...]:
    return ((q.kinetic, "KINETIC"), (q.strain, "STRAIN"), (q.potential, "POTENTIAL"),
            (q.P, "MOMENTUM"), (q.H, "MOMENT"))


def _places(quantity: Quantity, first: Whole) -> Iterable[tuple[sp.Symbol, Whole]]:
    """Components that are kept, and where each belongs behind a place."""
    return ((symbol, first + k) for k, symbol in enumerate(quantity.symbols[:len(AXES)])
            if isinstance(symbol, sp.Symbol))

