"""Kernels of contacts of points inside bodies: one for each frame, for any layout and surface."""

from typing import NamedTuple

from sebody.contract.layout import FRAME_CONSTANTS, Part
from sebody.contract.names import body_contact_kind
from sebody.derive.formulas.body_contact import POINT, SHAPES, Steps, body_contact, second
from sebody.derive.formulas.frames.frame import FrameOption
from sebody.derive.kernels.layouts import Layout
from sebody.derive.kernels.options import FRAMES
from sebody.derive.kernels.superelement import opaque_names
from sebody.derive.passes.lower import Names

# frames that average the increments of a step turn with a body only nearly: forces on the point and
# on the surface would not be in balance
BODY_CONTACTS = {body_contact_kind(name, planar): (name, planar)
                 for name, frame in FRAMES.items() for planar in (False, True)
                 if not frame.traits.incremental and (frame.traits.planar or not planar)}


class BodyContact(NamedTuple):
    """Description of a kernel: what is printed."""

    name: str
    layout: Layout
    frame: str
    option: FrameOption
    names: Names
    steps: Steps

    @property
    def constants(self) -> tuple[Part, ...]:
        """The row of constants without those of the law, which follow."""
        return FRAME_CONSTANTS + self.declared

    @property
    def declared(self) -> tuple[Part, ...]:
        """Constants beyond those of every frame and those of the law."""
        return (*self.option.traits.constants, *second(self.layout.planar), SHAPES, POINT)


def body_contact_kernel(name: str) -> BodyContact:
    """Derive the kernel of a name."""
    frame, planar = BODY_CONTACTS[name]
    steps = body_contact(planar, FRAMES[frame])
    return BodyContact(name, Layout(None, planar), frame, FRAMES[frame], opaque_names(steps.q),
                       steps)
