"""Rigid motions in the reduced coordinates of a body."""

import numpy as np
from numpy.typing import NDArray


def rigid_motions(coordinates: NDArray, keeps: tuple[str, ...], size: int,
                  point: NDArray) -> NDArray:
    """Unit rigid translations, then rotations about `point`: rows e, e x (X_i - point); e; zero.

    Parameters
    ----------
    coordinates : (n_nodes, 3), planar (n_nodes, 2)
        Boundary nodes.
    keeps : tuple of str
        DOF blocks that they keep.
    size : int
        Number of reduced coordinates.

    Returns
    -------
    (size, 6), planar (size, 3)
    """
    arms = coordinates[[keep != "rotation" for keep in keeps]] - point
    angles = sum(keep != "translation" for keep in keeps)
    count, dimension = arms.shape
    if dimension == 2:
        velocities = np.column_stack([-arms[:, 1], arms[:, 0]]).reshape(-1, 1)
    else:
        # Row of node i: (e_1 x a, e_2 x a, e_3 x a) = -skew(a).
        velocities = np.cross(np.eye(3), arms[:, None, :]).transpose(0, 2, 1).reshape(-1, 3)
    axes = velocities.shape[1]
    positions = np.hstack([np.tile(np.eye(dimension), (count, 1)), velocities])
    rotations = np.hstack(
        [np.zeros((angles * axes, dimension)), np.tile(np.eye(axes), (angles, 1))])
    internal = np.zeros((size - len(positions) - len(rotations), dimension + axes))
    return np.vstack([positions, rotations, internal])


def first_moment(mass: NDArray, modes: NDArray) -> NDArray:
    """The first moment of the mass about a point, (3,), planar (2,) [mass length].

    Parameters
    ----------
    mass : (n, n)
    modes : (n, 6), planar (n, 3)
        Rigid motions about the point.
    """
    dimension = 2 if modes.shape[1] == 3 else 3
    moment = modes[:, :dimension].T @ mass @ modes[:, dimension:]
    if dimension == 2:
        return np.array([moment[1, 0], -moment[0, 0]])
    # e_i . (e_k x c) = epsilon_ikl c_l: the moment is -skew(c) times the mass.
    skew = (moment - moment.T) / 2
    return np.array([skew[1, 2], skew[2, 0], skew[0, 1]])


def strainless_coordinates(keeps: tuple[str, ...], dimension: int) -> NDArray:
    """Boundary coordinates (k,) that move a free body as a whole: it resists none of them.

    Those of the only position that is kept, and the only rotation beside an only position. What a
    reduction finds as their stiffness is rounding, and none of their kind tells that it is small.

    Parameters
    ----------
    keeps : tuple of str
        DOF blocks kept at the boundary nodes.
    dimension : int
        Of the body, 2 or 3.
    """
    positions, rotations = (sum(keep in ("full", kind) for keep in keeps)
                            for kind in ("translation", "rotation"))
    if positions > 1:
        return np.arange(0)
    angles = (1 if dimension == 2 else 3) * rotations
    return np.arange(dimension + (angles if rotations == 1 else 0))
