"""A load on a body that turns with the body's frame.

A load on the FE model of a body is reduced to forces on its boundary nodes and modes, ``P = Phi^T
p``. A series of loads has columns C_k with amplitudes s_k of its own. With the rotation ``R_0`` of
the frame, the amplitude a and the whole load ``L = a P + sum_k s_k C_k`` their virtual work is

    sum L_i . R_0^T delta x_i + sum L_j . R_0^T delta theta_j + sum L_k delta y_k

delta theta_j being the variation of a node's rotation in global axes. The forces act on the nodes
where these are, so in any rigid motion the work is that of the load itself, and no force is left on
the frame: only the matrix needs its variation.
"""

from functools import cache
from typing import NamedTuple

import sympy as sp

from sebody.contract.layout import Part
from sebody.derive.form.arrays import Place, constant, pointed, scratch
from sebody.derive.form.counts import agreed, first, n, series
from sebody.derive.form.spaces import Space
from sebody.derive.form.steps import Invert, Product, Solve, Stage, Step
from sebody.derive.formulas import arrays
from sebody.derive.formulas.frames.frame import Frame, FrameOption, origin_stage
from sebody.derive.formulas.inertia.option_a import relative_rotating, relative_rotation
from sebody.derive.formulas.kinematics import local_displacement, unknown_rules
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.passes.linearize import Linearizer
from sebody.derive.symbolic.rotations import cross
from sebody.derive.symbolic.variation import check_same, differential

LOAD = Part("P", ("n",), "load on the local coordinates, of amplitude one")
COLUMNS = Part("columns", ("n", "series"), "loads on the local coordinates by each column of a "
               "series", columns=True)
AMPLITUDES = pointed("amplitudes", series)      # of the columns
_BY_COLUMNS = scratch("L")


class Steps(NamedTuple):
    """At node level, the same for every layout."""

    q: Quantities
    residual: tuple[Step, ...]
    prepared: tuple[Step, ...]      # of the matrix, once for all columns
    tangent: tuple[Step, ...]       # of one column


@cache
def body_load(planar: bool, frame: FrameOption) -> Steps:
    """Derive the steps in a frame."""
    q = Quantities(Space(planar))
    chosen, amplitude = frame.derive(q), _amplitude(q.space)
    on_position, on_rotation, on_mode = (
        amplitude * q.space.quantity(f"P_{home}", kind, home, constant(LOAD)).symbols
        + q.space.quantity(f"L_{home}", kind, home, _BY_COLUMNS).symbols
        for kind, home in (("vector", "position"), ("axial", "rotation"), ("scalar", "mode")))
    h, R0 = q.h.symbols, q.R0.symbols
    # an angle in a plane has the same axis in all frames
    turned = on_rotation if planar else q.Q.symbols.T * on_rotation
    relative = () if planar else (relative_rotation(q),)
    on_rotations = Stage("moment on the nodes, material", "rotation",
                         sets=((q.gt, -turned),))
    on_modes = Stage("force on the modes", "mode", sets=((q.gm, -on_mode),))
    residual = (
        Product("load by the columns of a series", constant(COLUMNS), AMPLITUDES, _BY_COLUMNS, n,
                series),
        *chosen.locate, *relative,
        Stage("force on the nodes in frame axes", "position",
              sets=((q.h, -on_position),)),
        Stage("force on the nodes", "position", sets=((q.gx, R0 * h),)), on_rotations, on_modes)
    inverses = tuple(Invert(step) for step in chosen.velocity if isinstance(step, Solve))
    if frame.traits.needs_rotations:        # the frame turns with rotations alone
        return Steps(q, residual, inverses, _column(q, chosen, on_rotations, on_modes))
    place = origin_stage(q, q.x0, q.x), local_displacement(q)
    moved = origin_stage(q, q.dx0, q.dx)
    return Steps(q, residual, (*place, *inverses),
                 (moved, *_column(q, chosen, on_rotations, on_modes)))


def _column(q: Quantities, chosen: Frame, on_rotations: Stage, on_modes: Stage) -> tuple[Step, ...]:
    """Differentials: the forces turn with the frame, moments also against their nodes."""
    rules = unknown_rules(q)
    if not q.space.planar:
        rules |= relative_rotating(q.Q.symbols, q.dth.symbols, q.dth0.symbols)
    chain, d, R0, h = Linearizer(q.space, rules), q.space.d, q.R0.symbols, q.h.symbols
    turning = cross(q.dth0.symbols, h)
    check_same("load on the nodes in frame axes", turning, R0.T * differential(R0 * h, rules), [R0])
    return (*chosen.variation,
            Stage("differential: force on the nodes, left in frame axes", "position",
                  sets=((d(q.gx), turning),)),
            chain.stage(on_rotations), chain.stage(on_modes))


def _amplitude(space: Space) -> sp.Symbol:
    """The time function's value, at its power port."""
    return space.quantity("amplitude", "scalar", "element", arrays.loads,
                          Place(3 * arrays.index[first + agreed("AT_PORT")])).symbols[0]
