"""Mean axes: to first order the deformation has no moment of momentum, ``sum Gam_i y_i = 0``.

The sum is over all local coordinates. ``Gam = J_c^-1 y_r^T Mbar`` with the rigid rotations y_r
about the centre of mass is their mean rotation, weighted by mass: one of a rigid rotation, zero of
a translation. So the frame is the same wherever its origin is, and it follows no light node.
"""

import sympy as sp

from sebody.contract.counts import axes_of
from sebody.contract.layout import Part
from sebody.contract.traits import FrameTraits
from sebody.derive.form.arrays import Place, constant
from sebody.derive.form.counts import (
    FIRST_ROTATION,
    POSITIONS,
    ROTATIONS,
    i,
    i3,
    j3,
    k,
    n,
)
from sebody.derive.form.functions import MEAN_AXES, PLANAR_MEAN_AXES
from sebody.derive.form.spaces import AXES, Quantity
from sebody.derive.form.steps import Search, Solve, Sum, search
from sebody.derive.form.whole import Whole
from sebody.derive.formulas import arrays
from sebody.derive.formulas.elastic import conjugate_to, virtual_work
from sebody.derive.formulas.frames.frame import (
    Condition,
    Frame,
    FrameOption,
    inverse_tangent_values,
    origin_stage,
    pulled_back,
)
from sebody.derive.formulas.kinematics import elastic_rotation_variation, local_displacement
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.symbolic.rotations import (
    cross,
    inverse_tangent_times,
    inverse_tangent_transposed_times,
)
from sebody.derive.symbolic.variation import check_same

GAM = Part("Gam", ("n", "turns"), "mean rotation of y, a column for each coordinate")


def mean_axes(q: Quantities) -> Frame:
    """Derive the frame."""
    conditions = _parts(q)
    of_position, of_rotation, of_mode = (part.weight for part in conditions)
    psi, r, wp = q.psi.symbols, q.X.symbols + q.u.symbols, q.wp.symbols
    dm, variation = q.space.d(q.qm), elastic_rotation_variation(q)

    def equation(rate: Quantity, x: Quantity, x0: Quantity, th: Quantity, m: Quantity
                 ) -> tuple[Sum, ...]:
        u = x.symbols - x0.symbols + cross(r, rate.symbols)
        turned = inverse_tangent_times(psi, th.symbols) - inverse_tangent_transposed_times(
            psi, rate.symbols)
        swap = dict(zip(
            [*q.dx.symbols, *q.dx0.symbols, *q.dth.symbols, *q.dth0.symbols],
            [*x.symbols, *x0.symbols, *th.symbols, *rate.symbols], strict=True))
        swap.pop(sp.S.Zero, None)
        check_same("variation of a displacement (17)", u,
                   local_displacement(q).short[0].subs(swap, simultaneous=True))
        check_same("variation of an elastic rotation (17)", turned,
                   variation.subs(swap, simultaneous=True))
        return (Sum("position", of_position * u), Sum("rotation", of_rotation * turned),
                Sum("mode", of_mode * sp.Matrix(m.kept)))

    def angular_rate(rate: Quantity, x: Quantity, x0: Quantity, th: Quantity, m: Quantity,
                     invert: bool) -> Solve:
        return Solve("mean rotation of the rates = 0", rate, equation(rate, x, x0, th, m),
                     sp.zeros(3, 1), "B", invert=invert)

    moments = of_position.T * wp, of_rotation.T * wp
    back = (Sum("position", cross(moments[0], r)),
            Sum("rotation", -inverse_tangent_times(psi, moments[1])))
    own = equation(q.dth0, q.dx, q.dx0, q.dth, dm)
    on_x, on_rotation, on_mode = (wp.dot(part.summand) for part in own)
    check_same("moment pulled back by the mean axes",
               -inverse_tangent_transposed_times(psi, moments[1]),
               -conjugate_to(on_rotation, q.dth.symbols))
    return Frame(
        locate=(_search(q), *inverse_tangent_values(q, q.psi, (q.e0, q.e1))),
        velocity=(origin_stage(q, q.v0, q.vs), angular_rate(q.Om0, q.vs, q.v0, q.Om, q.vm, True)),
        variation=(angular_rate(q.dth0, q.dx, q.dx0, q.dth, dm, False),),
        pull=(pulled_back(q, back, equation(q.wp, q.dx, q.dx0, q.dth, dm)),),
        work=virtual_work, position=-conjugate_to(on_x, q.dx.symbols),
        origin=-conjugate_to(on_x, q.dx0.symbols), on_psi=-moments[1],
        mode=-conjugate_to(on_mode, dm.kept), conditions=conditions)


def _parts(q: Quantities) -> tuple[Condition, Condition, Condition]:
    """The parts of displacements, rotations and modes in the mean rotation."""
    axes = AXES[:2] if q.space.planar else AXES
    turns = AXES[2:] if q.space.planar else AXES
    columns = {"position": [(axis, i3 + c) for c, axis in enumerate(axes)],
               "rotation": [(axis, j3 + c) for c, axis in enumerate(turns)]}
    parts = []
    for home, of in (("position", q.u), ("rotation", q.psi)):
        named = {axis: _column(q, home, place, axis) for axis, place in columns[home]}
        weight = sp.Matrix.hstack(*[named[axis].symbols if axis in named else sp.zeros(3, 1)
                                    for axis in AXES])
        parts.append(Condition(of, weight, tuple(named.values())))
    modal = _column(q, "mode", k)
    return *parts, Condition(q.ym, modal.symbols, (modal,))


def _column(q: Quantities, home: str, coordinate: Whole, axis: str = "") -> Quantity:
    """The mean rotation of one local coordinate."""
    return q.space.quantity(f"Gam_{home}{axis}", "axial", home, constant(GAM),
                            Place(axes_of(q.space.planar)["turns"] * coordinate))


def condition(q: Quantities) -> Condition:
    """The condition on all local coordinates."""
    of_one = _column(q, "coordinate", i)
    return Condition(q.space.quantity("y_all", "scalar", "coordinate", arrays.y), of_one.symbols,
                     (of_one,))


def _search(q: Quantities) -> Search:
    """The rotation of the frame, and those of the nodes in it."""
    psi, given = arrays.y.at(FIRST_ROTATION), (arrays.alphas, arrays.X, constant(GAM), arrays.qe)
    sizes, title = (POSITIONS, ROTATIONS, n), "rotation of the frame: mean axes"
    if q.space.planar:
        return search(title, PLANAR_MEAN_AXES, *sizes, *given, arrays.frame, psi, operations=200,
                      finds=q.R0)
    return search(title, MEAN_AXES, *sizes, arrays.nodes, *given, arrays.R, arrays.frame, psi,
                  operations=600, finds=q.R0)


FRAME = FrameOption(
    FrameTraits("axes in which the deformation has no moment of momentum: mean axes",
                needs_rotations=False, modes=True, constants=(GAM,)), mean_axes,
    "(14), and derive/formulas/frames/mean_axes.py", condition)
