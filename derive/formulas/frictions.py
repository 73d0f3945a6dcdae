"""Dry friction in joints: about an axis, along one, along and about it, at a ball.

The normal force is a preload, and what multipliers of the joint's equations press: the length of
those that are forces, and that of those that are moments over an arm.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import sympy as sp

from sebody.derive.form.spaces import Space
from sebody.derive.formulas.elements import (
    Block,
    Constant,
    Element,
    amplitude,
    constant,
    kept,
    near_angle,
    position,
    rotation,
)
from sebody.derive.formulas.law_elements import Forces, Measures, law_element
from sebody.derive.formulas.laws import TINY, Bristle, friction, length
from sebody.derive.symbolic.rotations import cross

BRISTLE = {"bristle": "stiffness of the bristles", "bristle_damping": "their damping",
           "coefficient": "coefficient of friction", "static": "the same of break-away",
           "speed": "reference speed of the smooth law, 0 for bristles"}
TAKEN = {"across": "square of the share of the force across the axis in the normal force",
         "along": "likewise of the force along the axis"}
LOADED = {"radius": "lever arm of the friction force; 1 along an axis [length]",
          "preload": "normal force that is always there",
          "per_moment": "one over the arm that turns moments into normal forces [1/length]"}


def bristle_constants(space: Space) -> tuple[list[Constant], Bristle]:
    """Declare the constants of dry friction."""
    constants = [constant(space, name, "scalar", meaning) for name, meaning in BRISTLE.items()]
    return constants, Bristle(*(c.symbols[0] for c in constants))


def friction_turn(planar: bool, read: tuple[int, int]) -> Element:
    """Friction about the axis of a revolute or universal joint, or of a turning drive."""
    space = Space(planar)
    blocks = [rotation(space, "a"), rotation(space, "b")]
    measures = Measures(blocks)
    vectors = [] if planar else turn_vectors(space)
    angle = Angle.of(measures, space, blocks, vectors, "angle")
    pressed, taken = None, []
    if read[0] and not planar:
        taken = [constant(space, name, "scalar", meaning) for name, meaning in TAKEN.items()]
        axis = sp.Matrix(measures.add_all("axis", blocks[1].state.symbols * cross(
            *(v.symbols for v in vectors[1:]))))
        pressed = partial(_pressed, axis, *(c.symbols[0] for c in taken))
    return _joint_friction("turn", "friction about an axis", space, measures, read,
                           [*taken, *vectors], [angle.value - kept("angle")], [angle.rate],
                           [angle.velocity], [("angle", angle.value)], pressed=pressed)


def _pressed(axis: sp.Matrix, across: sp.Symbol, along: sp.Symbol, forces: Sequence[sp.Symbol]
             ) -> sp.Expr:
    """The pressing part of a force in global axes on a bearing: across its axis, along it or both.

    ``sqrt(across |f - a (a . f)|^2 + along (a . f)^2)``
    """
    force = sp.Matrix(forces)
    axial = axis.dot(force)
    radial = force - axis * axial
    return sp.sqrt(across * radial.dot(radial) + along * axial**2 + TINY)


def turn_vectors(space: Space, of: str = "") -> list[Constant]:
    """Vectors from which an angle in space is read."""
    return [constant(space, "d" + of, "vector", "direction normal to the axis, in axes of body a"),
            constant(space, "n" + of, "vector", "where it is at angle zero, in axes of body b"),
            constant(space, "m" + of, "vector", "and at a right angle, in axes of body b")]


class Angle(NamedTuple):
    """Angle of body a against b about an axis they share, turns counted."""

    value: sp.Expr
    rate: sp.Expr           # of symbols of measures
    velocity: sp.Expr       # the same, of the velocities

    @classmethod
    def of(cls, measures: Measures, space: Space, blocks: Sequence[Block],
           vectors: Sequence[Constant], name: str) -> "Angle":
        """In space ``atan2(m . s, n . s)`` with ``s = R_b^T R_a d``, nearest to that kept."""
        a, b = blocks
        if space.planar:
            rate = a.rate.symbols[2] - b.rate.symbols[2]
            return cls(measures.add(name, a.angle - b.angle), measures.add(name + "_rate", rate),
                       rate)
        d, n, m = (v.symbols for v in vectors)
        Q = b.state.symbols.T * a.state.symbols
        seen = sp.Matrix(measures.add_all(name + "_seen", Q * d))
        c, s = n.dot(seen), m.dot(seen)
        turned = Q * cross(a.rate.symbols, d) - cross(b.rate.symbols, seen)
        velocity = (c * m.dot(turned) - s * n.dot(turned)) / (c**2 + s**2)
        along_n, along_m = (measures.add(f"{name}_{word}", v.dot(turned))
                            for word, v in (("along_n", n), ("along_m", m)))
        return cls(near_angle(sp.atan2(s, c), kept(name)),
                   (c * along_m - s * along_n) / (c**2 + s**2), velocity)


def friction_slide(planar: bool, read: tuple[int, int]) -> Element:
    """Friction along the axis of a prismatic joint, slider or sliding drive."""
    space = Space(planar)
    e = constant(space, "e", "vector", "axis, in axes of the first body")
    xa, xb, turn = position(space, "a"), position(space, "b"), rotation(space, "a")
    measures = Measures([xa, xb, turn])
    way = (turn.state.symbols * e.symbols).dot(xb.state.symbols - xa.state.symbols)
    rate = measures.rate(way)
    u, w = measures.add("way", way), measures.add("way_rate", rate)
    return _joint_friction("slide", "friction along an axis", space, measures, read, [e],
                           [u - kept("way")], [w], [rate], [("way", u)])


def friction_way(planar: bool) -> Element:
    """Friction along a path, of what one of its bodies bears.

    The path keeps the tangent ``T = w x_s`` of this body with the share w of it, so of a force lam
    on the point the body bears a normal force whose friction limit, conjugate to the way, is

        mu |T x lam|

    without a division; and a preload has ``mu |T|`` as much.
    """
    space = Space(planar)
    own = amplitude(space, "a")
    measures = Measures([own])
    s, w = measures.add("way", own.state.symbols[0]), measures.add("way_rate", own.rate.symbols[0])
    constants, bristle = bristle_constants(space)
    loaded = [constant(space, name, "scalar", meaning) for name, meaning in (
        ("preload", LOADED["preload"]), ("reads", "1 where the force of the path presses, else 0"))]
    preload, reads = (c.symbols[0] for c in loaded)
    lam, T = (space.quantity(name, "vector", "element") for name in ("lam", "tangent"))
    push = sp.Symbol("pressed")
    across = [x for x in cross(T.symbols, lam.symbols) if x != 0]
    normal = preload * length(T.kept) + reads * length(across)
    slip, rate = sp.symbols("increment slip")
    law = friction([slip], [rate], push, bristle)
    stages = (((push, normal), (slip, s - kept("way")), (rate, w)), *law.stages)
    return law_element(
        "planar_" * planar + "friction_way", "friction along a path", space, measures,
        [*constants, *loaded], stages, Forces((own.rate.symbols[0],), law.forces, law.forces),
        [("way", s), *law.memory, ("normal", normal)], reads=lam.kept, sees=T.kept)


def friction_cylindrical() -> Element:
    """Friction along and about the axis of a cylindrical joint: one vector, way and radius x angle.
    """
    space = Space(False)
    e = constant(space, "e", "vector", "axis, in axes of the first body")
    vectors = turn_vectors(space)
    xa, xb = position(space, "a"), position(space, "b")
    ra, rb = rotation(space, "a"), rotation(space, "b")
    measures = Measures([xa, xb, ra, rb])
    way = (ra.state.symbols * e.symbols).dot(xb.state.symbols - xa.state.symbols)
    way_rate = measures.rate(way)
    angle = Angle.of(measures, space, [ra, rb], vectors, "angle")
    radius = constant(space, "radius", "scalar", LOADED["radius"]).symbols[0]
    u, u_rate = measures.add("way", way), measures.add("way_rate", way_rate)
    return _joint_friction(
        "cylindrical", "friction along and about an axis", space, measures, (2, 2), [e, *vectors],
        [u - kept("way"), radius * (angle.value - kept("angle"))], [u_rate, radius * angle.rate],
        [way_rate, radius * angle.velocity], [("way", u), ("angle", angle.value)], lever=False)


def friction_spherical(read: tuple[int, int]) -> Element:
    """Friction of a ball in its socket: radius x rotation of a against b, in axes of b."""
    space = Space(False)
    ra, rb = rotation(space, "a"), rotation(space, "b")
    measures = Measures([ra, rb])
    Q = rb.state.symbols.T * ra.state.symbols
    spin = Q * ra.rate.symbols - rb.rate.symbols
    turned = Q * ra.increment.symbols - rb.increment.symbols
    turns, spins = measures.add_all("turned", turned), measures.add_all("spin", spin)
    return _joint_friction("spherical", "friction of a ball in its socket", space, measures, read,
                           [], turns, spins, list(spin), [])


def _joint_friction(what: str, summary: str, space: Space, measures: Measures,
                    read: tuple[int, int], own: Sequence[Constant], increments, rates,
                    full_rates, memory, lever: bool = True,
                    pressed: Callable[[Sequence[sp.Symbol]], sp.Expr] | None = None) -> Element:
    """The element of some increments and rates.

    Parameters
    ----------
    read : (int, int)
        Multipliers of the joint that are forces, and that are moments.
    lever : bool
        Whether the force acts at the radius; else measures are lengths already.
    pressed : callable, optional
        What the multipliers that are forces press with; by default their length.
    """
    constants, bristle = bristle_constants(space)
    loaded = [constant(space, name, "scalar", meaning) for name, meaning in LOADED.items()]
    radius, preload, per_moment = (c.symbols[0] for c in loaded)
    forces, moments = sp.symbols(f"force_1:{read[0] + 1}"), sp.symbols(f"moment_1:{read[1] + 1}")
    normal = preload
    if forces:
        normal += length(forces) if pressed is None else pressed(forces)
    if moments:
        normal += per_moment * length(moments)
    push = sp.Symbol("pressed")
    ways, speeds = (sp.symbols([f"{word}_{k + 1}" for k in range(len(rates))])
                    for word in ("increment", "slip"))
    law = friction(ways, speeds, push, bristle)
    stages = (((push, (radius if lever else 1) * normal), *zip(ways, increments, strict=True),
               *zip(speeds, rates, strict=True)), *law.stages)
    name = ("planar_" * space.planar + f"friction_{what}"
            + "".join(f"_{word}{n}" for word, n in zip("fm", read, strict=True) if n))
    return law_element(name, summary, space, measures, [*constants, *loaded, *own], stages,
                       Forces(tuple(full_rates), law.forces, law.forces),
                       [*memory, *law.memory, ("normal", normal)], reads=[*forces, *moments])
