"""Nodes of an FE model by their place: in a box, on a plane, on a cylinder, nearest to a point.

Tolerances are relative to the model's longest edge (`FEModel.extent`). A selection without nodes is
an error that names the nearest node.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.model import FEModel

TOLERANCE = 1e-6


def nodes_in_box(model: FEModel, lower: ArrayLike, upper: ArrayLike,
                 tolerance: float = TOLERANCE) -> tuple[int, ...]:
    """Nodes within a box along the axes, its faces included.

    Parameters
    ----------
    lower, upper : (3,), planar (2,)
        Opposite corners [length]; infinite entries leave a side open.
    tolerance : float
        Relative to the characteristic length of the model.

    Raises
    ------
    InputError
        No nodes there, or corners in the wrong order.
    """
    dimension = model.coordinates.shape[1]
    remedy = f"give {dimension} numbers, which may be infinite"
    lower, upper = (inputs.reals(corner, f"{name} corner of the box", remedy)
                    for name, corner in (("lower", lower), ("upper", upper)))
    if not lower.shape == upper.shape == (dimension,):
        raise InputError(f"corners of the box are {lower} and {upper}: {remedy}")
    if not np.all(lower <= upper):
        raise InputError(f"corners of the box are {lower} and {upper}: give the lower one first")
    outside = np.maximum(lower - model.coordinates, model.coordinates - upper)
    distance = np.linalg.norm(np.maximum(outside, 0.0), axis=1)
    return _within(model, distance, tolerance, f"in the box from {lower} to {upper}")


def nodes_on_plane(model: FEModel, point: ArrayLike, normal: ArrayLike,
                   tolerance: float = TOLERANCE) -> tuple[int, ...]:
    """Nodes on the plane (in a plane model: the line) through `point` across `normal`.

    Parameters
    ----------
    point, normal : (3,), planar (2,)
    tolerance : float
        Relative to the characteristic length of the model.

    Raises
    ------
    InputError
        No nodes there, or no normal.
    """
    point, normal = _place(model, point, "plane"), _axis(model, normal, "normal of the plane")
    distance = np.abs((model.coordinates - point) @ normal)
    return _within(model, distance, tolerance, f"on the plane through {point} across {normal}")


def nodes_on_cylinder(model: FEModel, point: ArrayLike, axis: ArrayLike | None, radius: float,
                      tolerance: float = TOLERANCE) -> tuple[int, ...]:
    """Nodes on an endless cylinder, such as the wall of a hole; in a plane model on a circle.

    Parameters
    ----------
    point : (3,), planar (2,)
        On the axis [length].
    axis : (3,), planar None
    radius : float
        [length]
    tolerance : float
        Relative to the characteristic length of the model. Nodes in the middle of straight edges
        lie inside the
        cylinder.

    Raises
    ------
    InputError
        No nodes there, no axis, or a radius that is not positive.
    """
    point = _place(model, point, "cylinder")
    radius = inputs.number(radius, "radius of the cylinder", above=0)
    arms = model.coordinates - point
    if len(point) == 2:
        if axis is not None:
            raise inputs.refusal("axis of the cylinder", axis, "give None, the model is planar")
    else:
        direction = _axis(model, axis, "axis of the cylinder")
        arms = arms - np.outer(arms @ direction, direction)
    distance = np.abs(np.linalg.norm(arms, axis=1) - radius)
    return _within(model, distance, tolerance,
                   f"on the cylinder of radius {radius:g} about {point}")


def nearest_node(model: FEModel, point: ArrayLike) -> int:
    """Node nearest to `point`, however far away it is; `FEModel.node_at` refuses a distant one."""
    point = _place(model, point, "nearest_node")
    return int(np.argmin(np.linalg.norm(model.coordinates - point, axis=1)))


def _place(model: FEModel, point: ArrayLike, what: str) -> NDArray:
    inputs.instance(model, "model", FEModel, "give an FEModel")
    return inputs.vector(point, f"point of {what}", model.coordinates.shape[1])


def _axis(model: FEModel, axis: ArrayLike, what: str) -> NDArray:
    axis = inputs.vector(axis, what, model.coordinates.shape[1])
    length = np.linalg.norm(axis)
    if length == 0:
        raise inputs.refusal(what, axis, "give a direction")
    return axis / length


def _within(model: FEModel, distance: NDArray, tolerance: float, where: str) -> tuple[int, ...]:
    """Nodes at most tolerance times the extent away."""
    tolerance = inputs.number(tolerance, "tolerance of a selection", least=0)
    nodes = np.flatnonzero(distance <= tolerance * model.extent)
    if not len(nodes):
        nearest = int(np.argmin(distance))
        raise InputError(
            f"no node {where}: the nearest, {model.node_name(nearest)} at "
            f"{model.coordinates[nearest]}, is {distance[nearest]:.3g} away; correct the place or "
            f"raise the tolerance, which is {tolerance:g} of {model.extent:.3g}")
    return tuple(nodes.tolist())
