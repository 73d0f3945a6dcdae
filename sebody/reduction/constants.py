"""The constants of a body's exact inertia and of its stiffening, from its FE model and modes."""

from dataclasses import replace
from itertools import count

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics.errors import InputError
from sebody.basics.inputs import refusal
from sebody.fem.model import FEModel
from sebody.reduction.body import ReducedBody
from sebody.reduction.boundary import Boundary
from sebody.reduction.clamped import ClampedInterior
from sebody.reduction.component import ComponentModes
from sebody.reduction.integrals import MassIntegrals
from sebody.reduction.invariant_checks import CONTRADICTION_LIMIT
from sebody.reduction.invariants import InertiaInvariants
from sebody.reduction.recovery import Recovery
from sebody.reduction.static_correction import static_correction
from sebody.reduction.stiffening import GeometricStiffness, Stiffening
from sebody.reduction.watch import Watch

_ASYMMETRY = 1e-8  # of a geometric stiffness, relative to its largest entry


def with_constants(body: ReducedBody, fe_model: FEModel, boundary: Boundary,
                   component: ComponentModes, interior: ClampedInterior, forces: NDArray,
                   watch: Watch) -> ReducedBody:
    """The body with its shapes, exact inertia if the FE model has a mass field, and stiffening.

    Parameters
    ----------
    component : ComponentModes
        Shapes of the reduced coordinates, in the DOFs that the boundary leaves independent.
    forces : (n, k)
        Loads on these DOFs, in the order of the body's.
    """
    shapes = boundary.ties.spread(component.basis)
    invariants = extra = None
    if fe_model.mass_field is not None:
        invariants, extra = _invariants(body, fe_model, boundary, component, interior, watch)
        shapes = np.hstack([shapes, extra.load_modes])
    notes = (*body.notes, *_inertia_notes(fe_model), *_stiffening_notes(fe_model, extra))
    recovery = _recovery(fe_model, shapes)
    if fe_model.stress:
        static = static_correction(fe_model, boundary, component, interior, body, forces)
        recovery = replace(recovery, static=fe_model.by_nodes(boundary.ties.spread(static)))
    return replace(body, invariants=invariants, recovery=recovery, notes=notes)


def with_shapes(body: ReducedBody, fe_model: FEModel, boundary: Boundary,
                component: ComponentModes) -> ReducedBody:
    """The body with its shapes alone."""
    return replace(body, recovery=_recovery(fe_model, boundary.ties.spread(component.basis)))


def _recovery(fe_model: FEModel, shapes: NDArray) -> Recovery:
    return Recovery(fe_model.by_nodes(shapes), fe_model.coordinates, fe_model.node_dofs,
                    cells=fe_model.cells, labels=fe_model.labels, stress=fe_model.stress,
                    outlines=fe_model.outlines)


def _inertia_notes(fe_model: FEModel) -> list[str]:
    """Notes on the parts of the inertia of the moving body."""
    if fe_model.mass_field is None:
        return []
    turning = fe_model.rows[:, fe_model.coordinates.shape[1]:]
    turning = turning[turning >= 0]
    massless = len(turning) and not fe_model.mass.diagonal()[turning].any()
    return ["exact inertia from the points of the mass" + (
        "; nodal rotations carry none" if massless else "")]


def _stiffening_notes(fe_model: FEModel, extra: Stiffening | None) -> list[str]:
    if extra is None or fe_model.geometric_stiffness is None:
        return []
    if not len(extra.Q) + len(extra.lam):
        return ["stiffening by stresses: negligible"]
    own = len(extra.lam) - extra.internal
    rest = "; the others change little" if own < extra.motions else ""
    internal = f", {extra.internal} of internal modes that stretch" if extra.internal else ""
    return [f"stiffening by stresses: {len(extra.Q)} load modes, {own} of {extra.motions} "
            f"resultants of second order{internal}{rest}"]


def _invariants(body: ReducedBody, fe_model: FEModel, boundary: Boundary,
                component: ComponentModes, interior: ClampedInterior, watch: Watch
                ) -> tuple[InertiaInvariants, Stiffening]:
    """Integrals about the mean of the boundary nodes, and what is of second order."""
    origin = body.coordinates.mean(axis=0)
    integrals = MassIntegrals(fe_model.mass_field, origin)
    shapes = boundary.ties.spread(component.basis)
    if fe_model.geometric_stiffness is None:
        n = shapes.shape[1]
        extra = Stiffening(np.zeros((len(shapes), 0)), np.zeros((0, n, n)), np.zeros(0),
                           np.zeros((n, 0)), np.zeros((0, n, n)))
    else:
        extra = _stiffening(fe_model, boundary, component, interior, body, integrals, watch)
    watch.stage("integrals of the inertia")
    values = integrals.integrals(np.hstack([shapes, extra.load_modes]))
    _check_mass(values["Mbar"][:len(body.mass), :len(body.mass)], body.mass)
    return InertiaInvariants(
        mass=float(fe_model.mass_field.mass.sum()), **values, Q=extra.Q, lam=extra.lam, E=extra.E,
        Ghat=extra.Ghat, origin=origin), extra


def _check_mass(found: NDArray, mass: NDArray) -> None:
    unit = np.sqrt(np.outer(np.diag(mass), np.diag(mass)))
    defect = np.abs(found - mass).max(initial=0.0, where=unit > 0)
    if np.any(np.abs(found - mass) > CONTRADICTION_LIMIT * unit.max()):
        raise InputError(f"mass_field contradicts the FE mass matrix: a difference of "
                         f"{defect:.3g} in the reduced mass; give the points, displacements and "
                         "weights that the matrix was integrated with, or no mass_field")


def _stiffening(fe_model: FEModel, boundary: Boundary, component: ComponentModes,
                interior: ClampedInterior, body: ReducedBody, integrals: MassIntegrals,
                watch: Watch) -> Stiffening:
    """Load modes and resultants; a prestress is its displacement above the forces on the means."""
    ties, basis, n = boundary.ties, component.basis, boundary.ties.size
    shapes = ties.spread(basis)
    # of solids it is linear by construction, and projected without a matrix of all DOFs
    projected = getattr(fe_model.geometric_stiffness, "projected", None)
    if projected is None:
        _check_linear(fe_model, shapes @ np.ones(shapes.shape[1]))
    faces = ties.tied_rows()
    stretched = fe_model.stiffness[:, faces].T
    done = count(1)

    def one_by_one(displacements: NDArray, onto: NDArray) -> NDArray:
        result = np.zeros((displacements.shape[1], onto.shape[1], onto.shape[1]))
        for k, displacement in enumerate(displacements.T):
            watch.stage(f"geometric stiffness of prestress {next(done)}")
            result[k] = onto.T @ (fe_model.geometric_stiffness(displacement) @ onto)
        return result

    def geometric(prestresses: NDArray, turn: NDArray | None) -> NDArray:
        own, onto = (basis, shapes) if turn is None else (basis @ turn, shapes @ turn)
        displacements = ties.spread(prestresses[:n])
        if projected:
            watch.stage(f"geometric stiffness of {displacements.shape[1]} prestresses")
        G = (projected or one_by_one)(displacements, onto)
        forces = np.zeros(len(shapes))
        for k, on_faces in enumerate((stretched @ displacements).T):
            forces[faces] = on_faces
            G[k] += boundary.second_order(forces, prestresses[n:, k], own)
        return (G + G.transpose(0, 2, 1)) / 2

    # rotations of lumped masses have no inertia, but turn what is fixed to them
    turning = fe_model.rows[:, body.coordinates.shape[1]:]
    massless = (turning >= 0) & (fe_model.mass.diagonal()[turning] == 0.0)

    def largest(motions: NDArray) -> NDArray:
        moved = ties.spread(motions[:n])
        found = integrals.largest(moved)
        if massless.any():
            turned = np.where(massless[..., None], moved[turning], 0.0)
            found = np.maximum(found, np.linalg.norm(turned, axis=1).max(axis=0, initial=0.0))
        return found

    held, size = boundary.size, integrals.size
    dimension = body.coordinates.shape[1]
    scale = np.full(held, size)
    scale[:dimension * len(body.position_nodes)] = 1.0
    rigid = body.rigid_modes_about(body.coordinates.mean(axis=0))
    loads = ties.gather(integrals.loads() * integrals.isotropic())
    loads[boundary.held] = 0.0
    answers, on_means = interior.answer(loads)
    above = np.zeros((len(on_means), len(component.omega_squared)))
    stress_stiffness = GeometricStiffness(
        geometric, np.vstack([basis, np.hstack([component.on_means, above])]), body.stiffness,
        body.mass, scale, rigid / [*[1.0] * dimension, *[size] * (rigid.shape[1] - dimension)],
        largest
    ).stiffening(np.vstack([loads, np.zeros(on_means.shape)]), np.vstack([answers, on_means]),
                 lambda moved: moved[:n].T @ (ties.project(fe_model.mass) @ moved[:n]))
    return replace(stress_stiffness, load_modes=ties.spread(stress_stiffness.load_modes[:n]))


def _check_linear(fe_model: FEModel, displacement: NDArray) -> None:
    """Refuse what is no prestress: it must double with the displacement."""
    once, twice = (fe_model.geometric_stiffness(k * displacement) for k in (1.0, 2.0))
    for tangent in (once, twice):
        _check_geometric(tangent, fe_model.stiffness)
    if abs(twice - 2.0 * once).max() > _ASYMMETRY * abs(once).max():
        raise InputError("geometric_stiffness does not double with the displacement; give that of "
                         "the linear stresses, without the stiffness at rest or terms of second "
                         "order")


def _check_geometric(tangent: sparse.csc_array, stiffness: sparse.csc_array) -> None:
    if not (sparse.issparse(tangent) or isinstance(tangent, np.ndarray)):
        raise refusal("the value of geometric_stiffness", tangent, "return a sparse matrix")
    if tangent.shape != stiffness.shape:
        raise InputError(f"geometric_stiffness has shape {tangent.shape}; the model's DOFs need "
                         f"{stiffness.shape}")
    if not np.isfinite(tangent.data if sparse.issparse(tangent) else tangent).all():
        raise InputError("geometric_stiffness is not finite; compute it again")
    if abs(tangent - tangent.T).max() > _ASYMMETRY * abs(tangent).max():
        raise InputError("geometric_stiffness is not symmetric; give the second derivative of the "
                         "energy, not a tangent with follower forces")
