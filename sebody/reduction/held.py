"""Reductions whose vibration modes are held while the FE model changes.

Constraint modes are those of the model at hand, so rigid motions and static responses are exact;
the vibration modes are shapes that another model has, as before a change of its sections.
They are no modes of this model: their stiffness and mass are full. So the reduction is a smooth
function of the model also where frequencies are equal and modes change places.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from sebody.fem.model import FEModel
from sebody.reduction.body import ReducedBody
from sebody.reduction.boundary import Items, boundary_of
from sebody.reduction.constants import with_constants
from sebody.reduction.methods import clamped
from sebody.reduction.missing import missing_of
from sebody.reduction.watch import SILENT


def vibration_shapes(fe_model: FEModel, boundary: Items, modes: int) -> NDArray:
    """Clamped vibration modes of an FE model, (independent DOFs, modes)."""
    _, interior, static = clamped(fe_model, boundary_of(fe_model, boundary))
    return static.with_vibrations(interior, modes).fixed_interface


def with_held_modes(fe_model: FEModel, boundary: Items, shapes: NDArray) -> ReducedBody:
    """Superelement of an FE model with given shapes in the place of its vibration modes.

    Parameters
    ----------
    boundary : mapping or pairs
        As of `craig_bampton`.
    shapes : (independent DOFs, modes)
        Of `vibration_shapes`, of a model with the same nodes; zero at the boundary.

    Raises
    ------
    InputError
        As of `craig_bampton`.
    """
    edge = boundary_of(fe_model, boundary)
    (stiffness, mass), interior, static = clamped(fe_model, edge)
    own = shapes.T @ (stiffness @ shapes)
    component = replace(static, fixed_interface=shapes, omega_squared=np.diag(own))
    n = static.constraint.shape[1]
    reduced = component.project(stiffness, mass)
    reduced[1][n:, n:] = shapes.T @ (mass @ shapes)
    body = ReducedBody(block_diag(reduced[0][:n, :n], own), reduced[1], edge.coordinates,
                       edge.keeps, shapes.shape[1], missing=missing_of(fe_model, "craig-bampton"),
                       materials=tuple(fe_model.materials), units=fe_model.units,
                       notes=("vibration modes of another model are held", *edge.notes))
    none = np.zeros((stiffness.shape[0], 0))
    return with_constants(body, fe_model, edge, component, interior, none, SILENT)
