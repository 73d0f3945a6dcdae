"""Forces conjugate to the local coordinates and to the frame, as forces on the unknowns.

What acts on a body's local coordinates also acts on its frame, since these move with it; the moment
on the frame is pulled back through the frame's variation.
"""

from collections.abc import Callable

import sympy as sp

from sebody.derive.form.spaces import Quantity
from sebody.derive.form.steps import Role, Solve, Stage
from sebody.derive.formulas.frames.frame import Frame
from sebody.derive.formulas.inertia.option import Inertia
from sebody.derive.formulas.quantities import Quantities

NONE = sp.zeros(3, 1)
MASSLESS = Inertia((), (), NONE, NONE, NONE, NONE, NONE, {}, (), None)


def forces_on_unknowns(q: Quantities, frame: Frame, share: sp.Matrix, on_frame: Stage,
                       inertia: Inertia = MASSLESS) -> tuple[Stage | Solve, ...]:
    """Steps from the forces f, m and fm conjugate to the local coordinates.

    Parameters
    ----------
    share : Matrix
        Further force on the origin of the frame.
    on_frame : Stage
        Further moment on the frame.
    """
    work, R0, h, alpha = frame.work(q), q.R0.symbols, q.h.symbols, q.alpha.symbols[0]
    origin = [Stage("force on the origin, through the frame", "position",
                    adds=((q.F, frame.origin),), continues=True)] if any(frame.origin) else []
    on_mean = [Stage("moment on the mean of the variations, (20)", "rotation",
                     adds=((q.Ms, work.mean),))] if work.mean else []
    of_mean = q.alpha_r.symbols[0] * q.Ms.symbols if work.mean else sp.zeros(3, 1)
    # one map for the sum of what is conjugate to psi_j
    of_psi = work.rotation.xreplace({m: m + more for m, more in zip(q.m.symbols, frame.on_psi,
                                                                    strict=True) if more != 0})
    return (
        Stage("forces on the frame: elastic (30) and inertia (57)", "position",
              adds=((q.F, work.origin + alpha * share),
                    (q.W, work.frame_positions + inertia.frame_positions))),
        on_frame,
        Stage("moments on the frame: elastic (30) and inertia (45)", "rotation",
              adds=((q.W, work.frame_rotations + inertia.frame_rotations),), continues=True),
        *frame.pull, *origin, *on_mean,
        Stage("force on the nodes in frame axes, (30), (57)", "position",
              sets=((q.h, work.position + inertia.position + frame.position
                     + alpha * q.F.symbols),)),
        Stage("force on the nodes", "position", sets=((q.gx, R0 * h),), role=Role.NODE_FORCE),
        Stage("moment on the nodes, (30), (57)", "rotation",
              sets=((q.gt, of_psi + inertia.rotation + frame.rotation + of_mean),)),
        Stage("force of the internal modes", "mode",
              sets=((q.gm, q.fm.symbols + frame.mode + (
                  q.pmd.symbols if inertia.products else sp.zeros(1, 1))),)),)


def forces_on_coordinates(q: Quantities, rows: Callable[[str], list[sp.Matrix]], f: sp.Matrix
                          ) -> tuple[Stage, ...]:
    """Forces conjugate to the local coordinates, of a force f on what moves by rows of them.

    `rows` gives what each coordinate of a position, a rotation or a mode adds to that motion.
    """
    return tuple(
        Stage(f"forces conjugate to the local coordinates: {home}s", home, sets=((of, _filled(
            of, [row.dot(f) for row in rows(home)])),))
        for home, of in (("position", q.f), ("rotation", q.m), ("mode", q.fm)))


def _filled(of: Quantity, values: list[sp.Expr]) -> sp.Matrix:
    """Components where a quantity has some, zero elsewhere."""
    found = iter(values)
    return sp.Matrix([next(found) if isinstance(s, sp.Symbol) else 0 for s in of.symbols])
