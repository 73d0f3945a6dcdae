"""Kernels of the motion of bodies: one for each frame, for any layout.

They write what results and warnings read: the place of the frame, its spin and rates, the local
coordinates and theirs. Superelements know most of it, too, but are not compiled for it.
"""

from typing import NamedTuple

from sebody.contract.layout import FRAME_CONSTANTS, MOTION, Part
from sebody.contract.names import motion_name
from sebody.derive.form import counts
from sebody.derive.form.arrays import Array, pointed
from sebody.derive.form.counts import agreed
from sebody.derive.form.kernel import Kernel, Operations
from sebody.derive.form.spaces import Quantity
from sebody.derive.form.statements import For, Let, Point, Return, Set, Statement
from sebody.derive.form.whole import Number, Whole
from sebody.derive.formulas import arrays
from sebody.derive.formulas.frames.frame import FrameOption
from sebody.derive.formulas.motion import motion
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.kernels.arguments import ARGUMENTS
from sebody.derive.kernels.bodies import STATE, gathered, pointers, read_counts
from sebody.derive.kernels.layouts import Layout
from sebody.derive.kernels.memory import Memory, chain, row_size, size_of
from sebody.derive.kernels.options import FRAMES
from sebody.derive.kernels.superelement import opaque_names
from sebody.derive.passes.lower import Lowering, Names
from sebody.derive.passes.operations import operations
from sebody.derive.passes.uses import uses

MOTIONS = {motion_name(name, planar): (name, planar)
           for name, frame in FRAMES.items() for planar in (False, True)
           if frame.traits.planar or not planar}
ROWS = {"y": arrays.y, "y_rate": arrays.eta, "y_second": arrays.etad}       # written in place
VECTORS = {"origin": "x0", "velocity": "v0", "acceleration": "a0", "spin": "Om0",
           "spin_rate": "Om0d"}
SIZE = counts.Count("size")         # of a row


class FrameMotion(NamedTuple):
    """Description of a kernel."""

    name: str
    frame: str
    option: FrameOption
    layout: Layout
    q: Quantities

    @property
    def constants(self) -> tuple[Part, ...]:
        """The row of constants."""
        return FRAME_CONSTANTS + self.option.traits.constants

    @property
    def names(self) -> Names:
        """Opaque functions and the symbols that hold their values."""
        return opaque_names(self.q)


def frame_motion(name: str) -> FrameMotion:
    """Derive the kernel of a name."""
    frame, planar = MOTIONS[name]
    return FrameMotion(name, frame, FRAMES[frame], Layout(None, planar),
                       motion(planar, FRAMES[frame]).q)


def motion_form(kernel: FrameMotion) -> Kernel:
    """The kernel as statements."""
    planar, n = kernel.layout.planar, counts.n
    lowering = Lowering(kernel.q.space, kernel.names)
    program = lowering.statements(motion(planar, kernel.option).steps)
    used = uses(program).arrays
    memory = Memory.of(array for array in (*STATE, *used) if array not in ROWS.values())
    points, size = _places(planar)
    targets = {point.array.name: point.array for point in points}
    of_element = (
        *pointers(arrays.reference in used), *chain(kernel.constants, planar, {}),
        *points, gathered(STATE), *program,
        *(_stored(getattr(kernel.q, name), targets[part]) for part, name in VECTORS.items()),
        For(counts.k, Number(0), Number(9), (
            Set((targets["rotation"][counts.k],), (arrays.frame[counts.k],)),)))
    lengths = Let((counts.row,), (row_size(memory.squares, 0),)), Let((SIZE,), (size,))
    body = (Let((n,), (counts.width,)), *read_counts(kernel.layout), *lengths, *memory.points,
            For(counts.element, Number(0), counts.count, of_element), Return(agreed("OK")))
    nothing = Operations(0, 0, 0, 0)
    return Kernel(kernel.name, body, {}, memory.rows, memory.squares, operations(program), nothing)


def _places(planar: bool) -> tuple[tuple[Point, ...], Whole]:
    """Pointers to the parts of the row that is written, and its length."""
    start, size, statements = ARGUMENTS["forces"].at(counts.element * SIZE), Number(0), []
    for part in MOTION.parts:
        array = ROWS.get(part.name) or pointed(part.name)
        statements.append(Point(array, start))
        start, size = array.at(size_of(part, planar)), size + size_of(part, planar)
    return tuple(statements), size


def _stored(quantity: Quantity, array: Array) -> Statement:
    """Components one after the other."""
    kept = tuple(quantity.kept)
    return Set(tuple(array[k] for k in range(len(kept))), kept)
