"""Option D: a rigid body on a frame of its own, and a constant mass on the rates of deformation.

For bodies of which the reduced mass and stiffness are known and nothing else. A displacement is
split into its rigid part, which turns exactly, and a rest that is orthogonal to it in the mass and
does not turn. So T is positive, indifferent to a superposed velocity, and at rest that of Mbar;
what it lacks is the inertia of the deformed shape, and geometric stiffness.

Everything is conjugate to y, to the origin and to the rotation of the frame, as in option C, with
the first moment of mass and the mean rotation of y as the only products of constants with
coordinates beyond those with the reduced matrices.
"""

from typing import NamedTuple

import sympy as sp

from sebody.contract.counts import axes_of
from sebody.contract.layout import Part
from sebody.contract.traits import InertiaTraits
from sebody.derive.form.arrays import Array, Place, constant, scratch
from sebody.derive.form.counts import damped, n, padded
from sebody.derive.form.functions import ADD_BLOCK_TIMES, STUMPFF_1_TO_7
from sebody.derive.form.spaces import Quantity
from sebody.derive.form.statements import Let
from sebody.derive.form.steps import Call, Product, Role, Shift, Stage, Step, Values, call
from sebody.derive.form.whole import Number, Truncated
from sebody.derive.formulas import arrays
from sebody.derive.formulas.elastic import ELASTIC
from sebody.derive.formulas.frames.frame import Frame
from sebody.derive.formulas.inertia import rigid_part as rigid
from sebody.derive.formulas.inertia.floating_field import Motion
from sebody.derive.formulas.inertia.option import Inertia, InertiaOption, Local
from sebody.derive.formulas.inertia.rates import (
    MOVING,
    RIGID,
    STRAINED,
    Form,
    energies_stage,
    form_value,
    frame_motion,
    on_frame_stage,
    quadratic_forms,
    second_derivatives,
)
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.passes.linearize import Linearizer

INERTIAL = Product("inertia force of deformation, Mbar yddot", arrays.M, arrays.etad,
                   arrays.pd)
ADDED = Shift("force conjugate to y, elastic and of inertia", arrays.s, arrays.pd)
ROWS = tuple(zip((arrays.y, arrays.eta, arrays.etad), RIGID, strict=True))
PARTS = (
    Part("columns", (1,), "columns of C: n of a damped body, else none"),
    Part("Jc", ("pairs",), "moments of inertia about the centre of mass, at rest"),
    Part("rigid_rows", ("motions", "n"),
         "S1, then Gam: first moment of mass and mean rotation of y", columns=True),
    Part("rigid_columns", ("n", "motions"), "their transpose", columns=True),
    Part("C", ("n", "damped"), "reduced damping", columns=True))
COLUMNS, JC, RIGID_ROWS, RIGID_COLUMNS, DAMPING = map(constant, PARTS)
CARRIED = scratch("carried")        # forces on the rigid parts


def option_d(q: Quantities) -> Inertia:
    """The option: no forces of the nodes' own, everything through the local coordinates."""
    none = sp.zeros(3, 1)
    return Inertia((), (), none, none, none, none, none, {}, (), None, carried)


def carried(q: Quantities, frame: Frame) -> Local:
    """Derive the steps in a frame."""
    rigid.prove()
    return _Carried(q, frame).local()


class _Rigid(NamedTuple):
    """The rigid part of a row of local coordinates."""

    first: Quantity
    angle: Quantity


class _Carried:
    """Quantities of the rigid part, and the steps that compute them."""

    def __init__(self, q: Quantities, frame: Frame):
        self.q, self.frame = q, frame
        axes = axes_of(q.space.planar)
        self.motions, D = Number(axes["motions"]), axes["D"]
        self.parts = [_Rigid(self.of_element(f"first{t}", "vector", out),
                             self.of_element(f"angle{t}", "axial", out, D))
                      for t, (_, out) in enumerate(ROWS)]
        (d, phi), (dd, phi_d), (ddd, phi_dd) = [
            (part.first.symbols, part.angle.symbols) for part in self.parts]
        self.y = rigid.Deformation(q.mc.symbols + d, dd, ddd, phi, phi_d, phi_dd)
        self.motion = Motion(q.mass.symbols[0], q.v0.symbols, q.a0.symbols - q.gamma.symbols,
                             q.Om0.symbols, q.Om0d.symbols)
        self.J = self.of_element("Jc", "inertia", JC).symbols
        self.w, self.wd, self.moment, self.on_frame = (
            q.space.quantity(name, "axial", "element") for name in ("wc", "wcd", "Mc", "Rr"))
        self.on_origin = q.space.quantity("Rt", "vector", "element")
        self.turning = rigid.Turning(self.w.symbols, self.wd.symbols, self.moment.symbols)
        self.pull = (self.of_element("on_first", "vector", CARRIED),
                     self.of_element("on_angle", "axial", CARRIED, D))

    def of_element(self, name: str, kind: str, array: Array, first: int = 0) -> Quantity:
        return self.q.space.quantity(name, kind, "element", array, Place(first))

    def local(self) -> Local:
        """All steps."""
        q = self.q
        return Local(
            motion=frame_motion(q, self.frame), forces=self.forces(), share=sp.zeros(3, 1),
            on_frame=on_frame_stage(q, self.on_origin.symbols, self.on_frame.symbols),
            energy=self.energy(), prepared=second_derivatives(q),
            held=(ELASTIC.differential(),), column=self.column)

    def forces(self) -> tuple[Step, ...]:
        """Elastic and inertia forces conjugate to y, and those on the frame."""
        return (ELASTIC, INERTIAL, ADDED, *self.rigid_rows(), *self.coefficients(),
                *self.stages(), *self.added(arrays.s, CARRIED, arrays.eta))

    def rigid_rows(self, differential: bool = False) -> tuple[Product, ...]:
        """First moment of mass and mean rotation of y and its rates, or of their differentials."""
        rows = [(row.d, out.d) for row, out in ROWS] if differential else ROWS
        return tuple(Product(f"rigid part of {row.name}", RIGID_ROWS, row, out, self.motions, n)
                     for row, out in rows)

    def coefficients(self) -> tuple[Values, ...]:
        """Values of the coefficients of exp and T, in space."""
        q = self.q
        if q.space.planar:
            return ()
        return (Values("coefficients of exp(phi) and T(phi), and for their derivatives",
                       tuple(getattr(q, f"r{k}") for k in range(1, 8)), STUMPFF_1_TO_7,
                       self.parts[0].angle, 60),)

    def stages(self) -> tuple[Stage, ...]:
        """The rigid part as a body."""
        m, y, t, J = self.motion, self.y, self.turning, self.J
        force = self.on_origin.symbols
        return (
            Stage("angular velocity of the rigid part", "element",
                  sets=((self.w, rigid.spin(m, y)),)),
            Stage("its rate", "element", sets=((self.wd, rigid.spin_rate(m, y)),)),
            Stage("rate of its momentum and of the moment of it", "element",
                  sets=((self.on_origin, rigid.on_origin(m, y)),
                        (self.moment, rigid.moment(J, t)))),
            Stage("moment on the frame, forces on the first moment and mean rotation", "element",
                  sets=((self.on_frame, rigid.on_frame(m, y, force, t)),
                        (self.pull[0], rigid.on_first(m, y, force)),
                        (self.pull[1], rigid.on_phi(y, J, t)))))

    def added(self, to: Array, carried: Array, rate: Array) -> tuple[Call, ...]:
        """The rigid part's forces, and damping."""
        return (call("forces of the rigid part, conjugate to y", ADD_BLOCK_TIMES, RIGID_COLUMNS,
                     carried, to, n, self.motions, padded(n)),
                call("damping force, Cbar ydot", ADD_BLOCK_TIMES, DAMPING, rate, to, n, damped,
                     padded(n)))

    def column(self, chain: Linearizer, velocities: tuple[Step, ...]) -> tuple[Step, ...]:
        """A column of the matrix, once the local coordinates have moved."""
        q = self.q
        steps: list[Step] = [chain.step(s) for s in velocities if s.role is not Role.BY_RULE]
        steps += [INERTIAL.differential(), ADDED.differential(),
                  *self.rigid_rows(differential=True)]
        for part in self.parts:
            chain.move(part.first)
            chain.move(part.angle)
        # in a plane the angular velocity makes no moment, so its differential is not wanted
        steps += [chain.stage(stage) for stage in self.stages()[q.space.planar:]]
        for quantity in (q.f, q.m, q.fm):
            chain.move(quantity)
        return (*steps, *self.added(arrays.s.d, CARRIED.d, arrays.eta.d))

    def energy(self) -> tuple[Step, ...]:
        """Energies; momentum and its moment about the global origin."""
        q, m, y, w = self.q, self.motion, self.y, self.w.symbols
        squared, elastic = (form_value(q, name, k).symbols[0]
                            for name, k in (("moving", MOVING), ("elastic", STRAINED)))
        size = n, n, padded(n)
        return (
            *quadratic_forms(
                Form("momentum of deformation, Mbar ydot", "twice its energy", arrays.M, arrays.eta,
                     *size),
                Form("elastic force, Sbar y", "twice its energy", arrays.S, arrays.y, *size),
                Form("damping force, Cbar ydot", "its power", DAMPING, arrays.eta, n, damped,
                     size[2])),
            energies_stage(q, rigid.kinetic_energy(m, y, self.J, w, squared), elastic / 2,
                           rigid.momentum(m, y), rigid.moment_of_momentum(m, y, self.J, w),
                           y.first))


def counts_of_body(planar: bool) -> dict[Array, tuple[Let, ...]]:
    """Columns of damping, which a body tells."""
    return {COLUMNS: (Let((damped,), (Truncated(COLUMNS[0]),)),)}


INERTIA = InertiaOption(
    InertiaTraits(
        "the rigid part of the motion, and rates of deformation (option D)", "d", rank=1,
        cost=1.25, softening=0.3, material=True,
        rates=True,
        constants=PARTS),
    option_d, "derive/formulas/inertia/rigid_part.py", counts_of_body)
