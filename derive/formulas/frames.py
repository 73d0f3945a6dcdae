"""Floating frames: where the frame is, how it varies, and what it returns to the unknowns.

Each frame is a condition on the nodes. Its variation is the differential of that condition, and
the force on an unknown is the moment ``W`` on the frame pulled back through the same variation.
"""

from collections.abc import Callable
from typing import NamedTuple

import sympy as sp

from sebody.derive.formulas.elastic import _of
from sebody.derive.formulas.kinematics import elastic_rotation_variation
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.symbolic.rotations import (
    exp,
    inverse_tangent_times,
    inverse_tangent_transposed_times,
    tangent,
)
from sebody.derive.symbolic.spaces import Quantity
from sebody.derive.symbolic.steps import Solve, Stage, Step, Text, cross
from sebody.derive.symbolic.variation import along, check_same, differential, turning
from sebody.kernels.layout import FrameTraits


class Frame(NamedTuple):
    """A choice of floating frame, for one space."""

    name: str
    traits: FrameTraits
    locate: tuple[Step, ...]
    rate: Callable[[Quantity, Quantity, bool], tuple[Step, ...]]  # (angular rate, of what, first)
    pull: tuple[Step, ...]              # W -> wp
    position: sp.Matrix                 # force of wp on R0^T delta x_i
    origin: sp.Matrix                   # force of wp on R0^T delta x_0, summed over positions
    rotation: sp.Matrix                 # force of wp on delta Theta_j
    differentials: tuple[Stage, ...] = ()   # of what `locate` computes, once dth0 is known
    small: bool = False                 # elastic rotations vary by (20) in place of (19)


TRAITS = {
    "converged_mean": FrameTraits("weighted mean of the node rotations, iterated until it is one"),
    "mean": FrameTraits("the paper's weighted mean of rotation increments since the last step",
                        planar=False, incremental=True),
    "mean_small": FrameTraits("the paper's mean of rotation increments since the last step, varied "
                              "for small increments", planar=False, exact=False,
                              incremental=True),
    "positions": FrameTraits("rotation of best fit of the node positions", needs_rotations=False,
                             fewest_positions=(3, 2)),
}


def origin_stage(q: Quantities, result: Quantity, of: Quantity) -> Stage:
    """Weighted mean (14), (18) of positions, or of their variations or velocities."""
    return Stage("origin of the frame, (14)", "position",
                 adds=((result, q.alpha.symbols[0] * of.symbols),))


def frame_axes(planar: bool) -> tuple[str, ...]:
    """Kernel text: entries of the frame's rotation into local variables."""
    if planar:
        return ("R0_cos, R0_sin = frame[0], frame[3]",)
    return ("R0_xx, R0_xy, R0_xz = frame[0], frame[1], frame[2]",
            "R0_yx, R0_yy, R0_yz = frame[3], frame[4], frame[5]",
            "R0_zx, R0_zy, R0_zz = frame[6], frame[7], frame[8]")


def inverse_tangent_values(q: Quantities, of: Quantity, names: tuple[str, str]) -> tuple[Step, ...]:
    """Coefficients of ``T^-1`` and their derivatives, once per node; none in a plane."""
    if q.space.planar:
        return ()
    x, y, z = (f"{of.array}[j3 + {k}]" if k else f"{of.array}[j3]" for k in range(3))
    line = (f"{names[0]}s[j], {names[1]}s[j] = inverse_tangent_coefficients("
            f"{x} * {x} + {y} * {y} + {z} * {z})")
    return (Text("coefficients of T^-1", (line,), ("inverse_tangent_coefficients",), "rotation",
                 30),)


def relative_rotation(q: Quantities) -> Stage:
    """The rotation of a node in the frame, as a function of its rotation vector."""
    return Stage("rotation of the node in the frame", "rotation",
                 sets=((q.Q, q.R0.symbols.T * q.R.symbols),))


def converged_mean(q: Quantities) -> Frame:
    """The frame in which the weighted elastic rotations vanish: ``sum alpha_j psi_j = 0``."""
    alpha, psi = q.alpha_r.symbols[0], q.psi.symbols
    variation = elastic_rotation_variation(q)

    def equation(rate: Quantity, of: Quantity) -> sp.Matrix:
        short = alpha * (inverse_tangent_transposed_times(psi, rate.symbols)
                         - inverse_tangent_times(psi, of.symbols))
        swap = dict(zip([*q.dth.symbols, *q.dth0.symbols], [*of.symbols, *rate.symbols],
                        strict=True))
        check_same("variation of the converged mean", short, -alpha * variation.subs(swap))
        return short

    def angular_rate(rate: Quantity, of: Quantity, first: bool) -> tuple[Step, ...]:
        return (Solve("B rate = sum alpha_j T^-1(psi_j) rate_j", rate, "rotation",
                      equation(rate, of), sp.zeros(3, 1), "B", invert=first),)

    call = ("planar_mean(N_ROTATIONS, alpha_rs, at(qe, ROTATIONS), frame, at(y, ROTATIONS))"
            if q.space.planar else
            "converged_mean(N_ROTATIONS, nodes, alpha_rs, R, frame, at(y, ROTATIONS))")
    lines = (f"status = {call}", "if status != 0:", "    return status")
    wp, wp_rate = q.wp.symbols, q.wp
    back = alpha * inverse_tangent_transposed_times(psi, wp)
    check_same("moment pulled back by the converged mean",
               back, -_of(wp.dot(equation(q.dth0, q.dth)), q.dth.symbols))
    return Frame(
        "converged_mean", TRAITS["converged_mean"],
        (Text("rotation of the frame: sum alpha_j psi_j = 0", lines,
              (call.split("(")[0],), operations=200),
         *inverse_tangent_values(q, q.psi, ("e0", "e1"))),
        angular_rate,
        (_pull_back(q, alpha * inverse_tangent_times(psi, wp), equation(wp_rate, q.dth),
                    "rotation"),),
        sp.zeros(3, 1), sp.zeros(3, 1), back)


def _pull_back(q: Quantities, short: sp.Matrix, equation: sp.Matrix, over: str) -> Solve:
    """``B^T wp = W`` where ``B`` is the matrix of the frame's equation in its rate."""
    unknown = q.wp.symbols
    matrix = sp.Matrix.hstack(*[equation.diff(u) if isinstance(u, sp.Symbol) else sp.zeros(3, 1)
                                for u in unknown])
    check_same("transposed equation of the frame", short, matrix.T * unknown)
    return Solve("B^T wp = W", q.wp, over, short, -q.W.symbols, "B", transposed=True)


def mean(q: Quantities) -> Frame:
    """The paper's frame (14)-(16): ``R0 = R0ref exp(sum alpha_j log(R0ref^T R_j))``."""
    alpha, beta, beta0 = q.alpha_r.symbols[0], q.beta.symbols, q.beta0.symbols
    T0 = tangent(beta0)
    _check_mean_variation(q)
    total = Stage("weighted mean of the rotation increments, (16)", "rotation",
                  adds=((q.beta0, alpha * beta),))

    def angular_rate(rate: Quantity, of: Quantity, first: bool) -> tuple[Step, ...]:
        part = q.mean if first else q.space.quantity(f"mean_{rate.name}", "axial", "element")
        return (Stage("sum alpha_j T^-1(beta_j) rate_j, (18)", "rotation",
                      adds=((part, alpha * inverse_tangent_times(beta, of.symbols)),)),
                Stage("rate of the frame, (19)", "element", sets=((rate, T0 * part.symbols),)))

    reference = "" if q.space.planar else ", reference"
    call = ("planar_mean(N_ROTATIONS, alpha_rs, at(qe, ROTATIONS), frame, at(y, ROTATIONS))"
            if q.space.planar else "weighted_mean(N_ROTATIONS, nodes, alpha_rs, R"
            f"{reference}, frame, at(beta, ROTATIONS), at(y, ROTATIONS))")
    lines = (f"status = {call}", "if status != 0:", "    return status")
    values = () if q.space.planar else (
        Text("coefficients of T(beta_0)", (
            "c2, c3, c4, c5 = stumpff_2345(beta0_x * beta0_x + beta0_y * beta0_y"
            " + beta0_z * beta0_z)",), ("stumpff_2345",), operations=60),)
    d = q.space.d
    return Frame(
        "mean", TRAITS["mean"],
        (Text("rotation of the frame, (15)-(16)", lines, (call.split("(")[0],), operations=250),
         *inverse_tangent_values(q, q.psi, ("e0", "e1")),
         *inverse_tangent_values(q, q.beta, ("b0", "b1")), total, *values),
        angular_rate,
        (Stage("moment on the frame, pulled back to the mean increment", "element",
               sets=((q.wp, T0.T * q.W.symbols),)),),
        sp.zeros(3, 1), sp.zeros(3, 1),
        alpha * inverse_tangent_transposed_times(beta, q.wp.symbols),
        (Stage("variation of the rotation increments, (18)", "rotation",
               sets=((d(q.beta), inverse_tangent_times(beta, q.dth.symbols)),)),
         Stage("variation of their mean, (18)", "rotation",
               adds=((d(q.beta0), alpha * inverse_tangent_times(beta, q.dth.symbols)),))))


def mean_small(q: Quantities) -> Frame:
    """The paper's mean with its small-increment variation (20), (43)-(44): cheaper forces.

    The forces are no gradient of the energy; they differ from those of (19) by terms of second
    order in psi where beta_0 = 0. The tangent is the exact differential of these forces.
    """
    exact, alpha, psi = mean(q), q.alpha_r.symbols[0], q.psi.symbols

    def angular_rate(rate: Quantity, of: Quantity, first: bool) -> tuple[Step, ...]:
        if not first:       # a true variation of the frame, for the tangent
            return exact.rate(rate, of, first)
        return (Stage("rate of the frame, (43)", "rotation", adds=(
            (rate, alpha * (of.symbols + cross(psi, of.symbols) / 2)),)),)

    W = q.W.symbols
    return exact._replace(
        name="mean_small", traits=TRAITS["mean_small"],
        rate=angular_rate, pull=(), rotation=alpha * (W - cross(psi, W) / 2), small=True)


def _check_mean_variation(q: Quantities) -> None:
    """(15)-(18): ``exp(beta)`` turns with ``T(beta) dbeta``, so ``dTheta_0 = T(beta0) dbeta0``."""
    beta, d = q.beta.symbols, q.space.d(q.beta).symbols
    turned = exp(beta) * sp.Matrix(3, 3, lambda i, j: 0)
    chain = differential(exp(beta), along(beta, d))
    rate = tangent(beta) * d
    R = exp(beta)
    for k in range(3):
        turned[:, k] = R * cross(rate, sp.eye(3)[:, k])
    check_same("rotation increment (18)", turned.reshape(9, 1), chain.reshape(9, 1))


def positions(q: Quantities) -> Frame:
    """The rotation of best fit of the node positions: ``sum w_j X_j x R0^T (x_j - x0) = 0``."""
    fit, X, u = q.fit.symbols[0], q.X.symbols, q.u.symbols
    r = X + u

    def equation(rate: Quantity, of: Quantity, origin: Quantity) -> sp.Matrix:
        short = fit * cross(X, of.symbols - origin.symbols + cross(r, rate.symbols))
        swap = dict(zip([*q.dx.symbols, *q.dx0.symbols, *q.dth0.symbols],
                        [*of.symbols, *origin.symbols, *rate.symbols], strict=True))
        swap.pop(sp.S.Zero, None)
        R0 = q.R0.symbols
        condition = fit * cross(X, R0.T * (q.x.symbols - q.x0.symbols))
        rules = turning(R0, q.dth0.symbols)
        for fixed_axes, local in ((q.x, q.dx), (q.x0, q.dx0)):
            rules |= along(fixed_axes.symbols, R0 * local.symbols)
        chain = differential(condition, rules).subs(swap)
        local = {s: e for s, e in zip(u, R0.T * (q.x.symbols - q.x0.symbols) - X, strict=True)
                 if isinstance(s, sp.Symbol)}
        check_same("variation of the rotation of best fit", short.subs(local), chain, [R0])
        return short

    def angular_rate(rate: Quantity, of: Quantity, first: bool) -> tuple[Step, ...]:
        origin = q.v0 if first else q.dx0
        steps = (origin_stage(q, origin, of),) if first else ()
        return (*steps, Solve("sum w_j X_j x (rate of r_j) = 0", rate, "position",
                              equation(rate, of, origin), sp.zeros(3, 1), "B", invert=first))

    call = ("planar_fit(N_POSITIONS, fits, X, alphas, qe, frame)" if q.space.planar else
            "best_fit(N_POSITIONS, fits, X, alphas, qe, frame)")
    lines = (f"status = {call}", "if status != 0:", "    return status")
    work = q.wp.symbols.dot(equation(q.dth0, q.dx, q.dx0))
    relative = ("planar_relative_angles(N_ROTATIONS, at(qe, ROTATIONS), frame, at(y, ROTATIONS))"
                if q.space.planar else
                "relative_rotations(N_ROTATIONS, nodes, R, frame, at(y, ROTATIONS))")
    psi_lines = (f"status = {relative}", "if status != 0:", "    return status")
    return Frame(
        "positions", TRAITS["positions"],
        (Text("rotation of the frame: best fit of the positions", lines,
              (call.split("(")[0],), operations=300),
         Text("elastic rotations, (11)", psi_lines, (relative.split("(")[0],), operations=60),
         *inverse_tangent_values(q, q.psi, ("e0", "e1"))),
        angular_rate,
        (_pull_back(q, fit * cross(r, cross(X, q.wp.symbols)), equation(q.wp, q.dx, q.dx0),
                    "position"),),
        -_of(work, q.dx.symbols), -_of(work, q.dx0.symbols), sp.zeros(3, 1))


FRAMES = {"converged_mean": converged_mean, "mean": mean, "mean_small": mean_small,
          "positions": positions}
