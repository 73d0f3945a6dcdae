"""The rigid part of a body's motion: its centre of mass, and a rotation that follows the frame.

Of the reduced mass alone the rigid modes are known, so is what a displacement y has of them: the
first moment of mass ``d = S1 y`` and the mean rotation ``phi = Gam y``. The rest is orthogonal to
them. The rigid part moves as a rigid body with the inertia at rest,

    x_c = x_0 + R_0 (m c + d) / m,      R_c = R_0 exp(phi)

and the rest with a constant mass on ydot. The exponential must be exact: of first order the energy
has no lower bound that holds.
"""

from functools import cache
from typing import NamedTuple

import sympy as sp

from sebody.derive.formulas.elastic import conjugate_to
from sebody.derive.formulas.inertia.floating_field import Motion
from sebody.derive.symbolic.rotations import cross, exp, skew, stumpff, tangent
from sebody.derive.symbolic.variation import Rules, along, check_same, differential, rotating


class Deformation(NamedTuple):
    """Moments of mass by the local coordinates and their rates."""

    first: sp.Matrix        # m c + S1 y, first moment of mass about the origin of the frame
    first_d: sp.Matrix      # S1 ydot
    first_dd: sp.Matrix     # S1 yddot
    phi: sp.Matrix          # Gam y
    phi_d: sp.Matrix        # Gam ydot
    phi_dd: sp.Matrix       # Gam yddot


class Turning(NamedTuple):
    """The rotation R_c: material vectors."""

    spin: sp.Matrix         # w_c, R_c' = R_c skew(w_c)
    spin_d: sp.Matrix
    moment: sp.Matrix       # J_c w_c' + w_c x J_c w_c


def spin(m: Motion, y: Deformation) -> sp.Matrix:
    """Material angular velocity of ``R_0 exp(phi)``."""
    return turned(y.phi, m.spin, -1) + along_tangent(y.phi, y.phi_d)


def spin_rate(m: Motion, y: Deformation) -> sp.Matrix:
    """Its rate."""
    phi, p = y.phi, y.phi_d
    once, s = cross(phi, p), phi.dot(phi)
    c2_d, c3_d = (stumpff(k, s).fdiff() * 2 * phi.dot(p) for k in (2, 3))
    return (turned(phi, m.turning, -1) + cross(turned(phi, m.spin, -1), along_tangent(phi, p))
            + along_tangent(phi, y.phi_dd) - c2_d * once + c3_d * cross(phi, once)
            + stumpff(3, s) * cross(p, once))


def moment(J: sp.Matrix, t: Turning) -> sp.Matrix:
    """Rate of the moment of momentum about the centre of mass, material."""
    return J * t.spin_d + cross(t.spin, J * t.spin)


def kinetic_energy(m: Motion, y: Deformation, J: sp.Matrix, w: sp.Matrix,
                   squared: sp.Expr) -> sp.Expr:
    """T; `squared` is ``ydot . Mbar ydot``, which has the rigid part of ydot, too."""
    p = momentum(m, y)
    return ((p.dot(p) - y.first_d.dot(y.first_d)) / (2 * m.mass)
            + (w.dot(J * w) - y.phi_d.dot(J * y.phi_d)) / 2 + squared / 2)


def momentum(m: Motion, y: Deformation) -> sp.Matrix:
    """Momentum of the body, in axes of the frame."""
    return m.mass * m.velocity + cross(m.spin, y.first) + y.first_d


def moment_of_momentum(m: Motion, y: Deformation, J: sp.Matrix, w: sp.Matrix) -> sp.Matrix:
    """About the origin of the frame, in its axes."""
    return cross(y.first, momentum(m, y)) / m.mass + turned(y.phi, J * w)


def on_origin(m: Motion, y: Deformation) -> sp.Matrix:
    """Force conjugate to ``R0^T delta x_0``: mass times what is felt of the acceleration."""
    w = m.spin
    return (m.mass * m.felt + cross(m.turning, y.first) + cross(w, cross(w, y.first))
            + 2 * cross(w, y.first_d) + y.first_dd)


def on_frame(m: Motion, y: Deformation, force: sp.Matrix, t: Turning) -> sp.Matrix:
    """Moment conjugate to ``delta Theta_0``; `force` is that on the origin."""
    return cross(y.first, force) / m.mass + turned(y.phi, t.moment)


def on_first(m: Motion, y: Deformation, force: sp.Matrix) -> sp.Matrix:
    """Force conjugate to ``S1 delta y``, without ``Mbar yddot``."""
    return (force - y.first_dd) / m.mass


def on_phi(y: Deformation, J: sp.Matrix, t: Turning) -> sp.Matrix:
    """Moment conjugate to ``Gam delta y``, without ``Mbar yddot``."""
    return along_tangent(y.phi, t.moment, -1) - J * y.phi_dd


def turned(phi: sp.Matrix, b: sp.Matrix, sign: int = 1) -> sp.Matrix:
    """``exp(phi) b``, or ``exp(-phi) b``, by cross products."""
    s, once = phi.dot(phi), cross(phi, b)
    return b + sign * stumpff(1, s) * once + stumpff(2, s) * cross(phi, once)


def along_tangent(phi: sp.Matrix, b: sp.Matrix, sign: int = 1) -> sp.Matrix:
    """``T(phi) b``, or with the other sign ``T(phi)^T b``, by cross products."""
    s, once = phi.dot(phi), cross(phi, b)
    return b - sign * stumpff(2, s) * once + stumpff(3, s) * cross(phi, once)


@cache
def prove() -> None:
    """Velocities from kinematics, forces by Hamilton's principle, with any constants."""
    mass = sp.Symbol("m")
    m = Motion(mass, *map(_vector, ("v", "b", "Om", "Omd")))
    y = Deformation(*map(_vector, ("e", "ed", "edd", "phi", "phid", "phidd")))
    # R0^T xddot_0 = v0*' + Omega_0 x v0*
    in_time = (along(m.velocity, m.felt - cross(m.spin, m.velocity)) | along(m.spin, m.turning)
               | along(y.first, y.first_d) | along(y.first_d, y.first_dd)
               | along(y.phi, y.phi_d) | along(y.phi_d, y.phi_dd))
    _prove_kinematics(m, y, in_time)
    _prove_forces(m, y, in_time)


def _prove_kinematics(m: Motion, y: Deformation, in_time: Rules) -> None:
    """Velocity of x_c and angular velocity of R_c."""
    R0, x0, b = sp.Matrix(3, 3, sp.symbols("R_:9")), _vector("x"), _vector("arm")
    check_same("rotation of the rigid part", turned(y.phi, b), exp(y.phi) * b)
    check_same("its inverse", turned(y.phi, b, -1), exp(y.phi).T * b)
    check_same("tangent of the rigid part", along_tangent(y.phi, b), tangent(y.phi) * b)
    check_same("its transpose", along_tangent(y.phi, b, -1), tangent(y.phi).T * b)
    rules = in_time | rotating(R0, m.spin) | along(x0, R0 * m.velocity)
    place, turn = x0 + R0 * y.first / m.mass, R0 * exp(y.phi)
    check_same("velocity of the centre of mass", momentum(m, y) / m.mass,
               R0.T * differential(place, rules), [R0])
    w = spin(m, y)
    check_same("angular velocity of the rigid part", skew(w).reshape(9, 1),
               (turn.T * differential(turn, rules)).reshape(9, 1), [R0])
    check_same("its rate", spin_rate(m, y), differential(w, in_time))


def _prove_forces(m: Motion, y: Deformation, in_time: Rules) -> None:
    """Momenta at the rates of variations, the rest at the variations; see `floating_field`."""
    entries = sp.symbols("J_:6")
    J = sp.Matrix(3, 3, [entries[k] for k in (0, 3, 4, 3, 1, 5, 4, 5, 2)])
    w = spin(m, y)
    T = kinetic_energy(m, y, J, w, sp.S.Zero)
    pushed, turning = momentum(m, y), moment_of_momentum(m, y, J, w)
    for name, p, of in (("momentum", pushed, m.velocity), ("moment of it", turning, m.spin)):
        check_same(f"{name} of a rigid part", p, conjugate_to(T, of))
    t = Turning(w, spin_rate(m, y), sp.zeros(3, 1))
    t = t._replace(moment=moment(J, t))
    force = on_origin(m, y)
    dx, dth = _vector("dx"), _vector("dth")
    form = (pushed.dot(cross(m.spin, dx) + cross(m.velocity, dth))
            + turning.dot(cross(m.spin, dth)))
    for name, short, p, along_ in (("origin", force, pushed, dx),
                                   ("frame", on_frame(m, y, force, t), turning, dth)):
        check_same(f"inertia of a rigid part on the {name}", short,
                   differential(p, in_time) - conjugate_to(form, along_))
    for name, short, of, rate in (("first moment", on_first(m, y, force), y.first, y.first_d),
                                  ("rotation", on_phi(y, J, t), y.phi, y.phi_d)):
        check_same(f"inertia on the {name}", short,
                   differential(conjugate_to(T, rate), in_time) - conjugate_to(T, of))


def _vector(name: str) -> sp.Matrix:
    return sp.Matrix(sp.symbols(f"{name}_:3"))
