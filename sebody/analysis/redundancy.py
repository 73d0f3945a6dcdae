"""Solution for accelerations and multipliers where constraints are redundant or mass is missing."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr
from scipy.sparse import csc_matrix

from sebody.analysis.sparse import Scaled
from sebody.assembly.numbering import Numbering
from sebody.errors import InputError

LARGEST = 3000          # unknowns up to which singular systems are analysed by dense algebra


def least(matrix: csc_matrix, demand: NDArray, numbering: Numbering) -> NDArray:
    """Solution, that of least norm where the matrix is singular.

    Raises
    ------
    InputError
        A singular matrix of too many unknowns.
    """
    system = Scaled(matrix)
    if system.regular:
        return system.solve(demand)
    if numbering.free > LARGEST:
        raise InputError("the constraints are redundant and too many to be sorted out: remove "
                         "redundant joints")
    return system.least(demand)[0]


class Solver:
    """Solves for accelerations and multipliers; finds redundant constraints and missing mass.

    Parameters
    ----------
    matrix : (n, n)
        Masses and constraints.
    multipliers : (m,)
        Which unknowns are multipliers.

    Attributes
    ----------
    redundant : tuple of str
        Joints with constraints that others contain.

    Raises
    ------
    InputError
        Something without mass can move, a joint acts on nothing, or the system is singular and too
        large to be looked into.
    """

    def __init__(self, matrix: csc_matrix, numbering: Numbering, multipliers: NDArray):
        self.system, self.names = Scaled(matrix), numbering.names
        self.redundant: tuple[str, ...] = ()
        if not self.system.regular:
            self._sort_out(multipliers)

    def __call__(self, residual: NDArray) -> NDArray:
        """Accelerations and multipliers, of least norm where these are not unique.

        Raises
        ------
        InputError
            Constraints that contradict each other.
        """
        if self.system.regular:
            return self.system.solve(residual)
        answer, left = self.system.least(residual)
        if left.max() > 1e-7 * max(np.abs(self.system.scale * residual).max(), 1e-300):
            raise InputError(f"the constraints contradict each other at "
                             f"{self.names[int(np.argmax(left))]}: they demand different "
                             "accelerations of the same thing; remove a joint or a drive")
        return answer

    def _sort_out(self, multipliers: NDArray) -> None:
        """Find redundant constraints, which allow a solution, and missing mass, which does not."""
        names, weakest = self.names, self.system.weakest
        if len(self.system.scale) > LARGEST:
            raise InputError(f"the constraints or the mass are singular at "
                             f"{'an unknown' if weakest is None else names[weakest]}: remove "
                             "redundant joints, give every body mass")
        whole = self.system.matrix.toarray()
        kept = np.ones(len(whole), dtype=bool)
        kept[multipliers] = False
        constraints = whole[multipliers][:, kept]
        rank, self.redundant = self._redundant(constraints, multipliers)
        free = np.linalg.svd(constraints)[2][rank:] if rank else np.eye(kept.sum())
        self._check_mass(free, whole[kept][:, kept], np.flatnonzero(kept))

    def _redundant(self, constraints: NDArray, multipliers: NDArray
                   ) -> tuple[int, tuple[str, ...]]:
        """Rank of the constraints, and the joints whose constraints do not increase the rank."""
        if not multipliers.size:
            return 0, ()
        names, lengths = self.names, np.linalg.norm(constraints, axis=1)
        for k in np.flatnonzero(lengths == 0.0):
            raise InputError(f"{names[multipliers[k]]} acts on nothing that can move: remove "
                             "the joint or free a node")
        R, order = qr(constraints.T / lengths, mode="r", pivoting=True)
        diagonal = np.abs(np.diag(R))
        rank = int((diagonal > 1e-9 * diagonal[0]).sum())
        return rank, tuple(dict.fromkeys(names[multipliers[k]].partition(" of ")[2]
                                         for k in order[rank:]))

    def _check_mass(self, free: NDArray, mass: NDArray, unknowns: NDArray) -> None:
        """Refuse a motion that the constraints leave free and that has no mass."""
        if not len(free):
            return
        mass = free @ mass @ free.T
        values, modes = np.linalg.eigh((mass + mass.T) / 2)
        if values[0] < 1e-12 * values[-1]:
            name = self.names[unknowns[np.argmax(np.abs(modes[:, 0] @ free))]]
            raise InputError(f"the mass is singular at {name}: nothing with mass moves with it; "
                             "give it a mass, fix it, or leave it out")
