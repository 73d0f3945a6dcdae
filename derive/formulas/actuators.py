"""Actuators: a force or torque along the motion that a joint or two points leave, and rotors.

With the displacement or angle u and the amplitude f of the input the virtual work is
``gain f delta u``. A rotor that turns ``ratio u`` relative to body b, about the axis of the joint,
adds to the kinetic energy of this body, in which it is at rest,

    J (w + ratio u')^2 / 2 - J w^2 / 2

where w is the rate of body b about the axis. Along a way the rotor turns with the motion alone.
"""

from collections.abc import Sequence
from typing import NamedTuple

import sympy as sp

from sebody.derive.form.spaces import Space
from sebody.derive.formulas.elements import (
    AMPLITUDE,
    Block,
    Constant,
    Element,
    amplitude,
    constant,
    element,
    position,
    rotation,
    varied,
)
from sebody.derive.symbolic.variation import differential


class Way(NamedTuple):
    """The coordinate that an actuator moves."""

    blocks: tuple[Block, ...]
    constants: list[Constant]
    moved: sp.Expr          # variation of the displacement or angle, linear in the directions
    carried: sp.Expr        # rate of the body that carries the rotor about the axis, before it


def turn(planar: bool) -> Way:
    """Angle of body a against b about the axis they share, fixed in body a."""
    space = Space(planar)
    a, b = rotation(space, "a"), rotation(space, "b")
    if planar:
        return Way((a, b), [], a.direction.symbols[2] - b.direction.symbols[2], b.rate.symbols[2])
    e = _axis(space)
    axis = a.state.symbols * e.symbols
    return Way((a, b), [e], axis.dot(a.state.symbols * a.direction.symbols
                                     - b.state.symbols * b.direction.symbols),
               axis.dot(b.state.symbols * b.rate.symbols))


def slide(planar: bool) -> Way:
    """Way of the point of body b along an axis fixed in body a."""
    space = Space(planar)
    e = _axis(space)
    xa, xb, Ra = position(space, "a"), position(space, "b"), rotation(space, "a")
    blocks = (xa, xb, Ra)
    way = (Ra.state.symbols * e.symbols).dot(xb.state.symbols - xa.state.symbols)
    return Way(blocks, [e], differential(way, varied(blocks)), sp.S.Zero)


def line(planar: bool) -> Way:
    """Distance of two points."""
    space = Space(planar)
    blocks = position(space, "a"), position(space, "b")
    d = blocks[1].state.symbols - blocks[0].state.symbols
    return Way(blocks, [], differential(sp.sqrt(d.dot(d)), varied(blocks)), sp.S.Zero)


def way(planar: bool) -> Way:
    """Way along a path, which is a coordinate: the same in a plane and in space."""
    own = amplitude(Space(planar), "a")
    return Way((own,), [], own.direction.symbols[0], sp.S.Zero)


WAYS = {"turn": (turn, "about an axis"), "slide": (slide, "along an axis"),
        "line": (line, "between two points"), "way": (way, "along a path")}


def motor(name: str, planar: bool) -> Element:
    """Force or torque along one of the ways."""
    made, where = WAYS[name]
    way, space = made(planar), Space(planar)
    gain = constant(space, "gain", "scalar", "force or torque at amplitude one")
    return element("planar_" * planar + f"{name}_motor", f"force of an actuator {where}", space,
                   way.blocks, (gain, *way.constants),
                   load=gain.symbols[0] * AMPLITUDE[0] * way.moved)


def rotor(name: str, planar: bool) -> Element:
    """Rotor that turns with the motion along one of the ways."""
    made, where = WAYS[name]
    way, space = made(planar), Space(planar)
    own = [constant(space, "inertia", "scalar", "moment of inertia of the rotor"),
           constant(space, "ratio", "scalar", "rate of the rotor by that of the motion")]
    inertia, ratio = (one.symbols[0] for one in own)
    spin = ratio * _rate(way.blocks, way.moved)
    return element("planar_" * planar + f"{name}_rotor", f"rotor of an actuator {where}", space,
                   way.blocks, (*own, *way.constants),
                   kinetic=inertia * (spin * way.carried + spin**2 / 2))


def _rate(blocks: Sequence[Block], moved: sp.Expr) -> sp.Expr:
    """Rate of a displacement from its variation."""
    return moved.xreplace({d: r for block in blocks for d, r in zip(
        block.direction.symbols, block.rate.symbols, strict=True) if isinstance(d, sp.Symbol)})


def _axis(space: Space) -> Constant:
    return constant(space, "e", "vector", "axis, in axes of body a")
