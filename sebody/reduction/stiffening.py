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
have a geometric stiffness. Internal modes are turned, too, and what they are by their stresses
(`internal_stresses.py`) decides what becomes of them:

* Those that stretch as the body vibrates slowly have resultants like boundary motions. Load modes
  are orthogonal to them, since their part of a displacement of second order is a deformation of its
  own, with inertia.
* Those without stresses that matter have none, and load modes are orthogonal to them all the same:
  a load mode that had a part of them would move the body as they do, and stresses of the rest of it
  would be what bends the body.
* The others carry stresses that only loads cause, such as axial modes of straight beams. They are
  uncorrected in the strain energy, so load modes are not made orthogonal to them: their part would
  be missing.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, eigh

from sebody.reduction.clamped import canonical_turn
from sebody.reduction.internal_stresses import divide

# Load cases with less strain energy than this part of the largest are rounding.
_NULL = 1e-8
_ROUNDING = 1e-10  # of a geometric stiffness that is none, relative to the largest
_REPEATED = 1e-6  # relative distance of squared periods that count as equal
# Squared period of motions without mass, which follow statically, over the longest one: what a
# prestress changes of them is their stiffness alone.
_STATIC = 1e-12
_LOWEST = 6     # frequencies that count, or as many as elastic boundary motions if they are more
# What a prestress changes is measured in squared frequencies of the free body, when it, or the load
# it answers, moves the body by a tenth of its size or turns it by 0.1 rad. So far a tension would
# buckle the body. Where no other prestress changes a frequency to first order, as in straight
# beams, whose bending and twist change one another alone, those that change less than _WEAK are
# left out: all of them if the section is compact. In frames, plates and solids they act together.
_WEAK, _FIRST_ORDER, _LARGEST_MOTION = 0.02, 1e-3, 0.1
_SOFT = 10.0    # times the strain energy of the softest vibration: harder ones move the body less
# Of more resultants than _MANY only those are kept that change the strain energy of some motion by
# more than _SLIGHT of it, moving the body as far. The others are of bending and twist: what they
# change is of the order of the rotation they make, tensions change a multiple of that.
_MANY, _SLIGHT = 18, 0.1


@dataclass(frozen=True, eq=False)
class Stiffening:
    """Terms of second order in y; Q, lam, E, Ghat as in `InertiaInvariants`.

    Parameters
    ----------
    load_modes : (n_dofs, n_eta)
        Shapes of unit modal mass, zero on the boundary.
    motions : int
        Number of elastic boundary motions, each of which could have a resultant.
    internal : int
        Number of resultants of internal modes; they come last.
    """

    load_modes: NDArray
    Q: NDArray
    lam: NDArray
    E: NDArray
    Ghat: NDArray
    motions: int = 0
    internal: int = 0


class GeometricStiffness:
    """Geometric stiffness of displacements, on the reduced coordinates of a body.

    Displacements may carry further rows: what else of a prestress its geometric stiffness needs.

    Parameters
    ----------
    of : function
        G (k, m, m) of displacements (n_dofs, k) on m combinations (n, m) of the coordinates, or on
        all coordinates (None).
    basis : (n_dofs, n)
        Shapes of the reduced coordinates.
    stiffness, mass : (n, n)
        Reduced matrices.
    scale : (n_boundary,)
        Of a motion of each boundary coordinate: 1, for rotations the size of the body.
    rigid : (n, r)
        Rigid motions.
    largest : function
        Largest rotation, or displacement over size, of displacements (n_dofs, k).
    """

    def __init__(self, of: Callable[[NDArray, NDArray | None], NDArray], basis: NDArray,
                 stiffness: NDArray, mass: NDArray, scale: NDArray, rigid: NDArray,
                 largest: Callable[[NDArray], NDArray]):
        self._of, self._basis, self._largest = of, basis, largest
        self._stiffness, self._held = stiffness, len(scale)
        boundary = slice(0, self._held)
        count = np.linalg.matrix_rank(rigid[boundary] * scale[:, None])
        values, vectors = np.linalg.eigh(stiffness[boundary, boundary] / np.outer(scale, scale))
        motions = vectors[:, count:] / scale[:, None] / np.sqrt(values[count:])
        modes = 1 / np.sqrt(np.diag(stiffness)[self._held:])
        self._elastic = block_diag(motions, np.diag(modes))     # orthonormal in strain energy
        self._count = motions.shape[1]                          # of them, on the boundary
        self._lowest = max(self._count, _LOWEST)                # vibrations that count
        momenta = mass @ rigid
        relative = mass - momenta @ np.linalg.pinv(rigid.T @ momenta) @ momenta.T
        # of the free body: inverse squares of frequencies, vibrations of unit strain energy
        inverse, self._vibrations = np.linalg.eigh(self._elastic.T @ relative @ self._elastic)
        self._inverse = np.maximum(inverse, _STATIC * (inverse.max(initial=0.0) or 1.0))

    def stiffening(self, loads: NDArray, answers: NDArray,
                   mass: Callable[[NDArray], NDArray]) -> Stiffening:
        """Load modes and resultants.

        Parameters
        ----------
        loads, answers : (n_dofs, k)
            Load cases and their displacements, boundary clamped.
        mass : function
            FE mass, (k, k), projected on displacements (n_dofs, k).
        """
        shapes = self._basis @ self._elastic
        motions, modes = shapes[:, :self._count], shapes[:, self._count:]
        of_motions = self._each(motions)
        stretching, clear = self._divided(of_motions, shapes)
        own = modes @ clear
        load_modes, Q = self._load_modes(loads, answers - own @ (own.T @ loads), mass)

        turn, G = self._prestresses(of_motions, motions, motions)
        count, turn = len(G), block_diag(turn, stretching)
        size = self._largest(shapes @ turn)     # motions d_e of largest rotation 1
        Ghat = np.concatenate([G, self._each(modes @ stretching)]) / size[:, None, None]
        chosen = np.append(self._that_matter(Ghat[:count]), np.ones(len(Ghat) - count, dtype=bool))
        E = (self._stiffness @ self._elastic @ turn * size)[:, chosen]
        return Stiffening(load_modes, Q, 1 / size[chosen]**2, E, Ghat[chosen], self._count,
                          stretching.shape[1])

    def _each(self, shapes: NDArray) -> NDArray:
        """G (k, n, n) of displacements (n_dofs, k)."""
        return self._of(shapes, None)

    def _load_modes(self, loads: NDArray, answers: NDArray, mass: Callable[[NDArray], NDArray]
                    ) -> tuple[NDArray, NDArray]:
        """Shapes of unit modal mass, and their Q."""
        values, vectors = np.linalg.eigh(loads.T @ answers)
        independent = values > _NULL * values.max(initial=0.0)
        orthonormal = vectors[:, independent] / np.sqrt(values[independent])
        moved = self._elastic @ (self._elastic.T @ (self._basis.T @ loads))
        shapes = answers @ orthonormal
        turn, G = self._prestresses(self._each(shapes), shapes,
                                    (answers + self._basis @ moved) @ orthonormal)
        shapes = shapes @ turn
        modal = np.diag(mass(shapes))           # the strain energy kap is then 1 / modal
        return shapes / np.sqrt(modal), -G * np.sqrt(modal)[:, None, None]

    def _divided(self, of_motions: NDArray, shapes: NDArray) -> tuple[NDArray, NDArray]:
        """Turns of the internal modes: those that stretch, and what load modes leave out."""
        vibrations = self._vibrations[:, -self._lowest:]
        reached = _LARGEST_MOTION / self._largest(shapes @ vibrations)
        amplitudes = vibrations * np.minimum(reached, np.sqrt(_SOFT) * reached.min(initial=np.inf))
        low, modes = self._elastic @ vibrations, shapes[:, self._count:]
        of_modes = self._of(modes, low)
        return divide(np.array([*(low.T @ of_motions @ low), *of_modes]),
                      amplitudes[self._count:], modes)

    def _that_matter(self, Ghat: NDArray) -> NDArray:
        """Resultants to keep, of geometric stiffnesses of motions of largest rotation 1."""
        if len(Ghat) <= _MANY:
            return np.ones(len(Ghat), dtype=bool)
        relative = self._elastic.T @ Ghat @ self._elastic
        return _LARGEST_MOTION * np.linalg.norm(relative, 2, axis=(1, 2)) > _SLIGHT

    def _prestresses(self, G: NDArray, shapes: NDArray, motions: NDArray
                     ) -> tuple[NDArray, NDArray]:
        """Turn (k, m) of orthonormal shapes (n_dofs, k) to the m that matter, and their G.

        With each shape the body has the displacement (n_dofs,) of the same column of `motions`.
        """
        size = len(self._stiffness)
        if shapes.shape[1] == 0 or self._elastic.shape[1] == 0:     # nothing could become stiffer
            return np.zeros((shapes.shape[1], 0)), np.zeros((0, size, size))
        relative = self._elastic.T @ G @ self._elastic
        turn, singular, _ = np.linalg.svd(relative.reshape(len(G), -1), full_matrices=False)
        turn = turn[:, singular > _ROUNDING * singular.max(initial=0.0)]
        turn = turn @ canonical_turn(singular[:turn.shape[1]], shapes @ turn)
        relative = np.einsum("bf,bij->fij", turn, relative)
        factor = _LARGEST_MOTION / self._largest(motions @ turn)
        changes = np.array([self._changes(one) for one in factor[:, None, None] * relative])
        tension = np.isinf(changes[:, 1])
        if changes[~tension, 0].max(initial=0.0) < _FIRST_ORDER:
            turn = turn[:, changes[:, 1] > _WEAK]
        return turn, np.einsum("bf,bij->fij", turn, G)

    def _changes(self, relative: NDArray) -> tuple[float, float]:
        """Largest change of a squared frequency by a stiffness over the elastic one.

        To first order, and in all. The change is that of the lowest frequencies: higher ones lie so
        close that bending and twist of nearly one frequency change each other more, and the more
        modes a body has the more often; but such short waves do not change what the body does.
        """
        inverse, matrix = self._inverse, self._vibrations.T @ relative @ self._vibrations
        equal = np.abs(inverse[:, None] - inverse) <= _REPEATED * np.maximum.outer(inverse, inverse)
        first = np.abs(np.linalg.eigvalsh(np.where(equal, matrix, 0.0))).max()
        lowest, most = slice(-self._lowest, None), 0.0
        for changed in (np.eye(len(matrix)) + matrix, np.eye(len(matrix)) - matrix):
            if np.linalg.eigvalsh(changed)[0] <= _WEAK:     # it buckles, or nearly
                return first, np.inf
            changes = eigh(np.diag(inverse), changed, eigvals_only=True)
            most = max(most, np.abs(inverse[lowest] / changes[lowest] - 1).max())
        return first, most
