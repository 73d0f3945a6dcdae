"""Strain energy of stress resultants that act on the deformed body.

``V = y^T Sbar y / 2 + sum_e [s_e^2 - (lam_e E_e . y)^2] / (2 lam_e)`` with the resultants ``s_e =
lam_e E_e . y + y^T Ghat_e y / 2``: the energy of the boundary loads on the second-order
displacements, completed to a square.
"""

from typing import NamedTuple

import sympy as sp

from sebody.derive.form.arrays import Array, Place
from sebody.derive.form.counts import deep, e, free, hn, j, resultants as counted, stretching
from sebody.derive.form.functions import ADD_BLOCKS_TIMES, ADD_PACKED, PACKED_TIMES, ROWS_TIMES
from sebody.derive.form.spaces import Quantity, Space
from sebody.derive.form.steps import Repeat, Stage, Step, call
from sebody.derive.formulas.inertia import floating_arrays as at
from sebody.derive.symbolic.variation import check_same


class Resultants(NamedTuple):
    """The parts of the resultants in a kernel."""

    forces: tuple[Step, ...]        # with Sbar y
    energy: sp.Expr                 # beyond y^T Sbar y / 2
    stiffness: tuple[Step, ...]     # added to the tangent of the forces


def resultants(space: Space) -> Resultants:
    """Derive the forces and their tangent from the energy."""
    _prove()

    def of_one(array: Array) -> Quantity:
        return space.quantity(f"{array.name}_e", "scalar", "resultant", array)
    lam, r, twice = (of_one(array).symbols[0] for array in (at.lam, at.along, at.twice))
    half = twice / 2
    extra = space.quantity("stiffened", "scalar", "element")
    E, Gy = (space.quantity(f"{array.name}_j", "scalar", "resultant", array,
                            Place(e * hn + j)).symbols[0] for array in (at.E, at.Gy))
    by_E, by_Gy, of_E, of_Gy = map(of_one, (at.by_E, at.by_Gy, at.of_E, at.of_Gy))
    one = space.quantity("by_stiffness", "scalar", "element", at.by_Gy, Place(counted))
    size = free, counted, hn
    return Resultants(
        forces=(
            call("Ghat_e y of all e, and Sbar y", PACKED_TIMES, at.stretched, at.z, at.Gy,
                 stretching * hn),
            call("E_e . y", ROWS_TIMES, at.E, at.z, at.along, *size),
            call("y . Ghat_e y", ROWS_TIMES, at.Gy, at.z, at.twice, *size),
            Stage("stress resultants: factors of their gradients", "resultant",
                  sets=((by_E, sp.Matrix([half])), (by_Gy, sp.Matrix([r + half / lam]))),
                  adds=((extra, sp.Matrix([half * (r + half / (2 * lam))])),)),
            Stage("and of Sbar y", "element", sets=((one, sp.ones(1, 1)),)),
            call("forces of the resultants and their geometric stiffness, with Sbar y",
                 ADD_BLOCKS_TIMES, at.E, at.by_E, at.Gy, at.by_Gy, at.local, free, counted,
                 stretching, hn)),
        energy=extra.symbols[0],
        stiffness=(
            call("stiffness and geometric stiffness", ADD_PACKED, at.stretched, at.by_Gy, at.Lz,
                 deep),
            Repeat("changes of the resultants", j, free, (
                Stage("factors of the column", "resultant",
                      sets=((of_E, sp.Matrix([Gy])), (of_Gy, sp.Matrix([E + Gy / lam])))),
                call("their forces", ADD_BLOCKS_TIMES, at.E, at.of_E, at.Gy, at.of_Gy,
                     at.Lz.at(j * deep), free, counted, counted, hn)))))


def _prove() -> None:
    """One resultant of two coordinates."""
    y, dy, E = (sp.Matrix(sp.symbols(f"{n}_:2")) for n in ("y", "dy", "E"))
    a, b, c, lam = sp.symbols("a b c lam")
    G = sp.Matrix([[a, b], [b, c]])
    s, r, q = lam * E.dot(y) + y.dot(G * y) / 2, E.dot(y), y.dot(G * y) / 2
    V = (s**2 - (lam * r)**2) / (2 * lam)
    check_same("energy of a resultant", sp.Matrix([q * (r + q / (2 * lam))]), sp.Matrix([V]))
    push, pull = q, r + q / lam
    force = push * E + pull * G * y
    check_same("force of a resultant", force, sp.Matrix([V.diff(v) for v in y]))
    Gy = G * y
    for k in range(2):
        column = Gy[k] * E + (E[k] + Gy[k] / lam) * Gy + pull * G[:, k]
        check_same("stiffness of a resultant", column, force.diff(y[k]))
