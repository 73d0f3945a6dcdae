"""Constants of option C in the order of its kernels, from the body's integrals."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import qr

from sebody.kernels.layout import Counts, FrameTraits, first_rotation
from sebody.reduction.invariants import InertiaInvariants


def floating_constants(invariants: InertiaInvariants, stiffness: NDArray,
                       conditions: NDArray, damping: NDArray | None = None
                       ) -> dict[str, ArrayLike]:
    """Values by name.

    Parameters
    ----------
    invariants : InertiaInvariants
        About the origin of the frame.
    stiffness : (n, n)
        Reduced stiffness.
    conditions : (k, n)
        What the local coordinates obey in the frame, see `frame_conditions`.
    damping : (n, n), optional
        Reduced damping.
    """
    kept, basis = determining(conditions)
    return packed(_restricted(invariants, basis), basis.T @ stiffness @ basis, kept,
                  None if damping is None else basis.T @ damping @ basis)


def packed(invariants: InertiaInvariants, stiffness: NDArray, kept: ArrayLike,
           damping: NDArray | None = None) -> dict[str, ArrayLike]:
    """Values by name, of integrals and a stiffness of the `kept` coordinates alone."""
    i, free = invariants, len(stiffness)
    pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)) if len(i.J0) == 3 else ((0, 0),)
    moments = np.vstack([i.S1, i.g, *(i.h[r, c] + i.h[c, r] for r, c in pairs)])
    across = i.K.transpose(0, 2, 1)
    blocks = [*(i.J2[pair] for pair in pairs), *across, *(across - i.K)]
    Cz = np.zeros((free, 0)) if damping is None else damping
    return {"sizes": [i.slaved, i.resultants, Cz.shape[1]], "Cz": Cz, "kept": kept, "c0": i.c0,
            "J0": [i.J0[pair] for pair in pairs], "moment_columns": moments.T,
            "moment_rows": moments, "quadratics": _by_columns(blocks, len(i.Mbar)), "Mz": i.Mbar,
            "Sz": stiffness, "followers": _by_columns(i.Q, free), "lam": i.lam, "E": i.E,
            "Ghat": _by_columns(i.Ghat, free)}


def frame_conditions(frame: FrameTraits, counts: Counts, values: Mapping[str, ArrayLike]
                     ) -> NDArray:
    """Linear conditions that the local coordinates obey: no motion of the frame is among them.

    The weighted displacements add up to zero; so do the weighted rotation vectors, or the moments
    of the displacements in a rotation of best fit.
    """
    D, turns = counts["D"], counts["lines"] - counts["D"] - counts["pairs"]
    first = first_rotation(counts["N_POSITIONS"], D == 2)
    found = np.zeros((D + turns, counts["n"]))
    found[:D, :first] = np.kron(values["alphas"], np.eye(D))
    if frame.needs_rotations:
        weights = np.kron(values["alpha_rs"], np.eye(turns))
        found[D:, first:first + weights.shape[1]] = weights
        return found
    for j, (w, X) in enumerate(zip(values["fits"], np.asarray(values["X"]), strict=True)):
        moment = (np.array([[-X[1], X[0]]]) if D == 2 else
                  np.array([[0, -X[2], X[1]], [X[2], 0, -X[0]], [-X[1], X[0], 0]]))
        found[D:, D * j:D * j + D] = w * moment
    return found


def determining(conditions: NDArray) -> tuple[NDArray, NDArray]:
    """Coordinates that determine the others, and the matrix that makes all of them, (n, free)."""
    count, n = conditions.shape
    scale = np.abs(conditions).max(axis=1, keepdims=True)
    order = qr(conditions / scale, mode="r", pivoting=True)[1]
    others, kept = order[:count], np.sort(order[count:])
    basis = np.zeros((n, n - count))
    basis[kept, np.arange(n - count)] = 1.0
    basis[others] = -np.linalg.solve(conditions[:, others], conditions[:, kept])
    return kept, basis


def _restricted(i: InertiaInvariants, basis: NDArray) -> InertiaInvariants:
    """The integrals of the coordinates that determine the others, and of the slaved ones."""
    n, free = basis.shape
    whole = np.zeros((n + i.slaved, free + i.slaved))
    whole[:n, :free], whole[n:, free:] = basis, np.eye(i.slaved)
    return InertiaInvariants(
        i.mass, i.c0, i.S1 @ whole, i.J0, i.g @ whole, i.h @ whole, whole.T @ i.K @ whole,
        whole.T @ i.J2 @ whole, whole.T @ i.Mbar @ whole, basis.T @ i.Q @ basis, i.lam,
        basis.T @ i.E, basis.T @ i.Ghat @ basis)


def _by_columns(matrices: ArrayLike, n: int) -> NDArray:
    """First columns of all matrices, then their second ones, and so on."""
    stack = np.asarray(matrices).reshape(-1, n, n)
    return stack.transpose(1, 2, 0).reshape(n, -1)
