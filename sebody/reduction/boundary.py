"""Boundary nodes of a reduction, and how the DOFs of the FE model follow them."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody import inputs
from sebody.errors import InputError
from sebody.fem.model import FEModel
from sebody.reduction.checks import KEEPS


@dataclass(frozen=True, eq=False)
class RigidFace:
    """FE nodes that move as a rigid body with a boundary node of their own (RBE2).

    Parameters
    ----------
    point : (3,), planar (2,)
        The boundary node, in FE axes [length].
    nodes : sequence of int
        FE nodes tied to it, with all their DOFs.

    Raises
    ------
    InputError
        No finite point, or no nodes.
    """

    point: NDArray
    nodes: tuple[int, ...]

    def __post_init__(self) -> None:
        point = inputs.vector(self.point, "point of a rigid face")
        remedy = "name the FE nodes tied to it"
        nodes = tuple(inputs.integer(node, "node of a rigid face", remedy=remedy)
                      for node in inputs.items(self.nodes, "nodes of a rigid face", remedy))
        if not nodes:
            raise InputError(f"a rigid face has no nodes: {remedy}")
        object.__setattr__(self, "point", point)
        object.__setattr__(self, "nodes", nodes)


BoundaryItem = tuple[int | RigidFace, str]


@dataclass(frozen=True, eq=False)
class Boundary:
    """The reduced boundary coordinates and what they do to the FE model.

    Parameters
    ----------
    coordinates : (n_nodes, 3), planar (n_nodes, 2)
    keeps : tuple of str
    motion : (n_dofs, n_boundary), sparse
        FE DOFs that unit boundary coordinates move; DOFs with an empty row are internal.
    faces : tuple of (columns, dofs, arms)
        Of each rigid face: columns of its rotation, translational DOFs (k, D) of its FE nodes and
        their arms (k, D) from the boundary node.
    """

    coordinates: NDArray
    keeps: tuple[str, ...]
    motion: sparse.csc_array
    faces: tuple[tuple[NDArray, NDArray, NDArray], ...]

    def second_order(self, forces: NDArray) -> NDArray:
        """Second derivative of the work of forces (n_dofs,) on the turning of rigid faces.

        A face turned by psi moves a node at the arm r by ``psi x (psi x r) / 2`` beyond the linear
        ``psi x r``: forces f that the prestress has there add ``(f r^T + r f^T) / 2 - f . r I``.
        """
        size = self.motion.shape[1]
        result = np.zeros((size, size))
        for columns, dofs, arms in self.faces:
            moments = forces[dofs].T @ arms
            whole = (moments + moments.T) / 2 - np.trace(moments) * np.eye(len(moments))
            # in a plane the angle turns the arm about the third axis: - f . r
            block = -np.trace(moments) if len(columns) == 1 else whole
            result[np.ix_(columns, columns)] += block
        return result


def boundary_of(fe_model: FEModel,
                items: Mapping[int | RigidFace, str] | Iterable[BoundaryItem]) -> Boundary:
    """Boundary coordinates: positions of all nodes in order, then rotations.

    Raises
    ------
    InputError
        Unknown or repeated nodes, or triplets that nodes do not have.
    """
    pairs = _pairs(fe_model, items)
    blocks, faces, width = [], [], 0
    for kind in ("translation", "rotation"):
        for item, keep in pairs:
            if keep not in ("full", kind):
                continue
            blocks.append(_motion(fe_model, item, kind))
            columns = width + np.arange(blocks[-1].shape[1])
            width += len(columns)
            if isinstance(item, RigidFace) and kind == "rotation":
                faces.append((columns, _translations(fe_model, item), _arms(fe_model, item)))
    points = [item.point if isinstance(item, RigidFace) else fe_model.coordinates[item]
              for item, _ in pairs]
    return Boundary(np.array(points, dtype=float), tuple(keep for _, keep in pairs),
                    sparse.hstack(blocks, format="csc"), tuple(faces))


def _translations(fe_model: FEModel, face: RigidFace) -> NDArray:
    return np.array([fe_model.dofs(node, "translation") for node in face.nodes])


def _arms(fe_model: FEModel, face: RigidFace) -> NDArray:
    return fe_model.coordinates[list(face.nodes)] - face.point


def _motion(fe_model: FEModel, item: int | RigidFace, kind: str) -> sparse.coo_array:
    """FE DOFs of a unit triplet of a node or rigid face, (n_dofs, 3), planar (n_dofs, 2 or 1)."""
    nodes = item.nodes if isinstance(item, RigidFace) else (item,)
    own = np.array([fe_model.dofs(node, kind) for node in nodes])
    unit = np.broadcast_to(np.eye(own.shape[1]), (len(nodes), own.shape[1], own.shape[1]))
    dofs, motion = own, unit
    if isinstance(item, RigidFace) and kind == "rotation":
        arms = _arms(fe_model, item)
        if arms.shape[1] == 2:
            turned = np.stack([-arms[:, 1], arms[:, 0]], axis=1)[:, :, None]
        else:
            turned = np.cross(np.eye(3), arms[:, None, :]).transpose(0, 2, 1)
        # FE nodes without rotations have no rows of their own to turn
        unit = unit if own.size else np.zeros((len(nodes), 0, turned.shape[2]))
        dofs = np.hstack([_translations(fe_model, item), own])
        motion = np.concatenate([turned, unit], axis=1)
    rows = np.repeat(dofs.ravel(), motion.shape[2])
    columns = np.tile(np.arange(motion.shape[2]), dofs.size)
    return sparse.coo_array((motion.ravel(), (rows, columns)),
                            shape=(fe_model.stiffness.shape[0], motion.shape[2]))


def _pairs(fe_model: FEModel, items: Mapping[int | RigidFace, str] | Iterable[BoundaryItem]
           ) -> list[BoundaryItem]:
    """Boundary nodes and what they keep."""
    remedy = "give pairs (node, 'full', 'translation' or 'rotation'), or a dict of them"
    pairs = []
    for one in inputs.items(items.items() if isinstance(items, Mapping) else items, "boundary",
                            remedy):
        pair = inputs.items(one, "a boundary node", remedy)
        if len(pair) != 2:
            raise inputs.refusal("a boundary node", one, remedy)
        node = pair[0]
        pairs.append((node if isinstance(node, RigidFace) else
                      inputs.integer(node, "boundary node"), pair[1]))
    if not pairs:
        raise InputError("boundary is empty; name one boundary node at least")
    taken = [node for item, _ in pairs
             for node in (item.nodes if isinstance(item, RigidFace) else (item,))]
    for item, keep in pairs:
        if isinstance(item, RigidFace):
            _check_face(fe_model, item, keep, taken)
        else:
            _check_node(fe_model, item, keep, taken)
    return pairs


def _check_node(fe_model: FEModel, node: int, keep: str, taken: list[int]) -> None:
    count = len(fe_model.coordinates)
    if not 0 <= node < count:
        raise InputError(f"boundary node {node} unknown; the model has nodes 0 to {count - 1}")
    if taken.count(node) > 1:
        raise InputError(f"boundary node {node} appears more than once; name it once")
    if not isinstance(keep, str) or keep not in KEEPS:
        raise InputError(
            f"boundary node {node} keeps {keep!r}; choose one of {', '.join(KEEPS)}"
        )
    if keep != "translation" and not len(fe_model.dofs(node, "rotation")):
        raise InputError(
            f"boundary node {node} keeps {keep!r}, but the model's nodes have no rotations; "
            "use 'translation', or a RigidFace, which turns as a whole"
        )


def _check_face(fe_model: FEModel, face: RigidFace, keep: str, taken: list[int]) -> None:
    count, dimension = fe_model.coordinates.shape
    if face.point.shape != (dimension,):
        raise InputError(f"point of a rigid face is {face.point}: give {dimension} finite numbers")
    if keep != "full":
        raise InputError(f"a rigid face keeps {keep!r}: its boundary node is 'full'")
    for node in face.nodes:
        if not 0 <= node < count:
            raise InputError(f"node {node} of a rigid face unknown: the model has nodes 0 to "
                             f"{count - 1}")
        if taken.count(node) > 1:
            raise InputError(f"boundary node {node} appears more than once; name it once")
    if not len(fe_model.dofs(0, "rotation")) and _collinear(_arms(fe_model, face)):
        raise InputError("the nodes of a rigid face lie on a line, so they do not hold its "
                         "rotation about the line: name more nodes")


def _collinear(points: NDArray) -> bool:
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return len(points) < 3 or spread[1] < 1e-8 * spread[0]
