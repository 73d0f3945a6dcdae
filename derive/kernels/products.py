"""Products with the derivatives of the forces of superelements and of loads on bodies.

A gradient of a run needs ``K^T w``, ``C^T w`` and ``M^T w`` for weights w of the forces on the
unknowns, or ``K dq + C dv + M da`` for a motion of these: products with the derivatives by
variations of the unknowns (rotations: material, not through T), their rates and second rates. They
take the price of about one column of the matrix each. Tasks of such a kernel:

=============  ===================================================================================
PREPARE        forces, and all that the products have in common: stays in scratch memory
ALONG          the product with a motion: steps of a column of the matrix
TRANSPOSED     products with weights: the same steps, read backwards
=============  ===================================================================================

In the array ``matrices`` of each element are four rows of n numbers: forces or their weights, then
motions by unknowns, rates and second rates. Positions are in axes of the frame, as in the matrix.
"""

from collections.abc import Iterable, Mapping

import sympy as sp

from sebody.contract.counts import MARGIN, whole_vectors
from sebody.contract.names import element_name, products_name
from sebody.derive.form import counts
from sebody.derive.form.arrays import Array, pointed
from sebody.derive.form.counts import agreed
from sebody.derive.form.kernel import Kernel
from sebody.derive.form.statements import For, If, Let, Point, Return, Set, Statement, compared
from sebody.derive.form.whole import Number, Whole, whole
from sebody.derive.formulas import arrays
from sebody.derive.kernels.arguments import ARGUMENTS
from sebody.derive.kernels.bodies import DIRECTIONS, STATE, gathered, pointers, read_counts
from sebody.derive.kernels.body_load import BodyLoad
from sebody.derive.kernels.layouts import Layout
from sebody.derive.kernels.memory import Memory, chain, row_size
from sebody.derive.kernels.superelement import Superelement
from sebody.derive.kernels.superelement_form import filled, known_of
from sebody.derive.passes.carried import carried
from sebody.derive.passes.lower import Lowering
from sebody.derive.passes.operations import operations
from sebody.derive.passes.reverse import Reversal
from sebody.derive.passes.transposes import bar_array
from sebody.derive.passes.unused import without_unused
from sebody.derive.passes.uses import uses

C_GEO = sp.Symbol("c_geo")
VECTORS, KEPT = pointed("vectors"), pointed("kept")
ROWS = 4        # of `VECTORS`: forces, and one for each of the directions


def products_superelement(kernel: Superelement) -> Kernel:
    """Products of a linearized superelement."""
    layout = kernel.layout
    n = counts.width if layout.modes is None else whole(layout.first_mode + layout.modes)
    before = Lowering(kernel.space, kernel.names, arrows=layout.modes is None)
    return _products(kernel.name, kernel, before, n, layout, MARGIN,
                     dict(kernel.options[1].transposes), kernel.read)


def products_body_load(kernel: BodyLoad) -> Kernel:
    """Products of a load on a body: it depends on the motion alone."""
    before = Lowering(kernel.space, kernel.names)
    return _products(element_name(kernel.name), kernel, before, counts.width, kernel.layout, 0, {},
                     {})


def _products(name: str, kernel: Superelement | BodyLoad, lowering: Lowering, n: Whole,
              layout: Layout, margin: int, transposes: Mapping[Array, Array], read: dict) -> Kernel:
    backwards = Reversal(kernel.space, kernel.tangent, DIRECTIONS, transposes).reversed()
    residual, prepared = map(lowering.statements, (kernel.residual, kernel.prepared))
    common = (*residual, Set((C_GEO,), (sp.Float(1.0),)), *prepared)
    along = (*_filled(DIRECTIONS, 1), *lowering.statements(kernel.tangent),
             *_emptied((arrays.g.d,), 0))
    clear, back = map(lowering.statements, backwards)
    back = (*clear, *_filled((bar_array(arrays.g.d),), 0), *back,
            *_emptied(map(bar_array, DIRECTIONS), 1))
    used = uses((*common, *along, *back)).arrays
    memory = Memory.of((*STATE, *DIRECTIONS, *used))
    keep, bodies, room = carried(common, (along, back), KEPT)
    of_element = without_unused((
        Let((counts.n,), (n,)), Let((counts.row,), (row_size(memory.squares, margin),)),
        Point(KEPT, ARGUMENTS["work"]), *_behind(memory, room),
        *pointers(arrays.reference in used),
        *(kernel.behind if isinstance(kernel, BodyLoad) else ()), *chain(
            kernel.constants, layout.planar, read),
        *filled((*common, *along, *back)),
        Point(arrays.g, ARGUMENTS["forces"].at(counts.element * counts.n)),
        Point(VECTORS, ARGUMENTS["matrices"].at(ROWS * (counts.element * counts.n))),
        If(compared(counts.task, "==", agreed("PREPARE")), (gathered(STATE), *common, *keep)),
        If(compared(counts.task, "==", agreed("ALONG")), (*bodies[0], *along)),
        If(compared(counts.task, "==", agreed("TRANSPOSED")), (*bodies[1], *back))))
    field = Point(arrays.field, ARGUMENTS["coefficients"].at(agreed("FIELD")))
    body = (*([field] if arrays.field in used else ()), *read_counts(layout),
            For(counts.element, Number(0), counts.count, of_element), Return(agreed("OK")))
    return Kernel(products_name(name), body, known_of(layout), memory.rows, memory.squares,
                  operations(common), operations(back), room)


def _behind(memory: Memory, room: int) -> tuple[Point, ...]:
    """Places of scratch arrays, behind the numbers that are kept."""
    first = ARGUMENTS["work"].at(whole_vectors(room))
    return tuple(Point(point.array, first.at(getattr(point.place, "first", Number(0))))
                 for point in memory.points)


def _filled(rows: Iterable[Array], first: int) -> tuple[Statement, ...]:
    """Scratch rows set to given vectors."""
    return tuple(For(counts.i, Number(0), counts.n, (
        Set((row[counts.i],), (VECTORS[k * counts.n + counts.i],)),))
        for k, row in enumerate(rows, first))


def _emptied(rows: Iterable[Array], first: int) -> tuple[Statement, ...]:
    """Vectors set to what scratch rows have."""
    return tuple(For(counts.i, Number(0), counts.n, (
        Set((VECTORS[k * counts.n + counts.i],), (row[counts.i],)),))
        for k, row in enumerate(rows, first))
