"""The constants of a body's exact inertia and of its stiffening, from its FE model and modes."""

import numpy as np
from numpy.typing import NDArray

from sebody.fem.model import FEModel
from sebody.reduction.body import ReducedBody
from sebody.reduction.boundary import Boundary
from sebody.reduction.clamped import ClampedInterior
from sebody.reduction.integrals import MassIntegrals
from sebody.reduction.invariants import InertiaInvariants
from sebody.reduction.stiffening import GeometricStiffness, Stiffening


def invariants_of(fe_model: FEModel, boundary: Boundary, basis: NDArray, interior: ClampedInterior,
                  body: ReducedBody) -> InertiaInvariants:
    """Integrals about the mean of the boundary nodes, with stiffening if the model has K_G.

    Parameters
    ----------
    basis : (n_dofs, n)
        Shapes of the reduced coordinates.
    """
    origin = body.coordinates.mean(axis=0)
    integrals = MassIntegrals(fe_model.mass_field, origin)
    if fe_model.geometric_stiffness is None:
        n = basis.shape[1]
        extra = Stiffening(np.zeros((len(basis), 0)), np.zeros((0, n, n)), np.zeros(0),
                           np.zeros((n, 0)), np.zeros((0, n, n)))
    else:
        extra = _stiffening(fe_model, boundary, basis, interior, body, integrals)
    found = integrals.integrals(np.hstack([basis, extra.load_modes]))
    return InertiaInvariants(mass=float(fe_model.mass_field.mass.sum()), **found, Q=extra.Q,
                             lam=extra.lam, E=extra.E, Ghat=extra.Ghat, origin=origin)


def _stiffening(fe_model: FEModel, boundary: Boundary, basis: NDArray, interior: ClampedInterior,
                body: ReducedBody, integrals: MassIntegrals) -> Stiffening:
    held = boundary.motion.shape[1]
    stiffness, size = fe_model.stiffness, integrals.size
    dimension = body.coordinates.shape[1]

    def geometric(shape: NDArray) -> NDArray:
        G = basis.T @ (fe_model.geometric_stiffness(shape) @ basis)
        G[:held, :held] += boundary.second_order(stiffness @ shape)
        return (G + G.T) / 2

    scale = np.full(held, size)
    scale[:dimension * len(body.position_nodes)] = 1.0
    rigid = np.linalg.matrix_rank(
        body.rigid_modes_about(body.coordinates.mean(axis=0))[:held] / size)
    loads = integrals.loads()
    loads[np.setdiff1d(np.arange(len(loads)), interior.internal)] = 0.0
    answers = interior.displacement(loads)
    return GeometricStiffness(geometric, basis, body.stiffness, scale, rigid, integrals.largest
                              ).stiffening(answers, loads.T @ answers,
                                           answers.T @ (fe_model.mass @ answers))
