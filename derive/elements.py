"""Joints and loads: small elements written out in components.

A constraint adds ``lambda . phi`` to the Lagrangian: its force is the coefficient of the unknowns'
variation in ``lambda . delta phi``, its tangent the differential of that force (the exact
second-order term), and ``phi`` differentiated twice in time starts the simulation.
"""

from typing import NamedTuple

import sympy as sp

from .elastic import _of
from .rotations import skew
from .stages import Quantity, Space
from .variation import along, check_same, coefficients, differential, turning


class Element(NamedTuple):
    """Description of a joint or a load."""

    name: str
    summary: str
    space: Space
    constants: tuple[Quantity, ...]     # in the order of the constants row
    rotations: tuple[Quantity, ...]     # rotation matrices it reads
    places: tuple[Quantity, ...]        # positions it reads, from its coordinates
    rates: tuple[Quantity, ...]         # velocities of its coordinates, block by block
    accelerations: tuple[Quantity, ...]
    directions: tuple[Quantity, ...]    # variations of its coordinates, block by block
    multipliers: tuple[sp.Symbol, ...]
    residual: tuple[sp.Expr, ...]       # force on the coordinates, then phi
    second: tuple[sp.Expr, ...]         # phi differentiated twice in time
    linear: tuple[sp.Expr, ...]         # differential of the residual, as `directions` vary
    on_multipliers: sp.Matrix           # derivative of the force by the multipliers
    power: sp.Expr | None = None        # rate of work done on the system


def revolute(grounded: bool) -> Element:
    """Revolute joint: two directions of a body stay normal to an axis fixed in another one.

    ``phi_k = (R_a n_k) . (R_b e)``, k = 1, 2; the position is shared, so it needs no constraint.
    To the ground ``R_b = I``. With the normals in body a, the gradient in its material axes does
    not change as it turns about the axis, and one factorization lasts.
    """
    space = Space(False)
    make = space.quantity
    e, n = make("e", "vector", "element"), [make(f"n{k}", "vector", "element") for k in (1, 2)]
    bodies = "a" if grounded else "ab"
    R = [make(f"R{b}", "rotation", "element") for b in bodies]
    rates = [make(f"Om{b}", "axial", "element") for b in bodies]
    accelerations = [make(f"A{b}", "axial", "element") for b in bodies]
    dth = [make(f"dth{b}", "axial", "element") for b in bodies]
    other = sp.eye(3) if grounded else R[1].symbols
    phi = [(R[0].symbols * nk.symbols).dot(other * e.symbols) for nk in n]
    return _constraint("revolute_ground" if grounded else "revolute", (
        "revolute joint to the ground" if grounded else "revolute joint between two bodies")
        + ": two directions stay normal to the axis", space, (e, *n), R, rates, accelerations,
        dth, phi)


def _constraint(name, summary, space, constants, R, rates, accelerations, dth, phi) -> Element:
    lam = sp.symbols(f"lam_1:{len(phi) + 1}")
    vary = _turning_all(R, dth)
    work = sum(force * differential(p, vary) for force, p in zip(lam, phi, strict=True))
    force = sp.Matrix.vstack(*[_of(work, d.symbols) for d in dth])
    linear = [differential(f, vary) for f in force] + [differential(p, vary) for p in phi]
    in_time = _turning_all(R, rates)
    for rate, acceleration in zip(rates, accelerations, strict=True):
        in_time |= along(rate.symbols, acceleration.symbols)
    second = [differential(differential(p, in_time), in_time) for p in phi]
    gradient = force.jacobian(sp.Matrix(lam))
    for k, p in enumerate(phi):
        check_same("constraint force is the gradient", sp.Matrix([differential(p, vary)]),
                   sp.Matrix([gradient[:, k].dot(sp.Matrix.vstack(*[d.symbols for d in dth]))]))
    return Element(name, summary, space, tuple(constants), tuple(R), (), tuple(rates),
                   tuple(accelerations), tuple(dth), lam, (*force, *phi), tuple(second),
                   tuple(linear), gradient)


def _turning_all(R, dth) -> dict:
    rules = {}
    for rotation, d in zip(R, dth, strict=True):
        rules |= turning(rotation.symbols, d.symbols)
    return rules


def spherical(grounded: bool, planar: bool) -> Element:
    """Spherical joint as an explicit constraint: a position stays with another, or where it is.

    Sharing or fixing the position does the same with fewer unknowns; this form is for comparison.
    """
    space = Space(planar)
    points = [space.quantity(f"x{b}", "vector", "element") for b in ("a" if grounded else "ab")]
    ground = space.quantity("c", "vector", "element")
    gap = points[0].symbols - (ground if grounded else points[1]).symbols
    lam = sp.symbols(f"lam_1:{3 if planar else 4}")
    phi = space.components("vector", gap)
    parts = [[space.quantity(f"{kind}{p.name[1:]}", "vector", "element") for p in points]
             for kind in ("v", "a", "dx")]
    vary = {}
    for point, d in zip(points, parts[2], strict=True):
        vary |= along(point.symbols, d.symbols)
    in_time = [along(p.symbols, v.symbols) for p, v in zip(points, parts[0], strict=True)]
    in_time += [along(v.symbols, a.symbols) for v, a in zip(*parts[:2], strict=True)]
    rates = {s: e for rule in in_time for s, e in rule.items()}
    work = sum(f * differential(p, vary) for f, p in zip(lam, phi, strict=True))
    kept = [s for d in parts[2] for s in d.kept]
    force_ = sp.Matrix(coefficients(work, kept))
    name = "planar_" * planar + "spherical" + "_ground" * grounded
    return Element(
        name, "spherical joint as an explicit constraint" + " to the ground" * grounded, space,
        (ground,) if grounded else (), (), tuple(points), *map(tuple, parts), lam,
        (*force_, *phi), tuple(differential(differential(p, rates), rates) for p in phi),
        (*(sp.S.Zero for _ in force_), *(differential(p, vary) for p in phi)),
        force_.jacobian(sp.Matrix(lam)))


def force(planar: bool) -> Element:
    """Dead force on a position: fixed direction in space, amplitude from the load's history."""
    space = Space(planar)
    d, v, dx, a = (space.quantity(name, "vector", "element") for name in ("d", "v", "dx", "a"))
    amplitude = sp.Symbol("amplitude")
    push = space.components("vector", -amplitude * d.symbols)
    return Element("planar_force" if planar else "force", "dead force on a position", space, (d,),
                   (), (), (v,), (a,), (dx,), (), tuple(push), (), tuple(sp.S.Zero for _ in push),
                   sp.zeros(len(push), 0), amplitude * d.symbols.dot(v.symbols))


def torque(planar: bool) -> Element:
    """Dead torque on a rotation: ``delta W = m . R dTheta``, so its material value turns."""
    space = Space(planar)
    d = space.quantity("d", "axial", "element")
    R = space.quantity("Ra", "rotation", "element")
    Om, dth, A = (space.quantity(name, "axial", "element") for name in ("Om", "dth", "A"))
    amplitude = sp.Symbol("amplitude")
    work = amplitude * d.symbols.dot(R.symbols * dth.symbols)
    material = -_of(work, dth.symbols)
    linear = differential(material, turning(R.symbols, dth.symbols))
    check_same("rate of a dead torque in material axes", linear,
               -amplitude * skew(R.symbols.T * d.symbols) * dth.symbols, [R.symbols])
    kept = space.components("axial", material)
    return Element("planar_torque" if planar else "torque", "dead torque on a rotation", space,
                   (d,), () if planar else (R,), (), (Om,), (A,), (dth,), (), tuple(kept), (),
                   tuple(space.components("axial", linear)), sp.zeros(len(kept), 0),
                   amplitude * (R.symbols * Om.symbols).dot(d.symbols))


ELEMENTS = {
    "revolute_ground": lambda: revolute(True),
    "revolute": lambda: revolute(False),
    "spherical_ground": lambda: spherical(True, False),
    "spherical": lambda: spherical(False, False),
    "planar_spherical_ground": lambda: spherical(True, True),
    "planar_spherical": lambda: spherical(False, True),
    "force": lambda: force(False),
    "torque": lambda: torque(False),
    "planar_force": lambda: force(True),
    "planar_torque": lambda: torque(True),
}
