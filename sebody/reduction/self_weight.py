"""Stiffness of a held structure under its own weight and loads that it carries.

A foundation that bears a weight is less stiff than unloaded: with the stresses of the displacements
u under the weights, base held, its reduced stiffness is ``K + K_W``, ``K_W = Phi^T K_G(u) Phi``.
Of a body that stiffens under gravity, as reductions of FE models with a geometric stiffness do, the
same happens by itself; K_W is for bodies whose weights are not part of the model.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.loads import body_force
from sebody.fem.model import FEModel
from sebody.reduction.body import ReducedBody
from sebody.reduction.boundary import BoundaryItem, Items, boundary_of
from sebody.reduction.interfaces import MeanFace, RigidFace
from sebody.reduction.methods import clamped, reduce
from sebody.reduction.rigid_motions import rigid_motions
from sebody.reduction.summary import place


def self_weight_stiffness(fe_model: FEModel, boundary: Items, base: int | RigidFace | MeanFace,
                          modes: int = 0, gravity: ArrayLike | None = None,
                          loads: ArrayLike | None = None) -> NDArray:
    """Geometric stiffness of the stresses of weights, in the coordinates of a held body.

    Parameters
    ----------
    fe_model : FEModel
        Free FE model with a geometric stiffness.
    boundary : mapping or pairs
        Interfaces as of `craig_bampton`, without the base.
    base : int, RigidFace or MeanFace
        What is held.
    modes : int
        Number of internal modes, both interfaces and base clamped.
    gravity : (3,), planar (2,), optional
        Acceleration of free fall of the own weight, in FE axes [length/time^2].
    loads : (n_dofs,), optional
        Further loads on the FE DOFs, such as the weight of what stands on top, see
        `sebody.fem.loads`.

    Returns
    -------
    (n, n)
        For ``grounded_body(..., self_weight_stiffness=)``.

    Raises
    ------
    InputError
        No geometric stiffness, neither gravity nor loads, or what `craig_bampton` refuses.
    """
    inputs.instance(fe_model, "fe_model", FEModel, "give an FEModel")
    if fe_model.geometric_stiffness is None:
        raise InputError("the FE model has no geometric stiffness, so its weight changes no "
                         "stiffness: give FEModel(geometric_stiffness=...)")
    u = _displacements(fe_model, base, gravity, loads)
    items = [*_pairs(boundary), (base, "full")]
    edge = boundary_of(fe_model, items)
    _, interior, static = clamped(fe_model, edge)
    basis = static.with_vibrations(interior, modes).basis
    shapes, forces = edge.ties.spread(basis), fe_model.stiffness @ u
    whole = shapes.T @ (fe_model.geometric_stiffness(u) @ shapes) + edge.second_order(
        forces, np.zeros(edge.means.shape[0]), basis)
    kept = _without_base(edge.keeps, edge.coordinates.shape[1], len(whole))
    found = whole[np.ix_(kept, kept)]
    return (found + found.T) / 2


def grounded_from_fe(fe_model: FEModel, boundary: Items, base: int | RigidFace | MeanFace,
                     modes: int = 0, gravity: ArrayLike | None = None,
                     loads: ArrayLike | None = None) -> ReducedBody:
    """Superelement of an FE model that is held at its base, with coupling and rigid mass.

    Parameters
    ----------
    fe_model, boundary, base, modes
        As of `self_weight_stiffness`.
    gravity, loads : optional
        The same: weights whose stresses are to be part of the stiffness. Without them the body
        stiffens with the stresses in it, as `craig_bampton` makes it.

    Returns
    -------
    ReducedBody
        For `Model.foundation`; its base is the last boundary node. Its weight is that of the FE
        model, to be given by `Model.gravity`.

    Raises
    ------
    InputError
        As of `self_weight_stiffness` and `craig_bampton`.
    """
    items = [*_pairs(boundary), (base, "full")]
    body = reduce(fe_model, items, modes)
    last = len(items) - 1
    note = (f"held to the ground at {place(body.coordinates[last])}: its base is boundary node "
            f"{last}")
    if gravity is None and loads is None:
        return replace(body, base=last, notes=(*body.notes, note))
    K = self_weight_stiffness(fe_model, boundary, base, modes, gravity, loads)
    n, dimension = len(body.mass), body.coordinates.shape[1]
    kept = _without_base(body.keeps, dimension, n)
    others = np.setdiff1d(np.arange(n), kept)
    P = np.zeros((len(kept), n))
    P[:, kept] = np.eye(len(kept))
    P[:, others] = -rigid_motions(body.coordinates, body.keeps, n, body.coordinates[last])[kept]
    return replace(body, stiffness=body.stiffness + P.T @ K @ P, base=last, invariants=None,
                   missing={**body.missing, "stiffening": _IN_STIFFNESS,
                            "exact inertia": _IN_STIFFNESS},
                   notes=(*body.notes, note, "the stiffness has the stresses of weights"))


_IN_STIFFNESS = ("the stresses of weights are part of the stiffness; leave out gravity= and loads= "
                 "for a body that stiffens with the stresses in it")


def _pairs(boundary: Items) -> list[BoundaryItem]:
    return list(boundary.items() if hasattr(boundary, "items") else inputs.items(
        boundary, "boundary", "give pairs of an interface and what it keeps"))


def _without_base(keeps: tuple[str, ...], dimension: int, size: int) -> NDArray:
    """Reduced coordinates but for those of the last boundary node, which keeps everything."""
    turns = 1 if dimension == 2 else 3
    first = dimension * sum(keep != "rotation" for keep in keeps)
    second = first + turns * sum(keep != "translation" for keep in keeps)
    return np.r_[:first - dimension, first:second - turns, second:size]


def _displacements(fe_model: FEModel, base: int | RigidFace | MeanFace,
                   gravity: ArrayLike | None, loads: ArrayLike | None) -> NDArray:
    """Static displacements (n_dofs,) under weights, base held."""
    if gravity is None and loads is None:
        raise InputError("self_weight_stiffness has neither gravity nor loads: give one of them")
    forces = np.zeros(fe_model.stiffness.shape[0])
    if gravity is not None:
        forces += body_force(fe_model, gravity)
    if loads is not None:
        forces += inputs.vector(loads, "loads", len(forces))
    edge = boundary_of(fe_model, [(base, "full")])
    _, interior, _ = clamped(fe_model, edge)
    return edge.ties.spread(interior.displacement(edge.ties.gather(forces)[:, None]))[:, 0]
