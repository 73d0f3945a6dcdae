"""Option C: kinetic energy of the displacement field itself, with slaved load modes.

A and B interpolate the velocity of the body from its boundary nodes. Here it is that of the field,
``v* = v0* + Omega_0 x (X + Phi y + Psi eta) + Phi ydot + Psi etadot``, with the same unknowns:
Ellenbroek and Schilder (2018). The load modes Psi follow the unknowns, ``eta_b = y^T Q_b y / 2``:
second-order displacements on which distributed loads work, with the geometric stiffness of these
loads (Wallrapp and Schwertassek, 1991) projected on them in Q.

Everything is conjugate to y, to the origin and to the rotation of the frame, as elastic forces are.
Gravity is the acceleration of the origin that is not felt. Contractions of constants with
coordinates are products of stacked matrices; the matrix has local tangents, made once, and then
three products a column. The products know coordinates and the frame's motion in axes of the body,
where its constants have the most zeros.

In every frame the local coordinates obey as many linear conditions as the frame has motions, such
as ``sum alpha_j u_j = 0`` and ``sum alpha_j psi_j = 0``: some coordinates determine the others. All
constants are of these alone, and so are the forces, since only motions that obey the conditions do
work.
"""

import sympy as sp

from sebody.contract.traits import InertiaTraits
from sebody.derive.formulas.frames.frame import Frame
from sebody.derive.formulas.inertia import (
    floating_field as field,
    floating_forces,
    floating_tangents,
)
from sebody.derive.formulas.inertia.floating_arrays import PARTS, TRANSPOSES, counts_of_body
from sebody.derive.formulas.inertia.floating_quantities import FloatingQuantities
from sebody.derive.formulas.inertia.option import Inertia, InertiaOption, Local
from sebody.derive.formulas.inertia.rates import frame_motion, on_frame_stage
from sebody.derive.formulas.quantities import Quantities


def option_c(q: Quantities) -> Inertia:
    """The option: no forces of the nodes' own, everything through the local coordinates."""
    none = sp.zeros(3, 1)
    return Inertia((), (), none, none, none, none, none, {}, (), None, floating)


def floating(q: Quantities, frame: Frame) -> Local:
    """Derive the steps in a frame."""
    field.prove()
    f = FloatingQuantities(q)
    return Local(
        motion=frame_motion(q, frame), forces=floating_forces.forces(f),
        share=sp.zeros(3, 1),
        on_frame=on_frame_stage(q, f.turn * f.on_origin.symbols, f.turn * f.on_frame.symbols),
        energy=floating_forces.energy(f), prepared=floating_tangents.prepared(f),
        held=floating_tangents.held(f),
        column=lambda chain, velocities: floating_tangents.column(f, chain, velocities))


INERTIA = InertiaOption(
    InertiaTraits(
        "the displacement field of the body, with slaved load modes (option C)", "c", rank=2,
        cost=1.8, softening=0.0, material=True,
        rates=True, field=True,
        constants=PARTS),
    option_c, "(1)-(4) of derive/formulas/inertia/theory.md", counts_of_body, TRANSPOSES)
