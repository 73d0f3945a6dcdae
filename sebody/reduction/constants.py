"""The constants of a body's exact inertia and of its stiffening, from its FE model and modes."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sebody.errors import InputError
from sebody.fem.model import FEModel
from sebody.reduction.body import ReducedBody
from sebody.reduction.boundary import Boundary
from sebody.reduction.clamped import ClampedInterior
from sebody.reduction.integrals import MassIntegrals
from sebody.reduction.invariant_checks import CONTRADICTION_LIMIT
from sebody.reduction.invariants import InertiaInvariants
from sebody.reduction.recovery import Recovery
from sebody.reduction.static_correction import static_correction
from sebody.reduction.stiffening import GeometricStiffness, Stiffening

_ASYMMETRY = 1e-8  # of a geometric stiffness, relative to its largest entry


def with_constants(body: ReducedBody, fe_model: FEModel, boundary: Boundary, basis: NDArray,
                   interior: ClampedInterior) -> ReducedBody:
    """The body with its shapes, exact inertia if the FE model has a mass field, and stiffening.

    Parameters
    ----------
    basis : (n_dofs, n)
        Shapes of the reduced coordinates.
    """
    shapes = basis
    invariants = None
    if fe_model.mass_field is not None:
        invariants, load_modes = _invariants(body, fe_model, boundary, basis, interior)
        shapes = np.hstack([basis, load_modes])
    recovery = Recovery(fe_model.by_nodes(shapes), fe_model.coordinates, fe_model.node_dofs,
                        cells=fe_model.cells, labels=fe_model.labels, stress=fe_model.stress,
                        outlines=fe_model.outlines)
    if fe_model.stress:
        static = static_correction(fe_model, basis, body, interior)
        recovery = replace(recovery, static=fe_model.by_nodes(static))
    return replace(body, invariants=invariants, recovery=recovery)


def _invariants(body: ReducedBody, fe_model: FEModel, boundary: Boundary, basis: NDArray,
                interior: ClampedInterior) -> tuple[InertiaInvariants, NDArray]:
    """Integrals about the mean of the boundary nodes, and the load modes (n_dofs, n_eta)."""
    origin = body.coordinates.mean(axis=0)
    integrals = MassIntegrals(fe_model.mass_field, origin)
    if fe_model.geometric_stiffness is None:
        n = basis.shape[1]
        extra = Stiffening(np.zeros((len(basis), 0)), np.zeros((0, n, n)), np.zeros(0),
                           np.zeros((n, 0)), np.zeros((0, n, n)))
    else:
        extra = _stiffening(fe_model, boundary, basis, interior, body, integrals)
    found = integrals.integrals(np.hstack([basis, extra.load_modes]))
    _check_mass(found["Mbar"][:len(body.mass), :len(body.mass)], body.mass)
    return InertiaInvariants(
        mass=float(fe_model.mass_field.mass.sum()), **found, Q=extra.Q, lam=extra.lam, E=extra.E,
        Ghat=extra.Ghat, origin=origin), extra.load_modes


def _check_mass(found: NDArray, mass: NDArray) -> None:
    unit = np.sqrt(np.outer(np.diag(mass), np.diag(mass)))
    defect = np.abs(found - mass).max(initial=0.0, where=unit > 0)
    if np.any(np.abs(found - mass) > CONTRADICTION_LIMIT * unit.max()):
        raise InputError(f"mass_field makes another mass than the FE mass matrix: off by "
                         f"{defect:.3g} in the reduced mass; give the points, displacements and "
                         "weights that the matrix was integrated with, or no mass_field")


def _stiffening(fe_model: FEModel, boundary: Boundary, basis: NDArray, interior: ClampedInterior,
                body: ReducedBody, integrals: MassIntegrals) -> Stiffening:
    held = boundary.motion.shape[1]
    stiffness, size = fe_model.stiffness, integrals.size
    dimension = body.coordinates.shape[1]

    def geometric(shape: NDArray) -> NDArray:
        tangent = fe_model.geometric_stiffness(shape)
        if tangent.shape != stiffness.shape:
            raise InputError(f"geometric_stiffness has shape {tangent.shape}; the model's DOFs "
                             f"need {stiffness.shape}")
        if abs(tangent - tangent.T).max() > _ASYMMETRY * abs(tangent).max():
            raise InputError("geometric_stiffness is not symmetric; give the second derivative of "
                             "the energy, not a tangent with follower forces")
        G = basis.T @ (tangent @ basis)
        G[:held, :held] += boundary.second_order(stiffness @ shape)
        return (G + G.T) / 2

    scale = np.full(held, size)
    scale[:dimension * len(body.position_nodes)] = 1.0
    rigid = body.rigid_modes_about(body.coordinates.mean(axis=0))
    loads = integrals.loads()
    loads[np.setdiff1d(np.arange(len(loads)), interior.internal)] = 0.0
    answers = interior.displacement(loads)
    return GeometricStiffness(
        geometric, basis, body.stiffness, body.mass, scale, rigid / [
            *[1.0] * dimension, *[size] * (rigid.shape[1] - dimension)], integrals.largest
    ).stiffening(loads, answers, answers.T @ (fe_model.mass @ answers))
