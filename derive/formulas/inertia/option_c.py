"""Option C: kinetic energy of the displacement field itself, with slaved load modes.

A and B interpolate the velocity of the body from its boundary nodes. Here it is that of the field,
``v* = v0* + Omega_0 x (X + Phi y + Psi eta) + Phi ydot + Psi etadot``, with the same unknowns:
Ellenbroek and Schilder (2018). The load modes Psi follow the unknowns, ``eta_b = y^T Q_b y / 2``:
second-order displacements on which distributed loads work, with the geometric stiffness of these
loads (Wallrapp and Schwertassek, 1991) projected on them in Q.

Everything is conjugate to y, to the origin and to the rotation of the frame, as elastic forces are.
Gravity is the acceleration of the origin that is not felt. Contractions of constants with
coordinates are products of stacked matrices; the matrix has local tangents, made once, and then
three products a column.

In every frame the local coordinates obey as many linear conditions as the frame has motions, such
as ``sum alpha_j u_j = 0`` and ``sum alpha_j psi_j = 0``: some coordinates determine the others. All
constants are of these alone, and so are the forces, since only motions that obey the conditions do
work.
"""

import sympy as sp

from sebody.derive.formulas.frames.frame import Frame
from sebody.derive.formulas.inertia import floating_field as field
from sebody.derive.formulas.inertia import slaved
from sebody.derive.formulas.inertia.option import Inertia, InertiaOption, Local
from sebody.derive.formulas.inertia.rates import (
    MOVING,
    STRAINED,
    Form,
    energies_stage,
    form_value,
    frame_motion,
    on_frame_stage,
    quadratic_forms,
    second_derivatives,
)
from sebody.derive.formulas.inertia.resultants import resultants
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.symbolic.linearize import Linearizer
from sebody.derive.symbolic.spaces import Quantity
from sebody.derive.symbolic.steps import Call, Repeat, Stage, Step
from sebody.kernels.layout import InertiaTraits, Part, axes_of

PLACE, RATE, SECOND = "Lz", "Lv", "La"      # local tangents, and the rows they multiply
GEOMETRY = sp.Symbol("c_geo")
ROWS = ("y", "z"), ("eta", "zd"), ("etad", "zdd")     # local coordinates and those of the products


def option_c(q: Quantities) -> Inertia:
    """The option: no forces of the nodes' own, everything through the local coordinates."""
    none = sp.zeros(3, 1)
    return Inertia((), (), none, none, none, none, none, {}, (), None, floating)


def floating(q: Quantities, frame: Frame) -> Local:
    """Derive the steps in a frame."""
    field.prove()
    return _Floating(q, frame).local()


class _Floating:
    """Quantities of the sums and rows, and the steps that compute them."""

    def __init__(self, q: Quantities, frame: Frame):
        self.q, self.frame = q, frame
        self.stress = resultants(q.space)
        counts = axes_of(q.space.planar)
        self.D, self.pairs, self.lines = counts["D"], counts["pairs"], counts["lines"]
        self.turns = self.lines - self.D - self.pairs
        self.force_rows = f"N + {self.D + self.turns}"
        self.felt = self.of_element("felt", "vector", "zdd", "N + {k}")
        self.turning = self.of_element("turning", "axial", "zdd", "N + {k}", self.D)
        self.spin = self.of_element("spin", "axial", "zd", "N + {k}")
        self.on_origin = self.of_element("Rt", "vector", "local", "N + {k}")
        self.on_frame = self.of_element("Rr", "axial", "local", "N + {k}", self.D)
        self.sums, self.integrals = self.make_sums()
        self.quantities, self.groups = self.make_row()
        self.row = field.Row(*(quantity.symbols for quantity in self.quantities))
        self.motion = field.Motion(q.mass.symbols[0], q.v0.symbols, self.felt.symbols,
                                   q.Om0.symbols, q.Om0d.symbols)
        self.force = field.on_coordinate(self.motion, self.row)
        self.factor_of_tangents = Stage(
            "motion of the frame as a factor of local tangents", "element",
            sets=((self.felt, q.a0.symbols - q.gamma.symbols), (self.turning, q.Om0d.symbols),
                  (self.spin, q.Om0.symbols)))

    def of_element(self, name: str, kind: str, array: str = "", place: str = "{k}",
                   first: int = 0) -> Quantity:
        return self.q.space.quantity(name, kind, "element", array, place, first)

    def make_sums(self) -> tuple[field.Sums, Stage]:
        """The integrals, from their parts at rest, linear and quadratic."""
        after_turns, D = self.D + self.turns, self.D

        def part(name, kind, array, first=0):
            return self.of_element(name, kind, array, first=first).symbols
        at_rest = part("c0", "vector", "c0"), part("J0", "inertia", "J0")
        linear = [(part(f"S1z{t}", "vector", array), part(f"gz{t}", "axial", array, D),
                   part(f"hz{t}", "inertia", array, after_turns))
                  for t, array in enumerate(("line0", "line1", "line2"))]
        jz = part("jz", "inertia", "product0")
        jzd = part("jzd", "inertia", "product1")
        uzd = part("uzd", "axial", "product1", self.pairs)
        vzd = part("vzd", "axial", "product1", self.pairs + self.turns)
        uzdd = part("uzdd", "axial", "product2")
        values = field.Sums(
            at_rest[0] + linear[0][0], linear[1][0], linear[2][0], at_rest[1] + linear[0][2] + jz,
            linear[1][2] + 2 * jzd, linear[1][1] + uzd, linear[2][1] + uzdd, vzd)
        kinds = {"J": "inertia", "Jd": "inertia", "spun": "axial", "accelerated": "axial",
                 "coupled": "axial"}
        kept = [self.of_element(f"sum_{name}", kinds.get(name, "vector"))
                for name in field.Sums._fields]
        return field.Sums(*(k.symbols for k in kept)), Stage(
            "integrals over the body", "element", sets=tuple(zip(kept, values, strict=True)))

    def make_row(self) -> tuple[field.Row, dict[str, list[Quantity]]]:
        """Quantities that belong to a coordinate: columns of constants and of products."""
        kinds = {"S1": "vector", "h": "inertia", "j": "inertia", "jd": "inertia"}
        arrays = {"moment_columns": "S1 g h", "products": "j u v w", "more": "jd ua wa"}
        size = {"vector": self.D, "axial": self.turns, "inertia": self.pairs}
        found, groups = {}, {}
        for array, names in arrays.items():
            first, groups[array] = 0, []
            for name in names.split():
                kind = kinds.get(name, "axial")
                found[name] = self.q.space.quantity(f"row_{name}", kind, "shape", array,
                                                    "{k}*hN + i", first)
                groups[array].append(found[name])
                first += size[kind]
        return field.Row(**found), groups

    def local(self) -> Local:
        """All steps."""
        q = self.q
        return Local(
            motion=frame_motion(q, self.frame), forces=self.forces(), share=sp.zeros(3, 1),
            on_frame=on_frame_stage(q, self.on_origin.symbols, self.on_frame.symbols),
            energy=self.energy(), prepared=self.prepared(),
            held=(gathered("dy", "dz"), *slaved.varied(),
                  self.tangent_times("block_times", PLACE, "dz", "N")),
            column=self.column)

    def forces(self) -> tuple[Step, ...]:
        """Local forces: integrals, then factors of the columns, then their products."""
        factors = [*self.factors("moment_columns"), *self.factors("products")]
        return (
            *(gathered(*rows) for rows in ROWS), *slaved.slaving(), *self.contractions(),
            self.integrals, self.factor_of_tangents,
            Stage("factors of the force on a coordinate", "element", sets=tuple(factors)),
            Call("force on the coordinates: first moments, couplings, inertia at rest",
                 "columns_times", ("moment_columns", "by_moment_columns", "local", "N",
                                   str(self.lines)),
                 ("moment_columns", "by_moment_columns", "local")),
            Call("of the deformed body", "add_block_times",
                 ("products", "by_products", "local", "N", str(self.pairs + 3 * self.turns), "hN"),
                 ("products", "by_products", "local")),
            Call("inertia force of deformation, Mbar zddot", "add_block_times",
                 ("Mz", "zdd", "local", "N", "N", "hN"), ("Mz", "zdd", "local"), 1),
            Call("elastic force, Sbar y", "add_block_times",
                 ("Sz", "z", "local", "free", "free", "hn"), ("Sz", "z", "local"), 1),
            Call("damping force, Cbar ydot", "add_block_times",
                 ("Cz", "zd", "local", "free", "damped", "hn"), ("Cz", "zd", "local"), 1),
            *self.stress.forces, slaved.pulled_back("local"),
            Stage("force and moment on the frame", "element",
                  sets=((self.on_origin, field.on_origin(self.motion, self.sums)),
                        (self.on_frame, field.on_frame(self.motion, self.sums)))),
            scattered("local", "s"))

    def contractions(self) -> tuple[Call, ...]:
        """Products of the constants with z and its rates, and of those with them again."""
        pairs, turns, lines = self.pairs, self.turns, self.lines
        blocks = f"{pairs + 2 * turns}*hN"
        sums = [Call(f"first moments and couplings of {row}", "columns_times",
                     ("moment_rows", row, out, str(lines), "N"), ("moment_rows", row, out))
                for row, out in (("z", "line0"), ("zd", "line1"), ("zdd", "line2"))]

        def dots(row, out, first, columns):
            vectors = f"at(products, {first}*hN)" if first else "products"
            return Call(f"quadratic parts, by {row}", "rows_times",
                        (vectors, row, out, "N", str(columns), "hN"), ("products", row, out))
        return (
            *sums,
            Call("J2_kl z and K_k^T z", "block_times",
                 ("quadratics", "z", "products", f"{pairs + turns}*hN", "N", blocks),
                 ("quadratics", "z", "products"), pairs + turns),
            Call("K_k^T zdot and (K_k^T - K_k) zdot", "block_times",
                 (f"at(quadratics, {pairs}*hN)", "zd", f"at(products, {pairs + turns}*hN)",
                  f"{2 * turns}*hN", "N", blocks), ("quadratics", "zd", "products"), 2 * turns),
            dots("z", "product0", 0, pairs), dots("zd", "product1", 0, pairs + 2 * turns),
            dots("zdd", "product2", pairs, turns))

    def factors(self, array: str) -> tuple:
        """Coefficients of the columns of an array in the force on a coordinate."""
        out, pairs, first = f"by_{array}", [], 0
        for quantity in self.groups[array]:
            factor = self.of_element(f"{out}_{quantity.name}", quantity.kind, out, first=first)
            pairs.append((factor, _derivative(self.force, quantity)))
            first += len(quantity.kept)
        return tuple(pairs)

    def prepared(self) -> tuple[Step, ...]:
        """Local tangents, once for all columns."""
        q, N = self.q, "N"
        pairs, turns = self.pairs, self.turns
        blocks = f"{pairs + 2 * turns}*hN"
        more = (Call("J2_kl zdot", "block_times",
                     ("quadratics", "zd", "more", f"{pairs}*hN", N, blocks),
                     ("quadratics", "zd", "more")),
                Call("K_k^T zddot and (K_k^T - K_k) zddot", "block_times",
                     (f"at(quadratics, {pairs}*hN)", "zdd", f"at(more, {pairs}*hN)",
                      f"{2 * turns}*hN", N, blocks), ("quadratics", "zdd", "more")))
        one = self.of_element("one", "scalar", "ones")
        followed = q.space.quantity("followed", "scalar", "slaved", "by_followers")
        on_eta = q.space.quantity("on_eta", "scalar", "slaved", "local", "free + b")
        return (
            slaved.stacked("zdd", "Za"), *second_derivatives(q), *more,
            Stage("factors of the local tangents", "element",
                  sets=(*self.block_factors("by_place", "j", "u", "", GEOMETRY),
                        *self.block_factors("by_rate", "", "v", "w"), (one, sp.ones(1, 1)))),
            Stage("forces on eta as factors", "slaved",
                  sets=((followed, GEOMETRY * on_eta.symbols),)),
            Repeat("local tangents: columns of the coordinates", "j", "N", tuple(
                Call(title, "block_times", (f"at({source}, j*{step})", by, f"at({to}, j*deep)", N,
                                            count, "hN"), (source, by, to))
                for title, source, step, by, to, count in (
                    ("by z", "quadratics", blocks, "by_place", PLACE, str(pairs + 2 * turns)),
                    ("by zdot", "quadratics", blocks, "by_rate", RATE, str(pairs + 2 * turns)),
                    ("by zddot", "Mz", "hN", "ones", SECOND, "1")))),
            Repeat("elastic and slaved parts", "j", "free", (
                *(Call(title, "add_block_times",
                       (f"at({source}, j*{step})", by, f"at({PLACE}, j*deep)", "free", count,
                        "hn"),
                       (source, by, PLACE))
                  for title, source, step, by, count in (
                      ("stiffness", "Sz", "hn", "ones", "1"),
                      ("forces on eta", "followers", "slaved*hn", "by_followers", "slaved"))),
                *self.stress.stiffness)),
            Repeat("structural damping", "j", "damped", (
                Call("a column", "add_block_times",
                     ("at(Cz, j*hn)", "ones", f"at({RATE}, j*deep)", "free", "1", "hn"),
                     ("Cz", "ones", RATE)),)),
            *self.borders())

    def block_factors(self, out: str, squares: str, couplings: str, gyroscopic: str,
                      scale: sp.Expr = sp.S.One) -> list:
        """Factors of the blocks J2_kl, K_k^T and K_k^T - K_k in a local tangent."""
        found, first = [], 0
        for name, like in ((squares, "j"), (couplings, "u"), (gyroscopic, "u")):
            kind = getattr(self.quantities, like).kind
            factor = self.of_element(f"{out}_{first}", kind, out, first=first)
            zero = sp.zeros(3, 3 if kind == "inertia" else 1)
            value = (scale * _derivative(self.force, getattr(self.quantities, name)) if name
                     else zero)
            found.append((factor, value))
            first += len(factor.kept)
        return found

    def borders(self) -> tuple[Stage, ...]:
        """Force and moment on the frame by the coordinates; everything by the frame's motion."""
        q = self.q
        totals = {"Rt": (field.on_origin, "vector", 0), "Rr": (field.on_frame, "axial", self.D)}
        rows, corner, columns = [], [], []
        for change, array in zip(field.gradients(self.row), (PLACE, RATE, SECOND), strict=True):
            scale = GEOMETRY if array == PLACE else 1
            for name, (force, kind, first) in totals.items():
                row = q.space.quantity(f"{name}_{array}", kind, "shape", array,
                                       "i*deep + N + {k}", first)
                rows.append((row, scale * field.by_sums(force(self.motion, self.sums), self.sums,
                                                        change)))
        for array, vector, first in ((RATE, q.Om0, 0), (SECOND, self.felt, 0),
                                     (SECOND, self.turning, self.D)):
            symbols = q.Om0d.symbols if vector is self.turning else vector.symbols
            for c, symbol in enumerate([s for s in symbols if isinstance(s, sp.Symbol)]):
                at = f"(N + {first + c})*deep" if first + c else "N*deep"
                column = q.space.quantity(f"{array}_{symbol}", "scalar", "shape", array,
                                          f"{at} + i")
                columns.append((column, sp.Matrix([self.force.diff(symbol)])))
                for name, (force, kind, below) in totals.items():
                    entry = self.of_element(f"{name}_{array}_{symbol}", kind, array,
                                            f"{at} + N + {{k}}", below)
                    corner.append((entry, force(self.motion, self.sums).diff(symbol)))
        return (Stage("local tangents: force and moment on the frame", "shape", sets=tuple(rows)),
                Stage("local tangents: motion of the frame", "shape", sets=tuple(columns)),
                Stage("local tangents: force on the frame by its motion", "element",
                      sets=tuple(corner)))

    def tangent_times(self, function: str, matrix: str, row: str, columns: str) -> Call:
        return Call(f"differential of the local forces by {row}", function,
                    (matrix, row, "dlocal", self.force_rows, columns, "deep"),
                    (matrix, row, "dlocal"), 1)

    def column(self, chain: Linearizer, velocities: tuple[Step, ...]) -> tuple[Step, ...]:
        """A column of the matrix, once everything local has moved."""
        q = self.q
        steps: list[Step] = [chain.step(step) for step in velocities]
        steps += [*(gathered("d" + row, "d" + to) for row, to in ROWS), *slaved.rates_varied(),
                  chain.stage(self.factor_of_tangents),
                  self.tangent_times("add_block_times", RATE, "dzd", f"N + {self.turns}"),
                  self.tangent_times("add_block_times", SECOND, "dzdd", self.force_rows),
                  slaved.pulled_back("dlocal"), scattered("dlocal", "ds")]
        for quantity in (q.f, q.m, q.fm, self.on_origin, self.on_frame):
            chain.move(quantity)
        return tuple(steps)

    def energy(self) -> tuple[Step, ...]:
        """Energies; momentum and its moment about the global origin."""
        q = self.q
        squared, elastic = (form_value(q, name, k).symbols[0]
                            for name, k in (("moving", MOVING), ("elastic", STRAINED)))
        pushed, turned = field.momenta(self.motion, self.sums)
        kinetic = field.kinetic_energy(self.motion, self.sums, squared)
        return (
            *quadratic_forms(
                Form("momentum of deformation, Mbar zdot", "twice its energy", "Mz", "zd", "N", "N",
                     "hN"),
                Form("elastic force, Sbar y", "twice its energy", "Sz", "z", "free", "free", "hn"),
                Form("damping force, Cbar ydot", "its power", "Cz", "zd", "free", "damped", "hn")),
            energies_stage(q, kinetic, elastic / 2 + self.stress.energy, pushed, turned,
                           self.sums.c))


def gathered(row: str, to: str) -> Call:
    """The coordinates that determine the others."""
    return Call(f"coordinates that determine the others, of {row}", "gather",
                (row, "kept", to, "free", "hN"), (row, "kept", to))


def scattered(row: str, to: str) -> Call:
    """Forces conjugate to them; those on the others are zero."""
    return Call("forces conjugate to y", "scatter", (row, "kept", to, "free", "n"),
                (row, "kept", to))


def _derivative(form: sp.Expr, quantity: Quantity) -> sp.Matrix:
    """Derivatives by the components of a quantity, in its shape."""
    return quantity.symbols.applyfunc(
        lambda s: form.diff(s) if isinstance(s, sp.Symbol) else sp.S.Zero)


INERTIA = InertiaOption(
    InertiaTraits(
        "the displacement field of the body, with slaved load modes (option C)", material=True,
        rates=True, field=True,
        constants=(
            Part("sizes", (3,), "slaved coordinates, resultants of second order, damped ones"),
            Part("kept", ("free",), "local coordinates that determine the others in the frame"),
            Part("c0", ("D",), "first moment of mass at rest, about the origin of the frame"),
            Part("J0", ("pairs",), "moments of inertia at rest"),
            Part("moment_columns", ("N", "lines"), "S1, g_k, h_kl + h_lk", columns=True),
            Part("moment_rows", ("lines", "N"), "their transpose", columns=True),
            Part("quadratics", ("N", "quadratic"),
                 "column by column of J2_kl, K_k^T, K_k^T - K_k", columns=True),
            Part("Mz", ("N", "N"), "reduced mass with slaved coordinates", columns=True),
            Part("Sz", ("free", "free"), "reduced stiffness", columns=True),
            Part("Cz", ("free", "damped"), "reduced damping", columns=True),
            Part("followers", ("free", "slaving"), "column by column of Q_b", columns=True),
            Part("lam", ("resultants",), "eigenvalues of the resultants"),
            Part("E", ("free", "resultants"), "their eigenvectors", columns=True),
            Part("Ghat", ("free", "stressing"), "column by column of Ghat_e", columns=True))),
    option_c)
