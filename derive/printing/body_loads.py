"""Files of loads on bodies: steps as those of superelements, in a frame of their own."""

from collections import Counter

import sympy

from sebody.derive.kernels.body_load import BodyLoad
from sebody.derive.kernels.resources import Resources
from sebody.derive.printing import parts, templates
from sebody.derive.printing.expressions import indented
from sebody.derive.printing.imports import import_lines
from sebody.derive.printing.step_printer import StepPrinter
from sebody.derive.printing.superelements import counted, reads, scratch_rows
from sebody.kernels.sources import room_hash


def body_load_text(kernel: BodyLoad, uses: Resources) -> str:
    """The file of a kernel."""
    planar = kernel.space.planar
    printer = StepPrinter(kernel.space, kernel.layout, kernel.names)
    residual = printer.lines(kernel.residual)
    in_residual = counted(printer)
    prepared = printer.lines(kernel.prepared)
    printer.operations = Counter()
    tangent = printer.lines(kernel.tangent)
    return templates.BODY_LOAD.format(
        frame=kernel.frame, frame_summary=kernel.option.traits.summary, planar=planar,
        space="motion in a plane" if planar else "motion in space",
        version=templates.VERSION, sympy=sympy.__version__, room=room_hash("kernels"),
        signature=templates.SIGNATURE,
        imports=import_lines({*templates.BODY_LOAD_NAMES, *uses.calls}),
        constants=parts.table(kernel.declared),
        chain=indented(parts.chain(kernel.constants, planar), 2),
        reference=templates.REFERENCE * ("reference" in uses.pointers),
        work_rows=len(uses.rows), residual_operations=in_residual,
        column_operations=counted(printer),
        rows=indented([*reads(kernel.layout), "row = padded(max(n, 9*N_ROTATIONS))",
                       *scratch_rows(uses)], 1),
        residual=indented(residual, 2), prepared=indented(prepared, 3) + "\n" * bool(prepared),
        seeds=indented(templates.LOAD_SEEDS[planar], 4), tangent=indented(tangent, 4))
