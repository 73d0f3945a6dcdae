"""Static response of the omitted modes of a body to its inertia loads.

Fixed-interface modes converge slowly where stresses are largest, at the boundary: there each of
them is held. With the residual flexibility of the clamped body,

    B = S_II^-1 - sum phi phi^T / omega^2    over the modes kept,

the displacement under loads p and the inertia ``-M a`` is ``Phi y + B (p - M a)``: the modes' own
part stays as the equations of motion make it, all others answer as to a load that changes slowly.
This is the method of mode acceleration (R.R. Craig and A.J. Kurdila, Fundamentals of Structural
Dynamics, 2nd ed., 2006, section 11.4). The accelerations are those of the boundary, which the
constraint modes carry inside, and the centripetal ones of the undeformed body; Coriolis' and those
of the deformation on a turning frame are left out.
"""

import numpy as np
from numpy.typing import NDArray

from sebody.fem.model import FEModel
from sebody.reduction.body import ReducedBody
from sebody.reduction.boundary import Boundary
from sebody.reduction.clamped import ClampedInterior
from sebody.reduction.component import ComponentModes
from sebody.reduction.integrals import MassIntegrals


def static_correction(fe_model: FEModel, boundary: Boundary, component: ComponentModes,
                      interior: ClampedInterior, body: ReducedBody, forces: NDArray) -> NDArray:
    """Displacements of the DOFs that the boundary leaves independent, under unit loads.

    The loads are ``M`` times the constraint modes, for unit accelerations of the n_b boundary
    coordinates, and minus those of centripetal accelerations of unit ``w_k w_l``, k <= l, about the
    mean of the boundary nodes; the latter are 0 of FE models whose points of mass are not known.
    Then come the loads on the body itself.

    Parameters
    ----------
    forces : (n, k)
        These loads.

    Returns
    -------
    (n, n_b + pairs + k)
    """
    ties, held = boundary.ties, len(body.stiffness) - body.modes
    modes = component.basis[:, held:]
    loads = np.hstack([ties.project(fe_model.mass) @ component.basis[:, :held],
                       ties.gather(_spin_loads(fe_model, body)), forces])
    loads[boundary.held] = 0.0
    # of modes that are held this stiffness is full, otherwise it has the squares of frequencies
    return interior.displacement(loads) - modes @ np.linalg.solve(body.stiffness[held:, held:],
                                                                  modes.T @ loads)


def _spin_loads(fe_model: FEModel, body: ReducedBody) -> NDArray:
    """Loads ``A_l^T M E_rk``, symmetrised in k and l, off the diagonal for both."""
    angles = 1 if body.planar else 3
    pairs = [(k, m) for k in range(angles) for m in range(k, angles)]
    if fe_model.mass_field is None:
        return np.zeros((fe_model.stiffness.shape[0], len(pairs)))
    integrals = MassIntegrals(fe_model.mass_field, body.coordinates.mean(axis=0))
    loads = integrals.loads()[:, -len(pairs):] * integrals.size
    return loads * [1.0 if k == m else 2.0 for k, m in pairs]
