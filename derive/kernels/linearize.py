"""The matrix of a superelement: the differential of its steps in the direction of each unknown.

First the local coordinates vary, then everything else. Where ``c_geo`` is zero the geometry is
held fixed between the two, which leaves the paper's tangents (31), (48)-(51), (60)-(63).
"""

from functools import cache

import sympy as sp

from sebody.derive.form.steps import Role, Scaling, Stage, Step
from sebody.derive.formulas import arrays
from sebody.derive.formulas.frames.frame import FrameOption, origin_stage
from sebody.derive.formulas.inertia.option import InertiaOption
from sebody.derive.formulas.kinematics import elastic_rotation_variation, unknown_rules
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.kernels.superelement import (
    Superelement,
    kept,
    node_formulas,
)
from sebody.derive.passes.linearize import Linearizer, along_own
from sebody.derive.symbolic.rotations import cross
from sebody.derive.symbolic.variation import check_same, differential


def linearized(kernel: Superelement) -> Superelement:
    """The kernel with the steps of a column of its matrix."""
    tangent = node_tangent(kernel.layout.planar, *kernel.options)
    return kernel._replace(tangent=kept(tangent, kernel.layout))


@cache
def node_tangent(planar: bool, frame: FrameOption, inertia: InertiaOption) -> tuple[Step, ...]:
    """Differentials at node level, the same for every layout."""
    formulas = node_formulas(planar, frame, inertia)
    q, d = formulas.q, formulas.q.space.d
    chain = Linearizer(q.space, unknown_rules(q) | along_own(q.space, q.qm)
                       | along_own(q.space, q.vm) | along_own(q.space, q.am)
                       | formulas.inertia.rules)
    displacement, *velocities = formulas.before
    steps: list[Step] = [
        origin_stage(q, q.dx0, q.dx), *formulas.frame.variation, chain.stage(displacement),
        Stage("variation of the elastic rotations, (17)", "rotation",
              sets=((d(q.psi), elastic_rotation_variation(q)),)),
        Stage("differential: internal modes", "mode", sets=((d(q.ym), d(q.qm).symbols),))]
    for quantity in (q.psi, q.ym, q.beta, q.beta0):
        chain.move(quantity)
    steps += [*formulas.local.held, _geometric_switch(q), *formulas.frame.differentials,
              *formulas.local.column(chain, tuple(velocities))]
    for step in formulas.after:
        steps.append(_in_frame_axes(q, chain, step) if step.role is Role.NODE_FORCE else
                     chain.step(step))
    return tuple(steps)


def _in_frame_axes(q: Quantities, chain: Linearizer, step: Stage) -> Stage:
    """Differential of the force on the nodes, rotated into frame axes: what the matrix holds."""
    R0, h = q.R0.symbols, q.h.symbols
    short = q.space.d(q.h).symbols + cross(q.dth0.symbols, h)
    check_same("force on the nodes in frame axes", short,
               R0.T * differential(step.sets[0][1], chain.rules), [R0])
    return Stage("differential: force on the nodes, left in frame axes", "position",
                 sets=((q.space.d(q.gx), short),))


def _geometric_switch(q: Quantities) -> Scaling:
    """Between the paper's tangents and the consistent one."""
    return Scaling(
        "c_geo = 0 leaves the paper's tangents (31), (60)-(63): geometry held fixed here",
        (arrays.y.d, arrays.qe.d), (q.dth0,), sp.Symbol("c_geo"))
