"""Matrix of option C: local tangents, made once, and then three products a column."""

import sympy as sp

from sebody.derive.formulas.inertia import floating_field as field
from sebody.derive.formulas.inertia import slaved
from sebody.derive.formulas.inertia.floating_forces import ROWS, conjugate, free, stacked
from sebody.derive.formulas.inertia.floating_quantities import (
    GEOMETRY,
    PLACE,
    RATE,
    SECOND,
    FloatingQuantities,
)
from sebody.derive.formulas.inertia.rates import second_derivatives
from sebody.derive.symbolic.linearize import Linearizer
from sebody.derive.symbolic.steps import Call, Stage, Step


def prepared(f: FloatingQuantities) -> tuple[Step, ...]:
    """Local tangents, once for all columns."""
    q, row, pairs, turns = f.q, f.quantities, f.pairs, f.turns
    one = f.of_element("one", "scalar", "ones")
    followed = q.space.quantity("followed", "scalar", "slaved", "by_followers")
    on_eta = q.space.quantity("on_eta", "scalar", "slaved", "local", "free + b")
    return (
        slaved.stacked("zdd", "Za"), *second_derivatives(q),
        stacked("J2_kl zdot", "of_place", "zd", "more", 0, pairs + turns),
        stacked("K_k^T zddot and (K_k^T - K_k) zddot", "of_rate", "zdd", "more", pairs, 2 * turns),
        Stage("factors of the local tangents", "element",
              sets=(*f.factors("by_place", [row.j, row.u], GEOMETRY),
                    *f.factors("by_rate", [row.v, row.w]), (one, sp.ones(1, 1)))),
        Stage("forces on eta as factors", "slaved", sets=((followed, GEOMETRY * on_eta.symbols),)),
        *(Call("local tangents", "clear", (out, "N*deep"), (out,))
          for out in (PLACE, RATE, SECOND)),
        *(Call(title, "add_packed", (matrices, factors, out, "deep"),
               (matrices, factors.split("(")[-1].split(",")[0], out))
          for title, matrices, factors, out in (
              ("by z: J2_kl and K_k^T", "of_place", "by_place", PLACE),
              ("forces on eta", "followers", "by_followers", PLACE),
              ("by zdot: K_k^T and K_k^T - K_k", "of_rate", "by_rate", RATE),
              ("structural damping", "Cz", "ones", RATE),
              ("by zddot", "Mz", "ones", SECOND))),
        *f.stress.stiffness, *_borders(f))


def _borders(f: FloatingQuantities) -> tuple[Stage, ...]:
    """Force and moment on the frame by the coordinates; everything by the frame's motion."""
    q = f.q
    totals = {"Rt": (field.on_origin, "vector", 0), "Rr": (field.on_frame, "axial", f.D)}
    rows, corner, columns = [], [], []
    for change, array in zip(field.gradients(f.row), (PLACE, RATE, SECOND), strict=True):
        scale = GEOMETRY if array == PLACE else 1
        for name, (force, kind, first) in totals.items():
            row = q.space.quantity(f"{name}_{array}", kind, "shape", array,
                                   "i*deep + N + {k}", first)
            rows.append((row, scale * field.by_sums(force(f.motion, f.sums), f.sums, change)))
    for array, vector, first in ((RATE, f.spin, 0), (SECOND, f.felt, 0),
                                 (SECOND, f.turning, f.D)):
        for c, symbol in enumerate(vector.kept):
            at = f"(N + {first + c})*deep" if first + c else "N*deep"
            column = q.space.quantity(f"{array}_{symbol}", "scalar", "shape", array, f"{at} + i")
            columns.append((column, sp.Matrix([f.force.diff(symbol)])))
            for name, (force, kind, below) in totals.items():
                entry = f.of_element(f"{name}_{array}_{symbol}", kind, array,
                                     f"{at} + N + {{k}}", below)
                corner.append((entry, force(f.motion, f.sums).diff(symbol)))
    return (Stage("local tangents: force and moment on the frame", "shape", sets=tuple(rows)),
            Stage("local tangents: motion of the frame", "shape", sets=tuple(columns)),
            Stage("local tangents: force on the frame by its motion", "element",
                  sets=tuple(corner)))


def held(f: FloatingQuantities) -> tuple[Step, ...]:
    """Of a column: local forces by changed local coordinates."""
    return free("dy", "dz"), *slaved.varied(), _times(f, "block_times", PLACE, "dz", "N")


def column(f: FloatingQuantities, chain: Linearizer, velocities: tuple[Step, ...]
           ) -> tuple[Step, ...]:
    """A column of the matrix, once everything local has moved."""
    q = f.q
    steps: list[Step] = [chain.step(step) for step in velocities]
    steps += [*(free("d" + row, "d" + to) for row, to in ROWS[1:]), *slaved.rates_varied(),
              chain.stage(f.moving),
              _times(f, "add_block_times", RATE, "dzd", f"N + {f.turns}"),
              _times(f, "add_block_times", SECOND, "dzdd", f.force_rows),
              slaved.pulled_back("dlocal"), conjugate("dlocal", "ds")]
    for quantity in (q.f, q.m, q.fm, f.on_origin, f.on_frame):
        chain.move(quantity)
    return tuple(steps)


def _times(f: FloatingQuantities, function: str, matrix: str, row: str, columns: str) -> Call:
    return Call(f"differential of the local forces by {row}", function,
                (matrix, row, "dlocal", f.force_rows, columns, "deep"),
                (matrix, row, "dlocal"), 1)
