"""The superelement kernel of a layout, a frame and an inertia option, stage by stage.

    locate the frame -> local coordinates and velocities -> Sbar y, Mbar ydot, Mbar yddot
    -> moment on the frame, pulled back -> forces on the unknowns

The tangent is the differential of these stages in the direction of each unknown in turn.
"""

from functools import cache
from typing import NamedTuple

import sympy as sp

from sebody.derive.formulas.damping import damping, linearized_damping
from sebody.derive.formulas.elastic import VirtualWork, _of, virtual_work, virtual_work_small
from sebody.derive.formulas.frames import FRAMES, Frame, origin_stage, relative_rotation
from sebody.derive.formulas.gravity import Gravity, gravity, linearized, taken_off
from sebody.derive.formulas.inertia import OPTIONS, Inertia, relative_turning
from sebody.derive.formulas.kinematics import (
    elastic_rotation_variation,
    local_displacement,
    local_velocity,
    unknown_rules,
)
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.kernels.layouts import Layout, LayoutError
from sebody.derive.symbolic.spaces import Space
from sebody.derive.symbolic.steps import (
    Damping,
    Linearizer,
    Product,
    Stage,
    Step,
    Text,
    along_own,
    cross,
)
from sebody.derive.symbolic.variation import check_same, differential
from sebody.kernels.names import superelement_name


class Superelement(NamedTuple):
    """Description of a kernel: what the printer turns into text."""

    layout: Layout
    space: Space
    frame: Frame
    inertia: Inertia
    names: dict                 # opaque functions -> symbols that hold their values
    residual: tuple[Step, ...]
    energy: tuple[Step, ...]
    tangent: tuple[Step, ...]   # of one column

    @property
    def name(self) -> str:
        """Module name of the kernel."""
        return superelement_name(self.layout.name, self.frame.name, self.inertia.name)


def superelement(layout: Layout, frame: str, inertia: str) -> Superelement:
    """Derive the kernel of a layout, frame and inertia option.

    Raises
    ------
    LayoutError
        If the layout cannot carry the frame.
    """
    if frame != "positions" and not layout.rotations:
        raise LayoutError(f"layout {layout.name} keeps no rotation, so the frame {frame!r} has "
                          "nothing to average: use the frame 'positions'")
    if frame == "positions" and layout.positions < (2 if layout.planar else 3):
        raise LayoutError(f"layout {layout.name} has too few positions for the frame 'positions', "
                          "which needs three nodes (two in a plane): use 'converged_mean'")
    if layout.planar and frame in ("mean", "mean_small"):
        raise LayoutError(f"in a plane the frame {frame!r} coincides with 'converged_mean': use "
                          "that one")
    q, chosen, option, parts = _derived(layout.planar, frame, inertia)
    steps = [_kept(part, layout) for part in parts]
    return Superelement(layout, q.space, chosen, option, _names(q), *steps)


def _kept(part, layout: Layout) -> tuple[Step, ...]:
    """Steps without those over rotations or of damping, where a layout has none."""
    kept = [s for s in part if (layout.rotations or getattr(s, "over", "") != "rotation")
            and (layout.damped or not isinstance(s, Damping))]
    return tuple(s._replace(steps=_kept(s.steps, layout)) if isinstance(s, Damping) else s
                 for s in kept)


@cache
def _derived(planar: bool, frame: str, inertia: str):
    """Stages at node level, the same for every layout: residual, energy and tangent."""
    q = Quantities(Space(planar))
    chosen, option = FRAMES[frame](q), OPTIONS[inertia](q)
    moved = q.vs if frame == "positions" else q.Om
    varied = q.dx if frame == "positions" else q.dth
    work = virtual_work_small(q) if chosen.small else virtual_work(q)
    weight = gravity(q)
    before = _motion(q, chosen, option, moved)
    after = _forces(q, chosen, option, work, weight)
    elastic, *inertia = PRODUCTS
    residual = [origin_stage(q, q.x0, q.x), *chosen.locate, *before, *weight.before, elastic,
                *weight.products, taken_off(""), damping(q), *inertia, *after]
    tangent = _tangent(q, chosen, varied, before, after, weight)
    return q, chosen, option, (residual, _energy(q, option, weight), tangent)


NODE_FORCE = "force on the nodes"
PRODUCTS = (Product("elastic force, s = Sbar y", "S", "y", "s"),
            Product("momentum, p = Mbar ydot", "M", "yd", "p"),
            Product("inertia force, pd = Mbar yddot", "M", "ydd", "pd"))


def _motion(q: Quantities, frame: Frame, option: Inertia, moved) -> list[Step]:
    relative = [relative_rotation(q)] if option.name == "a" else []
    return [local_displacement(q), local_velocity(q), *relative, option.velocity,
            *frame.rate(q.Om0, moved, True), *option.acceleration,
            Stage("internal modes", "mode",
                  sets=((q.ym, q.qm.symbols), (q.ydm, q.vm.symbols), (q.yddm, q.am.symbols)))]


def _forces(q: Quantities, frame: Frame, option: Inertia, work: VirtualWork,
            weight: Gravity) -> list[Step]:
    R0, h, alpha = q.R0.symbols, q.h.symbols, q.alpha.symbols[0]
    origin = [Stage("force on the origin, through the frame", "position",
                    adds=((q.F, frame.origin),), continues=True)] if any(frame.origin) else []
    on_mean = [Stage("moment on the mean of the variations, (20)", "rotation",
                     adds=((q.Ms, work.mean),))] if work.mean else []
    of_mean = q.alpha_r.symbols[0] * q.Ms.symbols if work.mean else sp.zeros(3, 1)
    return [
        Stage("forces on the frame: elastic (30) and inertia (57)", "position",
              adds=((q.F, work.origin + alpha * weight.origin),
                    (q.W, work.frame_positions + option.frame_positions))),
        Stage("moment of gravity on the frame", "element", adds=((q.W, weight.on_frame),),
              continues=True),
        Stage("moments on the frame: elastic (30) and inertia (45)", "rotation",
              adds=((q.W, work.frame_rotations + option.frame_rotations),), continues=True),
        *frame.pull, *origin, *on_mean,
        Stage("force on the nodes in frame axes, (30), (57)", "position",
              sets=((q.h, work.position + option.position + frame.position
                     + alpha * q.F.symbols),)),
        Stage(NODE_FORCE, "position", sets=((q.gx, R0 * h),)),
        Stage("moment on the nodes, (30), (57)", "rotation",
              sets=((q.gt, work.rotation + option.rotation + frame.rotation + of_mean),)),
        Stage("force of the internal modes", "mode",
              sets=((q.gm, q.fm.symbols + q.pmd.symbols),)),
    ]


def _tangent(q: Quantities, frame: Frame, varied, before, after, weight) -> list[Step]:
    """Differential of all stages: first the local coordinates, then everything else."""
    d = q.space.d
    chain = Linearizer(q.space, unknown_rules(q) | along_own(q.space, q.qm)
                       | along_own(q.space, q.vm) | along_own(q.space, q.am)
                       | relative_turning(q.Q.symbols, q.dth.symbols, q.dth0.symbols))
    skipped = ("rotation of the node in the frame",)
    steps: list[Step] = [origin_stage(q, q.dx0, q.dx), *frame.rate(q.dth0, varied, False),
                         chain.stage(before[0])]
    steps.append(Stage("variation of the elastic rotations, (17)", "rotation",
                       sets=((d(q.psi), elastic_rotation_variation(q)),)))
    steps.append(Stage("differential: internal modes", "mode",
                       sets=((d(q.ym), d(q.qm).symbols),)))
    for quantity in (q.psi, q.ym, q.beta, q.beta0):
        chain.move(quantity)
    elastic, *inertia = PRODUCTS
    steps += [elastic.differential(), _geometric_switch(q), *frame.differentials,
              *linearized(q, weight, chain), taken_off("d")]
    for quantity in (q.f, q.m, q.fm):
        chain.move(quantity)
    for step in before[1:]:
        if step.title not in skipped:
            steps.append(chain.solve(step) if hasattr(step, "unknown") else chain.stage(step))
    steps.append(linearized_damping(q, chain))
    steps += [product.differential() for product in inertia]
    for quantity in (q.px, q.pw, q.pxd, q.pwd, q.pmd):
        chain.move(quantity)
    for step in after:
        steps.append(chain.solve(step) if hasattr(step, "unknown") else
                     _in_frame_axes(q, chain, step) if step.title == NODE_FORCE else
                     chain.stage(step))
    return steps


def _in_frame_axes(q: Quantities, chain: Linearizer, step: Stage) -> Stage:
    """Differential of the force on the nodes, turned into frame axes: what the matrix holds."""
    R0, h = q.R0.symbols, q.h.symbols
    short = q.space.d(q.h).symbols + cross(q.dth0.symbols, h)
    check_same("force on the nodes in frame axes", short,
               R0.T * differential(step.sets[0][1], chain.rules), [R0])
    return Stage("differential: force on the nodes, left in frame axes", "position",
                 sets=((q.space.d(q.gx), short),))


def _geometric_switch(q: Quantities) -> Text:
    """Between the paper's tangent (31), (48)-(51), (60)-(63) and the consistent one."""
    lines = [f"{s} *= c_geo" for s in q.dth0.kept]
    return Text("c_geo = 0 leaves the paper's tangents (31), (60)-(63): geometry held fixed here",
                ("for i in range(n):", "    dy[i] *= c_geo", "    dqe[i] *= c_geo", *lines))


def _energy(q: Quantities, option: Inertia, weight: Gravity) -> list[Step]:
    """Potential of gravity; momentum and its moment: conjugate to rigid motions of the body."""
    e, push = q.space.quantity("e", "axial", "element"), q.space.quantity("e_v", "vector",
                                                                          "element")
    R0, p, x = q.R0.symbols, q.px.symbols, q.x.symbols
    of_positions = p.dot(R0.T * (push.symbols + cross(e.symbols, x)))
    of_rotations = option.spin.dot(q.R.symbols.T * e.symbols)
    one = sp.Matrix([weight.potential]), sp.Matrix([weight.strain])
    return [Stage("energies", "element", sets=((q.potential, one[0]),), adds=((q.strain, one[1]),),
                  continues=True),
            Stage("momentum and its moment about the origin: positions", "position",
                  adds=((q.P, _of(of_positions, push.symbols)),
                        (q.H, _of(of_positions, e.symbols)))),
            Stage("moment of momentum: rotations", "rotation",
                  adds=((q.H, _of(of_rotations, e.symbols)),), continues=True)]


def _names(q: Quantities) -> dict[sp.Expr, sp.Symbol]:
    from sebody.derive.symbolic.rotations import stumpff, tangent_inverse
    names = {}
    for vector, values in ((q.psi, (q.e0, q.e1)), (q.beta, (q.b0, q.b1))):
        s = vector.symbols.dot(vector.symbols)
        names |= {tangent_inverse(k, s): value.symbols[0] for k, value in enumerate(values)}
    s = q.beta0.symbols.dot(q.beta0.symbols)
    return names | {stumpff(k, s): getattr(q, f"c{k}").symbols[0] for k in range(2, 6)}
