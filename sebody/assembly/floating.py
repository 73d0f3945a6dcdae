"""Constants of option C in the order of its kernels, from the body's integrals."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import qr

from sebody.assembly.body_axes import (
    body_axes,
    grouped,
    of_coordinates,
    stiff_of,
    without_rounding,
)
from sebody.basics.errors import InputError
from sebody.contract.counts import Counts, first_rotation
from sebody.generated.options import CONDITIONS
from sebody.kernels.packed import pack
from sebody.kernels.packed_couplings import pack_couplings
from sebody.reduction.invariants import InertiaInvariants

TIE = 1e-6      # by how much the coordinates of equal nodes differ in the choice between them


class Free(NamedTuple):
    """Coordinates z that determine all local coordinates of a body."""

    turn: NDArray       # axes of the body in the frame, columns: boundary coordinates are in them
    axes: NDArray       # (bound_free, bound) boundary coordinates that determine the others
    order: NDArray      # where each z is among these and the modes

    def matrix(self, n: int) -> NDArray:
        """``z = A y`` of all n local coordinates, (free, n)."""
        bound_free, bound = self.axes.shape
        whole = np.zeros((n - bound + bound_free, n))
        whole[:bound_free, :bound] = self.axes
        whole[bound_free:, bound:] = np.eye(n - bound)
        return whole[self.order]

def floating_constants(invariants: InertiaInvariants, stiffness: NDArray, conditions: NDArray,
                       counts: Counts, damping: NDArray | None = None,
                       of_stresses: float = 0.0) -> dict[str, ArrayLike]:
    """Values by name.

    Parameters
    ----------
    invariants : InertiaInvariants
        About the origin of the frame.
    stiffness : (n, n)
        Reduced stiffness.
    conditions : (k, n)
        What the local coordinates obey in the frame, see `frame_conditions`.
    counts : dict
        Those of the body's kernel.
    damping : (n, n), optional
        Reduced damping.
    of_stresses : float
        Rounding in geometric stiffnesses, see `without_rounding`; none by default.
    """
    turn = body_axes(invariants, counts)
    coordinates, basis = free_coordinates(conditions, counts, turn)
    by = of_coordinates(turn.T, counts)
    of_z = by.T @ basis
    S, C = (None if A is None else stiff_of(A, of_z) for A in (stiffness, damping))
    inertia = without_rounding(_restricted(invariants.rotated(turn.T, by), basis), of_stresses, S)
    order = grouped(inertia.Mbar, S)
    coordinates = coordinates._replace(order=order)
    inertia = _restricted(inertia, np.eye(len(order))[:, order])
    return packed(inertia, S[np.ix_(order, order)], coordinates,
                  None if C is None else C[np.ix_(order, order)])


def packed(invariants: InertiaInvariants, stiffness: NDArray, coordinates: Free,
           damping: NDArray | None = None) -> dict[str, ArrayLike]:
    """Values by name, of integrals and a stiffness of the coordinates z, in axes of the body."""
    i, free, N = invariants, len(stiffness), len(invariants.Mbar)
    planar = len(i.J0) == 1
    pairs = ((0, 0),) if planar else ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    moments = np.vstack([i.S1, i.g, *(i.h[r, c] + i.h[c, r] for r, c in pairs)])
    across = i.K.transpose(0, 2, 1)

    def rows(matrices, size, symmetric=False):
        return pack(matrices, (len(matrices), size, size), symmetric)
    return {"sizes": [i.slaved, i.resultants, int(damping is not None)],
            "turn": coordinates.turn[:, 0] if planar else coordinates.turn.ravel(),
            "axes": coordinates.axes, "axes_back": coordinates.axes.T, "order": coordinates.order,
            "c0": i.c0, "J0": [i.J0[pair] for pair in pairs], "moment_columns": moments.T,
            "moment_rows": moments,
            "couplings": pack_couplings(np.array([i.J2[pair] for pair in pairs]), across),
            "Mz": rows([i.Mbar], N), "Cz": rows([] if damping is None else [damping], free),
            "followers": rows(i.Q, free, symmetric=True), "lam": i.lam, "E": i.E,
            "stretched": rows([*i.Ghat, stiffness], free, symmetric=True)}


def frame_conditions(frame: str, counts: Counts, values: Mapping[str, ArrayLike]) -> NDArray:
    """Linear conditions that the local coordinates obey: no motion of the frame is among them.

    The weighted displacements add up to zero, and so does what the frame declares.

    Parameters
    ----------
    frame : str
        Of a kernel.
    counts : dict
        Those of the body's kernel.
    values : dict
        Constants of the frame by name.

    Raises
    ------
    InputError
        A frame that declares no condition.
    """
    D, turns = counts["D"], counts["turns"]
    key = frame, D == 2
    if key not in CONDITIONS:
        raise InputError(f"frame {frame!r} declares no linear condition of the local coordinates, "
                         "which inertia='floating_field' needs: use another frame or option")
    condition, first = CONDITIONS[key], first_rotation(counts["N_POSITIONS"], D == 2)
    rows = np.zeros((D + turns, counts["n"]))
    rows[:D, :first] = np.kron(values["alphas"], np.eye(D))
    begin, size = {"position": (0, D), "rotation": (first, turns), "coordinate": (0, 1)}[
        condition.of]
    constants = (np.asarray(values[name]) for name in condition.constants)
    for j, of_node in enumerate(zip(*constants, strict=True)):
        at = begin + size * j
        rows[D:, at:at + size] = condition.coefficients(*of_node)
    return rows


def free_coordinates(conditions: NDArray, counts: Counts, turn: NDArray) -> tuple[Free, NDArray]:
    """Coordinates that determine the others, and the matrix that makes all of them, (n, free).

    All are in axes of the body, columns of `turn`.
    """
    count = len(conditions)
    by = of_coordinates(turn.T, counts)
    axes = np.eye(count)
    axes[:len(turn), :len(turn)] = turn.T
    if len(turn) == 3:
        axes[3:, 3:] = turn.T
    conditions = axes @ conditions @ by.T
    for of in np.split(conditions, [counts["bound"]], axis=1):    # modes have units of their own
        of[np.abs(of) < 1e-14 * np.abs(of).max(axis=1, keepdims=True, initial=0.0)] = 0.0
    free, basis = determining(conditions, counts["bound"])
    bound_free = np.count_nonzero(free < counts["bound"])
    rows = free[:bound_free]
    return Free(turn, by[rows, :counts["bound"]], np.arange(len(free))), basis


def determining(conditions: NDArray, bound: int) -> tuple[NDArray, NDArray]:
    """Coordinates that determine the others, and the matrix that makes all of them, (n, free).

    The others are among the first `bound`, those of the boundary.
    """
    count, n = conditions.shape
    scale = np.abs(conditions).max(axis=1, keepdims=True)
    first = 1.0 - TIE * np.arange(bound)        # of coordinates that determine as well as another
    others = qr((conditions / scale)[:, :bound] * first, mode="r", pivoting=True)[1][:count]
    free = np.setdiff1d(np.arange(n), others)
    basis = np.zeros((n, n - count))
    basis[free, np.arange(n - count)] = 1.0
    basis[others] = -np.linalg.solve(conditions[:, others], conditions[:, free])
    return free, basis


def _restricted(i: InertiaInvariants, basis: NDArray) -> InertiaInvariants:
    """The integrals of the coordinates that determine the others, and of the slaved ones."""
    n, free = basis.shape
    whole = np.zeros((n + i.slaved, free + i.slaved))
    whole[:n, :free], whole[n:, free:] = basis, np.eye(i.slaved)
    return InertiaInvariants(
        i.mass, i.c0, i.S1 @ whole, i.J0, i.g @ whole, i.h @ whole, whole.T @ i.K @ whole,
        whole.T @ i.J2 @ whole, whole.T @ i.Mbar @ whole, basis.T @ i.Q @ basis, i.lam,
        basis.T @ i.E, basis.T @ i.Ghat @ basis)
