"""Component modes of Craig and Bampton (section 2 of the paper).

    FE matrices -> constraint modes (2)-(4) -> fixed-interface modes (5)-(6) -> project (25), (38)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.matrices import fe_matrix
from sebody.fem.model import FEModel
from sebody.reduction.accuracy import Accuracy
from sebody.reduction.body import ReducedBody
from sebody.reduction.boundary import Items
from sebody.reduction.clamped import ClampedInterior
from sebody.reduction.component import ComponentModes, static_modes
from sebody.reduction.methods import reduce
from sebody.reduction.path_loads import PathLoads


def craig_bampton(
    fe_model: FEModel,
    boundary: Items,
    modes: int | Accuracy,
    select: Sequence[int] | None = None,
    recover: Sequence[int] | None = None,
    loads: Mapping[str, ArrayLike] | None = None,
    residual_modes: bool = False,
    paths: Mapping[str, str | Sequence[int] | PathLoads] | None = None,
) -> ReducedBody:
    """Superelement of an FE model; no modes gives Guyan's reduction.

    The same as `reduce` with its first method.

    If the model has a mass field, the body gets the constants of its exact inertia,
    and with a geometric stiffness those of its stiffening.

    Parameters
    ----------
    fe_model : FEModel
        Free FE model.
    boundary : mapping or pairs of node index and 'full', 'translation' or 'rotation'
        Boundary nodes, in the order wanted, and the DOF blocks kept there. A DOF block not kept is
        an internal DOF. In place of a node, a `RigidFace` ties FE nodes to a boundary node, and a
        `MeanFace` is the mean motion of FE nodes; a face by itself keeps both blocks.
    modes : int or Accuracy
        Number of fixed-interface modes, from the lowest frequency up, or what they are to achieve.
    select : sequence of int, optional
        Which of these modes to keep, counted from 0; default all. Modes that the motion cannot
        excite (out of plane, torsion) can be left out.
    recover : sequence of int, optional
        FE nodes whose motion and stress shall be known afterwards, of a large model; all by
        default. Stresses need all nodes of the elements around.
    loads : mapping of str to (n_dofs,), optional
        Loads on the FE DOFs by name, see `sebody.fem.loads`; applied with `Model.body_load`.
    residual_modes : bool
        Further internal modes that make the static response to every load exact.
    paths : mapping of str to str, sequence of int or PathLoads, optional
        Paths that nodes slide along, with static modes of loads on them; see `reduce`.

    Raises
    ------
    InputError
        Unknown or repeated boundary node, a DOF block the nodes do not have, more modes than there
        are, boundary nodes that leave a mechanism inside, loads of another length, or paths that
        are none.
    """
    return reduce(fe_model, boundary, modes, "craig-bampton", select, recover, loads,
                  residual_modes, paths=paths)


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
    moved = np.zeros((stiffness.shape[0], len(boundary_dofs)))
    moved[boundary_dofs, np.arange(len(boundary_dofs))] = 1.0
    interior = ClampedInterior(stiffness, mass, boundary_dofs)
    static = static_modes(stiffness, interior, moved, np.zeros((0, moved.shape[1])))
    return static.with_vibrations(interior, modes, select)


def _boundary_rows(rows: Sequence[int], size: int) -> NDArray:
    remedy = f"give different rows of the matrices, from 0 to {size - 1}"
    numbers = [inputs.integer(row, "boundary_dofs: one", least=0, most=size - 1, remedy=remedy)
               for row in inputs.items(rows, "boundary_dofs", remedy)]
    if len(set(numbers)) != len(numbers):
        raise inputs.refusal("boundary_dofs", numbers, remedy)
    return np.array(numbers, dtype=int)
