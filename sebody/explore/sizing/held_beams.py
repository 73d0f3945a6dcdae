"""A straight beam of elements of different heights as one superelement whose vibration modes are
held.

The basis ``T = [Psi, Phi]`` has the constraint modes Psi of the heights at hand and the clamped
vibration modes Phi of the heights as built. Psi changes with the height of an element e by
``dPsi = -P dK_e Psi`` with the inverse P of the clamped stiffness, so that

    (26) dS = Psi^T dK_e Psi + Phi^T dK_e Phi
         dM = T^T dM_e T - [Z^T dK_e Psi, 0] - [Z^T dK_e Psi, 0]^T,   Z = P M T

Section forces are those of the static equilibrium with the inertia forces, as results have them;
of vibration modes alone they would follow curvatures that cannot change with a height:

    (27) q = Psi y_B - Z c

with the accelerations c in space of boundary and modes, in axes of the body, without what the spin
adds inside. No mode is differentiated: equal frequencies, as of square sections, do no harm, and
all heights take one factorization.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import block_diag, eigh
from scipy.sparse.linalg import eigsh, splu

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem import beam_element
from sebody.fem.section import Section, StiffnessSection
from sebody.reduction.body import ReducedBody

IN_PLANE = np.array([0, 1, 5, 6, 7, 11])    # DOFs of an element in the xy plane
PLACES = 49             # heights between the bounds that elements are made for
DENSE = 100             # free DOFs up to which all modes are computed
EXACT = 1e-9            # of the largest number: between these places they are known like this


class Element(NamedTuple):
    """Matrices of elements, or their derivatives by the height."""

    stiffness: NDArray      # (elements, k, k)
    mass: NDArray           # (elements, k, k)
    forces: NDArray         # (elements, 2, 6, k) section forces at both ends of unit DOFs
    fibres: NDArray         # (elements, fibres, 6) normal stresses of unit section forces


class Elements:
    """Matrices of an element as smooth functions of its height between two bounds.

    Parameters
    ----------
    section : function
        Of a height.
    length : float
        Of an element.
    low, high : float
    planar : bool

    Raises
    ------
    InputError
        No fibres, or numbers that are not smooth functions.
    """

    def __init__(self, section: Callable[[float], Section | StiffnessSection], length: float,
                 low: float, high: float, planar: bool):
        self.section, self.length = section, length
        self.kept = IN_PLANE if planar else np.arange(12)
        nodes = np.cos(np.pi * (np.arange(PLACES) + 0.5) / PLACES)
        self.middle, self.half = (low + high) / 2, (high - low) / 2
        rows = np.array([self._row(x) for x in self.middle + self.half * nodes])
        self.coefficients = np.linalg.solve(chebyshev.chebvander(nodes, PLACES - 1), rows)
        self.slopes = chebyshev.chebder(self.coefficients) / self.half
        between = np.linspace(low, high, 7)[1:-1]
        wrong = self._at(self.coefficients, between) - [self._row(x) for x in between]
        if (np.abs(wrong) > EXACT * np.abs(rows).max(axis=0)).any():
            raise InputError(f"section: its numbers are not smooth between the heights {low:g} and "
                             f"{high:g}: give closer bounds, or a smooth function")

    def _row(self, height: float) -> NDArray:
        own = inputs.instance(self.section(float(height)), f"section of height {height:.4g}",
                              Section | StiffnessSection,
                              "return one, such as rectangle").stiffnesses
        if not own.fibres:
            raise InputError("section: it has no fibres to take stresses in: give fibres, or a "
                             "section such as rectangle")
        K, M = beam_element.stiffness(own, self.length), beam_element.mass(own, self.length)
        inner = np.ix_(self.kept, self.kept)
        return np.concatenate([K[inner].ravel(), M[inner].ravel(), K[:, self.kept].ravel(),
                               np.ravel([fibre.stress[0] for fibre in own.fibres]),
                               [own.mass * self.length]])

    def _at(self, coefficients: NDArray, heights: NDArray) -> NDArray:
        return chebyshev.chebvander((heights - self.middle) / self.half,
                                    len(coefficients) - 1) @ coefficients

    def at(self, heights: NDArray) -> Element:
        """All elements."""
        return self._parted(self._at(self.coefficients, heights))

    def slopes_at(self, heights: NDArray) -> Element:
        """Their derivatives by the height."""
        return self._parted(self._at(self.slopes, heights))

    def weights(self, heights: NDArray) -> tuple[NDArray, NDArray]:
        """Masses of all elements, and their derivatives, (elements,) each."""
        return self._at(self.coefficients[:, -1], heights), self._at(self.slopes[:, -1], heights)

    def _parted(self, rows: NDArray) -> Element:
        k, n = len(self.kept), len(rows)
        K, M, forces, fibres = np.split(rows[:, :-1], np.cumsum([k * k, k * k, 12 * k]), axis=1)
        sign = np.array([-1.0, 1.0])[:, None, None]     # of the part before the first end
        return Element(K.reshape(n, k, k), M.reshape(n, k, k), sign * forces.reshape(n, 2, 6, k),
                       fibres.reshape(n, -1, 6))


class HeldBeam:
    """Reductions of a beam with two full boundary nodes.

    Parameters
    ----------
    planar : bool
    length : float
    count : int
        Finite elements.
    modes : int
    elements : Elements
    built : (count,)
        Heights that the vibration modes are of.
    """

    def __init__(self, planar: bool, length: float, count: int, modes: int, elements: Elements,
                 built: NDArray):
        self.planar, self.length, self.count, self.modes = planar, length, count, modes
        self.elements = elements
        self.width = 3 if planar else 6
        self.dofs = self.width * np.arange(count)[:, None] + np.arange(2 * self.width)
        self.size = self.width * (count + 1)
        self.edge = np.r_[:self.width, self.size - self.width:self.size]
        self.inside = np.arange(self.width, self.size - self.width)
        self.order = self._order()
        self.Phi = np.zeros((self.size, modes))
        self.hold(built)

    def hold(self, heights: NDArray) -> None:
        """Hold the vibration modes of some heights from here on."""
        if not self.modes:
            return
        K, M = (A[self.inside][:, self.inside] for A in self.matrices(self.elements.at(heights)))
        if len(self.inside) <= DENSE:
            found = eigh(K.toarray(), M.toarray(), subset_by_index=[0, self.modes - 1])[1]
        else:
            found = eigsh(K, self.modes, M, sigma=0.0, v0=np.ones(len(self.inside)))[1]
        self.Phi = np.zeros((self.size, self.modes))
        self.Phi[self.inside] = found

    def _order(self) -> NDArray:
        """Boundary DOFs as reduced coordinates have them: positions first, then rotations."""
        turning = 1 if self.planar else 3
        first = np.arange(self.width - turning)
        last = np.arange(self.width - turning, self.width)
        return self.edge[np.r_[first, self.width + first, last, self.width + last]]

    def matrices(self, elements: Element) -> tuple[sparse.csc_array, sparse.csc_array]:
        """Stiffness and mass of all DOFs."""
        rows, columns = (one.ravel() for one in np.broadcast_arrays(
            self.dofs[:, :, None], self.dofs[:, None, :]))
        K, M = (sparse.csc_array((own.ravel(), (rows, columns)), shape=(self.size, self.size))
                for own in (elements.stiffness, elements.mass))
        return K, M

    def at(self, heights: NDArray) -> Held:
        """The body with some heights."""
        return Held(self, np.asarray(heights, dtype=float))


@dataclass(eq=False)
class Held:
    """A beam with some heights, reduced; along x."""

    beam: HeldBeam
    heights: NDArray

    def __post_init__(self) -> None:
        beam = self.beam
        self.elements = beam.elements.at(self.heights)
        self.by_height = beam.elements.slopes_at(self.heights)
        self.K, self.M = beam.matrices(self.elements)
        inside = beam.inside
        self._factor = splu(sparse.csc_matrix(self.K[inside][:, inside]))
        Psi = np.zeros((beam.size, len(beam.order)))
        Psi[beam.order, np.arange(len(beam.order))] = 1.0
        Psi[inside] = -self._factor.solve(self.K[inside] @ Psi)
        self.Psi, self.T = Psi, np.hstack([Psi, beam.Phi])
        self.stiffness = block_diag(Psi.T @ (self.K @ Psi), beam.Phi.T @ (self.K @ beam.Phi))
        self.mass = self.T.T @ (self.M @ self.T)
        self.Z = self.inverse(self.M @ self.T)

    def inverse(self, loads: NDArray) -> NDArray:
        """Displacements (size, k) of the clamped beam under loads (size, k)."""
        found = np.zeros_like(loads)
        found[self.beam.inside] = self._factor.solve(loads[self.beam.inside])
        return found

    def slopes(self) -> tuple[NDArray, NDArray]:
        """(26): of reduced stiffness and mass by all heights, (elements, n, n) each."""
        beam = self.beam
        dK, dM = self.by_height.stiffness, self.by_height.mass
        T = self.T[beam.dofs]
        Psi, Phi = T[..., :len(beam.order)], T[..., len(beam.order):]
        n, b = T.shape[2], len(beam.order)
        S, M = np.zeros((beam.count, n, n)), np.einsum("eai,eab,ebj->eij", T, dM, T)
        S[:, :b, :b] = np.einsum("eai,eab,ebj->eij", Psi, dK, Psi)
        S[:, b:, b:] = np.einsum("eai,eab,ebj->eij", Phi, dK, Phi)
        turned = np.einsum("eai,eab,ebj->eij", self.Z[beam.dofs], dK, Psi)
        M[:, :, :b] -= turned
        M[:, :b, :] -= turned.transpose(0, 2, 1)
        return S, M

    def fields(self, y: NDArray, c: NDArray) -> NDArray:
        """Displacements of all DOFs in equilibrium, (t, size): (27).

        Parameters
        ----------
        y, c : (t, n)
            Reduced coordinates, and accelerations in space of the boundary and of the modes.
        """
        return y[:, :len(self.beam.order)] @ self.Psi.T - c @ self.Z.T

    def section_forces(self, fields: NDArray) -> NDArray:
        """Section forces at both ends of all elements, (t, elements, 2, 6)."""
        return np.einsum("egfa,tea->tegf", self.elements.forces, fields[:, self.beam.dofs],
                         optimize=True)

    def body(self, turn: NDArray, units: str = "") -> ReducedBody:
        """The reduced body, rotated from the beam's axes to those of a model."""
        ends = np.zeros((2, 2 if self.beam.planar else 3))
        ends[1, 0] = self.beam.length
        found = ReducedBody(self.stiffness, self.mass, ends, ("full", "full"), self.beam.modes,
                            units=units)
        return found.rotated(turn)
