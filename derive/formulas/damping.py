"""Structural damping: forces ``Upsilon^T Cbar ydot`` from the true rates of the local coordinates.

``u_i`` and ``psi_j`` vary with (17), so do they in time: with velocities in place of variations. A
rigid motion has no such rates, however fast, and is not damped. (The ``ydot`` of the inertia
options is another thing: velocities, not rates of deformation.)
"""

from sebody.derive.form.steps import Damping, Product, Shift, Stage, Step
from sebody.derive.formulas import arrays
from sebody.derive.formulas.frames.frame import origin_stage
from sebody.derive.formulas.kinematics import (
    elastic_rotation_variation,
    in_time,
    local_displacement,
)
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.passes.linearize import Linearizer

FRICTION = Product("damping force, friction = Cbar eta", arrays.C, arrays.eta, arrays.friction)
ADDED = Shift("forces conjugate to y, damping included", arrays.s, arrays.friction)


def damping(q: Quantities) -> Damping:
    """Rates of deformation and the damping forces, added to the elastic ones."""
    return Damping("structural damping", (*rates(q), FRICTION, ADDED))


def linearized_damping(q: Quantities, chain: Linearizer) -> Damping:
    """Their differentials; velocities must have been moved before."""
    steps: list[Step] = [chain.stage(step) for step in rates(q)]
    return Damping("differential: structural damping",
                   (*steps, FRICTION.differential(), ADDED.differential()))


def rates(q: Quantities) -> tuple[Stage, ...]:
    """Rates of the local coordinates: those of the origin, displacements, rotations, modes."""
    velocities = in_time(q)
    return (origin_stage(q, q.v0, q.vs),
            Stage("rates of the elastic displacements", "position",
                  sets=((q.eu, local_displacement(q).short[0].xreplace(velocities)),)),
            Stage("rates of the elastic rotations", "rotation",
                  sets=((q.ep, elastic_rotation_variation(q).xreplace(velocities)),)),
            Stage("rates of the internal modes", "mode", sets=((q.em, q.vm.symbols),)))

