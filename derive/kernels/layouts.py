"""Layouts: which DOF blocks each boundary node of a superelement keeps (23), (39)."""

import re
from collections.abc import Mapping
from typing import NamedTuple

from sebody.contract.counts import LETTERS, first_mode, first_rotation, layout_name
from sebody.contract.names import ANY, layout_variant
from sebody.contract.traits import FrameTraits, InertiaTraits

PINNED = r"(?:m(\d+)(?:s(\d+)e(\d+))?)?"
PATTERN = re.compile(rf"(planar-)?(?:{ANY}|(?=[ftr])(f\d+)?(t\d+)?(r\d+)?{PINNED})(d)?")
NUMBERS = "no", "one", "two", "three", "four", "five", "six"


class LayoutError(ValueError):
    """A layout name that cannot be read, or a layout no frame can carry."""


class Layout(NamedTuple):
    """Boundary nodes of a superelement and the space it moves in.

    The local coordinates are ordered ``y = (positions, rotations, internal modes)``; a kernel
    therefore depends on the two counts of DOF blocks alone, never on the order of the nodes. The
    number of internal modes is a run-time size, unless a layout pins it: constant sizes are faster.
    With it, a layout may pin the numbers of slaved coordinates and of stress resultants.
    In a general layout the counts of DOF blocks are run-time sizes, too, and None here.
    """

    nodes: tuple[str, ...] | None   # what each boundary node keeps: full, translation or rotation
    planar: bool = False        # motion in a plane: (x, y) and one angle in place of DOF blocks
    modes: int | None = None    # number of internal modes, where it is pinned
    damped: bool = False        # with structural damping: twice the tangent, so only where wanted
    # numbers of slaved coordinates and of stress resultants of second order, where they are pinned
    second_order: tuple[int, int] | None = None

    @classmethod
    def parse(cls, name: str) -> "Layout":
        """Read a name: ``f2``, ``planar-f2``, ``f2t1``, ``f2m4`` (four modes), ``f2d``, ``any``.

        ``f2m4s2e1`` has two slaved coordinates and one stress resultant, as straight beams do.
        """
        match = PATTERN.fullmatch(name)
        if not match:
            raise LayoutError(f"layout {name!r} is unknown: write counts of full, translation-only "
                              "and rotation-only nodes, such as f2, f2t1, f2r1, t8 or planar-f2, "
                              "m with the number of internal modes to pin it, as in f2m4, s and "
                              "e behind it with those of slaved coordinates and stress resultants "
                              "of second order, as in f2m4s2e1 for straight beams, and d for "
                              f"structural damping; or {ANY} for any nodes; or the name of a "
                              "joint, rigid body or load, such as distance")
        nodes = []
        for part, kind in zip(match.groups()[1:4], LETTERS, strict=True):
            nodes += [kind] * int(part[1:]) if part else []
        modes, *second_order = match.group(5, 6, 7)
        layout = cls(tuple(nodes) if any(match.groups()[1:4]) else None, bool(match.group(1)),
                     None if modes is None else int(modes), bool(match.group(8)),
                     None if None in second_order else tuple(map(int, second_order)))
        if layout.positions == 0:
            raise LayoutError(f"layout {name!r} keeps no position: a superelement needs at least "
                              "one node with translations to place its frame")
        return layout

    @property
    def name(self) -> str:
        """Canonical name; the order of the nodes does not enter."""
        nodes = layout_name(self.nodes or (), self.planar) + ANY * (self.nodes is None)
        return layout_variant(nodes, self.modes, self.damped, self.second_order)

    @property
    def positions(self) -> int | None:
        """Number of nodes that keep their position."""
        return None if self.nodes is None else sum(kind != "rotation" for kind in self.nodes)

    @property
    def rotations(self) -> int | None:
        """Number of nodes that keep their rotation."""
        return None if self.nodes is None else sum(kind != "translation" for kind in self.nodes)

    @property
    def rotation_size(self) -> int:
        """Coordinates of one rotation."""
        return 1 if self.planar else 3

    @property
    def first_rotation(self) -> int | None:
        """Index in ``y`` of the first rotation."""
        return None if self.nodes is None else first_rotation(self.positions, self.planar)

    @property
    def first_mode(self) -> int | None:
        """Index in ``y`` of the first internal mode."""
        return None if self.nodes is None else first_mode(self.positions, self.rotations,
                                                          self.planar)


def fits(layout: Layout, frame: FrameTraits) -> bool:
    """Tell if a layout can carry a frame; a general one has nodes enough for any."""
    if layout.nodes is None:
        return frame.planar or not layout.planar
    return ((layout.rotations > 0 or not frame.needs_rotations)
            and layout.positions >= frame.fewest_positions[layout.planar]
            and (frame.planar or not layout.planar))


def check_inertia(layout: Layout, frame: str, inertia: str, frames: Mapping[str, FrameTraits],
                  options: Mapping[str, InertiaTraits]) -> None:
    """Refuse a layout or a frame that an inertia option cannot have.

    A frame that depends on the last step, where rates of the frame are needed.

    Raises
    ------
    LayoutError
        With the frames that the option can have, or with what to leave out of the layout.
    """
    if layout.second_order is not None and not options[inertia].field:
        raise LayoutError(f"layout {layout.name}: bodies with inertia option {inertia!r} have no "
                          "slaved coordinates and stress resultants: leave out s and e with their "
                          "numbers")
    if options[inertia].rates and layout.damped:
        raise LayoutError(f"layout {layout.name}: kernels of inertia option {inertia!r} take "
                          "damped bodies, too: leave out the d")
    if options[inertia].rates and frames[frame].incremental:
        others = " or ".join(repr(name) for name, other in frames.items() if not other.incremental)
        raise LayoutError(f"inertia option {inertia!r} needs the exact rates of a frame that "
                          f"depends on the state alone, which {frame!r} does not: use {others}")


def check_frame(layout: Layout, frame: str, frames: Mapping[str, FrameTraits]) -> None:
    """Refuse a frame that a layout cannot carry.

    Raises
    ------
    LayoutError
        With the frames that it can carry.
    """
    traits = frames[frame]
    able = [name for name, other in frames.items() if fits(layout, other)]
    others = " or ".join(map(repr, able)) or "a layout with more nodes"
    if traits.needs_rotations and layout.rotations == 0:
        raise LayoutError(f"layout {layout.name} keeps no rotation, so the frame {frame!r} has "
                          f"nothing to average: use the frame {others}")
    if not fits(layout, traits._replace(planar=True)):
        spatial, planar = (NUMBERS[count] for count in traits.fewest_positions)
        raise LayoutError(f"layout {layout.name} has too few positions for the frame {frame!r}, "
                          f"which needs {spatial} nodes ({planar} in a plane): use {others}")
    if not fits(layout, traits):
        same = next(name for name in able if frames[name].needs_rotations)
        raise LayoutError(f"in a plane the frame {frame!r} coincides with {same!r}: use that one")
