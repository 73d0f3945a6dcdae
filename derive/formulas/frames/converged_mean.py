"""The frame in which the weighted elastic rotations vanish: ``sum alpha_j psi_j = 0``."""

import sympy as sp

from sebody.contract.traits import FrameTraits
from sebody.derive.form.counts import FIRST_ROTATION, ROTATIONS
from sebody.derive.form.functions import CONVERGED_MEAN, PLANAR_MEAN
from sebody.derive.form.spaces import Quantity
from sebody.derive.form.steps import Search, Solve, Sum, search
from sebody.derive.formulas import arrays
from sebody.derive.formulas.elastic import conjugate_to, virtual_work
from sebody.derive.formulas.frames.frame import (
    Condition,
    Frame,
    FrameOption,
    inverse_tangent_values,
    pulled_back,
)
from sebody.derive.formulas.kinematics import elastic_rotation_variation
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.symbolic.rotations import (
    inverse_tangent,
    inverse_tangent_times,
    inverse_tangent_transposed_times,
)
from sebody.derive.symbolic.variation import check_same


def converged_mean(q: Quantities) -> Frame:
    """Derive the frame."""
    alpha, psi = q.alpha_r.symbols[0], q.psi.symbols
    variation = elastic_rotation_variation(q)

    def equation(rate: Quantity, of: Quantity, invert: bool = False) -> sp.Matrix:
        turned = (inverse_tangent(psi) * of.symbols if invert else
                  inverse_tangent_times(psi, of.symbols))
        short = alpha * (inverse_tangent_transposed_times(psi, rate.symbols) - turned)
        swap = dict(zip([*q.dth.symbols, *q.dth0.symbols], [*of.symbols, *rate.symbols],
                        strict=True))
        check_same("variation of the converged mean", short, -alpha * variation.subs(swap))
        return short

    def angular_rate(rate: Quantity, of: Quantity, invert: bool) -> Solve:
        return Solve("B rate = sum alpha_j T^-1(psi_j) rate_j", rate,
                     (Sum("rotation", equation(rate, of, invert)),), sp.zeros(3, 1), "B",
                     invert=invert, weight=alpha)

    wp = q.wp.symbols
    back = alpha * inverse_tangent_transposed_times(psi, wp)
    check_same("moment pulled back by the converged mean",
               back, -conjugate_to(wp.dot(equation(q.dth0, q.dth)), q.dth.symbols))
    return Frame(
        locate=(mean_search(q, 200), *inverse_tangent_values(q, q.psi, (q.e0, q.e1))),
        velocity=(angular_rate(q.Om0, q.Om, True),),
        variation=(angular_rate(q.dth0, q.dth, False),),
        pull=(pulled_back(q, (Sum("rotation", alpha * inverse_tangent_times(psi, wp)),),
                          (Sum("rotation", equation(q.wp, q.dth)),), alpha),),
        work=virtual_work, position=sp.zeros(3, 1), origin=sp.zeros(3, 1), on_psi=alpha * wp,
        conditions=(condition(q),))


def condition(q: Quantities) -> Condition:
    """The condition on the elastic rotations."""
    return Condition(q.psi, -q.alpha_r.symbols[0] * sp.eye(3), (q.alpha_r,))


def mean_search(q: Quantities, operations: int) -> Search:
    """The search for the frame; in a plane the mean of the angles."""
    psi, weights = arrays.y.at(FIRST_ROTATION), arrays.alpha_rs
    title = "rotation of the frame: sum alpha_j psi_j = 0"
    if q.space.planar:
        angles = arrays.qe.at(FIRST_ROTATION)
        return search(title, PLANAR_MEAN, ROTATIONS, weights, angles, arrays.frame, psi,
                      operations=operations, finds=q.R0)
    return search(title, CONVERGED_MEAN, ROTATIONS, arrays.nodes, weights, arrays.R, arrays.frame,
                  psi, operations=operations, finds=q.R0)


FRAME = FrameOption(
    FrameTraits("weighted mean of the node rotations, iterated until it is one"), converged_mean,
    "(14), and derive/formulas/frames/converged_mean.py", condition)
