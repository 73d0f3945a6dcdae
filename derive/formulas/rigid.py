"""Rigid bodies and point masses: the case of one node, from their kinetic energy."""

import sympy as sp

from sebody.derive.form.spaces import AXES, Space
from sebody.derive.formulas.elements import Element, constant, element, position, rotation
from sebody.derive.symbolic.rotations import cross


def rigid_body(planar: bool) -> Element:
    """A rigid body on a node anywhere in it: mass, first moment ``m c`` and inertia about the node.

    ``T = m v.v/2 + v . R (Omega x m c) + Omega . J Omega/2``, gravity ``V = -g . (m x + R m c)``.
    """
    space = Space(planar)
    mass = constant(space, "mass", "scalar", "mass")
    first = constant(space, "mc", "vector", "first moment of mass about the node, body axes")
    pairs = ((2, 2),) if planar else ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
    moments = [constant(space, f"J_{AXES[i]}{AXES[j]}", "scalar",
                        "inertia about the node, body axes") for i, j in pairs]
    inertia = sp.zeros(3, 3)
    for (i, j), moment in zip(pairs, moments, strict=True):
        inertia[i, j] = inertia[j, i] = moment.symbols[0]
    x, turn = position(space, "a"), rotation(space, "a")
    v, spin, m = x.rate.symbols, turn.rate.symbols, mass.symbols[0]
    R, mc = turn.state.symbols, first.symbols
    kinetic = (m * v.dot(v) / 2 + v.dot(R * cross(spin, mc)) + spin.dot(inertia * spin) / 2)
    field = space.quantity("field", "vector", "element").symbols
    return element("planar_" * planar + "rigid_body", "rigid body", space, (x, turn),
                   (mass, first, *moments), kinetic=kinetic,
                   potential=-field.dot(m * x.state.symbols + R * mc))


def point_mass(planar: bool) -> Element:
    """A mass without rotation on a position."""
    space = Space(planar)
    mass, x = constant(space, "mass", "scalar", "mass"), position(space, "a")
    v, m = x.rate.symbols, mass.symbols[0]
    field = space.quantity("field", "vector", "element").symbols
    return element("planar_" * planar + "point_mass", "point mass", space, (x,), (mass,),
                   kinetic=m * v.dot(v) / 2, potential=-field.dot(m * x.state.symbols))
