"""The superelement kernel of a layout, a frame and an inertia option, step by step.

    locate the frame -> local coordinates and velocities -> Sbar y, Mbar ydot, Mbar yddot
    -> moment on the frame, pulled back -> forces on the unknowns
"""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import sympy as sp

from sebody.contract.layout import DAMPING_CONSTANTS, SUPERELEMENT_CONSTANTS, Part
from sebody.contract.names import superelement_name
from sebody.derive.form.arrays import Array
from sebody.derive.form.spaces import Space
from sebody.derive.form.statements import Let
from sebody.derive.form.steps import Damping, Role, Solve, Stage, Step, Sum
from sebody.derive.formulas.damping import damping, linearized_damping
from sebody.derive.formulas.elastic import ELASTIC, conjugate_to
from sebody.derive.formulas.frames.frame import Frame, FrameOption, origin_stage
from sebody.derive.formulas.gravity import TAKEN_OFF, Gravity, gravity, linearized
from sebody.derive.formulas.inertia.option import Inertia, InertiaOption, Local
from sebody.derive.formulas.inertia.rates import rigid_angle
from sebody.derive.formulas.kinematics import local_displacement, local_velocity
from sebody.derive.formulas.pulled_back import forces_on_unknowns
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.kernels.layouts import Layout, check_frame, check_inertia
from sebody.derive.kernels.options import (
    FRAMES,
    INERTIA_OPTIONS,
    frame_traits,
    inertia_traits,
)
from sebody.derive.passes.linearize import Linearizer
from sebody.derive.passes.lower import Names
from sebody.derive.symbolic.rotations import cross, stumpff, tangent_inverse


class Formulas(NamedTuple):
    """Steps at node level, the same for every layout."""

    q: Quantities
    frame: Frame
    inertia: Inertia
    local: Local
    before: tuple[Stage | Solve, ...]   # from the frame to local velocities and accelerations
    after: tuple[Stage | Solve, ...]    # from local forces to those on the unknowns

    @property
    def residual(self) -> tuple[Step, ...]:
        """All steps of the forces."""
        q = self.q
        return (origin_stage(q, q.x0, q.x), *self.frame.locate, *self.before, *self.local.forces,
                *self.after)


class Superelement(NamedTuple):
    """Description of a kernel: what is linearized and printed."""

    layout: Layout
    frame: str
    inertia: str
    options: tuple[FrameOption, InertiaOption]
    formulas: Formulas
    residual: tuple[Step, ...]
    energy: tuple[Step, ...]
    prepared: tuple[Step, ...]          # of the matrix, once for all columns
    tangent: tuple[Step, ...] = ()      # of one column

    @property
    def name(self) -> str:
        """Module name of the kernel."""
        return superelement_name(self.layout.name, self.frame, self.inertia)

    @property
    def space(self) -> Space:
        """The space in which it moves."""
        return self.formulas.q.space

    @property
    def names(self) -> Names:
        """Opaque functions and the symbols that hold their values."""
        return opaque_names(self.formulas.q)

    @property
    def declared(self) -> tuple[Part, ...]:
        """Constants that its frame and inertia option read in addition."""
        return tuple(part for option in self.options for part in option.traits.constants)

    @property
    def constants(self) -> tuple[Part, ...]:
        """The row of constants."""
        return SUPERELEMENT_CONSTANTS + DAMPING_CONSTANTS * self.layout.damped + self.declared

    @property
    def read(self) -> dict[Array, tuple[Let, ...]]:
        """Counts that its inertia option reads from constants, by the array of these."""
        return self.options[1].read(self.layout.planar)


def superelement(layout: Layout, frame: str, inertia: str) -> Superelement:
    """Derive the forces and energies of a layout, frame and inertia option.

    Raises
    ------
    LayoutError
        If the layout cannot carry the frame, or the inertia option cannot have it.
    """
    check_frame(layout, frame, frame_traits())
    check_inertia(layout, frame, inertia, frame_traits(), inertia_traits())
    options = FRAMES[frame], INERTIA_OPTIONS[inertia]
    formulas = node_formulas(layout.planar, *options)
    return Superelement(layout, frame, inertia, options, formulas,
                        kept(formulas.residual, layout), kept(formulas.local.energy, layout),
                        kept(formulas.local.prepared, layout))


def kept(steps: tuple[Step, ...], layout: Layout) -> tuple[Step, ...]:
    """Steps without those over rotations or of damping, where a layout has none."""
    def has(part: Step | Sum) -> bool:
        return layout.rotations != 0 or getattr(part, "over", "") != "rotation"

    def of_layout(step: Step) -> Step:
        if isinstance(step, Damping):
            return step._replace(steps=kept(step.steps, layout))
        if isinstance(step, Solve):
            return step._replace(sums=tuple(filter(has, step.sums)))
        return step
    return tuple(of_layout(s) for s in steps
                 if has(s) and (layout.damped or not isinstance(s, Damping)))


@cache
def node_formulas(planar: bool, frame: FrameOption, inertia: InertiaOption) -> Formulas:
    """Derive the steps at node level."""
    q = Quantities(Space(planar))
    chosen, option = frame.derive(q), inertia.derive(q)
    local = (option.local or _of_nodes(option))(q, chosen)
    before = local_displacement(q), local_velocity(q), *local.motion
    return Formulas(q, chosen, option, local, before,
                    forces_on_unknowns(q, chosen, local.share, local.on_frame, option))


def _of_nodes(inertia: Inertia) -> Callable[[Quantities, Frame], Local]:
    """Local forces from momenta of the nodes and modes, ``Mbar ydot``."""
    def local(q: Quantities, frame: Frame) -> Local:
        weight = gravity(q)
        modes = Stage("internal modes", "mode",
                      sets=((q.ym, q.qm.symbols), (q.ydm, q.vm.symbols), (q.yddm, q.am.symbols)))

        def column(chain: Linearizer, velocities: tuple[Step, ...]) -> tuple[Step, ...]:
            steps: list[Step] = [*linearized(q, weight, chain), TAKEN_OFF.differential()]
            for quantity in (q.f, q.m, q.fm):
                chain.move(quantity)
            steps += [chain.step(step) for step in velocities if step.role is not Role.BY_RULE]
            steps.append(linearized_damping(q, chain))
            steps += [product.differential() for product in inertia.products]
            for quantity in (q.px, q.pw, q.pxd, q.pwd, q.pmd):
                chain.move(quantity)
            return tuple(steps)
        return Local(
            motion=(*inertia.velocity, *frame.velocity, *inertia.acceleration, modes),
            forces=(*weight.before, ELASTIC, *weight.products, TAKEN_OFF, damping(q),
                    *inertia.products),
            share=weight.origin,
            on_frame=Stage("moment of gravity on the frame", "element",
                           adds=((q.W, weight.on_frame),), continues=True),
            energy=_energy(q, inertia, weight), prepared=(), held=(ELASTIC.differential(),),
            column=column)
    return local


def _energy(q: Quantities, inertia: Inertia, weight: Gravity) -> tuple[Stage, ...]:
    """Potential of gravity; momentum and its moment: conjugate to rigid motions of the body."""
    e, push = q.space.quantity("e", "axial", "element"), q.space.quantity("e_v", "vector",
                                                                          "element")
    R0, p, x = q.R0.symbols, q.px.symbols, q.x.symbols
    of_positions = p.dot(R0.T * (push.symbols + cross(e.symbols, x)))
    of_rotations = inertia.spin.dot(q.R.symbols.T * e.symbols)
    one = sp.Matrix([weight.potential]), sp.Matrix([weight.strain])
    return (Stage("energies", "element", sets=((q.potential, one[0]),), adds=((q.strain, one[1]),),
                  continues=True),
            Stage("momentum and its moment about the origin: positions", "position",
                  adds=((q.P, conjugate_to(of_positions, push.symbols)),
                        (q.H, conjugate_to(of_positions, e.symbols)))),
            Stage("moment of momentum: rotations", "rotation",
                  adds=((q.H, conjugate_to(of_rotations, e.symbols)),), continues=True))


def opaque_names(q: Quantities) -> Names:
    """Functions that SymPy keeps whole, and the symbols that hold their values."""
    names = {}
    for vector, values in ((q.psi, (q.e0, q.e1, q.e2)), (q.beta, (q.b0, q.b1))):
        s = vector.symbols.dot(vector.symbols)
        names |= {tangent_inverse(k, s): value.symbols[0] for k, value in enumerate(values)}
    s, carried = (v.symbols.dot(v.symbols) for v in (q.beta0, rigid_angle(q)))
    names |= {stumpff(k, s): getattr(q, f"c{k}").symbols[0] for k in range(2, 6)}
    return names | {stumpff(k, carried): getattr(q, f"r{k}").symbols[0] for k in range(1, 8)}
