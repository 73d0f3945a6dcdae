"""Strain energy of stress resultants that act on the deformed body.

``V = y^T Sbar y / 2 + sum_e [s_e^2 - (lam_e E_e . y)^2] / (2 lam_e)`` with the resultants ``s_e =
lam_e E_e . y + y^T Ghat_e y / 2``: the energy of the boundary loads on the second-order
displacements, completed to a square.
"""

from typing import NamedTuple

import sympy as sp

from sebody.derive.symbolic.spaces import Space
from sebody.derive.symbolic.steps import Call, Repeat, Stage, Step
from sebody.derive.symbolic.variation import check_same


class Resultants(NamedTuple):
    """What the resultants contribute to a kernel."""

    forces: tuple[Step, ...]        # with Sbar y
    energy: sp.Expr                 # beyond y^T Sbar y / 2
    stiffness: tuple[Step, ...]     # added to the tangent of the forces


def resultants(space: Space) -> Resultants:
    """Derive the forces and their tangent from the energy."""
    _prove()

    def of_one(name):
        return space.quantity(f"{name}_e", "scalar", "resultant", name)
    lam, r, twice = (of_one(n).symbols[0] for n in ("lam", "along", "twice"))
    half = twice / 2
    extra = space.quantity("stiffened", "scalar", "element")
    E = space.quantity("E_j", "scalar", "resultant", "E", "e*hn + j").symbols[0]
    Gy = space.quantity("Gy_j", "scalar", "resultant", "Gy", "e*hn + j").symbols[0]
    by_E, by_Gy, of_E, of_Gy = map(of_one, ("by_E", "by_Gy", "of_E", "of_Gy"))
    one = space.quantity("by_stiffness", "scalar", "element", "by_Gy", "resultants")
    size = ("free", "resultants", "hn")
    return Resultants(
        forces=(
            Call("Ghat_e y of all e, and Sbar y", "packed_times",
                 ("stretched", "z", "Gy", "stretching*hn"), ("stretched", "z", "Gy")),
            Call("E_e . y", "rows_times", ("E", "z", "along", *size), ("E", "z", "along")),
            Call("y . Ghat_e y", "rows_times", ("Gy", "z", "twice", *size), ("Gy", "z", "twice")),
            Stage("stress resultants: factors of their gradients", "resultant",
                  sets=((by_E, sp.Matrix([half])), (by_Gy, sp.Matrix([r + half / lam]))),
                  adds=((extra, sp.Matrix([half * (r + half / (2 * lam))])),)),
            Stage("and of Sbar y", "element", sets=((one, sp.ones(1, 1)),)),
            Call("forces of the resultants and their geometric stiffness, with Sbar y",
                 "add_blocks_times", ("E", "by_E", "Gy", "by_Gy", "local", "free", "resultants",
                                      "stretching", "hn"),
                 ("E", "by_E", "Gy", "by_Gy", "local"))),
        energy=extra.symbols[0],
        stiffness=(
            Call("stiffness and geometric stiffness", "add_packed",
                 ("stretched", "by_Gy", "Lz", "deep"), ("stretched", "by_Gy", "Lz")),
            Repeat("changes of the resultants", "j", "free", (
                Stage("factors of the column", "resultant",
                      sets=((of_E, sp.Matrix([Gy])), (of_Gy, sp.Matrix([E + Gy / lam])))),
                Call("their forces", "add_blocks_times",
                     ("E", "of_E", "Gy", "of_Gy", "at(Lz, j*deep)", "free", "resultants",
                      "resultants", "hn"), ("E", "of_E", "Gy", "of_Gy", "Lz"))))))


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
    for j in range(2):
        column = Gy[j] * E + (E[j] + Gy[j] / lam) * Gy + pull * G[:, j]
        check_same("stiffness of a resultant", column, force.diff(y[j]))
