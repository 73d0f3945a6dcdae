"""Option B, (52)-(59): T in the material angular velocities."""

import sympy as sp

from sebody.contract.traits import InertiaTraits
from sebody.derive.form.steps import Stage
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
from sebody.derive.symbolic.rotations import cross
from sebody.derive.symbolic.variation import along, check_same, differential


def option_b(q: Quantities) -> Inertia:
    """Derive the option."""
    accelerate, force, on_frame = position_part(q)
    Om, p, pd, dth = q.Om.symbols, q.pw.symbols, q.pwd.symbols, q.dth.symbols
    variation = angular_velocity_variation(q.space)
    rate = q.space.quantity("dthd", "axial", "rotation").symbols
    conjugate = conjugate_to(p.dot(variation), rate)
    moment = differential(conjugate, along(p, pd)) - conjugate_to(p.dot(variation), dth)
    short = pd + cross(Om, p)
    check_same("moment of option B (57)", short, moment)
    return Inertia(
        (Stage("material angular velocities, (52)", "rotation", sets=((q.w, q.Om.symbols),)),),
        (accelerate, Stage("their rates, (58)", "rotation", sets=((q.wd, q.A.symbols),))),
        force, short, on_frame, sp.zeros(3, 1), conjugate, {}, PRODUCTS, (arrays.yd, arrays.p))


INERTIA = InertiaOption(
    InertiaTraits("material angular velocities (option B)", "b", rank=0, cost=1.0, softening=1.0,
                  material=True, modes_apart=True),
    option_b, "(32)-(35), (52)-(59)")
