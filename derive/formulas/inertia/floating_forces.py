"""Forces and energies of option C, step by step.

Contractions of the constants with coordinates are products with stacked matrices, whose zeros are
left out.
"""

from sebody.derive.formulas.inertia import floating_field as field
from sebody.derive.formulas.inertia import slaved
from sebody.derive.formulas.inertia.floating_quantities import FloatingQuantities
from sebody.derive.formulas.inertia.rates import MOVING, STRAINED, energies_stage, form_value
from sebody.derive.symbolic.steps import Call, Stage, Step
from sebody.kernels.layout import whole_vectors

ROWS = ("y", "z"), ("eta", "zd"), ("etad", "zdd")     # local coordinates and those of the products


def forces(f: FloatingQuantities) -> tuple[Step, ...]:
    """Local forces: integrals, then factors of the columns, then their products."""
    row = f.quantities
    return (
        all_free(), *slaved.slaving(), *_contractions(f),
        f.integrals, f.moving,
        Stage("factors of the force on a coordinate", "element",
              sets=(*f.factors("by_moment_columns", f.groups["moment_columns"]),
                    *f.factors("by_products", [row.j, row.u, row.v, row.w]))),
        stacked("inertia force of deformation, Mbar zddot", "Mz", "zdd", "local", 0, 1),
        added("damping force, Cbar ydot", "Cz", "zd"),
        Call("force on the coordinates: first moments, couplings, inertia at rest and deformed",
             "add_blocks_times",
             ("moment_columns", "by_moment_columns", "products", "by_products", "local", "N",
              str(f.lines), str(f.pairs + 3 * f.turns), "hN"),
             ("moment_columns", "by_moment_columns", "products", "by_products", "local")),
        *f.stress.forces, slaved.pulled_back("local"),
        Stage("force and moment on the frame, in axes of the body", "element",
              sets=((f.on_origin, field.on_origin(f.motion, f.sums)),
                    (f.on_frame, field.on_frame(f.motion, f.sums)))),
        conjugate("local", "s"))


def _contractions(f: FloatingQuantities) -> tuple[Call, ...]:
    """Products of the constants with z and its rates, and of those with them again."""
    pairs, turns, lines = f.pairs, f.turns, f.lines

    def dots(title, vectors, row, out, first, columns):
        """Columns from one on, some more than asked: vectors of `LANES` are added up together."""
        at = f"at({vectors}, {first}*hN)" if first else vectors
        return Call(f"{title}, by {row}", "rows_times",
                    (at, row, out, "N", str(whole_vectors(columns)), "hN"), (vectors, row, out))
    moments = "first moments, couplings, inertia at rest"
    return (
        stacked("J2_kl z and K_k^T z", "of_place", "z", "products", 0, pairs + turns),
        stacked("K_k^T zdot and (K_k^T - K_k) zdot", "of_rate", "zd", "products", pairs + turns,
                2 * turns),
        dots(moments, "moment_columns", "z", "line0", 0, lines),
        dots(moments, "moment_columns", "zd", "line1", 0, lines),
        dots(moments, "moment_columns", "zdd", "line2", 0, f.D + turns),
        dots("quadratic parts", "products", "z", "product0", 0, pairs),
        dots("quadratic parts", "products", "zd", "product1", 0, pairs + 2 * turns),
        dots("quadratic parts", "products", "zdd", "product2", pairs, turns))


def energy(f: FloatingQuantities) -> tuple[Step, ...]:
    """Energies; momentum and its moment about the global origin."""
    q = f.q
    squared, elastic = (form_value(q, name, k).symbols[0]
                        for name, k in (("moving", MOVING), ("elastic", STRAINED)))
    pushed, turned = (f.turn * p for p in field.momenta(f.motion, f.sums))
    kinetic = field.kinetic_energy(f.motion, f.sums, squared)

    def square(title, vector, row, k, size, height):
        return Call(title, "rows_times", (vector, row, f"at(squares, {k})", size, "1", height),
                    (vector.split("(")[-1].split(",")[0], row, "squares"))
    return (
        stacked("momentum of deformation, Mbar zdot", "Mz", "zd", "moved", 0, 1),
        square("twice its energy", "moved", "zd", MOVING, "N", "hN"),
        square("twice that of Sbar y", "at(Gy, resultants*hn)", "z", STRAINED, "free", "hn"),
        stacked("damping force, Cbar ydot", "Cz", "zd", "moved", 0, 1),
        square("its power", "moved", "zd", 2, "free", "hn"),
        energies_stage(q, kinetic, elastic / 2 + f.stress.energy, pushed, turned,
                       f.turn * f.sums.c))


def stacked(title: str, matrices: str, row: str, out: str, first: int, count: int) -> Call:
    """Products of packed matrices with a row, one after the other from a place on."""
    to = f"at({out}, {first}*hN)" if first else out
    return Call(title, "packed_times", (matrices, row, to, f"{count}*hN"), (matrices, row, out))


def added(title: str, matrix: str, row: str) -> Call:
    """A product that is added to the local forces."""
    return Call(title, "add_packed_times", (matrix, row, "local"), (matrix, row, "local"), 1)


def all_free() -> Call:
    """The coordinates that determine the others, their rates and second rates."""
    given, to = zip(*ROWS, strict=True)
    return Call("coordinates that determine the others, and their rates", "all_to_free",
                (*given, "axes", "order", "unordered", *to, "bound", "bound_free", "free", "hN"),
                (*given, "axes", "order", "unordered", *to))


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
