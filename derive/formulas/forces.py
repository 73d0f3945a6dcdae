"""Loads, springs and dampers, from their virtual work, energy and dissipation."""

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


def way_spring() -> Element:
    """Spring and damper along a path: ``F = k u + k3 u^3 + c u'``, u the way from that at rest."""
    space = Space(False)
    constants = [*_stiffness(space), constant(space, "length", "scalar", "way at rest")]
    k, k3, c, length = (q.symbols[0] for q in constants)
    own = amplitude(space, "a")
    stretch, rate = own.state.symbols[0] - length, own.rate.symbols[0]
    return element("way_spring", "spring and damper along a path", space, (own,), constants,
                   strain=k * stretch**2 / 2 + k3 * stretch**4 / 4, dissipation=c * rate**2 / 2)


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


ACROSS = "12", "21"                 # axes of couplings: those across a shaft
COUPLED = "11", "12", "21", "22"


def bushing(planar: bool) -> Element:
    """Springs and dampers along and about axes that turn with body a.

    Stretch ``u = E^T R_a^T (x_b - x_a)`` and turn w along the axes E, which have coefficients for
    each axis. With ``Q = R_a^T R_b``, w is the sine of the angle along its axis, from the
    antisymmetric part of Q (in a plane the angle). A bearing lets body b turn freely about the
    direction n: there ``w = n x Q n`` is the tilt of that direction, and n is zero elsewhere.
    """
    return _between_axes(planar, False)


def bearing(planar: bool) -> Element:
    """A bushing whose axes 1 and 2 are coupled: forces ``-k12 u_2 - c12 u_2'`` along 1 and so on.

    Tilts about these axes are coupled to each other and to the forces. The symmetric parts have an
    energy or dissipate, the others are forces that do work, by which journal bearings drive whirls.
    """
    return _between_axes(planar, True)


class Measures(NamedTuple):
    """Stretches and turns between two bodies along axes of the first one, and their rates."""

    blocks: tuple[Block, ...]       # positions, then rotations
    axes: list[Constant]
    free: list[Constant]
    stretch: list[sp.Expr]
    turn: list[sp.Expr]             # of all three axes
    rates: tuple[list[sp.Expr], list[sp.Expr]]
    directions: tuple[list[sp.Expr], list[sp.Expr]]     # the same, of variations


def _between_axes(planar: bool, coupled: bool) -> Element:
    space = Space(planar)
    by = measures(space)
    each = [constant(space, "k", "vector", "stiffness along each axis"),
            constant(space, "c", "vector", "damping along each axis"),
            constant(space, "kt", "axial", "stiffness about each axis"),
            constant(space, "ct", "axial", "damping about each axis")]
    couplings = _couplings(space) if coupled else {}
    u, w, (du, dw), (vu, vw) = by.stretch, by.turn, by.rates, by.directions
    k, c, kt, ct = (q.symbols for q in each)

    def quadratic(coefficients, values):
        return sum(a * value**2 for a, value in zip(coefficients, values, strict=True)) / 2

    strain, stiff = _coupled(couplings, "k", u, w, vu, vw) if coupled else (0, 0)
    dissipation, damped = _coupled(couplings, "c", du, dw, vu, vw) if coupled else (0, 0)
    what = "bearing" if coupled else "bushing"
    return element("planar_" * planar + what, "springs and dampers along and about axes"
                   + ", coupled" * coupled,
                   space, by.blocks, (*each, *couplings.values(), *by.free, *by.axes),
                   strain=quadratic(k, u) + quadratic(kt, w) + strain,
                   dissipation=quadratic(c, du) + quadratic(ct, dw) + dissipation,
                   load=sp.sympify(stiff + damped))


def measures(space: Space) -> Measures:
    """Stretches and turns of a bushing, see `bushing`."""
    planar = space.planar
    own = [constant(space, f"e{k}", "vector", "direction of an axis, in axes of body a")
           for k in range(1, 3 if planar else 4)]
    axes = [*(q.symbols for q in own), *[sp.Matrix([0, 0, 1])] * planar]
    free: list[Constant] = []
    xa, xb = position(space, "a"), position(space, "b")
    ra, rb = rotation(space, "a"), rotation(space, "b")
    Ra = ra.state.symbols
    stretch, Q = Ra.T * (xb.state.symbols - xa.state.symbols), Ra.T * rb.state.symbols
    if planar:
        turn = sp.Matrix([0, 0, rb.angle - ra.angle])
    else:
        free = [constant(space, "n", "vector", "direction about which b turns freely, or zero")]
        n = free[0].symbols
        turn = (1 - n.dot(n)) * sp.Matrix(
            [Q[2, 1] - Q[1, 2], Q[0, 2] - Q[2, 0], Q[1, 0] - Q[0, 1]]) / 2 + cross(n, Q * n)

    def along(what: str) -> tuple[list[sp.Expr], list[sp.Expr]]:
        """Rates or variations of stretch and turn along the axes."""
        dxa, dxb, da, db = (getattr(one, what).symbols for one in (xa, xb, ra, rb))
        du, spin = Ra.T * (dxb - dxa) - cross(da, stretch), Q * db - da
        if not planar:
            spin = (1 - n.dot(n)) * spin + n * n.dot(spin) + cross(n, cross(spin, Q * n))
        return [e.dot(du) for e in axes], [e.dot(spin) for e in axes]

    return Measures((xa, xb, ra, rb), own, free, [e.dot(stretch) for e in axes],
                    [e.dot(turn) for e in axes], along("rate"), along("direction"))


def _couplings(space: Space) -> dict[str, Constant]:
    """Coefficients that couple axes 1 and 2, by name."""
    kinds = {"k": "stiffness", "c": "damping"}
    found = {}
    for key, kind in kinds.items():
        found |= {key + at: f"{kind}: force along axis {at[0]} by way along {at[1]}"
                  for at in ACROSS}
        if space.planar:
            continue
        found |= {f"{key}t{at}": f"{kind}: moment about axis {at[0]} by turn about {at[1]}"
                  for at in ACROSS}
        found |= {f"{key}ut{at}": f"{kind}: force along axis {at[0]} by turn about {at[1]}"
                  for at in COUPLED}
        found |= {f"{key}tu{at}": f"{kind}: moment about axis {at[0]} by way along {at[1]}"
                  for at in COUPLED}
    return {name: constant(space, name, "scalar", meaning) for name, meaning in found.items()}


def _coupled(coupled: dict[str, Constant], key: str, u: list, w: list, vu: list, vw: list
             ) -> tuple[sp.Expr, sp.Expr]:
    """Energy, or half the dissipation, of the symmetric part, and virtual work of the other.

    Of an entry a of the matrix and b opposite to it: ``(a + b) x y / 2`` and
    ``-(a - b) (y dx - x dy) / 2``.
    """
    energy, work = sp.S.Zero, sp.S.Zero

    def add(one: str, opposite: str, x: int, y: int, row: tuple[list, list],
            column: tuple[list, list]) -> None:
        nonlocal energy, work
        a, b = (coupled[key + name].symbols[0] for name in (one, opposite))
        energy += (a + b) * row[0][x] * column[0][y] / 2
        work -= (a - b) * (column[0][y] * row[1][x] - row[0][x] * column[1][y]) / 2
    ways, turns = (u, vu), (w, vw)
    add("12", "21", 0, 1, ways, ways)
    if f"{key}t12" in coupled:
        add("t12", "t21", 0, 1, turns, turns)
        for i in range(2):
            for j in range(2):
                add(f"ut{i + 1}{j + 1}", f"tu{j + 1}{i + 1}", i, j, ways, turns)
    return energy, work
