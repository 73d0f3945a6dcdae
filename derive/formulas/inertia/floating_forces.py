"""Forces and energies of option C, step by step.

Contractions of the constants with coordinates are products with stacked matrices, whose zeros are
left out.
"""

from sebody.contract.counts import whole_vectors
from sebody.derive.form.arrays import Array, View
from sebody.derive.form.counts import N, bound, bound_free, free, hN, hn, resultants
from sebody.derive.form.functions import (
    ADD_BLOCKS_TIMES,
    ADD_PACKED_TIMES,
    ALL_TO_FREE,
    COLUMNS_TIMES_ALL,
    COUPLINGS_TIMES,
    FROM_FREE,
    PACKED_TIMES,
    ROWS_TIMES,
    TO_FREE,
)
from sebody.derive.form.steps import Call, Stage, Step, call
from sebody.derive.form.whole import Whole
from sebody.derive.formulas import arrays
from sebody.derive.formulas.inertia import floating_arrays as at, floating_field as field, slaved
from sebody.derive.formulas.inertia.floating_quantities import FloatingQuantities
from sebody.derive.formulas.inertia.rates import (
    LOST,
    MOVING,
    STRAINED,
    energies_stage,
    form_value,
)

ROWS = (arrays.y, at.z), (arrays.eta, at.zd), (arrays.etad, at.zdd)     # local and free ones


def forces(f: FloatingQuantities) -> tuple[Step, ...]:
    """Local forces: integrals, then factors of the columns, then their products."""
    row = f.quantities
    return (
        all_free(), *slaved.slaving(), *_contractions(f),
        f.integrals, f.moving,
        Stage("factors of the force on a coordinate", "element",
              sets=(*f.factors(at.by_moment_columns, f.groups[at.moment_columns]),
                    *f.factors(at.by_products, [row.j, row.u, row.v, row.w]))),
        stacked("inertia force of deformation, Mbar zddot", at.Mz, at.zdd, at.local, 1),
        added("damping force, Cbar ydot", at.Cz, at.zd),
        call("force on the coordinates: first moments, couplings, inertia at rest and deformed",
             ADD_BLOCKS_TIMES, at.moment_columns, at.by_moment_columns, at.products,
             at.by_products, at.local, N, f.lines, f.pairs + 3 * f.turns, hN),
        *f.stress.forces, slaved.pulled_back(at.local),
        Stage("force and moment on the frame, in axes of the body", "element",
              sets=((f.on_origin, field.on_origin(f.motion, f.sums)),
                    (f.on_frame, field.on_frame(f.motion, f.sums)))),
        conjugate(at.local, arrays.s))


def _contractions(f: FloatingQuantities) -> tuple[Call, ...]:
    """Products of the constants with z and its rates, and of those with them again."""
    pairs, turns, lines = f.pairs, f.turns, f.lines

    def dots(first: Whole, row: Array, out: Array, columns: int) -> Call:
        """Some columns more than asked: vectors of `LANES` are added up together."""
        return call(f"quadratic parts, by {row.name}", ROWS_TIMES, at.products.at(first * hN), row,
                    out, N, whole_vectors(columns), hN)
    return (
        coupled(f, "J2_kl z, K_k^T z, K_k^T zdot and K_k zdot", at.z, at.zd, at.products),
        call("first moments, couplings, inertia at rest, by z and its rates", COLUMNS_TIMES_ALL,
             at.moment_rows, at.z, at.zd, at.zdd, *at.lines, lines, N),
        *(dots(first, row, out, count)
          for first, row, out, count in zip(
              (0, 0, pairs), (at.z, at.zd, at.zdd), at.quadratic,
              (pairs, pairs + 2 * turns, turns), strict=True)))


def energy(f: FloatingQuantities) -> tuple[Step, ...]:
    """Energies; momentum and its moment about the global origin."""
    q = f.q
    squared, elastic = (form_value(q, name, k).symbols[0]
                        for name, k in (("moving", MOVING), ("elastic", STRAINED)))
    pushed, turned = (f.turn * p for p in field.momenta(f.motion, f.sums))
    kinetic = field.kinetic_energy(f.motion, f.sums, squared)

    def square(title: str, vector: Array | View, row: Array, k: int, size: Whole, height: Whole
               ) -> Call:
        return call(title, ROWS_TIMES, vector, row, at.squares.at(k), size, 1, height)
    return (
        stacked("momentum of deformation, Mbar zdot", at.Mz, at.zd, at.moved, 1),
        square("twice its energy", at.moved, at.zd, MOVING, N, hN),
        square("twice that of Sbar y", at.Gy.at(resultants * hn), at.z, STRAINED, free, hn),
        stacked("damping force, Cbar ydot", at.Cz, at.zd, at.moved, 1),
        square("its power", at.moved, at.zd, LOST, free, hn),
        energies_stage(q, kinetic, elastic / 2 + f.stress.energy, pushed, turned,
                       f.turn * f.sums.c))


def stacked(title: str, matrices: Array, row: Array, out: Array | View, count: int) -> Call:
    """Products of packed matrices with a row, one after the other."""
    return call(title, PACKED_TIMES, matrices, row, out, count * hN)


def coupled(f: FloatingQuantities, title: str, row: Array, rate: Array, out: Array) -> Call:
    """Products of the quadratic constants with a row and its rate."""
    return call(title, COUPLINGS_TIMES, at.couplings, row, rate, out, f.made * hN)


def added(title: str, matrix: Array, row: Array) -> Call:
    """A product that is added to the local forces."""
    return call(title, ADD_PACKED_TIMES, matrix, row, at.local, products=1)


def all_free() -> Call:
    """The coordinates that determine the others, their rates and second rates."""
    given, to = zip(*ROWS, strict=True)
    return call("coordinates that determine the others, and their rates", ALL_TO_FREE, *given,
                at.axes, at.order, at.unordered, *to, bound, bound_free, free, hN)


def to_free(row: Array, to: Array) -> Call:
    """The coordinates that determine the others, in axes of the body."""
    return call(f"coordinates that determine the others, of {row.name}", TO_FREE, row, at.axes,
                at.order, at.unordered, to, bound, bound_free, free, hN)


def conjugate(row: Array, to: Array) -> Call:
    """Forces conjugate to all local coordinates from those on the ones that determine them."""
    return call("forces conjugate to y", FROM_FREE, row, at.axes_back, at.order, at.unordered, to,
                bound, bound_free, free)
