"""Option A, (36)-(47): T in the angular velocities rotated into frame axes."""

import sympy as sp

from sebody.contract.traits import InertiaTraits
from sebody.derive.form.steps import Role, Stage
from sebody.derive.formulas import arrays
from sebody.derive.formulas.elastic import conjugate_to
from sebody.derive.formulas.inertia.option import (
    PRODUCTS,
    Inertia,
    InertiaOption,
    position_part,
)
from sebody.derive.formulas.kinematics import angular_velocity_variation
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.symbolic.rotations import cross, skew
from sebody.derive.symbolic.variation import Rules, along, check_same, differential


def option_a(q: Quantities) -> Inertia:
    """Derive the option."""
    accelerate, force, on_frame = position_part(q)
    Q, Om, Om0 = q.Q.symbols, q.Om.symbols, q.Om0.symbols
    w, p, pd, dth, dth0 = (q.w.symbols, q.pw.symbols, q.pwd.symbols, q.dth.symbols,
                           q.dth0.symbols)
    frames = [Q]
    in_time = relative_rotating(Q, Om, Om0) | along(Om, q.A.symbols)
    meaning = {s: e for s, e in zip(w, Q * Om, strict=True) if isinstance(s, sp.Symbol)}
    w_rate = Q * q.A.symbols + cross(w, Om0)
    check_same("rate of Omega* (46)", w_rate.subs(meaning), differential(Q * Om, in_time), frames)
    rate = q.space.quantity("dthd", "axial", "rotation").symbols
    of_velocity = Q * angular_velocity_variation(q.space)
    varied = of_velocity + differential(Q * Om, relative_rotating(Q, dth, dth0))
    check_same("variation of Omega* (42)", Q * rate + cross(w, dth0).subs(meaning), varied, frames)
    form = p.dot(varied)
    conjugate = Q.T * p
    moment = differential(conjugate, in_time | along(p, pd)) - conjugate_to(form, dth)
    short = Q.T * (pd + cross(Om0, p) - cross(w, p))
    check_same("moment of option A (45)", short.subs(meaning), moment, frames)
    on_frame_w = cross(w, p)
    check_same("frame term of option A (45)", on_frame_w.subs(meaning),
               -conjugate_to(form, dth0), frames)
    # an angle in a plane has the same axis in all frames
    relative = () if q.space.planar else (relative_rotation(q),)
    return Inertia(
        (*relative,
         Stage("angular velocities in frame axes, (36)", "rotation", sets=((q.w, Q * Om),))),
        (accelerate, Stage("their rates, (46)", "rotation", sets=((q.wd, w_rate),))),
        force, short, on_frame, on_frame_w, conjugate, relative_rotating(Q, dth, dth0), PRODUCTS,
        (arrays.yd, arrays.p))


def relative_rotation(q: Quantities) -> Stage:
    """The rotation of a node in the frame."""
    return Stage("rotation of the node in the frame", "rotation",
                 sets=((q.Q, q.R0.symbols.T * q.R.symbols),), role=Role.BY_RULE)


def relative_rotating(Q: sp.Matrix, dth: sp.Matrix, dth0: sp.Matrix) -> Rules:
    """Rules for ``Q = R0^T R_j``: it turns with the node and against the frame."""
    change = Q * skew(dth) - skew(dth0) * Q
    return {s: e for s, e in zip(Q, change, strict=True) if isinstance(s, sp.Symbol)}


INERTIA = InertiaOption(
    InertiaTraits("angular velocities in frame axes (option A)", "a", rank=0, cost=1.0,
                  softening=1.0, material=False, modes_apart=True),
    option_a, "(32)-(38), (40)-(47)")
