"""Geometric stiffening of a reduced body: load modes and stress resultants of second order.

K_G(u) is the geometric stiffness of the stresses of a displacement u, and ``G(u) = Phi^T K_G(u)
Phi`` that on the reduced coordinates y.

* Load modes Psi answer the loads that accelerating, turning and spinning make, with the boundary
  clamped. Their amplitudes follow y, ``eta_b = y^T Q_b y / 2`` with ``Q_b = -G(Psi_b) / kap_b``,
  ``Psi^T S Psi = diag(kap)``: a displacement of second order on which any such load p does the work
  of its geometric stiffness, ``p^T Psi Q = -G(p)``. (O. Wallrapp and R. Schwertassek, Int. J.
  Numer. Meth. Engng 32, 1991, put the same matrices into the forces.)
* Stress resultants ``s_e = lam_e E_e^T y + y^T Ghat_e y / 2`` of the elastic boundary motions:
  ``sum_e lam_e E_e E_e^T`` is the boundary stiffness, ``Ghat_e = G(Phi d_e)`` with ``E_e^T d_f =
  delta_ef``.

Both are prestresses: displacements orthonormal in strain energy, turned so that as few as possible
have a geometric stiffness. Stress-carrying internal modes are uncorrected in the strain energy, so
load modes are not made orthogonal to them: their part would be missing.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from sebody.reduction.clamped import canonical_turn

# Load cases with less strain energy than this part of the largest are rounding.
_NULL = 1e-8
_ROUNDING = 1e-10  # of a geometric stiffness that is none, relative to the largest
# A prestress is left out if it changes no stiffness by this part when it moves the body by a tenth
# of its size or turns it by 0.1 rad.
_NEGLIGIBLE, _LARGEST_MOTION = 0.01, 0.1


@dataclass(frozen=True, eq=False)
class Stiffening:
    """What y brings along in second order; Q, lam, E, Ghat as in `InertiaInvariants`.

    Parameters
    ----------
    load_modes : (n_dofs, n_eta)
        Shapes of unit modal mass, zero on the boundary.
    """

    load_modes: NDArray
    Q: NDArray
    lam: NDArray
    E: NDArray
    Ghat: NDArray


class GeometricStiffness:
    """Geometric stiffness of displacements, on the reduced coordinates of a body.

    Parameters
    ----------
    of : function
        G (n, n) of a displacement (n_dofs,).
    basis : (n_dofs, n)
        Shapes of the reduced coordinates.
    stiffness : (n, n)
        Reduced stiffness.
    scale : (n_boundary,)
        Of a motion of each boundary coordinate: 1, for rotations the size of the body.
    rigid : int
        Number of rigid motions.
    largest : function
        Largest rotation, or displacement over size, of displacements (n_dofs, k).
    """

    def __init__(self, of: Callable[[NDArray], NDArray], basis: NDArray, stiffness: NDArray,
                 scale: NDArray, rigid: int, largest: Callable[[NDArray], NDArray]):
        self._of, self._basis, self._largest = of, basis, largest
        self._stiffness, self._held = stiffness, len(scale)
        held = slice(0, self._held)
        values, vectors = np.linalg.eigh(stiffness[held, held] / np.outer(scale, scale))
        self._boundary = vectors[:, rigid:] / scale[:, None] / np.sqrt(values[rigid:])
        modes = 1 / np.sqrt(np.diag(stiffness)[self._held:])
        self._elastic = block_diag(self._boundary, np.diag(modes))   # orthonormal in strain energy

    def stiffening(self, answers: NDArray, energies: NDArray, masses: NDArray) -> Stiffening:
        """Load modes and resultants.

        Parameters
        ----------
        answers : (n_dofs, k)
            Displacements under load cases, boundary clamped.
        energies, masses : (k, k)
            FE stiffness and mass, projected on them.
        """
        values, vectors = np.linalg.eigh(energies)
        kept = values > _NULL * values.max(initial=0.0)
        orthonormal = vectors[:, kept] / np.sqrt(values[kept])
        turn, G = self._prestresses(answers @ orthonormal)
        weights = orthonormal @ turn
        modal = np.einsum("ia,ij,ja->a", weights, masses, weights)
        # of unit modal mass; the strain energy kap is then 1 / modal
        scaled = weights / np.sqrt(modal)
        Q = -G * np.sqrt(modal)[:, None, None]

        turn, G = self._prestresses(self._basis[:, :self._held] @ self._boundary)
        motions = self._boundary @ turn
        size = self._largest(self._basis[:, :self._held] @ motions)
        lam = 1 / size**2       # of motions d_e of largest rotation 1
        E = np.zeros((len(self._stiffness), len(lam)))
        held = slice(0, self._held)
        E[held] = self._stiffness[held, held] @ motions * size
        return Stiffening(answers @ scaled, Q, lam, E, G / size[:, None, None])

    def _prestresses(self, shapes: NDArray) -> tuple[NDArray, NDArray]:
        """Turn (k, m) of orthonormal shapes (n_dofs, k) to the m that matter, and their G."""
        size = len(self._stiffness)
        if shapes.shape[1] == 0:
            return np.zeros((0, 0)), np.zeros((0, size, size))
        G = np.array([self._of(shape) for shape in shapes.T])
        relative = self._elastic.T @ G @ self._elastic
        turn, singular, _ = np.linalg.svd(relative.reshape(len(G), -1), full_matrices=False)
        turn = turn[:, singular > _ROUNDING * singular.max(initial=0.0)]
        turn = turn @ canonical_turn(singular[:turn.shape[1]], shapes @ turn)
        relative = np.einsum("bf,bij->fij", turn, relative)
        change = np.abs(np.linalg.eigvalsh(relative)).max(axis=1, initial=0.0)
        motion = self._largest(shapes @ turn)
        turn = turn[:, _LARGEST_MOTION * change > _NEGLIGIBLE * motion]
        return turn, np.einsum("bf,bij->fij", turn, G)
