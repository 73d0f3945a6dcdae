"""A DOF block of a reduced body that nothing needs, left to follow the others.

Where no force acts on boundary coordinates e but the body's own, they follow the other boundary
coordinates statically (R.J. Guyan, AIAA Journal 3, 1965, p. 380): ``K_eb y_b + K_ee y_e = 0``. What
they move beyond that joins the internal modes: those of the body with the boundary that is left
clamped, in the space of the modes before and the released coordinates. The static shapes are those
of a reduction of the FE model with this boundary, the modes are theirs as far as the modes before
span them.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, eigh

from sebody.basics.errors import InputError
from sebody.fem.stress import StressModes
from sebody.reduction.body import ReducedBody
from sebody.reduction.invariants import InertiaInvariants
from sebody.reduction.recovery import Recovery
from sebody.reduction.truncation import truncated

_SOFT = 1e-12           # relative stiffness of a released motion that is none
_CANCELLED = 1e-14      # of the sum of sizes: what is left is rounding, as of no stiffness at all
_MASSLESS = 1e-14       # squared periods, relative to the largest, of motions without inertia


class Released(NamedTuple):
    """A body without one of its DOF blocks.

    Parameters
    ----------
    body : ReducedBody
    basis : (n, n_new)
        Old reduced coordinates of unit new ones.
    bound : (n_b,) of int
        Which of the old boundary coordinates the new ones are.
    """

    body: ReducedBody
    basis: NDArray
    bound: NDArray


def released(body: ReducedBody, node: int, kind: str, modes: int | None = None) -> Released:
    """The body without the position or rotation of a boundary node.

    Parameters
    ----------
    node : int
        Place among the boundary nodes.
    kind : {'position', 'rotation'}
    modes : int, optional
        Internal modes to keep; as many as before by default, at most the released coordinates more.

    Raises
    ------
    InputError
        The node does not keep this DOF block, no position would be left, or nothing resists the
        released motion.
    """
    gone = coordinates_of(body, node, kind)
    if node == body.base:
        raise InputError(f"boundary node {node} is the base that holds the body to the ground")
    n, held = len(body.mass), len(body.mass) - body.modes
    bound = np.setdiff1d(np.arange(held), gone)
    inner = np.concatenate([gone, np.arange(held, n)])
    basis = np.zeros((n, len(bound)))
    basis[bound, np.arange(len(bound))] = 1.0
    K = body.stiffness
    _check_resisted(body, gone)
    basis[gone] = -np.linalg.solve(K[np.ix_(gone, gone)], K[np.ix_(gone, bound)])
    squares, vectors = eigh(body.mass[np.ix_(inner, inner)], K[np.ix_(inner, inner)])
    massive = np.flatnonzero(squares > _MASSLESS * squares[-1])[::-1]
    shapes = np.zeros((n, len(massive)))
    shapes[inner] = vectors[:, massive] / np.sqrt(squares[massive])
    basis = np.hstack([basis, shapes])
    other = "translation" if kind == "rotation" else "rotation"
    left = [k for k in range(len(body.keeps)) if k != node or body.keeps[k] == "full"]
    keeps = tuple(other if k == node else body.keeps[k] for k in left)

    def projected(matrix: NDArray) -> NDArray:
        reduced = basis.T @ matrix @ basis
        summed = np.abs(basis).T @ np.abs(matrix) @ np.abs(basis)
        return np.where(np.abs(reduced) > _CANCELLED * summed, (reduced + reduced.T) / 2, 0.0)
    made = ReducedBody(
        projected(K), projected(body.mass), body.coordinates[left], keeps, len(massive),
        None if body.damping is None else projected(body.damping),
        body.invariants and _projected(body.invariants, basis),
        body.recovery and _recovery(body, basis, gone, keeps, len(massive)),
        (*body.notes, f"{kind} of boundary node {node} released"),
        {name: basis.T @ load for name, load in body.loads.items()},
        body.missing, body.materials, body.units,
        outputs={name: matrix @ basis for name, matrix in body.outputs.items()},
        base=None if body.base is None else left.index(body.base), paths=body.paths)
    kept = min(body.modes if modes is None else modes, len(massive))
    return Released(truncated(made, kept), basis[:, :len(bound) + kept], bound)


def coordinates_of(body: ReducedBody, node: int, kind: str) -> NDArray:
    """Places of the reduced coordinates of a DOF block that may be released.

    Raises
    ------
    InputError
        The node does not keep it, or it is the only position.
    """
    d, r = (2, 1) if body.planar else (3, 3)
    nodes, size, first = ((body.position_nodes, d, 0) if kind == "position" else
                          (body.rotation_nodes, r, d * len(body.position_nodes)))
    if node not in nodes:
        raise InputError(f"boundary node {node} does not keep its {kind}")
    if nodes == (node,) and kind == "position":
        raise InputError(f"boundary node {node} has the only position that is kept: without it the "
                         "place of the body is undefined")
    return first + size * nodes.index(node) + np.arange(size)


def _check_resisted(body: ReducedBody, gone: NDArray) -> None:
    diagonal = np.diag(body.stiffness)[gone]
    if not diagonal.min() > 0 or np.linalg.eigvalsh(
            body.stiffness[np.ix_(gone, gone)] / np.sqrt(np.outer(diagonal, diagonal)))[0] < _SOFT:
        raise InputError("nothing in the body resists the released motion while its other nodes "
                         "are held")


def _projected(i: InertiaInvariants, basis: NDArray) -> InertiaInvariants:
    whole = block_diag(basis, np.eye(i.slaved))
    return replace(
        i, S1=i.S1 @ whole, g=i.g @ whole, h=i.h @ whole, K=whole.T @ i.K @ whole,
        J2=whole.T @ i.J2 @ whole, Mbar=whole.T @ i.Mbar @ whole, Q=basis.T @ i.Q @ basis,
        E=basis.T @ i.E, Ghat=basis.T @ i.Ghat @ basis)


def _recovery(body: ReducedBody, basis: NDArray, gone: NDArray, keeps: tuple[str, ...],
              modes: int) -> Recovery:
    """The shapes of the new coordinates, in FE axes."""
    recovery, n = body.recovery, len(body.mass)
    by = None
    if recovery.by is not None:
        turn = recovery.axes
        angles = sum(keep != "translation" for keep in keeps)
        by = block_diag(np.kron(np.eye(sum(keep != "rotation" for keep in keeps)), turn),
                        np.eye(angles) if body.planar else np.kron(np.eye(angles), turn),
                        np.eye(modes))
        basis = recovery.by.T @ basis @ by
    first_mode = n - body.modes
    of_bound = block_diag(basis[:first_mode, :first_mode - len(gone)], np.eye(
        0 if recovery.static is None else recovery.static.shape[1] - first_mode))
    return replace(
        recovery, by=by,
        shapes=np.hstack([recovery.shapes[:, :n] @ basis, recovery.shapes[:, n:]]),
        stress=tuple(replace(one, modes=one.modes @ basis) if isinstance(one, StressModes)
                     else one for one in recovery.stress),
        static=None if recovery.static is None else recovery.static @ of_bound)
