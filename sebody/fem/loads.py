"""Loads on the nodes of an FE model: vectors for the reduction, see `craig_bampton`.

Forces are consistent with the shape functions of the elements, so their sum and moment are those of
the load. Vectors may be added and multiplied.
"""

from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.face_functions import face_rule
from sebody.fem.faces import faces_within, normals
from sebody.fem.model import FEModel


def pressure(model: FEModel, nodes: str | Iterable[int], value: float = 1.0) -> NDArray:
    """Pressure on the outer faces all of whose nodes are among `nodes`, inwards.

    Parameters
    ----------
    nodes : str or iterable of int
        A node set by its name, or nodes.
    value : float
        Pressure [force/length^2]; in a plane [force/length] on edges.

    Returns
    -------
    (n_dofs,)
        Forces [force].

    Raises
    ------
    InputError
        Nodes there are not, nodes that no face lies between, or no number.
    """
    value = inputs.number(value, "pressure")
    return _on_faces(model, nodes, "pressure", lambda normal: -value * normal)


def traction(model: FEModel, nodes: str | Iterable[int], vector: ArrayLike) -> NDArray:
    """Force by area on the outer faces all of whose nodes are among `nodes`, (n_dofs,).

    Parameters
    ----------
    nodes : str or iterable of int
        A node set by its name, or nodes.
    vector : (3,), planar (2,)
        Traction in FE axes [force/length^2]; in a plane on edges [force/length].

    Raises
    ------
    InputError
        As for `pressure`.
    """
    vector = inputs.vector(vector, "traction", model.coordinates.shape[1])
    return _on_faces(model, nodes, "traction",
                     lambda normal: np.linalg.norm(normal, axis=-1, keepdims=True) * vector)


def line_load(model: FEModel, vector: ArrayLike,
              nodes: str | Iterable[int] | None = None) -> NDArray:
    """Force by length on beam elements, with the moments of their clamped ends, (n_dofs,).

    Parameters
    ----------
    vector : (3,) or (n_nodes, 3), planar (2,) or (n_nodes, 2)
        Force by length in FE axes [force/length]; at every node, linear between them.
    nodes : str or iterable of int, optional
        Beams between these nodes alone; all by default.

    Raises
    ------
    InputError
        As for `pressure`, or a model without beams.
    """
    dimension = model.coordinates.shape[1]
    by_node = inputs.array(vector, "line load", (len(model.coordinates), dimension)
                           if np.ndim(vector) == 2 else (dimension,))
    by_node = np.broadcast_to(by_node, model.coordinates.shape)
    inside = np.ones(len(model.coordinates), dtype=bool)
    if nodes is not None:
        inside[:] = False
        inside[_nodes(model, nodes, "line load")] = True
    pairs = np.concatenate([np.zeros((0, 2), dtype=int),
                            *(cells for kind, cells in model.cells if kind == "line")])
    pairs = pairs[inside[pairs].all(axis=1)]
    if not len(pairs):
        raise InputError("line load: no beam of the model lies between the nodes given; give the "
                         "nodes at both ends of each")
    along = model.coordinates[pairs[:, 1]] - model.coordinates[pairs[:, 0]]
    lengths = np.linalg.norm(along, axis=1)
    first, last = by_node[pairs[:, 0]], by_node[pairs[:, 1]]
    result = np.zeros(model.stiffness.shape[0])
    for nodes_of, near, far, sign in zip(pairs.T, (first, last), (last, first), (1.0, -1.0),
                                         strict=True):
        forces, moments = _at_end(along, lengths, near, far)
        for node, force, moment in zip(nodes_of, forces, moments, strict=True):
            result[model.dofs(int(node), "translation")] += force
            result[model.dofs(int(node), "rotation")] += sign * moment
    return result


def body_force(model: FEModel, field: ArrayLike) -> NDArray:
    """Force on the mass of the model, (n_dofs,): mass times an acceleration.

    Parameters
    ----------
    field : (3,), planar (2,)
        Force by mass in FE axes [length/time^2].
    """
    field = inputs.vector(field, "body force", model.coordinates.shape[1])
    motion = np.zeros(model.stiffness.shape[0])
    for k, value in enumerate(field):
        rows = model.rows[:, k]
        motion[rows[rows >= 0]] = value
    return model.mass @ motion


def point_load(model: FEModel, node: int, force: ArrayLike,
               moment: ArrayLike | None = None) -> NDArray:
    """Force, and moment where the node has rotations, on one node, (n_dofs,).

    Raises
    ------
    InputError
        A node there is not, or a force or moment on DOFs that it does not have.
    """
    result = np.zeros(model.stiffness.shape[0])
    for kind, value in (("translation", force), ("rotation", moment)):
        if value is None:
            continue
        rows = model.dofs(node, kind)
        what = "force" if kind == "translation" else "moment"
        if not len(rows):
            raise InputError(f"point load: {model.node_name(node)} has no {kind}s for a {what}; "
                             "load a node that has them")
        result[rows] = inputs.vector(np.atleast_1d(value), f"{what} of a point load", len(rows))
    return result


def _on_faces(model: FEModel, nodes: str | Iterable[int], what: str,
              of_normal: Callable[[NDArray], NDArray]) -> NDArray:
    """Consistent forces; `of_normal` makes forces of normals as long as the area, (f, g, D)."""
    inputs.instance(model, "model", FEModel, "give an FEModel")
    groups = faces_within(model, _nodes(model, nodes, what))
    if not groups:
        raise InputError(f"{what}: the model has no outer face with all its nodes among those "
                         "given; give all nodes of the faces, and cells to the model")
    dimension = model.coordinates.shape[1]
    result = np.zeros(model.stiffness.shape[0])
    for kind, faces in groups:
        values, slopes, weights = face_rule(kind)
        by_point = of_normal(normals(model.coordinates[faces], slopes)) * weights[:, None]
        forces = np.einsum("ga,fgd->fad", values, by_point)
        np.add.at(result, model.rows[faces, :dimension].reshape(-1), forces.reshape(-1))
    return result


def _at_end(along: NDArray, lengths: NDArray, near: NDArray, far: NDArray
            ) -> tuple[NDArray, NDArray]:
    """Forces and moments of clamped beams at their ends, under loads that are linear along them.

    Parameters
    ----------
    along : (k, D)
        From end to end [length].
    lengths : (k,)
    near, far : (k, D)
        Forces by length at this end and at the other one.
    """
    unit, size = along / lengths[:, None], lengths[:, None]
    axial, of_far = (np.einsum("ki,ki->k", one, unit)[:, None] * unit for one in (near, far))
    forces = (size / 6 * (2 * axial + of_far)
              + size / 20 * (7 * (near - axial) + 3 * (far - of_far)))
    mean = size / 60 * (3 * near + 2 * far)
    if along.shape[1] == 2:
        return forces, along[:, 0] * mean[:, 1] - along[:, 1] * mean[:, 0]
    return forces, np.cross(along, mean)


def _nodes(model: FEModel, nodes: str | Iterable[int], what: str) -> list[int]:
    """Nodes of a set, or those given."""
    if isinstance(nodes, str):
        return list(model.node_set(nodes))
    last = len(model.coordinates) - 1
    return [inputs.integer(node, f"{what}: a node", least=0, most=last,
                           remedy=f"the model has nodes 0 to {last}")
            for node in inputs.items(nodes, f"nodes of a {what}", "give node indices")]
