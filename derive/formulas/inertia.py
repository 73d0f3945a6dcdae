"""Inertia forces by Hamilton's principle from ``T = ydot^T Mbar ydot / 2``, (32)-(63).

``Mbar`` is constant, so ``delta T = p . delta ydot`` with ``p = Mbar ydot``: only the variation of
the velocities that enter T is needed. The part with the rate of a variation is integrated by
parts. In option A the angular velocities are turned into frame axes, in option B they are material.
"""

from typing import NamedTuple

import sympy as sp

from sebody.derive.formulas.elastic import _of
from sebody.derive.formulas.kinematics import angular_velocity_variation, unknown_rules
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.symbolic.rotations import skew
from sebody.derive.symbolic.steps import Stage, cross
from sebody.derive.symbolic.variation import along, check_same, differential, turning
from sebody.kernels.layout import InertiaTraits


class Inertia(NamedTuple):
    """What an inertia option contributes to a kernel."""

    name: str
    traits: InertiaTraits
    velocity: Stage             # w_j of (36) or (52)
    acceleration: tuple[Stage, ...]  # ydd of (46) or (58)
    position: sp.Matrix         # generalized force on R0^T delta x_i
    rotation: sp.Matrix         # on delta Theta_j
    frame_positions: sp.Matrix  # on delta Theta_0, summed over positions
    frame_rotations: sp.Matrix  # summed over rotations
    spin: sp.Matrix             # conjugate to Omega_j: material angular momentum of the node


TRAITS = {"a": InertiaTraits("angular velocities in frame axes (option A)", material=False),
          "b": InertiaTraits("material angular velocities (option B)", material=True)}


def position_part(q: Quantities) -> tuple[Stage, sp.Matrix, sp.Matrix]:
    """Positions: local acceleration and the forces on ``delta x_i`` and ``delta Theta_0``."""
    R0, Om0, p, pd = q.R0.symbols, q.Om0.symbols, q.px.symbols, q.pxd.symbols
    in_time = turning(R0, Om0) | along(p, pd) | along(q.v.symbols, q.a.symbols)
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
    on_frame = -_of(p.dot(cross(q.vs.symbols, q.dth0.symbols)), q.dth0.symbols)
    stage = Stage("local accelerations of the nodes, (46), (58)", "position",
                  sets=((q.vsd, short),))
    return stage, force, on_frame


def option_b(q: Quantities) -> Inertia:
    """Option B, (52)-(59): T in the material angular velocities."""
    accelerate, force, on_frame = position_part(q)
    Om, p, pd, dth = q.Om.symbols, q.pw.symbols, q.pwd.symbols, q.dth.symbols
    variation = angular_velocity_variation(q.space)
    rate = q.space.quantity("dthd", "axial", "rotation").symbols
    conjugate = _of(p.dot(variation), rate)
    moment = differential(conjugate, along(p, pd)) - _of(p.dot(variation), dth)
    short = pd + cross(Om, p)
    check_same("moment of option B (57)", short, moment)
    return Inertia(
        "b", TRAITS["b"],
        Stage("material angular velocities, (52)", "rotation", sets=((q.w, q.Om.symbols),)),
        (accelerate, Stage("their rates, (58)", "rotation", sets=((q.wd, q.A.symbols),))),
        force, short, on_frame, sp.zeros(3, 1), conjugate)


def option_a(q: Quantities) -> Inertia:
    """Option A, (36)-(47): T in the angular velocities turned into frame axes."""
    accelerate, force, on_frame = position_part(q)
    Q, Om, Om0 = q.Q.symbols, q.Om.symbols, q.Om0.symbols
    w, p, pd, dth, dth0 = (q.w.symbols, q.pw.symbols, q.pwd.symbols, q.dth.symbols,
                           q.dth0.symbols)
    frames = [Q]
    in_time = relative_turning(Q, Om, Om0) | along(Om, q.A.symbols)
    meaning = {s: e for s, e in zip(w, Q * Om, strict=True) if isinstance(s, sp.Symbol)}
    w_rate = Q * q.A.symbols + cross(w, Om0)
    check_same("rate of Omega* (46)", w_rate.subs(meaning), differential(Q * Om, in_time), frames)
    rate = q.space.quantity("dthd", "axial", "rotation").symbols
    of_velocity = Q * angular_velocity_variation(q.space)
    varied = of_velocity + differential(Q * Om, relative_turning(Q, dth, dth0))
    check_same("variation of Omega* (42)", Q * rate + cross(w, dth0).subs(meaning), varied, frames)
    form = p.dot(varied)
    conjugate = Q.T * p
    moment = differential(conjugate, in_time | along(p, pd)) - _of(form, dth)
    short = Q.T * (pd + cross(Om0, p) - cross(w, p))
    check_same("moment of option A (45)", short.subs(meaning), moment, frames)
    on_frame_w = cross(w, p)
    check_same("frame term of option A (45)", on_frame_w.subs(meaning), -_of(form, dth0), frames)
    return Inertia(
        "a", TRAITS["a"],
        Stage("angular velocities in frame axes, (36)", "rotation", sets=((q.w, Q * Om),)),
        (accelerate, Stage("their rates, (46)", "rotation", sets=((q.wd, w_rate),))),
        force, short, on_frame, on_frame_w, conjugate)


def relative_turning(Q: sp.Matrix, dth: sp.Matrix, dth0: sp.Matrix) -> dict:
    """Rules for ``Q = R0^T R_j``: it turns with the node and against the frame."""
    change = Q * skew(dth) - skew(dth0) * Q
    return {s: e for s, e in zip(Q, change, strict=True) if isinstance(s, sp.Symbol)}


OPTIONS = {"a": option_a, "b": option_b}
