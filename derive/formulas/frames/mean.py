"""The paper's frame (14)-(16): ``R0 = R0ref exp(sum alpha_j log(R0ref^T R_j))``."""

import sympy as sp

from sebody.contract.traits import FrameTraits
from sebody.derive.form.counts import FIRST_ROTATION, ROTATIONS
from sebody.derive.form.functions import STUMPFF_2345, WEIGHTED_MEAN
from sebody.derive.form.spaces import Quantity
from sebody.derive.form.steps import Stage, Step, Values, search
from sebody.derive.formulas import arrays
from sebody.derive.formulas.elastic import virtual_work
from sebody.derive.formulas.frames.converged_mean import condition
from sebody.derive.formulas.frames.frame import Frame, FrameOption, inverse_tangent_values
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.symbolic.rotations import (
    cross,
    exp,
    inverse_tangent_times,
    inverse_tangent_transposed_times,
    tangent,
)
from sebody.derive.symbolic.variation import along, check_same, differential


def mean(q: Quantities) -> Frame:
    """Derive the frame, in space; in a plane it is the converged mean."""
    alpha, beta, beta0 = q.alpha_r.symbols[0], q.beta.symbols, q.beta0.symbols
    T0, d = tangent(beta0), q.space.d
    _check_variation(q)

    def angular_rate(rate: Quantity, of: Quantity, part: Quantity) -> tuple[Step, ...]:
        return (Stage("sum alpha_j T^-1(beta_j) rate_j, (18)", "rotation",
                      adds=((part, alpha * inverse_tangent_times(beta, of.symbols)),)),
                Stage("rate of the frame, (19)", "element", sets=((rate, T0 * part.symbols),)))

    search_step = search(
        "rotation of the frame, (15)-(16)", WEIGHTED_MEAN, ROTATIONS, arrays.nodes,
        arrays.alpha_rs, arrays.R, arrays.reference, arrays.frame, arrays.beta.at(FIRST_ROTATION),
        arrays.y.at(FIRST_ROTATION), operations=250, finds=q.R0)
    total = Stage("weighted mean of the rotation increments, (16)", "rotation",
                  adds=((q.beta0, alpha * beta),))
    return Frame(
        locate=(search_step, *inverse_tangent_values(q, q.psi, (q.e0, q.e1)),
                *inverse_tangent_values(q, q.beta, (q.b0, q.b1)), total,
                Values("coefficients of T(beta_0)", (q.c2, q.c3, q.c4, q.c5), STUMPFF_2345,
                       q.beta0, 60)),
        velocity=angular_rate(q.Om0, q.Om, q.mean),
        variation=angular_rate(q.dth0, q.dth, q.space.quantity("mean_dth0", "axial", "element")),
        pull=(Stage("moment on the frame, pulled back to the mean increment", "element",
                    sets=((q.wp, T0.T * q.W.symbols),)),),
        work=virtual_work, position=sp.zeros(3, 1), origin=sp.zeros(3, 1),
        rotation=alpha * inverse_tangent_transposed_times(beta, q.wp.symbols),
        differentials=(
            Stage("variation of the rotation increments, (18)", "rotation",
                  sets=((d(q.beta), inverse_tangent_times(beta, q.dth.symbols)),)),
            Stage("variation of their mean, (18)", "rotation",
                  adds=((d(q.beta0), alpha * inverse_tangent_times(beta, q.dth.symbols)),))))


def _check_variation(q: Quantities) -> None:
    """(15)-(18): ``exp(beta)`` turns with ``T(beta) dbeta``, so ``dTheta_0 = T(beta0) dbeta0``."""
    beta, d = q.beta.symbols, q.space.d(q.beta).symbols
    rotated = exp(beta) * sp.Matrix(3, 3, lambda i, j: 0)
    chain = differential(exp(beta), along(beta, d))
    rate = tangent(beta) * d
    R = exp(beta)
    for k in range(3):
        rotated[:, k] = R * cross(rate, sp.eye(3)[:, k])
    check_same("rotation increment (18)", rotated.reshape(9, 1), chain.reshape(9, 1))


FRAME = FrameOption(
    FrameTraits("the paper's weighted mean of rotation increments since the last step",
                planar=False, incremental=True), mean, "(14)-(16), (18), (19)", condition)
