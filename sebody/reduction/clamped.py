"""The body with its boundary clamped: static solutions and vibration modes of its interior."""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import eigh
from scipy.sparse.linalg import LinearOperator, SuperLU, eigsh, splu

from sebody.errors import InputError

_DENSE_LIMIT = 1000  # internal DOFs up to which the dense eigenvalue solver is used
_SINGULAR = 1e-13  # ratio of pivot to diagonal entry below which the internal stiffness is singular
_REPEATED = 1e-6  # relative distance below which eigenvalues or components count as equal


class ClampedInterior:
    """Internal DOFs of a body and the factored stiffness S_II that holds them.

    Parameters
    ----------
    stiffness, mass : (n_dofs, n_dofs), sparse
        FE matrices.
    internal : (n_internal,)
        Rows of the internal DOFs.

    Raises
    ------
    InputError
        A mechanism inside.
    """

    def __init__(self, stiffness: sparse.csc_array, mass: sparse.csc_array, internal: NDArray):
        self.internal, self._size = internal, stiffness.shape[0]
        self._factor = None
        if len(internal):
            self._stiffness = stiffness[internal][:, internal]
            self._mass = mass[internal][:, internal]
            self._factor = _factorise(self._stiffness)

    def displacement(self, forces: NDArray) -> NDArray:
        """Static displacement (n_dofs, k) under forces (n_dofs, k) on internal DOFs."""
        result = np.zeros((self._size, forces.shape[1]))
        if self._factor is not None:
            result[self.internal] = self._factor.solve(np.ascontiguousarray(forces[self.internal]))
        return result

    def vibrations(self, modes: int) -> tuple[NDArray, NDArray]:
        """Lowest modes (5): omega^2 (m,) and mass-normalised shapes (n_dofs, m)."""
        if modes == 0:
            return np.zeros(0), np.zeros((self._size, 0))
        omega_squared, inner = _fixed_interface_modes(self._stiffness, self._mass, self._factor,
                                                      modes)
        shapes = np.zeros((self._size, modes))
        shapes[self.internal] = inner
        return omega_squared, shapes


def _factorise(stiffness: sparse.csc_array) -> SuperLU:
    """Factor the internal stiffness S_II, refusing one that leaves a motion free."""
    options = {"SymmetricMode": True}
    # SciPy 1.11 selects rows with 64-bit indices, which its SuperLU does not accept
    short = (array.astype(np.intc) for array in (stiffness.indices, stiffness.indptr))
    matrix = sparse.csc_array((stiffness.data.copy(), *short), shape=stiffness.shape)
    try:
        factor = splu(matrix, "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
        pivots = factor.U.diagonal()[factor.perm_c]
        weakest = np.min(pivots / stiffness.diagonal())
    except RuntimeError:  # SuperLU met a pivot of exactly zero
        weakest = 0.0
    if not weakest > _SINGULAR:
        raise InputError(
            "S_II is singular: with the boundary clamped the body can still move without strain "
            "(a mechanism inside); keep more boundary nodes or triplets, or connect loose parts"
        )
    return factor


def _fixed_interface_modes(
    stiffness: sparse.csc_array, mass: sparse.csc_array, factor: SuperLU, modes: int
) -> tuple[NDArray, NDArray]:
    """Lowest `modes` solutions of (5): omega^2 (m,) and mass-normalised shapes (n_internal, m)."""
    size = stiffness.shape[0]
    wanted = min(size, modes + 4)  # a few more, so that a repeated frequency is not cut in two
    if size <= _DENSE_LIMIT or wanted >= size:
        # The inverse problem: low modes to full accuracy, and massless DOFs do no harm.
        inverse, shapes = eigh(
            mass.toarray(), stiffness.toarray(), subset_by_index=[size - wanted, size - 1]
        )
        inverse, shapes = inverse[::-1], shapes[:, ::-1]
        with_mass = inverse > 1e-14 * inverse[0]
        omega_squared = 1.0 / inverse[with_mass]
        shapes = shapes[:, with_mass] * np.sqrt(omega_squared)
    else:
        omega_squared, shapes = eigsh(
            stiffness,
            wanted,
            mass,
            sigma=0.0,
            OPinv=LinearOperator(stiffness.shape, factor.solve),
            v0=np.random.default_rng(0).standard_normal(size),
        )
    if len(omega_squared) < modes:
        raise InputError(
            f"modes is {modes}, but only {len(omega_squared)} internal motions carry mass; ask "
            "for fewer"
        )
    shapes = shapes @ canonical_turn(omega_squared, shapes)
    return omega_squared[:modes], shapes[:, :modes]


def canonical_turn(values: NDArray, shapes: NDArray) -> NDArray:
    """Orthogonal turn (m, m) of shapes (n, m) that have equal values among themselves.

    What it makes of them does not depend on a solver's choices of sign and within equal values:
    each shape's largest component is positive, and the later shapes of the same value vanish
    there: a beam of square section gets modes in its principal planes.
    """
    whole = np.eye(len(values))
    gaps = np.abs(np.diff(values)) > _REPEATED * np.maximum(values[1:], values[:-1])
    for group in np.split(np.arange(len(values)), np.flatnonzero(gaps) + 1):
        for position in range(len(group)):
            rest = shapes @ whole[:, group[position:]]
            row = rest[_first_largest(np.linalg.norm(rest, axis=1))]
            # Orthonormal columns, the first along `row`, so only the first shape moves there.
            turn = np.linalg.qr(np.column_stack([row, np.eye(len(row))]))[0]
            turn[:, 0] *= np.sign(turn[:, 0] @ row)
            whole[:, group[position:]] = whole[:, group[position:]] @ turn
    return whole


def _first_largest(values: NDArray) -> int:
    """Index of the first entry that equals the largest up to rounding."""
    return int(np.argmax(values >= (1 - _REPEATED) * np.max(values)))
