"""Contact of a point inside a reduced body with a surface that another node carries.

The point is where the recovery of the body's FE model has it, as points of paths are: with the
frame ``x_0, R_0``, the local coordinates y, the rows Phi_y of the recovery that belong to the
point, and its rows of the followers ``eta_b = y . Q_b y / 2``, ``H = Phi_eta_b Q_b``,

    x = x_0 + R_0 r,                     r = X + Phi_y y + y . H y / 2
    R_0^T x' = x_0' + Om_0 x r + Phi y', Phi = Phi_y + H y      (velocities in axes of the frame)

x_0, R_0 and y are functions of the unknowns. Friction and contact are those of a point of a node,
see `contacts`. A force F on the point acts on what the point moves with, ``f = R_0^T F``:

    F . delta x = f . R_0^T delta x_0 + (r x f) . delta Theta_0 + (Phi^T f) . delta y

so its power is that on the unknowns, and in a rigid motion of body and surface it does no work.
"""

import itertools
from functools import cache, partial
from typing import NamedTuple

import sympy as sp

from sebody.contract.layout import Part
from sebody.derive.form.arrays import Place, constant, scratch
from sebody.derive.form.counts import i3, j3, k
from sebody.derive.form.spaces import AXES, Quantity, Space
from sebody.derive.form.steps import Invert, Product, Solve, Stage, Step
from sebody.derive.formulas import arrays
from sebody.derive.formulas.contacts import contact
from sebody.derive.formulas.damping import rates
from sebody.derive.formulas.elastic import conjugate_to
from sebody.derive.formulas.elements import Element, position
from sebody.derive.formulas.frames.frame import Frame, FrameOption, origin_stage
from sebody.derive.formulas.kinematics import (
    elastic_rotation_variation,
    local_displacement,
    local_velocity,
    unknown_rules,
)
from sebody.derive.formulas.pulled_back import forces_on_coordinates, forces_on_unknowns
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.passes.linearize import Linearizer, along_own
from sebody.derive.symbolic.rotations import cross
from sebody.derive.symbolic.variation import check_same

SHAPES = Part("Phi", ("n", "D"), "displacement of the point by local coordinates, a row each")
POINT = Part("point", ("D",), "the point in the undeformed frame [length]")
SECOND = tuple(Part(f"H{axis}", ("n", "n"), f"second derivatives of the displacement along {axis}",
                    columns=True) for axis in AXES)
BENT = tuple(scratch(f"bent_{axis}") for axis in AXES)      # H y


def second(planar: bool) -> tuple[Part, ...]:
    """Constants of second order."""
    return SECOND[:2] if planar else SECOND


class Steps(NamedTuple):
    """At node level, the same for every layout; the law between them is in components."""

    q: Quantities
    law: Element                    # on the point, as the position a, and on the surface's node
    point: tuple[Step, ...]         # place and velocity of the point
    forces: tuple[Step, ...]        # from the force on the point to those on the unknowns
    prepared: tuple[Step, ...]      # of the matrix, once for all columns
    moved: tuple[Step, ...]         # of a column: what the point does
    turned: tuple[Step, ...]        # and the forces, with that on the point


@cache
def body_contact(planar: bool, frame: FrameOption) -> Steps:
    """Derive the steps in a frame."""
    q = Quantities(Space(planar))
    chosen, law = frame.derive(q), contact("any", planar, False)
    place, velocity = _point(q, chosen)
    after = _forces(q, chosen)
    chain = Linearizer(q.space, unknown_rules(q) | along_own(q.space, q.qm)
                       | along_own(q.space, q.vm))
    moved = _moved(q, chosen, chain, place, velocity)
    chain.move(_force(q))
    turned = tuple(chain.step(step) for step in after)
    inverses = tuple(Invert(step) for step in chosen.velocity if isinstance(step, Solve))
    located = origin_stage(q, q.x0, q.x), *chosen.locate
    return Steps(q, law, (*located, *place, *velocity), after, inverses, moved, turned)


def _force(q: Quantities) -> Quantity:
    """The force on the point."""
    return q.space.quantity("Fp", "vector", "element")


def _products(q: Quantities) -> tuple[Product, ...]:
    """Changes of the shapes as the body deforms."""
    return tuple(Product(f"change of the shapes, {part.name} y", constant(part), arrays.y, bent)
                 for part, bent in zip(second(q.space.planar), BENT, strict=False))


def _bent(q: Quantities, home: str) -> list[list[Quantity]]:
    """These changes for each coordinate of a position, of a rotation or for a mode, by axes."""
    first = {"position": i3, "rotation": j3, "mode": k}[home]
    return [[q.space.quantity(f"{bent.name}_{home}{axis}", "scalar", home, bent, Place(first + c))
             for bent in BENT[:len(second(q.space.planar))]]
            for c, axis in enumerate(_axes(q, home))]


def _axes(q: Quantities, home: str) -> tuple[str, ...]:
    return {"position": AXES[:2] if q.space.planar else AXES,
            "rotation": AXES[2:] if q.space.planar else AXES, "mode": ("",)}[home]


def _shapes(q: Quantities, home: str, part: sp.Expr = sp.S.One) -> list[sp.Matrix]:
    """Displacement of the point by each coordinate of a position, of a rotation or by a mode.

    With a `part` of its change by the deformation.
    """
    first = {"position": i3, "rotation": j3, "mode": k}[home]
    size = 2 if q.space.planar else 3
    shapes = [q.space.quantity(f"Phi_{home}{axis}", "vector", home, constant(SHAPES),
                               Place(size * (first + c))).symbols
              for c, axis in enumerate(_axes(q, home))]
    return [shape + part * sp.Matrix([*(one.symbols[0] for one in bent), 0][:3])
            for shape, bent in zip(shapes, _bent(q, home), strict=True)]


def _recovered(q: Quantities, result: Quantity, of: dict[str, Quantity], what: str,
               part: sp.Expr = sp.S.One) -> tuple[Stage, ...]:
    """``Phi y``, or of rates, summed over positions, rotations and modes."""
    return tuple(Stage(f"{what} of the point by {home}s", home, adds=((result, sum(
        (shape * one for shape, one in zip(_shapes(q, home, part), quantity.kept, strict=True)),
        sp.zeros(3, 1))),), continues=home != "position") for home, quantity in of.items())


def _point(q: Quantities, frame: Frame) -> tuple[tuple[Step, ...], tuple[Step, ...]]:
    """Place and velocity of the point: of position a of the law."""
    a, X = position(q.space, "a"), q.space.quantity("Xp", "vector", "element", constant(POINT))
    r, w, w_rate = (q.space.quantity(name, "vector", "element") for name in ("rp", "up", "upd"))
    R0, arm = q.R0.symbols, q.space.quantity("rp", "vector", "element").symbols
    place = (local_displacement(q),
             Stage("internal modes", "mode", sets=((q.ym, q.qm.symbols),)),
             *_products(q),
             *_recovered(q, w, {"position": q.u, "rotation": q.psi, "mode": q.ym}, "displacement",
                         sp.S.Half),
             Stage("arm of the point in the frame", "element", sets=((r, X.symbols + w.symbols),)),
             Stage("place of the point", "element",
                   sets=((a.state, q.x0.symbols + R0 * arm),)))
    whole = local_velocity(q)
    velocities = Stage("velocity of the nodes in frame axes", "position", sets=whole.sets[:1],
                       short=whole.short[:1])
    velocity = (velocities, *frame.velocity, *rates(q),
                *_recovered(q, w_rate, {"position": q.eu, "rotation": q.ep, "mode": q.em}, "rate"),
                Stage("velocity of the point", "element", sets=((a.rate, R0 * (
                    q.v0.symbols + cross(q.Om0.symbols, arm) + w_rate.symbols)),)))
    return place, velocity


def _forces(q: Quantities, frame: Frame) -> tuple[Stage | Solve, ...]:
    """From the force on the point to those conjugate to y, to the frame, to the unknowns."""
    f, arm = (q.space.quantity(name, "vector", "element") for name in ("fp", "rp"))
    on_frame = cross(arm.symbols, f.symbols)
    _check_work(q, f, on_frame)
    return (
        Stage("force on the point in frame axes", "element",
              sets=((f, q.R0.symbols.T * _force(q).symbols),)),
        *forces_on_coordinates(q, partial(_shapes, q), f.symbols),
        *forces_on_unknowns(q, frame, f.symbols, Stage(
            "moment of the force on the frame", "element", adds=((q.W, on_frame),),
            continues=True)))


def _check_work(q: Quantities, f: Quantity, on_frame: sp.Matrix) -> None:
    """The moment on the frame is conjugate to its rotation in the motion of the point."""
    arm = q.space.quantity("rp", "vector", "element").symbols
    turned = f.symbols.dot(cross(q.dth0.symbols, arm))
    check_same("moment of the force on the frame", on_frame, conjugate_to(turned, q.dth0.symbols))


def _moved(q: Quantities, frame: Frame, chain: Linearizer, place: tuple[Step, ...],
           velocity: tuple[Step, ...]) -> tuple[Step, ...]:
    """Differentials of place and velocity."""
    d, (displacement, _, *others) = q.space.d, place
    R0, dv = q.R0.symbols, q.dv.symbols
    steps: list[Step] = [
        Stage("directions of positions in frame axes", "position",
              sets=((q.dx, R0.T * q.dx.symbols), (q.dv, R0.T * dv))),
        origin_stage(q, q.dx0, q.dx), *frame.variation, chain.stage(displacement),
        Stage("variation of the elastic rotations, (17)", "rotation",
              sets=((d(q.psi), elastic_rotation_variation(q)),)),
        Stage("differential: internal modes", "mode", sets=((d(q.ym), d(q.qm).symbols),))]
    for quantity in (q.psi, q.ym, q.beta, q.beta0):
        chain.move(quantity)
    for home in ("position", "rotation", "mode"):
        for quantity in itertools.chain(*_bent(q, home)):
            chain.move(quantity)
    return (*steps, *frame.differentials, *(step.differential() for step in _products(q)),
            *(chain.step(step) for step in (*others, *velocity) if step not in _products(q)))
