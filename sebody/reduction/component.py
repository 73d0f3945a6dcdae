"""Shapes of a reduction: of unit boundary coordinates, and internal ones that leave these 0."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import block_diag

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.tabular import brief
from sebody.reduction.clamped import ClampedInterior

_ROUNDING = 1e-11  # ratio of stiffness to its summands below which stiffness is rounding error


@dataclass(frozen=True, eq=False)
class ComponentModes:
    """Basis of the reduction, ``q = constraint @ y_B + fixed_interface @ y_I`` (10).

    Parameters
    ----------
    constraint : (n_dofs, n_boundary)
        Static modes of unit boundary coordinates (4).
    fixed_interface : (n_dofs, m)
        Vibration modes with the boundary clamped, mass-normalised (6), or the shapes that another
        reduction has in their place.
    omega_squared : (m,)
        Squares of their angular frequencies [1/time^2].
    on_means : (m, n_boundary)
        Forces on the boundary coordinates that are means, in the constraint modes.
    strainless : (k,) of int
        Boundary coordinates whose constraint modes are rigid motions of the body.
    """

    constraint: NDArray
    fixed_interface: NDArray
    omega_squared: NDArray
    on_means: NDArray
    strainless: NDArray = field(default_factory=lambda: np.zeros(0, dtype=int))

    __repr__ = brief

    @property
    def basis(self) -> NDArray:
        """All modes side by side, (n_dofs, n_boundary + m)."""
        return np.hstack([self.constraint, self.fixed_interface])

    def project(self, stiffness: sparse.csc_array, mass: sparse.csc_array) -> tuple:
        """Reduced stiffness (25) and mass (38), (n, n) each, of the FE matrices."""
        static, dynamic = self.constraint, self.fixed_interface
        boundary = static.T @ (stiffness @ static)
        boundary = (boundary + boundary.T) / 2  # rounding of what is stiff, as axially, is not
        summands = np.abs(static).T @ (abs(stiffness) @ np.abs(static))
        if np.all(np.abs(boundary) <= _ROUNDING * summands):
            boundary[:] = 0.0  # a boundary that holds the body without strain, e.g. one node
        # of these rounding alone is left, which nothing else of their kind would show to be small
        boundary[self.strainless] = boundary[:, self.strainless] = 0.0
        coupling = static.T @ (mass @ dynamic)
        reduced_mass = np.block([
            [static.T @ (mass @ static), coupling],
            [coupling.T, np.eye(dynamic.shape[1])],
        ])
        return block_diag(boundary, np.diag(self.omega_squared)), reduced_mass

    def project_damping(self, damping: sparse.csc_array) -> NDArray:
        """Reduced damping (n, n) of an FE matrix of the deformation."""
        basis = self.basis
        reduced = basis.T @ (damping @ basis)
        reduced[self.strainless] = reduced[:, self.strainless] = 0.0
        return (reduced + reduced.T) / 2

    def with_rigid(self, rigid: NDArray, values: NDArray, strainless: NDArray) -> ComponentModes:
        """Constraint modes that make rigid motions (n_dofs, r) of their boundary values (n_b, r).

        They are that but for rounding, which is large where parts of the body hang softly. Those
        of the boundary coordinates `strainless` are such motions themselves.
        """
        unit = np.abs(values).max(axis=1, keepdims=True)
        unit[unit == 0] = 1.0
        missing = rigid - self.constraint @ values
        return replace(self, strainless=strainless, constraint=self.constraint + missing @ (
            np.linalg.pinv(values / unit) / unit.T))

    def with_vibrations(self, interior: ClampedInterior, modes: int,
                        select: Sequence[int] | None = None) -> ComponentModes:
        """The same boundary with the lowest modes of its interior, or with those selected of them.

        Raises
        ------
        InputError
            More modes than there are, or a wrong selection.
        """
        modes = check_count(modes, interior)
        chosen = list(range(modes)) if select is None else [
            inputs.integer(mode, "select: one mode") for mode in inputs.items(
                select, "select", "give a list of modes, counted from 0")]
        if len(set(chosen)) != len(chosen) or not set(chosen) <= set(range(modes)):
            raise InputError(
                f"select = {chosen} must name different modes among the {modes} computed, counted "
                "from 0; raise modes or correct it"
            )
        omega_squared, shapes = interior.vibrations(modes)
        return replace(self, fixed_interface=shapes[:, chosen],
                       omega_squared=omega_squared[chosen])


def check_count(modes: int, interior: ClampedInterior,
                what: str = "clamped body has {} internal DOFs") -> int:
    """A number of modes that the body has."""
    modes = inputs.integer(modes, "modes")
    if not 0 <= modes <= interior.count:
        raise InputError(f"modes is {modes}, but the {what.format(interior.count)}; ask for 0 to "
                         f"{interior.count} or refine the FE model")
    return modes


def static_modes(stiffness: sparse.csc_array, interior: ClampedInterior, moved: NDArray,
                 values: NDArray) -> ComponentModes:
    """Constraint modes alone, of unit motions `moved` of DOFs and `values` of means."""
    answers, on_means = interior.answer(-(stiffness @ moved), values)
    return ComponentModes(moved + answers, np.zeros((len(moved), 0)), np.zeros(0), on_means)
