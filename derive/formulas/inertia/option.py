"""Inertia forces by Hamilton's principle from ``T = ydot^T Mbar ydot / 2``, (32)-(63).

``Mbar`` is constant, so ``delta T = p . delta ydot`` with ``p = Mbar ydot``: only the variation of
the velocities that enter T is needed. The part with the rate of a variation is integrated by
parts. Positions are common to all options.
"""

from collections.abc import Callable
from typing import NamedTuple

import sympy as sp

from sebody.contract.traits import InertiaTraits
from sebody.derive.form.arrays import Array
from sebody.derive.form.statements import Let
from sebody.derive.form.steps import Product, Stage, Step
from sebody.derive.formulas import arrays
from sebody.derive.formulas.elastic import conjugate_to
from sebody.derive.formulas.frames.frame import Frame
from sebody.derive.formulas.kinematics import unknown_rules
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.passes.linearize import Linearizer
from sebody.derive.symbolic.rotations import cross
from sebody.derive.symbolic.variation import Rules, along, check_same, differential, rotating

PRODUCTS = (Product("momentum, p = Mbar ydot", arrays.M, arrays.yd, arrays.p),
            Product("inertia force, pd = Mbar yddot", arrays.M, arrays.ydd, arrays.pd))


class Local(NamedTuple):
    """Steps between the local displacements of the nodes and the forces conjugate to them."""

    motion: tuple[Step, ...]        # local velocities and accelerations, that of the frame
    forces: tuple[Step, ...]        # conjugate to y
    share: sp.Matrix                # of a position in the force on the origin, times its weight
    on_frame: Stage                 # forces on the origin and moment on the frame
    energy: tuple[Step, ...]
    prepared: tuple[Step, ...]      # of the matrix, once for all columns
    held: tuple[Step, ...]          # of a column: forces of changed local coordinates
    # the rest of a column, with the differentials of what was local velocities before
    column: Callable[[Linearizer, tuple[Step, ...]], tuple[Step, ...]]


class Inertia(NamedTuple):
    """The parts of an inertia option in a kernel."""

    velocity: tuple[Stage, ...]     # w_j of (36) or (52), and what it needs
    acceleration: tuple[Stage, ...]  # ydd of (46) or (58)
    position: sp.Matrix             # generalized force on R0^T delta x_i
    rotation: sp.Matrix             # on delta Theta_j
    frame_positions: sp.Matrix      # on delta Theta_0, summed over positions
    frame_rotations: sp.Matrix      # summed over rotations
    spin: sp.Matrix                 # conjugate to Omega_j: material angular momentum of the node
    rules: Rules                    # differentials of its own quantities
    products: tuple[Product, ...]   # momenta and inertia forces
    kinetic: tuple[Array, Array] | None     # rows whose product is twice the kinetic energy
    local: Callable[[Quantities, Frame], Local] | None = None   # if not by momenta of the nodes


class InertiaOption(NamedTuple):
    """A choice of inertia forces: what it needs, and its derivation."""

    traits: InertiaTraits
    derive: Callable[[Quantities], Inertia]
    equations: str      # where they stand, as of a frame
    # counts that it reads from its constants, by their array: in a plane or in space
    read: Callable[[bool], dict[Array, tuple[Let, ...]]] = lambda planar: {}
    transposes: tuple[tuple[Array, Array], ...] = ()    # constants stored beside their transpose


def position_part(q: Quantities) -> tuple[Stage, sp.Matrix, sp.Matrix]:
    """Positions: local acceleration and the forces on ``delta x_i`` and ``delta Theta_0``."""
    R0, Om0, p, pd = q.R0.symbols, q.Om0.symbols, q.px.symbols, q.pxd.symbols
    in_time = rotating(R0, Om0) | along(p, pd) | along(q.v.symbols, q.a.symbols)
    frames = [R0]
    short = q.acc.symbols + cross(q.vs.symbols, Om0)
    meaning = dict(zip(q.vs.symbols, R0.T * q.v.symbols, strict=True)) | dict(
        zip(q.acc.symbols, R0.T * q.a.symbols, strict=True))
    meaning.pop(sp.S.Zero, None)
    chain = differential(R0.T * q.v.symbols, in_time)
    check_same("rate of xdot* (46), (58)", short.subs(meaning), chain, frames)
    # delta xdot* = R0^T d(delta x)/dt + xdot* x dTheta0; by parts: -d/dt (R0 p) . delta x
    force = pd + cross(Om0, p)
    check_same("by parts, positions (57)", R0 * force, differential(R0 * p, in_time), frames)
    rules = unknown_rules(q)
    varied = differential(R0.T * q.v.symbols, rules)
    check_same("variation of xdot* (42), (56)",
               (q.dv.symbols + cross(q.vs.symbols, q.dth0.symbols)).subs(meaning), varied, frames)
    on_frame = -conjugate_to(p.dot(cross(q.vs.symbols, q.dth0.symbols)), q.dth0.symbols)
    stage = Stage("local accelerations of the nodes, (46), (58)", "position",
                  sets=((q.vsd, short),))
    return stage, force, on_frame
