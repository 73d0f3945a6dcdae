"""The size of a model: what lengths and errors of positions are compared with."""

import numpy as np
from numpy.typing import NDArray

from sebody.model.mechanism import Mechanism
from sebody.model.shafts import is_unbalance
from sebody.reduction.body import ReducedBody

# constants of elements that are lengths, and moments of inertia of rigid bodies
LENGTHS, MOMENTS = ("length",), ("J_xx", "J_yy", "J_zz")


def extent(model: Mechanism) -> float:
    """Largest length in a model [length]; 0 if nothing has one.

    The distance of the outermost nodes, ground points included, the size of the largest body, the
    largest radius of gyration of a rigid body about its node, the longest spring or path: where
    the model is put, and which way it is turned, does not matter.
    """
    points = [node.point for node in (*model.nodes.values(), *model.grounds)]
    lengths = [_diameter(np.array(points)) if points else 0.0]
    lengths += [_size(reduced) for reduced in
                {body.reduced: body.reduced for body in model.bodies.values()}.values()]
    lengths += [path.length for path in model.paths.values()]
    for body in model.rigid_bodies.values():
        if is_unbalance(body):
            continue
        moments = [body.number(name) for name in MOMENTS if name in body.constants]
        lengths.append(float(np.sqrt(max(moments, default=0.0) / body.number("mass"))))
    lengths += [element.number(name) for element in (*model.loads, *model.constraints)
                for name in LENGTHS if name in element.constants]
    return max(lengths)


def _size(body: ReducedBody) -> float:
    """Distance of the outermost nodes; of a body on one node its radius of gyration."""
    size = _diameter(body.coordinates)
    if size > 0.0:
        return size
    turns = body.rigid_modes_about(body.centre_of_mass)[:, body.coordinates.shape[1]:]
    return float(np.sqrt(max((turns.T @ body.mass @ turns).diagonal().max(), 0.0)
                         / body.total_mass))


def _diameter(points: NDArray) -> float:
    """Twice the largest distance from the middle of the points."""
    middle = (points.max(axis=0) + points.min(axis=0)) / 2
    return 2.0 * float(np.linalg.norm(points - middle, axis=1).max())
