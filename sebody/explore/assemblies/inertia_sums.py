"""Exact inertia of an assembly: sums of the integrals of its bodies over their mass."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics.vectors import axes_cross, skew
from sebody.explore.assemblies.placed_bodies import Motion, Placed
from sebody.fem.mass_field import MassField
from sebody.model.parts import Element
from sebody.reduction.integrals import MassIntegrals
from sebody.reduction.invariants import InertiaInvariants
from sebody.reduction.rigid_motions import rigid_motions
from sebody.reduction.stiffening import Stiffening

SUMMED = "c0", "S1", "J0", "g", "h", "K", "J2", "Mbar"


def summed_invariants(placed: Iterable[Placed], rigid: Iterable[Element], motion: Motion,
                      places: dict[str, NDArray], mass: NDArray, coordinates: NDArray,
                      keeps: tuple[str, ...], stiffening: Stiffening | None = None
                      ) -> InertiaInvariants | None:
    """Integrals of all bodies, rigid ones and point masses, about the mean of the interfaces.

    Parameters
    ----------
    motion : callable
        Rows of a quantity by its name, (size, n).
    places : dict of (D,)
        Of nodes by name, in the state.
    mass : (n, n)
        Reduced mass of the assembly.
    coordinates : (n_interfaces, D)
    keeps : tuple of str
    stiffening : Stiffening, optional
        None where the assembly has none. The rows of `placed` and `motion` go on with load modes.

    Returns
    -------
    InertiaInvariants or None
        None if a body has none.
    """
    origin, parts = coordinates.mean(axis=0), []
    for one in placed:
        if one.body.invariants is None:
            return None
        parts.append(_of_body(one.body.invariants.about(origin - one.shift),
                              np.vstack([one.rows, one.slaved])))
    n = len(mass)
    N = n if stiffening is None else n + len(stiffening.Q)
    parts += [of_rigid(one, motion, places, origin, N) for one in rigid]
    sums = {name: sum(part[name] for part in parts) for name in SUMMED}
    whole = np.array(sums["Mbar"])
    whole[:n, :n] = mass
    R = rigid_motions(coordinates, keeps, N, origin)
    second = ({"Q": np.zeros((0, n, n)), "lam": np.zeros(0), "E": np.zeros((n, 0)),
               "Ghat": np.zeros((0, n, n))} if stiffening is None else
              {name: getattr(stiffening, name) for name in ("Q", "lam", "E", "Ghat")})
    return InertiaInvariants(**_consistent(sums, whole, R, len(origin)), **second, origin=origin)


def _of_body(own: InertiaInvariants, D: NDArray) -> dict[str, NDArray]:
    """Those of one body, whose shapes are linear in its coordinates."""
    return {"c0": own.c0, "S1": own.S1 @ D, "J0": own.J0, "g": own.g @ D, "h": own.h @ D,
            "K": D.T @ own.K @ D, "J2": D.T @ own.J2 @ D, "Mbar": D.T @ own.Mbar @ D}


def of_rigid(one: Element, motion: Motion, places: dict[str, NDArray], origin: NDArray,
              size: int) -> dict[str, NDArray]:
    """Those of a rigid body or a point mass: a point with rotary inertia."""
    node, mass = one.attachments[0].node, one.number("mass")
    D = len(origin)
    moved = motion(f"{node.name}.position")
    point, turned, inertia = places[node.name], None, None
    if one.kind.endswith("rigid_body"):
        turn = places[f"{node.name}.rotation"]
        arm, rotation = turn @ one.vector("mc") / mass, motion(f"{node.name}.rotation")
        J = _moments(one, D) - mass * (arm @ arm if D == 2 else 0.0)
        if D == 3:
            own = turn.T @ arm
            J = turn @ (J - mass * (own @ own * np.eye(3) - np.outer(own, own))) @ turn.T
            moved = moved - skew(arm) @ rotation
        else:
            moved = moved + np.outer([-arm[1], arm[0]], rotation[0])
        point, turned, inertia = point + arm, sparse.csr_array(rotation), np.atleast_2d(J)[None]
    field = MassField(point[None], sparse.csr_array(moved), sparse.csr_array([[mass]]), turned,
                      inertia)
    return MassIntegrals(field, origin).integrals(np.eye(size))


def _moments(one: Element, dimension: int) -> NDArray:
    """Inertia of a rigid body about its node, in its own axes."""
    if dimension == 2:
        return np.array(one.number("J_zz"))
    return np.array([[one.number("J_" + "".join(sorted(a + b))) for b in "xyz"] for a in "xyz"])


def _consistent(sums: dict[str, NDArray], mass: NDArray, rigid: NDArray, D: int) -> dict:
    """Sums whose rigid motions are those of the reduced mass.

    Integrals of bodies are those of their undeformed shapes; in a state under stress these differ
    by strains from the mass of the assembly, which is exact. What the mass determines is taken from
    it, and K and J2 follow on rigid translations.
    """
    momenta = rigid.T @ mass
    S1, g = momenta[:D], momenta[D:]
    total = float(np.trace(S1 @ rigid[:, :D]) / D)
    moments = S1 @ rigid[:, D:]         # e_i . (e_k x c0)
    if D == 2:
        c0 = np.array([moments[1, 0], -moments[0, 0]])
    else:
        c0 = np.array([moments[1, 2] - moments[2, 1], moments[2, 0] - moments[0, 2],
                       moments[0, 1] - moments[1, 0]]) / 2
    shifted = S1 / total                # translation that a motion has in the mean
    rest = np.eye(len(mass)) - rigid[:, :D] @ shifted
    turned = axes_cross(S1)                 # e_k x S1, (r, D, n)
    units = axes_cross(np.eye(D))           # (e_k x e_i), (r, D, D) by columns i
    K = np.array([_with_translations(own, shifted, rest, units[k].T @ S1, -1.0)
                  for k, own in enumerate(sums["K"])])
    J2 = np.array([[_with_translations(
        own, shifted, rest, (units[k].T @ turned[m] + units[m].T @ turned[k]) / 2, 1.0)
        for m, own in enumerate(row)] for k, row in enumerate(sums["J2"])])
    return {"mass": total, "c0": c0, "S1": S1, "J0": (g @ rigid[:, D:] + (g @ rigid[:, D:]).T) / 2,
            "g": g, "h": sums["h"], "K": K, "J2": J2, "Mbar": mass}


def _with_translations(matrix: NDArray, shifted: NDArray, rest: NDArray, known: NDArray,
                       sign: float) -> NDArray:
    """A symmetric (sign 1) or skew (-1) form (n, n) whose rows of translations are known, (D, n).
    """
    across = shifted.T @ known
    return across + sign * (across @ rest).T + rest.T @ matrix @ rest
