"""Gravity from the potential of the reduced mass.

The centre of mass is where the reduced mass has it: rigid translations ``r`` make of
``m x_cm = m x_0 + R_0 (m c + r^T Mbar y)`` the first moment of mass of the deformed body, ``c``
being the centre of mass at rest, seen from the origin of the frame. With the field ``g``

    V = -g . m x_cm,    delta V = -(Mbar r gamma) . delta y + (gamma x d) . delta Theta_0
                                  - m gamma . R_0^T delta x_0

where ``gamma = R_0^T g`` and ``d = m c + r^T Mbar y``: conservative, no deformation in free fall of
a body that has none, and like an elastic force to everything that follows.
"""

from typing import NamedTuple

import sympy as sp

from sebody.derive.form.counts import n
from sebody.derive.form.steps import Product, Shift, Stage, Step
from sebody.derive.form.whole import Number
from sebody.derive.formulas import arrays
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.passes.linearize import Linearizer
from sebody.derive.symbolic.rotations import cross
from sebody.derive.symbolic.variation import along, check_same, differential, rotating

TAKEN_OFF = Shift("force conjugate to y, elastic and gravity", arrays.s, arrays.weight, adds=False)


class Gravity(NamedTuple):
    """The parts of gravity in a kernel."""

    before: tuple[Step, ...]        # field in frame axes, first moment of mass; once y is known
    products: tuple[Step, ...]      # forces conjugate to y, taken off the elastic ones
    on_frame: sp.Matrix             # moment conjugate to delta Theta_0
    origin: sp.Matrix               # share of a position in the force on delta x_0
    potential: sp.Expr
    strain: sp.Expr                 # what half of y . (Sbar y - Mbar r gamma) lacks of the strain


def gravity(q: Quantities) -> Gravity:
    """Stages and forces of gravity; its variation is checked before anything is emitted."""
    R0, gamma, moment = q.R0.symbols, q.gamma.symbols, q.d.symbols
    mass, at_rest, x0 = q.mass.symbols[0], q.mc.symbols, q.x0.symbols
    d = at_rest + moment
    potential = -(mass * (R0.T * x0).dot(gamma) + d.dot(gamma))
    _check_variation(q, d, mass)
    axes = Number(2 if q.space.planar else 3)
    return Gravity(
        before=(in_frame_axes(q), Product("first moment of mass of the deformation, d = r^T Mbar y",
                                          arrays.mass_rows, arrays.y, arrays.d, axes, n)),
        products=(Product("weight conjugate to y, Mbar r gamma", arrays.mass_columns, arrays.gamma,
                          arrays.weight, n, axes),),
        on_frame=cross(gamma, d), origin=-mass * gamma, potential=potential,
        strain=moment.dot(gamma) / 2)


def in_frame_axes(q: Quantities) -> Stage:
    """The field, seen in the frame."""
    return Stage("gravity in frame axes", "element",
                 sets=((q.gamma, q.R0.symbols.T * q.field.symbols),),
                 short=(cross(q.gamma.symbols, q.dth0.symbols),))


def _check_variation(q: Quantities, d: sp.Matrix, mass: sp.Expr) -> None:
    """``delta V`` of the header, by the chain rule."""
    R0, g, x0, dd = q.R0.symbols, q.field.symbols, q.x0.symbols, q.space.d(q.d).symbols
    rules = rotating(R0, q.dth0.symbols) | along(x0, R0 * q.dx0.symbols) | along(q.d.symbols, dd)
    chain = differential(-g.dot(mass * x0 + R0 * d), rules)
    gamma = R0.T * g
    short = -gamma.dot(dd) + cross(gamma, d).dot(q.dth0.symbols) - mass * gamma.dot(q.dx0.symbols)
    check_same("variation of the potential of gravity", sp.Matrix([short]), sp.Matrix([chain]),
               [R0])


def linearized(q: Quantities, gravity: Gravity, chain: Linearizer) -> tuple[Step, ...]:
    """Differentials of the stages, in their order."""
    field, moment = gravity.before
    steps = [chain.stage(field), moment.differential()]
    chain.move(q.d)
    return (*steps, *(p.differential() for p in gravity.products))

