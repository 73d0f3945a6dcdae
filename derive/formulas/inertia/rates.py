"""What options share whose energy is in rates of deformation and the motion of the frame."""

from typing import NamedTuple

import sympy as sp

from sebody.derive.formulas import gravity
from sebody.derive.formulas.damping import rates
from sebody.derive.formulas.frames.frame import Frame, origin_stage
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.symbolic.linearize import Linearizer
from sebody.derive.symbolic.spaces import Quantity
from sebody.derive.symbolic.steps import Call, Solve, Stage, Step, Values, cross
from sebody.derive.symbolic.variation import along
from sebody.kernels.layout import axes_of

MOVING, STRAINED = range(2)      # places in the array `squares`; then the power lost


def frame_motion(q: Quantities, frame: Frame) -> tuple[Step, ...]:
    """Rates of the local coordinates and of the frame, twice; gravity."""
    Om0 = q.Om0.symbols
    second = {"eu": "eud", "ep": "epd", "em": "emd", "Om0": "Om0d"}
    in_time = (along(q.vs.symbols, q.acc.symbols + cross(q.vs.symbols, Om0))
               | along(q.v0.symbols, q.a0.symbols + cross(q.v0.symbols, Om0))
               | along(q.u.symbols, q.eu.symbols) | along(q.psi.symbols, q.ep.symbols)
               | along(q.Om.symbols, q.A.symbols) | along(q.vm.symbols, q.am.symbols))
    clock = Linearizer(q.space, in_time, lambda quantity: getattr(q, second[quantity.name]))
    solve = [clock.step(step) for step in frame.velocity if isinstance(step, Solve)]
    of_y = [step for step in rates(q) if step.sets]
    modes = Stage("internal modes", "mode", sets=((q.ym, q.qm.symbols),))
    return (*frame.velocity, modes, origin_stage(q, q.v0, q.vs), origin_stage(q, q.a0, q.acc),
            *of_y, *solve, *map(clock.step, of_y), gravity.in_frame_axes(q))


def second_derivatives(q: Quantities) -> tuple[Values, ...]:
    """Of the coefficients of ``T^-1``, in space: second rates have their derivatives."""
    if q.space.planar:
        return ()
    return (Values("second derivative of the coefficients of T^-1", (q.e2,),
                   "inverse_tangent_second", q.psi, 30),)


def on_frame_stage(q: Quantities, force: sp.Matrix, moment: sp.Matrix) -> Stage:
    """Force and moment on the frame, with those of the nodes."""
    return Stage("inertia and weight on the frame", "element",
                 adds=((q.F, force), (q.W, moment)), continues=True)


class Form(NamedTuple):
    """A matrix and the row on both sides of it: titles of product and value; counts as text."""

    title: str
    value: str
    matrix: str
    row: str
    rows: str
    columns: str
    height: str


def quadratic_forms(mass: Form, stiffness: Form, damping: Form) -> tuple[Call, ...]:
    """Twice the kinetic energy of deformation and the strain energy, and the power lost."""
    steps = []
    for k, form in enumerate((mass, stiffness, damping)):
        out = f"at(squares, {k})" if k else "squares"
        steps += [Call(form.title, "block_times",
                       (form.matrix, form.row, "moved", form.rows, form.columns, form.height),
                       (form.matrix, form.row, "moved")),
                  Call(form.value, "rows_times",
                       ("moved", form.row, out, form.rows, "1", form.height),
                       ("moved", form.row, "squares"))]
    return tuple(steps)


def form_value(q: Quantities, name: str, k: int) -> Quantity:
    """The value of a form, by its place."""
    return q.space.quantity(name, "scalar", "element", "squares", "{k}", k)


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
    return q.space.quantity("angle0", "axial", "element", "rigid0", "{k}",
                            axes_of(q.space.planar)["D"])
