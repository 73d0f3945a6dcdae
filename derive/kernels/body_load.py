"""Kernels of loads on bodies: one for each frame, for any layout."""

from typing import NamedTuple

from sebody.contract.layout import FRAME_CONSTANTS, Part
from sebody.contract.names import body_load_kind
from sebody.derive.form import counts
from sebody.derive.form.spaces import Space
from sebody.derive.form.statements import Let, Point
from sebody.derive.form.steps import Step
from sebody.derive.formulas import arrays
from sebody.derive.formulas.body_load import AMPLITUDES, COLUMNS, LOAD, body_load
from sebody.derive.formulas.frames.frame import FrameOption
from sebody.derive.kernels.arguments import ARGUMENTS
from sebody.derive.kernels.layouts import Layout
from sebody.derive.kernels.options import FRAMES
from sebody.derive.kernels.superelement import opaque_names
from sebody.derive.passes.lower import Names

BODY_LOADS = {body_load_kind(name, planar): (name, planar)
              for name, frame in FRAMES.items() for planar in (False, True)
              if frame.traits.planar or not planar}


class BodyLoad(NamedTuple):
    """Description of a kernel: what is printed."""

    name: str
    layout: Layout
    frame: str
    option: FrameOption
    space: Space
    names: Names
    residual: tuple[Step, ...]
    prepared: tuple[Step, ...]          # of the matrix, once for all columns
    tangent: tuple[Step, ...]           # of one column

    @property
    def constants(self) -> tuple[Part, ...]:
        """The row of constants."""
        return FRAME_CONSTANTS + self.declared

    @property
    def declared(self) -> tuple[Part, ...]:
        """Constants beyond those of every frame."""
        return (*self.option.traits.constants, LOAD, COLUMNS)

    @property
    def behind(self) -> tuple[Let | Point, ...]:
        """The numbers behind the index row: place of the amplitudes of a series, their count."""
        return (Let((counts.series,), (arrays.unknowns[counts.n + 1],)),
                Point(AMPLITUDES, ARGUMENTS["loads"].at(arrays.unknowns[counts.n])))


def body_load_kernel(name: str) -> BodyLoad:
    """Derive the kernel of a name."""
    frame, planar = BODY_LOADS[name]
    steps = body_load(planar, FRAMES[frame])
    return BodyLoad(name, Layout(None, planar), frame, FRAMES[frame], steps.q.space,
                    opaque_names(steps.q), steps.residual, steps.prepared, steps.tangent)
