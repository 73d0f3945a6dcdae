"""Contact of a sphere or point with a plane, sphere or cylinder that a body carries.

The place s of the centre is seen from the body: ``s = R_b^T (x_a - x_b)``. The surface gives its
distance and its outward normal n there. The point of contact is at ``s - r n``, where the material
of the sphere has the velocity ``s' - r (Q Om_a - Om_b) x n`` against the body's, ``Q = R_b^T R_a``.
"""

import sympy as sp

from sebody.derive.form.spaces import Space
from sebody.derive.formulas.elements import (
    Element,
    choose,
    constant,
    kept,
    position,
    rotation,
)
from sebody.derive.formulas.frictions import bristle_constants
from sebody.derive.formulas.law_elements import Forces, Measures, law_element
from sebody.derive.formulas.laws import friction, impact
from sebody.derive.formulas.stops import impact_constants
from sebody.derive.symbolic.rotations import cross

CENTRE = sp.Float(1e-10)    # of the radius of what is round: its centre has a normal, too


def _plane(space: Space, s: sp.Matrix) -> tuple[list, sp.Expr, sp.Matrix]:
    n = constant(space, "n", "vector", "outward normal, in axes of body b")
    level = constant(space, "level", "scalar", "its distance from the place of body b [length]")
    return [n, level], n.symbols.dot(s) - level.symbols[0], n.symbols


def _round(space: Space, across: sp.Matrix) -> tuple[list, sp.Expr, sp.Matrix]:
    """Distance and normal of what is round: outside, or inside of a bore."""
    size = constant(space, "size", "scalar", "its radius [length]")
    side = constant(space, "side", "scalar", "1 outside, -1 inside")
    far = sp.sqrt(across.dot(across) + (CENTRE * size.symbols[0])**2)
    sign = side.symbols[0]
    return [size, side], sign * (far - size.symbols[0]), sign * across / far


def _sphere(space: Space, s: sp.Matrix) -> tuple[list, sp.Expr, sp.Matrix]:
    return _round(space, s)


def _cylinder(space: Space, s: sp.Matrix) -> tuple[list, sp.Expr, sp.Matrix]:
    e = constant(space, "e", "vector", "axis of the cylinder, in axes of body b")
    across, gap, normal = _round(space, s - e.symbols * e.symbols.dot(s))
    return [e, *across], gap, normal


def _any(space: Space, s: sp.Matrix) -> tuple[list, sp.Expr, sp.Matrix]:
    """Each of these by constants: a plane where `flat` is 1; a sphere is a cylinder without axis.
    """
    e = constant(space, "e", "vector", "normal of a plane, axis of a cylinder, in axes of body b")
    level = constant(space, "level", "scalar", "distance of a plane from the place of body b "
                     "[length]")
    flat = constant(space, "flat", "scalar", "1 of a plane, else 0")
    across, far, normal = _round(space, s - e.symbols * e.symbols.dot(s))
    near = e.symbols.dot(s) - level.symbols[0]
    which = flat.symbols[0]
    return ([e, level, flat, *across], choose(which, near, far),
            sp.Matrix([choose(which, *pair) if pair != (0, 0) else sp.S.Zero
                       for pair in zip(e.symbols, normal, strict=True)]))


SURFACES = {"plane": _plane, "sphere": _sphere, "cylinder": _cylinder, "any": _any}


def contact(surface: str, planar: bool, turning: bool) -> Element:
    """Contact with friction; `turning` of a sphere, which rolls, else of a point."""
    space = Space(planar)
    xa, xb = position(space, "a"), position(space, "b")
    rb = rotation(space, "b")
    blocks = [xa, xb, *[rotation(space, "a")] * turning, rb]
    measures = Measures(blocks)
    Rb = rb.state.symbols
    s = Rb.T * (xa.state.symbols - xb.state.symbols)
    s_rate = Rb.T * (xa.rate.symbols - xb.rate.symbols) - cross(rb.rate.symbols, s)
    seen = sp.Matrix([*measures.add_all("place", s[:2 if planar else 3]), *[0] * planar])
    shape, gap, normal = SURFACES[surface](space, seen)
    radius = constant(space, "radius", "scalar", "radius of the sphere [length]")
    r = radius.symbols[0]
    constants, bristle = bristle_constants(space)
    own = impact_constants(space)
    names = sp.symbols("normal_1:4")
    n = sp.Matrix(names[:2] + (0,) if planar else names)
    spin, turned = _turning(space, blocks, turning, rb)
    material = s_rate - (r * cross(spin, n) if turning else sp.zeros(3, 1))
    moved = (seen - sp.Matrix([kept(f"place_{k + 1}") for k in range(2 if planar else 3)]
                              + [0] * planar))
    turns = sp.Matrix([*measures.add_all("turned", turned)]) if turning else sp.zeros(3, 1)
    moved = moved - (r * cross(turns, n) if turning else sp.zeros(3, 1))
    rates = sp.Matrix(measures.add_all("rate", list(s_rate)[:2 if planar else 3]) + [0] * planar)
    spins = sp.Matrix(measures.add_all("spin", spin)) if turning else sp.zeros(3, 1)
    slip = rates - (r * cross(spins, n) if turning else sp.zeros(3, 1))
    size = 2 if planar else 3
    across = [[(1 if i == j else 0) - n[i] * n[j] for j in range(size)] for i in range(size)]

    def flat(v):
        return [sum(across[i][j] * v[j] for j in range(size)) for i in range(size)]
    depth, speed = sp.symbols("gap_closed closing")
    hit = impact(depth, speed, *(c.symbols[0] for c in own))
    push = hit.forces[0]
    slips, increments = (sp.symbols(f"{word}_1:{size + 1}") for word in ("slip", "increment"))
    drag = friction(increments, slips, push, bristle, across)
    stages = (tuple(zip(names, normal[:size], strict=False)) + ((depth, r - gap),),
              ((speed, -n.dot(rates)), *zip(slips, flat(slip), strict=True),
               *zip(increments, flat(moved), strict=True)),
              *hit.stages, *drag.stages)
    forces = [-push * n[i] + f for i, f in enumerate(flat(drag.forces))]
    lost = [-(push - hit.elastic) * n[i] + f for i, f in enumerate(flat(drag.forces))]
    memory = [(f"place_{k + 1}", seen[k]) for k in range(size)]
    if planar and turning:
        memory.append(("angle", blocks[2].angle - rb.angle))
    name = f"{'sphere' if turning else 'point'}_on_{surface}"
    return law_element(
        "planar_" * planar + name,
        f"contact of a {'sphere' if turning else 'point'} with a {surface}", space, measures,
        [*own, *constants, radius, *shape], stages,
        Forces(tuple(material[:size]), tuple(forces), tuple(lost)),
        [*memory, *hit.memory, *drag.memory, ("normal", push)], hit.stored)


def _turning(space: Space, blocks, turning: bool, rb) -> tuple[sp.Matrix, sp.Matrix]:
    """Angular velocity of the sphere against the body, in its axes; rotation in the step."""
    if not turning:
        return sp.zeros(3, 1), sp.zeros(3, 1)
    ra = blocks[2]
    if space.planar:
        angle = ra.angle - rb.angle - kept("angle")
        return ra.rate.symbols - rb.rate.symbols, sp.Matrix([0, 0, angle])
    Q = rb.state.symbols.T * ra.state.symbols
    return (Q * ra.rate.symbols - rb.rate.symbols,
            Q * ra.increment.symbols - rb.increment.symbols)
