"""Springs and dampers whose forces are tables of the elongation and of its rate.

The energy is the integral of the force by the elongation, the dissipation that of the damper by the
rate; tables are cubics between their rows and straight beyond them, see `sebody/kernels/tables.py`.
"""

import sympy as sp

from sebody.derive.form.spaces import Quantity, Space
from sebody.derive.formulas.elements import (
    Constant,
    Element,
    constant,
    element,
    kept,
    near_angle,
    position,
    rotation,
    tabled,
)
from sebody.derive.formulas.forces import measures
from sebody.derive.symbolic.rotations import cross
from sebody.kernels.tables import SIZE


def spring(planar: bool) -> Element:
    """Spring and damper between two points, of the stretch and its rate."""
    space = Space(planar)
    length = constant(space, "length", "scalar", "length without elongation")
    a, b = position(space, "a"), position(space, "b")
    d, w = b.state.symbols - a.state.symbols, b.rate.symbols - a.rate.symbols
    now = sp.sqrt(d.dot(d))
    constants, strain, dissipation = _laws([length], now - length.symbols[0], d.dot(w) / now)
    return element("planar_" * planar + "table_spring",
                   "spring and damper between two points, by tables", space, (a, b), constants,
                   strain=strain, dissipation=dissipation)


def torsion_spring(planar: bool) -> Element:
    """Spring and damper about an axis, of the angle and its rate; see `forces.torsion_spring`."""
    space = Space(planar)
    own = [constant(space, "rest", "scalar", "angle without elongation [rad]")]
    a, b = rotation(space, "a"), rotation(space, "b")
    memory = []
    if planar:
        angle, rate = a.angle - b.angle, a.rate.symbols[2] - b.rate.symbols[2]
    else:
        own += [constant(space, "n", "vector", "direction normal to the axis, body a"),
                constant(space, "m", "vector", "direction normal to both, body b")]
        n, m = (v.symbols for v in own[1:])
        seen = b.state.symbols.T * a.state.symbols * n
        angle = near_angle(sp.atan2(m.dot(seen), n.dot(seen)), kept("angle"))
        memory = [("angle", angle)]
        rate = (a.state.symbols * cross(n, m)).dot(a.state.symbols * a.rate.symbols
                                                   - b.state.symbols * b.rate.symbols)
    constants, strain, dissipation = _laws(own, angle - own[0].symbols[0], rate)
    return element("planar_" * planar + "table_torsion_spring",
                   "spring and damper about an axis, by tables", space, (a, b), constants,
                   strain=strain, dissipation=dissipation, memory=memory)


def bushing(planar: bool) -> Element:
    """A bushing with laws along and about its axes, see `forces.bushing`."""
    space = Space(planar)
    by, d = measures(space), 2 if planar else 3
    # in a plane the axis of turns is the third one
    ways = [(f"{k + 1}", by.stretch[k], by.rates[0][k]) for k in range(d)]
    turns = [(f"t{k + 1}", by.turn[k], by.rates[1][k]) for k in ((2,) if planar else range(3))]
    constants, strain, dissipation = [*by.free, *by.axes], sp.S.Zero, sp.S.Zero
    for key, value, rate in (*ways, *turns):
        constants, of_force, of_damper = _laws(constants, value, rate, key)
        strain, dissipation = strain + of_force, dissipation + of_damper
    return element("planar_" * planar + "table_bushing",
                   "springs and dampers along and about axes, by tables", space, by.blocks,
                   constants, strain=strain, dissipation=dissipation)


def _laws(before: list[Constant], u: sp.Expr, rate: sp.Expr, of: str = ""
          ) -> tuple[list[Constant], sp.Expr, sp.Expr]:
    """Constants with both tables, energy and dissipation."""
    first = sum(len(one.quantity.kept) for one in before)
    tables = [Constant(Quantity(name + of, "table", "element", None, sp.Matrix(
                  sp.symbols(f"{name}{of}_0:{SIZE}"))), f"table of the {what}")
              for name, what in (("force", "force"), ("damper", "force of the damper"))]
    return [*before, *tables], tabled(u, 0, first), tabled(rate, 0, first + SIZE)
