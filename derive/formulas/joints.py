"""Joints and drives: equations between positions and rotations of two nodes.

One family of primitives from which the runtime builds joints. The ground is a node that is fixed,
so only the joints that fast scenes use most have a form of their own for it. Normals are fixed in
the first body: its gradient in material axes does not change as it turns, and one factorization
lasts.
"""

import sympy as sp

from sebody.derive.form.spaces import Space
from sebody.derive.formulas.elements import (
    AMPLITUDE,
    Block,
    Constant,
    Element,
    constant,
    element,
    position,
    rotation,
)


def _vector(space: Space, name: str, meaning: str) -> Constant:
    return constant(space, name, "vector", meaning)


def _normals(space: Space, count: int) -> list[Constant]:
    return [_vector(space, f"n{k + 1}", "direction normal to the axis, in axes of the first body")
            for k in range(count)]


def _pair(make, space: Space, grounded: bool) -> list[Block]:
    return [make(space, name) for name in ("a" if grounded else "ab")]


def parallel(grounded: bool) -> Element:
    """Two directions stay normal to an axis: ``phi_k = (R_a n_k) . (R_b e)``, ``R_b = I`` aground.

    With a shared position it is a revolute joint.
    """
    space = Space(False)
    e = _vector(space, "e", "axis, in axes of the second body or the ground")
    n = _normals(space, 2)
    blocks = _pair(rotation, space, grounded)
    axis = e.symbols if grounded else blocks[1].state.symbols * e.symbols
    return element("parallel" + "_ground" * grounded,
                   "two directions stay normal to an axis" + " of the ground" * grounded, space,
                   blocks, (e, *n),
                   constraints=[(blocks[0].state.symbols * nk.symbols).dot(axis) for nk in n])


def perpendicular() -> Element:
    """A direction of each body stay normal to each other: ``phi = (R_a n) . (R_b e)``."""
    space = Space(False)
    e = _vector(space, "e", "direction in axes of the second body")
    n = _vector(space, "n", "direction in axes of the first body")
    a, b = _pair(rotation, space, False)
    return element("perpendicular", "two directions stay normal to each other", space, (a, b),
                   (e, n), constraints=[(a.state.symbols * n.symbols).dot(
                       b.state.symbols * e.symbols)])


def coincident(grounded: bool, planar: bool) -> Element:
    """A position stays with another, or where it is; sharing it takes no equation."""
    space = Space(planar)
    blocks = _pair(position, space, grounded)
    ground = _vector(space, "c", "place of the ground [length]")
    gap = blocks[0].state.symbols - (ground.symbols if grounded else blocks[1].state.symbols)
    return element("planar_" * planar + "coincident" + "_ground" * grounded,
                   "a position stays with " + ("a point" if grounded else "another"), space,
                   blocks, (ground,) if grounded else (),
                   constraints=space.components("vector", gap))


def off_plane(normals: int, planar: bool) -> Element:
    """A point stays on a plane of body a, or a line with two: ``(R_a n_k) . (x_b - x_a) = 0``."""
    space = Space(planar)
    n = _normals(space, normals)
    xa, xb, turn = position(space, "a"), position(space, "b"), rotation(space, "a")
    gap = xb.state.symbols - xa.state.symbols
    return element("planar_" * planar + ("on_plane" if normals == 1 and not planar else "on_line"),
                   "a point stays on a " + ("plane" if normals == 1 and not planar else "line")
                   + " of a body", space, (xa, xb, turn), n,
                   constraints=[(turn.state.symbols * nk.symbols).dot(gap) for nk in n])


def aligned() -> Element:
    """In a plane two bodies keep the angle between them: ``phi = theta_a - theta_b``."""
    space = Space(True)
    a, b = _pair(rotation, space, False)
    return element("planar_aligned", "two bodies turn together", space, (a, b),
                   constraints=[a.angle - b.angle])


def distance(planar: bool) -> Element:
    """Two points keep their distance: ``phi = (d . d - l^2) / (2 l)``, smooth and of length."""
    space = Space(planar)
    length = constant(space, "length", "scalar", "distance [length]")
    a, b = _pair(position, space, False)
    d, l = b.state.symbols - a.state.symbols, length.symbols[0]     # noqa: E741  (as in the text)
    return element("planar_" * planar + "distance", "two points keep their distance", space,
                   (a, b), (length,), constraints=[(d.dot(d) - l**2) / (2 * l)])


def turn_drive(planar: bool) -> Element:
    """The angle of body a against b about the axis they share follows a given motion.

    ``phi = (R_a n) . R_b (cos(angle) m - sin(angle) n)``, with m = e x n: the direction n of body a
    stays normal to where m has rotated; zero also half a turn off, where a run does not get to.
    """
    space = Space(planar)
    a, b = _pair(rotation, space, False)
    angle = AMPLITUDE[0]
    if planar:
        return element("planar_turn_drive", "the angle between two bodies is given", space,
                       (a, b), constraints=[a.angle - b.angle - angle])
    n = _vector(space, "n", "direction normal to the axis, in axes of the first body")
    m = _vector(space, "m", "axis x n")
    target = b.state.symbols * (sp.cos(angle) * m.symbols - sp.sin(angle) * n.symbols)
    return element("turn_drive", "the angle between two bodies about an axis is given", space,
                   (a, b), (n, m), constraints=[(a.state.symbols * n.symbols).dot(target)])


def slide_drive(planar: bool) -> Element:
    """The way of b along an axis of a is given: ``(R_a e) . (x_b - x_a) = s(t) + s_0``."""
    space = Space(planar)
    e = _vector(space, "e", "axis, in axes of the first body")
    start = constant(space, "start", "scalar", "way at the start [length]")
    xa, xb, turn = position(space, "a"), position(space, "b"), rotation(space, "a")
    way = (turn.state.symbols * e.symbols).dot(xb.state.symbols - xa.state.symbols)
    return element("planar_" * planar + "slide_drive", "the way along an axis is given", space,
                   (xa, xb, turn), (e, start),
                   constraints=[way - start.symbols[0] - AMPLITUDE[0]])
