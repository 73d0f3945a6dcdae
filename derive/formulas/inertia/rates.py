"""Common parts of options whose energy is in rates of deformation and motion of the frame."""

from typing import NamedTuple

import sympy as sp

from sebody.contract.counts import axes_of
from sebody.derive.form.arrays import Array, Place, scratch
from sebody.derive.form.functions import BLOCK_TIMES, INVERSE_TANGENT_SECOND, ROWS_TIMES
from sebody.derive.form.spaces import Quantity
from sebody.derive.form.steps import Call, Solve, Stage, Step, Sum, Values, call, solve_matrix
from sebody.derive.form.whole import Whole
from sebody.derive.formulas import gravity
from sebody.derive.formulas.damping import rates
from sebody.derive.formulas.frames.frame import Frame, origin_stage
from sebody.derive.formulas.motion import SECOND, rate_of, time_rules
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.passes.linearize import Linearizer
from sebody.derive.symbolic.rotations import cross
from sebody.derive.symbolic.variation import (
    DerivationError,
    Rules,
    along,
    check_same,
    differential,
)

RATES = {"u": "eu", "psi": "ep", "ym": "em"}     # of local coordinates, by name
MOVING, STRAINED, LOST = range(3)       # places among the squares: energies, power lost
SQUARES, MOVED = scratch("squares"), scratch("moved")
RIGID = tuple(map(scratch, ("rigid0", "rigid1", "rigid2")))     # rigid parts of y and its rates


def frame_motion(q: Quantities, frame: Frame) -> tuple[Step, ...]:
    """Rates of the local coordinates and of the frame, twice; gravity."""
    rules = time_rules(q) | along(q.Om0.symbols, q.Om0d.symbols)
    clock = Linearizer(q.space, rules, lambda quantity: rate_of(q, quantity))
    of_y = [step for step in rates(q) if step.sets]
    modes = Stage("internal modes", "mode", sets=((q.ym, q.qm.symbols),))
    return (*frame.velocity, modes, origin_stage(q, q.v0, q.vs), origin_stage(q, q.a0, q.acc),
            *of_y, *_accelerations(q, frame, rules, [clock.step(step) for step in of_y]),
            gravity.in_frame_axes(q))


def _accelerations(q: Quantities, frame: Frame, rules: Rules, stages: list[Stage]
                   ) -> tuple[Step, ...]:
    """Second rates of the local coordinates, and the frame's, which closes their sum.

    The frame is where a sum over the local coordinates is zero: so is that of their rates and of
    their second rates, ``sum L(k_j + M_j Omega_0') = 0``. What does not depend on Omega_0' is
    computed once, for the sum and for the second rates.

    Raises
    ------
    DerivationError
        A frame that declares no linear condition, or has no equation for its rate.
    """
    solves = [step for step in frame.velocity if isinstance(step, Solve)]
    if not frame.conditions or not solves:
        raise DerivationError("inertia options with rates of the frame need one that declares the "
                              "linear `conditions` of its local coordinates and solves for its "
                              "rate")
    rate, Om0d = solves[0], q.Om0d
    turning = sp.Matrix(Om0d.kept)
    rated = set().union(*(sp.sympify(rate).free_symbols for rate in rules.values()))
    before, sums, after = [], [], list(stages)
    for (of, weight, _), part in zip(frame.conditions, rate.sums, strict=True):
        target = getattr(q, SECOND[RATES[of.name]])
        closing = next(stage for stage in stages if stage.sets[0][0] is target)
        value = closing.sets[0][1]
        stored = sp.Matrix(target.symbols[:value.rows])
        # without rates what is left is the part of the frame, factored
        by_turning = value.xreplace(dict.fromkeys(rated - set(turning), sp.S.Zero))
        equation = solve_matrix(rate, part) * Om0d.symbols
        check_same("rate of the frame's equation", weight * value,
                   differential(part.summand, rules))
        check_same("the part of the frame", by_turning, value.jacobian(turning) * turning)
        check_same("the part of the frame in it", weight * by_turning, equation)
        after.remove(closing)
        sums.append(Sum(part.over, equation + weight * stored))
        if not any(by_turning):
            before.append(closing)
            continue
        before.append(closing._replace(title=closing.title + ", the frame held",
                                       sets=((target, value.subs({s: 0 for s in Om0d.kept})),)))
        after.insert(0, closing._replace(sets=((target, stored + by_turning),)))
    solve = Solve("rate: " + rate.title, Om0d, tuple(sums), sp.zeros(3, 1), rate.inverse)
    return *before, solve, *after


def second_derivatives(q: Quantities) -> tuple[Values, ...]:
    """Values of the coefficients of ``T^-1``, in space: second rates have their derivatives."""
    if q.space.planar:
        return ()
    return (Values("second derivative of the coefficients of T^-1", (q.e2,),
                   INVERSE_TANGENT_SECOND, q.psi, 30),)


def on_frame_stage(q: Quantities, force: sp.Matrix, moment: sp.Matrix) -> Stage:
    """Force and moment on the frame, with those of the nodes."""
    return Stage("inertia and weight on the frame", "element",
                 adds=((q.F, force), (q.W, moment)), continues=True)


class Form(NamedTuple):
    """A matrix and the row on both sides of it: titles of product and value."""

    title: str
    value: str
    matrix: Array
    row: Array
    rows: Whole
    columns: Whole
    height: Whole


def quadratic_forms(mass: Form, stiffness: Form, damping: Form) -> tuple[Call, ...]:
    """Twice the kinetic energy of deformation and the strain energy, and the power lost."""
    steps = []
    for k, form in enumerate((mass, stiffness, damping)):
        steps += [call(form.title, BLOCK_TIMES, form.matrix, form.row, MOVED, form.rows,
                       form.columns, form.height),
                  call(form.value, ROWS_TIMES, MOVED, form.row, SQUARES.at(k), form.rows, 1,
                       form.height)]
    return tuple(steps)


def form_value(q: Quantities, name: str, k: int) -> Quantity:
    """The value of a form, by its place."""
    return q.space.quantity(name, "scalar", "element", SQUARES, Place(k))


def energies_stage(q: Quantities, kinetic: sp.Expr, strain: sp.Expr, momentum: sp.Matrix,
                   moment: sp.Matrix, first_moment: sp.Matrix) -> Stage:
    """Energies, momentum and its moment about the global origin.

    Parameters
    ----------
    momentum, moment : sympy.Matrix
        Of the body, about the origin of the frame and in its axes.
    first_moment : sympy.Matrix
        Of mass, likewise.
    """
    R0, x0, gamma = q.R0.symbols, q.x0.symbols, q.gamma.symbols
    potential = -(first_moment + q.mass.symbols[0] * R0.T * x0).dot(gamma)
    return Stage("energies, momentum and its moment about the origin", "element", sets=(
        (q.kinetic, sp.Matrix([kinetic])), (q.strain, sp.Matrix([strain])),
        (q.potential, sp.Matrix([potential])), (q.P, R0 * momentum),
        (q.H, cross(x0, R0 * momentum) + R0 * moment)))


def rigid_angle(q: Quantities) -> Quantity:
    """Mean rotation of the local coordinates, of option D."""
    return q.space.quantity("angle0", "axial", "element", RIGID[0],
                            Place(axes_of(q.space.planar)["D"]))
