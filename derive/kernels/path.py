"""Kernels of points on paths of bodies: one for each frame, for any layout."""

from typing import NamedTuple

from sebody.contract.layout import FRAME_CONSTANTS, Part
from sebody.contract.names import path_across_kind, path_kind, path_load_kind, path_turn_kind
from sebody.derive.formulas.frames.frame import FrameOption
from sebody.derive.formulas.path import LOAD, LoadSteps, body_path, path_load
from sebody.derive.formulas.path_across import body_across
from sebody.derive.formulas.path_direction import DIRECTION, body_direction, section_names
from sebody.derive.formulas.path_steps import PATH, Steps
from sebody.derive.formulas.path_turn import HELD, body_turn
from sebody.derive.kernels.body_contact import BODY_CONTACTS
from sebody.derive.kernels.layouts import Layout
from sebody.derive.kernels.options import FRAMES
from sebody.derive.kernels.superelement import opaque_names
from sebody.derive.passes.lower import Names

# of the frames that points inside bodies have: others turn with a body only nearly
PATHS = {path_kind(name, planar): (name, planar) for name, planar in BODY_CONTACTS.values()}

PATH_TURNS = {path_turn_kind(name, planar): (name, planar)
              for name, planar in BODY_CONTACTS.values()}

PATH_ACROSS = {path_across_kind(name): (name, planar)
               for name, planar in BODY_CONTACTS.values() if not planar}

PATH_LOADS = {path_load_kind(name, planar): (name, planar)
              for name, planar in BODY_CONTACTS.values()}


class BodyPath(NamedTuple):
    """Description of a kernel: what is printed."""

    name: str
    layout: Layout
    frame: str
    option: FrameOption
    names: Names
    steps: Steps | LoadSteps

    @property
    def declared(self) -> tuple[Part, ...]:
        """Constants beyond those of every frame."""
        held = HELD if self.layout.planar else DIRECTION
        own = (LOAD,) if self.name in PATH_LOADS else (held,) if self.turns else ()
        return (*self.option.traits.constants, *own, PATH)

    @property
    def turns(self) -> bool:
        """Tell if the kernel is of a node that turns with the path."""
        return self.name in PATH_TURNS

    @property
    def across(self) -> bool:
        """Tell if the kernel is of a point that the path holds in one direction."""
        return self.name in PATH_ACROSS

    @property
    def constants(self) -> tuple[Part, ...]:
        """The row of constants; the path comes last, since its length differs."""
        return FRAME_CONSTANTS + self.declared


def path_kernel(name: str) -> BodyPath:
    """Derive the kernel of a point on a path, or of a node that turns with one, by its name."""
    frame, planar = (PATHS | PATH_TURNS | PATH_ACROSS)[name]
    option = FRAMES[frame]
    if name in PATHS:
        steps = body_path(planar, option)
    elif name in PATH_ACROSS:
        steps = body_across(option)
    else:
        steps = body_turn(option) if planar else body_direction(option)
    names = opaque_names(steps.q)
    if name in PATH_TURNS and not planar:
        names |= section_names(steps.q)
    return BodyPath(name, Layout(None, planar), frame, FRAMES[frame], names, steps)


def path_load_kernel(name: str) -> BodyPath:
    """Derive the kernel of forces that move along a path, by its name."""
    frame, planar = PATH_LOADS[name]
    steps = path_load(planar, FRAMES[frame])
    return BodyPath(name, Layout(None, planar), frame, FRAMES[frame], opaque_names(steps.q), steps)
