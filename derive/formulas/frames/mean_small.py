"""The paper's mean with its small-increment variation (20), (43)-(44): cheaper forces.

The forces are no gradient of the energy; they differ from those of (19) by terms of second order
in psi where beta_0 = 0. The tangent is the exact differential of these forces.
"""

from sebody.contract.traits import FrameTraits
from sebody.derive.form.steps import Stage
from sebody.derive.formulas.elastic import virtual_work_small
from sebody.derive.formulas.frames.converged_mean import condition
from sebody.derive.formulas.frames.frame import Frame, FrameOption
from sebody.derive.formulas.frames.mean import mean
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.symbolic.rotations import cross


def mean_small(q: Quantities) -> Frame:
    """Derive the frame; its variation, for the tangent, is the true one."""
    alpha, psi, Om, W = (q.alpha_r.symbols[0], q.psi.symbols, q.Om.symbols, q.W.symbols)
    velocity = Stage("rate of the frame, (43)", "rotation",
                     adds=((q.Om0, alpha * (Om + cross(psi, Om) / 2)),))
    return mean(q)._replace(velocity=(velocity,), pull=(), work=virtual_work_small,
                            rotation=alpha * (W - cross(psi, W) / 2))


FRAME = FrameOption(
    FrameTraits("the paper's mean of rotation increments since the last step, varied for small "
                "increments", planar=False, exact=False, incremental=True), mean_small,
    "(14)-(16), (20), (43), (44)", condition)
