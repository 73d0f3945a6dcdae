"""Forces and energies of option C, step by step.

Contractions of the constants with coordinates are products with stacked matrices, whose zeros are
left out.
"""

import sympy as sp

from sebody.derive.formulas import gravity
from sebody.derive.formulas.damping import rates
from sebody.derive.formulas.frames.frame import Frame, origin_stage
from sebody.derive.formulas.inertia import floating_field as field
from sebody.derive.formulas.inertia import slaved
from sebody.derive.formulas.inertia.floating_quantities import FloatingQuantities
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.symbolic.linearize import Linearizer
from sebody.derive.symbolic.steps import Call, Solve, Stage, Step, cross
from sebody.derive.symbolic.variation import along

ROWS = ("y", "z"), ("eta", "zd"), ("etad", "zdd")     # local coordinates and those of the products


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
    return (*frame.velocity, modes, origin_stage(q, q.v0, q.vs),
            origin_stage(q, q.a0, q.acc), *of_y, *solve, *map(clock.step, of_y),
            gravity.in_frame_axes(q))


def forces(f: FloatingQuantities) -> tuple[Step, ...]:
    """Local forces: integrals, then factors of the columns, then their products."""
    weighted = [f.quantities.j, f.quantities.u, f.quantities.w]     # the first products
    return (
        *(free(*rows) for rows in ROWS), *slaved.slaving(), *_contractions(f),
        f.integrals, f.moving,
        Stage("factors of the force on a coordinate", "element",
              sets=(*f.factors("by_moment_columns", f.groups["moment_columns"]),
                    *f.factors("by_products", weighted))),
        Call("force on the coordinates: first moments, couplings, inertia at rest",
             "columns_times", ("moment_columns", "by_moment_columns", "local", "N", str(f.lines)),
             ("moment_columns", "by_moment_columns", "local")),
        Call("of the deformed body", "add_block_times",
             ("products", "by_products", "local", "N", str(f.pairs + 2 * f.turns), "hN"),
             ("products", "by_products", "local")),
        added("inertia force of deformation, Mbar zddot", "Mz", "zdd"),
        added("damping force, Cbar ydot", "Cz", "zd"),
        *f.stress.forces, slaved.pulled_back("local"),
        Stage("force and moment on the frame, in axes of the body", "element",
              sets=((f.on_origin, field.on_origin(f.motion, f.sums)),
                    (f.on_frame, field.on_frame(f.motion, f.sums)))),
        conjugate("local", "s"))


def on_frame(f: FloatingQuantities) -> Stage:
    """Force and moment on the frame, in its own axes."""
    return Stage("inertia and weight on the frame", "element",
                 adds=((f.q.F, f.turn * f.on_origin.symbols),
                       (f.q.W, f.turn * f.on_frame.symbols)), continues=True)


def _contractions(f: FloatingQuantities) -> tuple[Call, ...]:
    """Products of the constants with z and its rates, and of those with them again."""
    pairs, turns, lines = f.pairs, f.turns, f.lines
    sums = [Call(f"first moments and couplings of {row}", "columns_times",
                 ("moment_rows", row, out, str(lines), "N"), ("moment_rows", row, out))
            for row, out in (("z", "line0"), ("zd", "line1"), ("zdd", "line2"))]

    def dots(row, out, first, columns):
        vectors = f"at(products, {first}*hN)" if first else "products"
        return Call(f"quadratic parts, by {row}", "rows_times",
                    (vectors, row, out, "N", str(columns), "hN"), ("products", row, out))
    return (
        *sums,
        stacked("J2_kl z and K_k^T z", "of_place", "z", "products", 0, pairs + turns),
        stacked("(K_k^T - K_k) zdot and K_k^T zdot", "of_rate", "zd", "products", pairs + turns,
                2 * turns),
        dots("z", "product0", 0, pairs), dots("zd", "product1", 0, pairs + turns),
        dots("zd", "product3", pairs + 2 * turns, turns), dots("zdd", "product2", pairs, turns))


def energy(f: FloatingQuantities) -> tuple[Step, ...]:
    """Energies; momentum and its moment about the global origin."""
    q = f.q
    squared, elastic = (f.of_element(name, "scalar", "squares", first=k)
                        for k, name in enumerate(("moving", "elastic")))
    pushed, turned = (f.turn * p for p in field.momenta(f.motion, f.sums))
    x0, gamma, R0 = q.x0.symbols, q.gamma.symbols, q.R0.symbols
    moment = f.turn * f.sums.c + q.mass.symbols[0] * R0.T * x0

    def square(title, vector, row, k, size, height):
        return Call(title, "rows_times", (vector, row, f"at(squares, {k})", size, "1", height),
                    (vector.split("(")[-1].split(",")[0], row, "squares"))
    return (
        stacked("momentum of deformation, Mbar zdot", "Mz", "zd", "moved", 0, 1),
        square("twice its energy", "moved", "zd", 0, "N", "hN"),
        square("twice that of Sbar y", "at(Gy, resultants*hn)", "z", 1, "free", "hn"),
        stacked("damping force, Cbar ydot", "Cz", "zd", "moved", 0, 1),
        square("its power", "moved", "zd", 2, "free", "hn"),
        Stage("energies, momentum and its moment about the origin", "element", sets=(
            (q.kinetic, sp.Matrix([field.kinetic_energy(f.motion, f.sums, squared.symbols[0])])),
            (q.strain, elastic.symbols / 2 + sp.Matrix([f.stress.energy])),
            (q.potential, sp.Matrix([-moment.dot(gamma)])), (q.P, R0 * pushed),
            (q.H, cross(x0, R0 * pushed) + R0 * turned))))


def stacked(title: str, matrices: str, row: str, out: str, first: int, count: int) -> Call:
    """Products of packed matrices with a row, one after the other from a place on."""
    to = f"at({out}, {first}*hN)" if first else out
    return Call(title, "packed_times", (matrices, row, to, f"{count}*hN"), (matrices, row, out))


def added(title: str, matrix: str, row: str) -> Call:
    """A product that is added to the local forces."""
    return Call(title, "add_packed_times", (matrix, row, "local"), (matrix, row, "local"), 1)


def free(row: str, to: str) -> Call:
    """The coordinates that determine the others, in axes of the body."""
    return Call(f"coordinates that determine the others, of {row}", "to_free",
                (row, "axes", "order", "unordered", to, "bound", "bound_free", "free", "hN"),
                (row, "axes", "order", "unordered", to))


def conjugate(row: str, to: str) -> Call:
    """Forces conjugate to all local coordinates from those on the ones that determine them."""
    return Call("forces conjugate to y", "from_free",
                (row, "axes_back", "order", "unordered", to, "bound", "bound_free", "free"),
                (row, "axes_back", "order", "unordered", to))
