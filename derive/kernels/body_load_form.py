"""The statements of the kernel of a load on a body, from its steps."""

from sebody.derive.form import counts
from sebody.derive.form.counts import agreed
from sebody.derive.form.kernel import Kernel
from sebody.derive.form.statements import (
    For,
    If,
    Let,
    Point,
    Return,
    Set,
    compared,
)
from sebody.derive.form.whole import Number
from sebody.derive.formulas import arrays
from sebody.derive.kernels.arguments import ARGUMENTS
from sebody.derive.kernels.bodies import (
    DIRECTIONS,
    FACTORS,
    MATRIX,
    STATE,
    columns,
    gathered,
    pointers,
    power_of_forces,
    read_counts,
)
from sebody.derive.kernels.body_load import BodyLoad
from sebody.derive.kernels.memory import Memory, chain, row_size
from sebody.derive.passes.lower import Lowering
from sebody.derive.passes.operations import operations
from sebody.derive.passes.uses import uses


def body_load_form(kernel: BodyLoad) -> Kernel:
    """The kernel as statements; its forces know no accelerations."""
    n, planar, lowering = counts.n, kernel.layout.planar, Lowering(kernel.space, kernel.names)
    residual, prepared, tangent = map(lowering.statements, (
        kernel.residual, kernel.prepared, kernel.tangent))
    used = uses((*residual, *prepared, *tangent)).arrays
    memory = Memory.of((*STATE[:2], *used, DIRECTIONS[0]))
    row = Let((counts.row,), (row_size(memory.squares, 0),))
    matrix = If(compared(counts.task, "==", agreed("TANGENT")), (
        Set((FACTORS[0],), (ARGUMENTS["coefficients"][agreed("C_STIFFNESS")],)),
        Point(MATRIX, ARGUMENTS["matrices"].at(counts.element * n * n)),
        *prepared, columns(planar, DIRECTIONS[:1], tangent)))
    of_element = (
        *pointers(arrays.reference in used), *kernel.behind, *chain(kernel.constants, planar, {}),
        Point(arrays.g, ARGUMENTS["forces"].at(counts.element * n)), gathered(STATE[:2]),
        *residual, If(compared(counts.task, "==", agreed("ENERGY")), power_of_forces()), matrix)
    body = (Let((n,), (counts.width,)), *read_counts(kernel.layout), row, *memory.points,
            For(counts.element, Number(0), counts.count, of_element), Return(agreed("OK")))
    return Kernel(kernel.name, body, {}, memory.rows, memory.squares, operations(residual),
                  operations(tangent))
