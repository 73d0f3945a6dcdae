"""Matrix of option C: local tangents, made once, and then three products a column."""

import sympy as sp

from sebody.derive.form.arrays import Array, Place
from sebody.derive.form.counts import N, b, deep, free, hN, i
from sebody.derive.form.functions import (
    ADD_BLOCK_TIMES,
    ADD_COUPLINGS,
    ADD_PACKED,
    BLOCK_TIMES,
    CLEAR,
    Function,
)
from sebody.derive.form.steps import Call, Stage, Step, call
from sebody.derive.form.whole import Whole
from sebody.derive.formulas import arrays
from sebody.derive.formulas.inertia import floating_arrays as at, floating_field as field, slaved
from sebody.derive.formulas.inertia.floating_forces import ROWS, conjugate, coupled, to_free
from sebody.derive.formulas.inertia.floating_quantities import (
    GEOMETRY,
    PLACE,
    RATE,
    SECOND,
    FloatingQuantities,
)
from sebody.derive.formulas.inertia.rates import second_derivatives
from sebody.derive.passes.linearize import Linearizer


def prepared(f: FloatingQuantities) -> tuple[Step, ...]:
    """Local tangents, once for all columns."""
    q, row = f.q, f.quantities
    one = f.of_element("one", "scalar", at.ones)
    not_asked = f.of_element("not_asked", "axial", at.by_couplings, Place(f.made - f.turns))
    followed = q.space.quantity("followed", "scalar", "slaved", at.by_followers)
    on_eta = q.space.quantity("on_eta", "scalar", "slaved", at.local, Place(free + b))
    return (
        slaved.accelerated(), *second_derivatives(q),
        coupled(f, "J2_kl zdot, K_k^T zddot and K_k zddot", at.zd, at.zdd, at.more),
        Stage("factors of the local tangents", "element",
              sets=(*f.factors(at.by_couplings, [row.j, row.u, row.v, row.w], moved=2),
                    (not_asked, sp.zeros(3, 1)), (one, sp.ones(1, 1)))),
        Stage("forces on eta as factors", "slaved", sets=((followed, GEOMETRY * on_eta.symbols),)),
        *(call("local tangents", CLEAR, out, N * deep) for out in (PLACE, RATE, SECOND)),
        call("by z: J2_kl and K_k^T; by zdot: K_k^T and K_k", ADD_COUPLINGS, at.couplings,
             at.by_couplings, at.scales, PLACE, RATE, f.made, hN, deep),
        *(call(title, ADD_PACKED, matrices, factors, out, deep)
          for title, matrices, factors, out in (
              ("forces on eta", at.followers, at.by_followers, PLACE),
              ("structural damping", at.Cz, at.ones, RATE),
              ("by zddot", at.Mz, at.ones, SECOND))),
        *f.stress.stiffness, *_borders(f))


def _borders(f: FloatingQuantities) -> tuple[Stage, ...]:
    """Force and moment on the frame by the coordinates; everything by the frame's motion."""
    q = f.q
    totals = {"Rt": (field.on_origin, "vector", 0), "Rr": (field.on_frame, "axial", f.D)}
    rows, corner, columns = [], [], []
    for change, array in zip(field.gradients(f.row), (PLACE, RATE, SECOND), strict=True):
        scale = GEOMETRY if array is PLACE else 1
        for name, (force, kind, first) in totals.items():
            row = q.space.quantity(f"{name}_{array.name}", kind, "shape", array,
                                   Place(i * deep + N, first=first))
            rows.append((row, scale * field.by_sums(force(f.motion, f.sums), f.sums, change)))
    for array, vector, first in ((RATE, f.spin, 0), (SECOND, f.felt, 0),
                                 (SECOND, f.turning, f.D)):
        for c, symbol in enumerate(vector.kept):
            begin = (N + (first + c)) * deep
            column = q.space.quantity(f"{array.name}_{symbol}", "scalar", "shape", array,
                                      Place(begin + i))
            columns.append((column, sp.Matrix([f.force.diff(symbol)])))
            for name, (force, kind, below) in totals.items():
                entry = f.of_element(f"{name}_{array.name}_{symbol}", kind, array,
                                     Place(begin + N, first=below))
                corner.append((entry, force(f.motion, f.sums).diff(symbol)))
    return (Stage("local tangents: force and moment on the frame", "shape", sets=tuple(rows)),
            Stage("local tangents: motion of the frame", "shape", sets=tuple(columns)),
            Stage("local tangents: force on the frame by its motion", "element",
                  sets=tuple(corner)))


def held(f: FloatingQuantities) -> tuple[Step, ...]:
    """Steps of a column: local forces by changed local coordinates."""
    return (to_free(arrays.y.d, at.z.d), *slaved.varied(),
            _times(f, BLOCK_TIMES, PLACE, at.z.d, N))


def column(f: FloatingQuantities, chain: Linearizer, velocities: tuple[Step, ...]
           ) -> tuple[Step, ...]:
    """A column of the matrix, once everything local has moved."""
    q = f.q
    steps: list[Step] = [chain.step(step) for step in velocities]
    steps += [*(to_free(row.d, to.d) for row, to in ROWS[1:]), *slaved.rates_varied(),
              chain.stage(f.moving),
              _times(f, ADD_BLOCK_TIMES, RATE, at.zd.d, N + f.turns),
              _times(f, ADD_BLOCK_TIMES, SECOND, at.zdd.d, f.force_rows),
              slaved.pulled_back(at.local.d), conjugate(at.local.d, arrays.s.d)]
    for quantity in (q.f, q.m, q.fm, f.on_origin, f.on_frame):
        chain.move(quantity)
    return tuple(steps)


def _times(f: FloatingQuantities, function: Function, matrix: Array, row: Array, columns: Whole
           ) -> Call:
    return call(f"differential of the local forces by {row.name}", function, matrix, row,
                at.local.d, f.force_rows, columns, deep, products=1)
