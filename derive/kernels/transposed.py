"""Transposed products of kernels: a row of weights times the derivatives of the forces.

For weights w of the forces on the unknowns (of positions in axes of the frame, as in the matrix) a
superelement gives ``K^T w``, ``C^T w`` and ``M^T w``: the products with the derivatives of its
forces by variations of the unknowns, their rates and second rates. A joint, body or load gives
``J^T w`` with its iteration matrix. What a gradient of a run needs; no such kernel is shipped yet.

In the array ``matrices`` are the weights, n numbers, and behind them n of each product.
"""

import sympy as sp

from sebody.contract.counts import MARGIN
from sebody.derive.form import counts
from sebody.derive.form.arrays import scratch
from sebody.derive.form.counts import agreed
from sebody.derive.form.kernel import Kernel, Operations
from sebody.derive.form.statements import Change, For, Let, Point, Return, Set, Statement, Update
from sebody.derive.form.whole import Number, whole
from sebody.derive.formulas import arrays
from sebody.derive.formulas.elements import Element
from sebody.derive.kernels.arguments import ARGUMENTS
from sebody.derive.kernels.bodies import DIRECTIONS, MATRIX, STATE, gathered, pointers, read_counts
from sebody.derive.kernels.element_form import (
    C_CONSTRAINT,
    known_counts,
    loads,
    places,
    stored,
    tangent_coefficients,
)
from sebody.derive.kernels.memory import Memory, chain, row_size
from sebody.derive.kernels.superelement import Superelement
from sebody.derive.kernels.superelement_form import filled, known_of
from sebody.derive.passes.lower import Lowering
from sebody.derive.passes.operations import operations
from sebody.derive.passes.reverse import Reversal, transposed_forms
from sebody.derive.passes.transposes import bar_array
from sebody.derive.passes.uses import uses

C_GEO = sp.Symbol("c_geo")


def transposed_superelement(kernel: Superelement) -> Kernel:
    """Forces, then the column of the matrix read backwards, of a linearized superelement."""
    n, i, layout = counts.n, counts.i, kernel.layout
    backwards = Reversal(kernel.space, kernel.tangent, DIRECTIONS,
                         dict(kernel.options[1].transposes)).reversed()
    lowering = Lowering(kernel.space, kernel.names, arrows=layout.modes is None)
    residual, prepared, clear, steps = map(lowering.statements, (
        kernel.residual, kernel.prepared, backwards.clear, backwards.steps))
    program = (
        *residual, Set((C_GEO,), (ARGUMENTS["coefficients"][agreed("C_GEO")],)), *prepared, *clear,
        For(i, Number(0), n, (Set((bar_array(arrays.g.d)[i],), (MATRIX[i],)),)), *steps,
        For(i, Number(0), n, tuple(Set((MATRIX[(k + 1) * n + i],), (bar_array(row)[i],))
                                   for k, row in enumerate(DIRECTIONS))))
    used = uses(program).arrays
    memory = Memory.of((*STATE, *used))
    size = counts.width if layout.modes is None else whole(layout.first_mode + layout.modes)
    of_element = (
        Let((n,), (size,)), Let((counts.row,), (row_size(memory.squares, MARGIN),)),
        *memory.points, *pointers(arrays.reference in used),
        *chain(kernel.constants, layout.planar, kernel.read), *filled(program),
        Point(arrays.g, ARGUMENTS["forces"].at(counts.element * n)),
        Point(MATRIX, ARGUMENTS["matrices"].at(4 * (counts.element * n))), gathered(STATE),
        *program)
    body = (Point(arrays.field, ARGUMENTS["coefficients"].at(agreed("FIELD"))),
            *read_counts(layout), For(counts.element, Number(0), counts.count, of_element),
            Return(agreed("OK")))
    return Kernel("transposed_" + kernel.name, body, known_of(layout), memory.rows,
                  memory.squares, operations(residual), operations(steps))


def transposed_element(element: Element) -> Kernel:
    """``J^T w`` of a linearized joint, body or load."""
    width, coordinates = len(element.residual), element.coordinates
    weights = sp.symbols(f"w_:{width}")
    directions, units = ([s for block in element.blocks for s in getattr(block, of).kept]
                         for of in ("direction", "unit"))
    found = transposed_forms(element.linear, weights, [*directions, *units])
    of_multipliers = [C_CONSTRAINT * sum(w * element.on_multipliers[i, k] for i, w in enumerate(
        weights[:coordinates])) for k in range(len(element.multipliers))]
    given, turned = scratch("bdq"), _through_tangent(element)
    program, _ = stored(
        [*(found.get(s, sp.S.Zero) for s in directions), *(found.get(s, sp.S.Zero) for s in units),
         *of_multipliers],
        [*(given[k] for k in range(coordinates)), *(MATRIX[width + k] for k in range(width))], 0)
    of_element = (
        *places(element), *loads(element), *tangent_coefficients(element),
        Point(given, ARGUMENTS["work"]),
        Point(MATRIX, ARGUMENTS["matrices"].at(2 * (counts.element * counts.WIDTH))),
        *(Set((w,), (MATRIX[k],)) for k, w in enumerate(weights)), *program, *turned)
    body = (For(counts.element, Number(0), counts.count, of_element), Return(agreed("OK")))
    return Kernel("transposed_" + element.name, body, known_counts(element), 1, 0,
                  Operations(0, 0, 0, 0), operations(tuple(program)))


def _through_tangent(element: Element) -> tuple[Statement, ...]:
    """Bars of the variations added to those of the unknowns: of rotations in space by ``T^T``."""
    known, i, j, r, k = known_counts(element), counts.i, counts.j, counts.r, counts.k
    first, given, width = known[counts.FIRST_ROTATION], scratch("bdq"), len(element.residual)
    positions = first if known[counts.ROTATIONS] else element.coordinates
    plain = For(i, Number(0), whole(positions), (
        Update(MATRIX[width + i], Change.ADD, given[i]),))
    entry = ARGUMENTS["T"][9 * arrays.nodes[j] + 3 * r + k] * given[first + 3 * j + r]
    turned = For(j, Number(0), counts.ROTATIONS, (For(r, Number(0), Number(3), (
        For(k, Number(0), Number(3), (
            Update(MATRIX[(width + first) + 3 * j + k], Change.ADD, entry),)),)),))
    return (plain, turned) if known[counts.ROTATIONS] else (plain,)
