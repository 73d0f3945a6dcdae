"""Local coordinates and velocities of a superelement in its floating frame, (11), (17), (33).

All variations are written in local axes: positions by ``R0^T delta x``, rotations by the
material ``delta Theta``.
"""

import sympy as sp

from sebody.derive.form.spaces import Space
from sebody.derive.form.steps import Stage
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.symbolic.rotations import (
    cross,
    exp,
    inverse_tangent,
    skew,
    tangent,
    tangent_inverse,
)
from sebody.derive.symbolic.variation import Rules, along, check_same, differential, rotating


def unknown_rules(q: Quantities) -> Rules:
    """Differentials of what a superelement starts from: the unknowns, their rates, the frame.

    The frame's own, ``dx0`` and ``dth0``, are quantities that the frame's stages compute.
    """
    R0 = q.R0.symbols
    rules = rotating(R0, q.dth0.symbols)
    for fixed_axes, local in ((q.x, q.dx), (q.x0, q.dx0), (q.v, q.dv), (q.a, q.da)):
        rules |= along(fixed_axes.symbols, R0 * local.symbols)
    return rules | along(q.Om.symbols, q.dOm.symbols) | along(q.A.symbols, q.dA.symbols)


def in_time(q: Quantities) -> Rules:
    """Velocities in place of variations: whatever varies so has these rates."""
    pairs = ((q.dx, q.vs), (q.dx0, q.v0), (q.dth, q.Om), (q.dth0, q.Om0),
             (q.space.d(q.qm), q.vm))
    return {d: rate for varied, rated in pairs
            for d, rate in zip(varied.symbols, rated.symbols, strict=True)
            if isinstance(d, sp.Symbol)}


def local_displacement(q: Quantities) -> Stage:
    """Displacement of the nodes in the frame, (11); varied, (17)."""
    r = q.X.symbols + q.u.symbols
    return Stage(
        "displacement of the nodes in the frame, (11)", "position",
        sets=((q.u, q.R0.symbols.T * (q.x.symbols - q.x0.symbols) - q.X.symbols),),
        short=(q.dx.symbols - q.dx0.symbols + cross(r, q.dth0.symbols),))


def local_velocity(q: Quantities) -> Stage:
    """Velocity and acceleration of the nodes, rotated into frame axes, (33)."""
    R0, dth0 = q.R0.symbols, q.dth0.symbols
    return Stage(
        "velocity and acceleration of the nodes in frame axes, (33)", "position",
        sets=((q.vs, R0.T * q.v.symbols), (q.acc, R0.T * q.a.symbols)),
        short=(q.dv.symbols + cross(q.vs.symbols, dth0),
               q.da.symbols + cross(q.acc.symbols, dth0)))


def elastic_rotation_variation(q: Quantities) -> sp.Matrix:
    """``delta psi_j`` of (17), from differentiating ``exp(psi_j) = R0^T R_j``.

    ``R0^T R_j`` turns with ``dTheta_j`` and against ``dTheta_0``; ``exp`` turns with
    ``T(psi) dpsi``. Shortened with ``T^-1(psi) exp(-psi) = T^-T(psi)``.
    """
    psi, dth, dth0 = q.psi.symbols, q.dth.symbols, q.dth0.symbols
    short = difference_of_rates(psi, dth, dth0)
    rotated = exp(psi) * skew(dth) - skew(dth0) * exp(psi)
    chain = differential(exp(psi), along(psi, short))
    check_same("variation of the elastic rotation (17)", chain.reshape(9, 1), rotated.reshape(9, 1))
    check_same("inverse of the tangent operator", inverse_tangent(psi) * tangent(psi), sp.eye(3))
    return short


def difference_of_rates(psi: sp.Matrix, of: sp.Matrix, frame: sp.Matrix) -> sp.Matrix:
    """``T^-1(psi) of - T^-T(psi) frame``, in cross products of difference and sum."""
    difference, total = of - frame, of + frame
    once = cross(psi, difference)
    return (difference + cross(psi, total) / 2
            + tangent_inverse(0, psi.dot(psi)) * cross(psi, once))


def angular_velocity_variation(space: Space) -> sp.Matrix:
    """``delta Omega = d(dTheta)/dt + Omega x dTheta``, from mixed derivatives of a rotation, (56).

    ``skew(Omega) = R^T Rdot``; the variation of ``Rdot = R skew(Omega)`` is the rate of
    ``dR = R skew(dTheta)``.
    """
    q = Quantities(space)
    Om, dth, rate = q.Om.symbols, q.dth.symbols, space.quantity("dthd", "axial", "rotation").symbols
    short = rate + cross(Om, dth)
    rate_of_variation = skew(Om) * skew(dth) + skew(rate)       # R^T d/dt (R skew(dTheta))
    chain = rate_of_variation - skew(dth) * skew(Om)            # minus (dR)^T R skew(Omega)
    check_same("variation of an angular velocity (56)", skew(short).reshape(9, 1),
               chain.reshape(9, 1))
    return short
