"""The rotation of best fit of the node positions: ``sum w_j X_j x R0^T (x_j - x0) = 0``."""

import sympy as sp

from sebody.contract.traits import FrameTraits
from sebody.derive.form.counts import FIRST_ROTATION, POSITIONS, ROTATIONS
from sebody.derive.form.functions import (
    BEST_FIT,
    PLANAR_FIT,
    RELATIVE_ANGLES,
    RELATIVE_ROTATIONS,
)
from sebody.derive.form.spaces import Quantity
from sebody.derive.form.steps import Search, Solve, Sum, search
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
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.symbolic.rotations import cross, skew
from sebody.derive.symbolic.variation import along, check_same, differential, rotating


def positions(q: Quantities) -> Frame:
    """Derive the frame."""
    fit, X, u = q.fit.symbols[0], q.X.symbols, q.u.symbols
    r = X + u

    def equation(rate: Quantity, of: Quantity, origin: Quantity) -> sp.Matrix:
        short = fit * cross(X, of.symbols - origin.symbols + cross(r, rate.symbols))
        swap = dict(zip([*q.dx.symbols, *q.dx0.symbols, *q.dth0.symbols],
                        [*of.symbols, *origin.symbols, *rate.symbols], strict=True))
        swap.pop(sp.S.Zero, None)
        R0 = q.R0.symbols
        condition = fit * cross(X, R0.T * (q.x.symbols - q.x0.symbols))
        rules = rotating(R0, q.dth0.symbols)
        for fixed_axes, local in ((q.x, q.dx), (q.x0, q.dx0)):
            rules |= along(fixed_axes.symbols, R0 * local.symbols)
        chain = differential(condition, rules).subs(swap)
        local = {s: e for s, e in zip(u, R0.T * (q.x.symbols - q.x0.symbols) - X, strict=True)
                 if isinstance(s, sp.Symbol)}
        check_same("variation of the rotation of best fit", short.subs(local), chain, [R0])
        return short

    def angular_rate(rate: Quantity, of: Quantity, origin: Quantity, invert: bool) -> Solve:
        return Solve("sum w_j X_j x (rate of r_j) = 0", rate,
                     (Sum("position", equation(rate, of, origin)),), sp.zeros(3, 1), "B",
                     invert=invert)

    work = q.wp.symbols.dot(equation(q.dth0, q.dx, q.dx0))
    return Frame(
        locate=(*_searches(q), *inverse_tangent_values(q, q.psi, (q.e0, q.e1))),
        velocity=(origin_stage(q, q.v0, q.vs), angular_rate(q.Om0, q.vs, q.v0, True)),
        variation=(angular_rate(q.dth0, q.dx, q.dx0, False),),
        pull=(pulled_back(q, (Sum("position", fit * cross(r, cross(X, q.wp.symbols))),),
                          (Sum("position", equation(q.wp, q.dx, q.dx0)),)),),
        work=virtual_work, position=-conjugate_to(work, q.dx.symbols),
        origin=-conjugate_to(work, q.dx0.symbols), rotation=sp.zeros(3, 1),
        conditions=(condition(q),))


def condition(q: Quantities) -> Condition:
    """The condition on the displacements."""
    return Condition(q.u, q.fit.symbols[0] * skew(q.X.symbols), (q.fit, q.X))


def _searches(q: Quantities) -> tuple[Search, Search]:
    """The fit, and the rotations of the nodes in the frame."""
    psi, planar = arrays.y.at(FIRST_ROTATION), q.space.planar
    fit = search("rotation of the frame: best fit of the positions",
                 PLANAR_FIT if planar else BEST_FIT, POSITIONS, arrays.fits, arrays.X,
                 arrays.alphas, arrays.qe, arrays.frame, operations=300, finds=q.R0)
    title = "elastic rotations, (11)"
    if planar:
        angles = arrays.qe.at(FIRST_ROTATION)
        return fit, search(title, RELATIVE_ANGLES, ROTATIONS, angles, arrays.frame, psi,
                           operations=60)
    return fit, search(title, RELATIVE_ROTATIONS, ROTATIONS, arrays.nodes, arrays.R, arrays.frame,
                       psi, operations=60)


FRAME = FrameOption(
    FrameTraits("rotation of best fit of the node positions", needs_rotations=False,
                fewest_positions=(3, 2)), positions,
    "(14), and derive/formulas/frames/positions.py", condition)
