"""Component modes of Craig and Bampton (section 2 of the paper).

    FE matrices -> constraint modes (2)-(4) -> fixed-interface modes (5)-(6) -> project (25), (38)
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import block_diag

from sebody import inputs
from sebody.errors import InputError
from sebody.fem.model import FEModel, fe_matrix
from sebody.reduction.body import ReducedBody
from sebody.reduction.boundary import BoundaryItem, RigidFace, boundary_of
from sebody.reduction.clamped import ClampedInterior
from sebody.reduction.constants import with_constants

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
    """

    constraint: NDArray
    fixed_interface: NDArray
    omega_squared: NDArray

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


def craig_bampton(
    fe_model: FEModel,
    boundary: Mapping[int | RigidFace, str] | Iterable[BoundaryItem],
    modes: int,
    select: Sequence[int] | None = None,
    recover: Sequence[int] | None = None,
) -> ReducedBody:
    """Superelement of an FE model; no modes gives Guyan's reduction.

    Where the model knows the points of its mass, the body gets the constants of its exact inertia,
    and with a geometric stiffness those of its stiffening.

    Parameters
    ----------
    fe_model : FEModel
        Free FE model.
    boundary : mapping or pairs of node index and 'full', 'translation' or 'rotation'
        Boundary nodes, in the order wanted, and the triplets kept there. A triplet not kept is
        an internal DOF. A `RigidFace`, which keeps 'full', ties FE nodes to a boundary node.
    modes : int
        Number of fixed-interface modes, from the lowest frequency up.
    select : sequence of int, optional
        Which of these modes to keep, counted from 0; default all. Modes that the motion cannot
        excite (out of plane, torsion) can be left out.
    recover : sequence of int, optional
        FE nodes whose motion and stress shall be known afterwards, of a large model; all by
        default. Stresses need all nodes of the elements around.

    Raises
    ------
    InputError
        Unknown or repeated boundary node, a triplet the nodes do not have, more modes than there
        are, or boundary nodes that leave a mechanism inside.
    """
    inputs.instance(fe_model, "fe_model", FEModel, "give an FEModel")
    edge = boundary_of(fe_model, boundary)
    component, interior = _component_modes(fe_model.stiffness, fe_model.mass, edge.motion, modes,
                                           select)
    stiffness, mass = component.project(fe_model.stiffness, fe_model.mass)
    body = ReducedBody(stiffness, mass, edge.coordinates, edge.keeps, len(component.omega_squared))
    body = with_constants(body, fe_model, edge, component.basis, interior)
    return body if recover is None else body.recovering(recover)


def component_modes(
    stiffness: sparse.csc_array,
    mass: sparse.csc_array,
    boundary_dofs: Sequence[int],
    modes: int,
    select: Sequence[int] | None = None,
) -> ComponentModes:
    """Constraint modes (4) and fixed-interface modes (6) of FE matrices of any DOF layout.

    Parameters
    ----------
    stiffness, mass : (n_dofs, n_dofs), dense or sparse
        FE matrices.
    boundary_dofs : sequence of int
        Rows of the boundary coordinates, in the order of the reduced coordinates.
    modes, select
        As for `craig_bampton`.

    Raises
    ------
    InputError
        More modes than there are, a wrong selection, or a mechanism inside.
    """
    stiffness, mass = fe_matrix(stiffness, "stiffness"), fe_matrix(mass, "mass")
    if not stiffness.shape == mass.shape == (stiffness.shape[0],) * 2:
        raise InputError(f"stiffness has shape {stiffness.shape} and mass {mass.shape}: give "
                         "square matrices of one size")
    boundary_dofs = _boundary_rows(boundary_dofs, stiffness.shape[0])
    count = len(boundary_dofs)
    held = sparse.csc_array((np.ones(count), (boundary_dofs, np.arange(count))),
                            shape=(stiffness.shape[0], count))
    return _component_modes(stiffness, mass, held, modes, select)[0]


def _component_modes(
    stiffness: sparse.csc_array, mass: sparse.csc_array, motion: sparse.csc_array, modes: int,
    select: Sequence[int] | None
) -> tuple[ComponentModes, ClampedInterior]:
    """Modes of a boundary whose unit coordinates move the DOFs by `motion`; the rest is inside."""
    internal = np.setdiff1d(np.arange(stiffness.shape[0]), motion.indices)
    modes = inputs.integer(modes, "modes")
    if not 0 <= modes <= len(internal):
        raise InputError(
            f"modes is {modes}, but the clamped body has {len(internal)} internal DOFs; ask for "
            f"0 to {len(internal)} or refine the FE model"
        )
    chosen = list(range(modes)) if select is None else [
        inputs.integer(mode, "select: one mode") for mode in inputs.items(
            select, "select", "give a list of modes, counted from 0")]
    if len(set(chosen)) != len(chosen) or not set(chosen) <= set(range(modes)):
        raise InputError(
            f"select = {chosen} must name different modes among the {modes} computed, counted "
            "from 0; raise modes or correct it"
        )
    interior = ClampedInterior(stiffness, mass, internal)
    moved = motion.toarray()
    constraint = moved - interior.displacement(stiffness @ moved)
    omega_squared, shapes = interior.vibrations(modes)
    return ComponentModes(constraint, shapes[:, chosen], omega_squared[chosen]), interior


def _boundary_rows(rows: Sequence[int], size: int) -> NDArray:
    remedy = f"give different rows of the matrices, from 0 to {size - 1}"
    found = [inputs.integer(row, "boundary_dofs: one", least=0, most=size - 1, remedy=remedy)
             for row in inputs.items(rows, "boundary_dofs", remedy)]
    if len(set(found)) != len(found):
        raise inputs.refusal("boundary_dofs", found, remedy)
    return np.array(found, dtype=int)
