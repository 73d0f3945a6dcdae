"""Loads, springs and dampers, from their virtual work, energy and dissipation."""

import sympy as sp

from sebody.derive.form.spaces import Space
from sebody.derive.formulas.elements import (
    AMPLITUDE,
    Constant,
    Element,
    amplitude,
    constant,
    element,
    kept,
    near_angle,
    position,
    rotation,
)
from sebody.derive.symbolic.rotations import cross


def force(planar: bool, follower: bool) -> Element:
    """Force on a position, along a direction of space or of a body (follower)."""
    space = Space(planar)
    d, x = constant(space, "d", "vector", "force at amplitude one"), position(space, "a")
    blocks, direction = [x], d.symbols
    if follower:
        turn = rotation(space, "a")
        blocks, direction = [x, turn], turn.state.symbols * d.symbols
    name = "planar_" * planar + "follower_" * follower + "force"
    kind = "follower" if follower else "fixed-direction"
    return element(name, f"{kind} force on a position", space,
                   blocks, (d,), load=AMPLITUDE[0] * direction.dot(x.direction.symbols))


def torque(planar: bool, follower: bool) -> Element:
    """Torque on a rotation: ``delta W = m . R dTheta``, or ``m . dTheta`` when it follows."""
    space = Space(planar)
    d, turn = constant(space, "d", "axial", "torque at amplitude one"), rotation(space, "a")
    direction = turn.direction.symbols
    if not follower:
        direction = turn.state.symbols * direction
    name = "planar_" * planar + "follower_" * follower + "torque"
    kind = "follower" if follower else "fixed-direction"
    return element(name, f"{kind} torque on a rotation", space,
                   [turn], (d,), load=AMPLITUDE[0] * d.symbols.dot(direction))


def mode_force() -> Element:
    """Force on an internal mode: work ``f dy``."""
    mode = amplitude(Space(False), "a")
    factor = constant(Space(False), "factor", "scalar", "force at amplitude one")
    return element("mode_force", "force on an internal mode", Space(False), [mode], (factor,),
                   load=AMPLITUDE[0] * factor.symbols[0] * mode.direction.symbols[0])


def _stiffness(space: Space) -> list[Constant]:
    """Coefficients of ``k u + k3 u^3 + c u'``."""
    meanings = {"k": "stiffness", "k3": "cubic stiffness", "c": "damping"}
    return [constant(space, name, "scalar", meaning) for name, meaning in meanings.items()]


def spring(planar: bool) -> Element:
    """Spring and damper between two points: ``F = k u + k3 u^3 + c u'``, u the stretch."""
    space = Space(planar)
    constants = [*_stiffness(space), constant(space, "length", "scalar", "length at rest")]
    k, k3, c, length = (q.symbols[0] for q in constants)
    a, b = position(space, "a"), position(space, "b")
    d, w = b.state.symbols - a.state.symbols, b.rate.symbols - a.rate.symbols
    now = sp.sqrt(d.dot(d))
    stretch, rate = now - length, d.dot(w) / now
    return element("planar_" * planar + "spring", "spring and damper between two points", space,
                   (a, b), constants, strain=k * stretch**2 / 2 + k3 * stretch**4 / 4,
                   dissipation=c * rate**2 / 2)


def torsion_spring(planar: bool) -> Element:
    """Spring and damper about the axis two bodies share: ``M = k u + k3 u^3 + c u'``.

    In space the angle is read from two directions, ``atan2(m_b . R n, n_b . R n)``, with as many
    whole turns as bring it nearest to that of the last accepted step.
    """
    space = Space(planar)
    constants = [*_stiffness(space), constant(space, "rest", "scalar", "angle at rest [rad]")]
    k, k3, c, rest = (q.symbols[0] for q in constants)
    a, b = rotation(space, "a"), rotation(space, "b")
    memory = []
    if planar:
        angle, rate = a.angle - b.angle - rest, a.rate.symbols[2] - b.rate.symbols[2]
        vectors = []
    else:
        vectors = [constant(space, "n", "vector", "direction normal to the axis, body a"),
                   constant(space, "m", "vector", "direction normal to both, body b")]
        n, m = (v.symbols for v in vectors)
        seen = b.state.symbols.T * a.state.symbols * n      # n and m: rest angle off the start
        angle = near_angle(sp.atan2(m.dot(seen), n.dot(seen)), kept("angle"))
        memory = [("angle", angle)]
        e = cross(n, m)
        rate = (a.state.symbols * e).dot(a.state.symbols * a.rate.symbols
                                         - b.state.symbols * b.rate.symbols)
        angle = angle - rest
    return element("planar_" * planar + "torsion_spring", "spring and damper about an axis", space,
                   (a, b), (*constants, *vectors), strain=k * angle**2 / 2 + k3 * angle**4 / 4,
                   dissipation=c * rate**2 / 2, memory=memory)


def bushing(planar: bool) -> Element:
    """Springs and dampers along and about axes that turn with body a.

    Stretch ``u = E^T R_a^T (x_b - x_a)``, turn ``w``: the sine of the angle along its axis, from
    the antisymmetric part of ``R_a^T R_b`` (in a plane the angle), along the axes E, too; each axis
    has its own coefficients.
    """
    space = Space(planar)
    own = [constant(space, f"e{k}", "vector", "direction of an axis, in axes of body a")
           for k in range(1, 3 if planar else 4)]
    constants = [constant(space, "k", "vector", "stiffness along each axis"),
                 constant(space, "c", "vector", "damping along each axis"),
                 constant(space, "kt", "axial", "stiffness about each axis"),
                 constant(space, "ct", "axial", "damping about each axis")]
    k, c, kt, ct = (q.symbols for q in constants)
    axes = [*(q.symbols for q in own), *[sp.Matrix([0, 0, 1])] * planar]
    xa, xb = position(space, "a"), position(space, "b")
    ra, rb = rotation(space, "a"), rotation(space, "b")
    Ra, Rb = ra.state.symbols, rb.state.symbols
    gap, rate = xb.state.symbols - xa.state.symbols, xb.rate.symbols - xa.rate.symbols
    stretch = Ra.T * gap
    speed = Ra.T * rate - cross(ra.rate.symbols, stretch)
    Q = Ra.T * Rb
    turn = (sp.Matrix([0, 0, rb.angle - ra.angle]) if planar else
            sp.Matrix([Q[2, 1] - Q[1, 2], Q[0, 2] - Q[2, 0], Q[1, 0] - Q[0, 1]]) / 2)
    spin = Q * rb.rate.symbols - ra.rate.symbols

    def quadratic(coefficients, vector):
        return sum(a * axis.dot(vector)**2
                   for a, axis in zip(coefficients, axes, strict=True)) / 2
    return element("planar_" * planar + "bushing", "springs and dampers along and about axes",
                   space, (xa, xb, ra, rb), (*constants, *own),
                   strain=quadratic(k, stretch) + quadratic(kt, turn),
                   dissipation=quadratic(c, speed) + quadratic(ct, spin))
