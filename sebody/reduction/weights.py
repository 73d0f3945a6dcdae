"""Weights of the boundary nodes in the superelement's reference frame (14), (16)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.reduction.body import ReducedBody

# In directions in which the nodes spread less than this, relative to the widest, weights take the
# mean ever less of the way to the centre: of nodes that are in a plane but for the digits of a
# file, weights that reach a centre outside this plane are millions of both signs.
_THIN = 0.1
# Largest norm of what weights differ by from equal ones, which no centre within the nodes' hull
# needs. Weights for a centre far outside multiply differences of rotations between close nodes.
_LARGEST = 1.0


def frame_weights(coordinates: ArrayLike, centre_of_mass: ArrayLike) -> NDArray:
    """Smallest weights that add up to one and bring the weighted mean to the centre of mass.

    The mean stays short of it in directions in which the nodes hardly spread, or not at all, and of
    a centre that is far outside the hull of the nodes.

    Section 3.1 of the paper with its claims (i) to (iii) kept: the sum is an exact constraint and
    coordinates are relative to the nodes' mean, where (21)-(22) mix lengths squared with a pure
    number and so depend on units and origin.

    Parameters
    ----------
    coordinates : (n_nodes, 3), planar (n_nodes, 2)
        Boundary nodes [length].
    centre_of_mass : (3,), planar (2,)
        Centre of mass of the body in the same axes [length].

    Returns
    -------
    (n_nodes,)
        Weights alpha.

    Raises
    ------
    InputError
        Shapes that do not fit or values that are not finite.
    """
    remedy = "give (n_nodes, 3) and (3,) numbers, or planar (n_nodes, 2) and (2,)"
    coordinates = inputs.reals(coordinates, "coordinates", remedy)
    centre = inputs.reals(centre_of_mass, "centre_of_mass", remedy)
    if coordinates.ndim != 2 or not len(coordinates) or centre.shape != coordinates.shape[1:]:
        raise InputError(
            f"coordinates have shape {coordinates.shape} and centre_of_mass {centre.shape}: "
            f"{remedy}"
        )
    if not (np.all(np.isfinite(coordinates)) and np.all(np.isfinite(centre))):
        raise InputError("coordinates or centre_of_mass are not finite; correct them")
    middle = coordinates.mean(axis=0)
    # The rows of the centred coordinates add up to zero, so the minimum-norm solution does too:
    # added to 1/n it meets the constraint and keeps the norm minimal.
    directions, spread, weights = np.linalg.svd((coordinates - middle).T, full_matrices=False)
    enough = np.maximum(spread, _THIN * spread.max() or 1.0)
    shift = weights.T @ (spread / enough**2 * (directions.T @ (centre - middle)))
    shift /= max(1.0, np.linalg.norm(shift) / _LARGEST)
    return 1.0 / len(coordinates) + shift - shift.mean()


def body_weights(body: ReducedBody) -> tuple[NDArray, NDArray]:
    """Weights of the position DOF blocks and of the rotation DOF blocks (remark of section 3.1).

    Returns
    -------
    positions : (n_position_nodes,)
        Weights in the order of `body.position_nodes`.
    rotations : (n_rotation_nodes,)
        Weights in the order of `body.rotation_nodes`; empty if no rotation is kept.

    Raises
    ------
    InputError
        No body.
    """
    inputs.instance(body, "body", ReducedBody, "give a ReducedBody")
    positions = frame_weights(body.coordinates[list(body.position_nodes)], body.centre_of_mass)
    if not body.rotation_nodes:
        return positions, np.zeros(0)
    rotations = frame_weights(body.coordinates[list(body.rotation_nodes)], body.centre_of_mass)
    return positions, rotations
