"""Shapes of a reduction: of unit boundary coordinates, and internal ones that leave these 0."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import block_diag

_ROUNDING = 1e-11  # ratio of stiffness to its summands below which stiffness is rounding error


@dataclass(frozen=True, eq=False)
class ComponentModes:
    """Basis of the reduction, ``q = constraint @ y_B + fixed_interface @ y_I`` (10).

    Parameters
    ----------
    constraint : (n_dofs, n_boundary)
        Static modes of unit boundary coordinates (4).
    fixed_interface : (n_dofs, m)
        Vibration modes with the boundary clamped, mass-normalised (6).
    omega_squared : (m,)
        Squares of their angular frequencies [1/time^2].
    on_means : (m, n_boundary)
        Forces on the boundary coordinates that are means, in the constraint modes.
    """

    constraint: NDArray
    fixed_interface: NDArray
    omega_squared: NDArray
    on_means: NDArray

    @property
    def basis(self) -> NDArray:
        """All modes side by side, (n_dofs, n_boundary + m)."""
        return np.hstack([self.constraint, self.fixed_interface])

    def project(self, stiffness: sparse.csc_array, mass: sparse.csc_array) -> tuple:
        """Reduced stiffness (25) and mass (38), (n, n) each, of the FE matrices."""
        static, dynamic = self.constraint, self.fixed_interface
        boundary = static.T @ (stiffness @ static)
        summands = np.abs(static).T @ (abs(stiffness) @ np.abs(static))
        if np.all(np.abs(boundary) <= _ROUNDING * summands):
            boundary[:] = 0.0  # a boundary that holds the body without strain, e.g. one node
        coupling = static.T @ (mass @ dynamic)
        reduced_mass = np.block([
            [static.T @ (mass @ static), coupling],
            [coupling.T, np.eye(dynamic.shape[1])],
        ])
        return block_diag(boundary, np.diag(self.omega_squared)), reduced_mass
