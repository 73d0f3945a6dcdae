"""Boundary nodes of a reduction, and how the DOFs of the FE model follow them."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.model import FEModel
from sebody.reduction.checks import KEEPS
from sebody.reduction.interfaces import MeanFace, MeanMotion, RigidFace
from sebody.reduction.ties import Ties, collinear

BoundaryItem = tuple[int | RigidFace | MeanFace, str]
Items = Mapping[int | RigidFace | MeanFace, str] | Iterable[BoundaryItem | RigidFace | MeanFace]


@dataclass(frozen=True, eq=False)
class Boundary:
    """The reduced boundary coordinates and what they are among the DOFs of the FE model.

    The DOFs here are those that rigid faces leave independent, see `Ties`. A boundary coordinate is
    either one of them or a mean of several.

    Parameters
    ----------
    coordinates : (n_nodes, 3), planar (n_nodes, 2)
    keeps : tuple of str
    ties : Ties
    held, held_columns : (h,) of int
        DOFs that are boundary coordinates, and which.
    means : (m, n_independent), sparse
        Boundary coordinates that are means of DOFs.
    mean_columns : (m,) of int
        Which these are.
    mean_motions : tuple of (rows of translation, rows of rotation, MeanMotion)
        Of each mean face whose rotation matters: its rows in `means`, and what they are made of.
    notes : tuple of str
        What each boundary node is.
    stiffened : bool
        Whether some are rigid faces.
    nodes : tuple of int
        FE nodes that follow them: single ones, and those of rigid faces.
    """

    coordinates: NDArray
    keeps: tuple[str, ...]
    ties: Ties
    held: NDArray
    held_columns: NDArray
    means: sparse.csr_array
    mean_columns: NDArray
    mean_motions: tuple[tuple[NDArray, NDArray, MeanMotion], ...]
    notes: tuple[str, ...] = ()
    stiffened: bool = False
    nodes: tuple[int, ...] = ()

    @property
    def size(self) -> int:
        """Number of boundary coordinates."""
        return len(self.held) + len(self.mean_columns)

    def unit_motions(self) -> tuple[NDArray, NDArray]:
        """DOFs (n_independent, size) and means (m, size) of unit boundary coordinates."""
        moved = np.zeros((self.ties.size, self.size))
        moved[self.held, self.held_columns] = 1.0
        values = np.zeros((len(self.mean_columns), self.size))
        values[np.arange(len(values)), self.mean_columns] = 1.0
        return moved, values

    def values(self, shapes: NDArray) -> NDArray:
        """Boundary coordinates (size, n) of shapes (n_independent, n)."""
        result = np.zeros((self.size, shapes.shape[1]))
        result[self.held_columns] = shapes[self.held]
        result[self.mean_columns] = self.means @ shapes
        return result

    def second_order(self, forces: NDArray, on_means: NDArray, basis: NDArray) -> NDArray:
        """Second derivative of the work of a prestress on the turning of faces.

        Parameters
        ----------
        forces : (n_dofs,)
            Internal forces at the FE DOFs.
        on_means : (m,)
            Forces and moments that hold the means.
        basis : (n_independent, n)
            Shapes of the reduced coordinates.
        """
        result = self.ties.second_order(forces, basis)
        for moves, turns, motion in self.mean_motions:
            dimension = self.coordinates.shape[1]
            force, moment = np.zeros(dimension), np.zeros(3 if dimension == 3 else 1)
            force[:len(moves)] = on_means[moves]
            moment[:len(turns)] = on_means[turns]
            shapes = basis[self.ties.independent[motion.rows]]
            result += motion.second_order(force, moment, shapes)
        return result


def boundary_of(fe_model: FEModel, items: Items) -> Boundary:
    """Boundary coordinates: positions of all nodes in order, then rotations.

    Raises
    ------
    InputError
        Unknown or repeated nodes, or DOF blocks that nodes do not have.
    """
    pairs = _pairs(fe_model, items)
    rigid = [item for item, _ in pairs if isinstance(item, RigidFace)]
    ties = Ties(fe_model, rigid)
    motions = {item: _mean_motion(fe_model, item, keep) for item, keep in pairs
               if isinstance(item, MeanFace)}
    held, held_columns, means, mean_columns = [], [], [], []
    mean_rows = {item: {} for item in motions}
    width = 0
    for kind in ("translation", "rotation"):
        for item, keep in pairs:
            if keep not in ("full", kind):
                mean_rows.get(item, {})[kind] = np.zeros(0, dtype=int)
                continue
            if isinstance(item, MeanFace):
                rows = _mean_rows(motions[item], kind, ties)
                mean_rows[item][kind] = len(mean_columns) + np.arange(rows.shape[0])
                means.append(rows)
                mean_columns.extend(width + np.arange(rows.shape[0]))
                width += rows.shape[0]
            else:
                own = (ties.face_rows(item, kind) if isinstance(item, RigidFace)
                       else ties.independent[fe_model.dofs(item, kind)])
                held.extend(own)
                held_columns.extend(width + np.arange(len(own)))
                width += len(own)
    points = [motions[item].point if isinstance(item, MeanFace) else
              item.point if isinstance(item, RigidFace) else fe_model.coordinates[item]
              for item, _ in pairs]
    return Boundary(
        np.array(points, dtype=float), tuple(keep for _, keep in pairs), ties,
        np.array(held, dtype=int), np.array(held_columns, dtype=int),
        sparse.vstack(means, format="csr") if means else sparse.csr_array((0, ties.size)),
        np.array(mean_columns, dtype=int),
        tuple((mean_rows[item]["translation"], mean_rows[item]["rotation"], motion)
              for item, motion in motions.items()
              if len(mean_rows[item]["rotation"]) or motion.off_centre),
        tuple(f"boundary node {k}{_name(item)} is {_described(fe_model, item)}"
              for k, (item, _) in enumerate(pairs)), bool(rigid),
        tuple(node for item, _ in pairs if not isinstance(item, MeanFace)
              for node in _named(item)[1]))


def _name(item: int | RigidFace | MeanFace) -> str:
    return f", {item.name!r}," if not isinstance(item, int) and item.name else ""


def _described(fe_model: FEModel, item: int | RigidFace | MeanFace) -> str:
    """An interface in words."""
    if isinstance(item, RigidFace):
        return f"a rigid face of {len(item.nodes)} nodes"
    if isinstance(item, MeanFace):
        how = {"area": "by area", "equal": "equal"}.get(str(item.weights), "given")
        return f"the mean of {len(item.nodes)} nodes, weights {how}"
    return f"FE {fe_model.node_name(item)}"


def _mean_motion(fe_model: FEModel, face: MeanFace, keep: str) -> MeanMotion:
    """The mean, refused where its nodes do not hold the rotation that is needed."""
    motion = MeanMotion(fe_model, face)
    if not motion.turns and (keep != "translation" or motion.off_centre):
        raise InputError(f"the nodes of {face.called} lie on a line, so they do not determine its "
                         "rotation about the line: name more nodes, or keep 'translation' at "
                         "their centre")
    return motion


def _mean_rows(motion: MeanMotion, kind: str, ties: Ties) -> sparse.coo_array:
    """Mean translations or rotations as rows of the independent DOFs."""
    weights = motion.translation() if kind == "translation" else motion.rotation()
    count = len(weights)
    columns = np.tile(ties.independent[motion.rows].ravel(), count)
    rows = np.repeat(np.arange(count), motion.rows.size)
    return sparse.coo_array((weights.ravel(), (rows, columns)), shape=(count, ties.size))


def _pairs(fe_model: FEModel, items: Items) -> list[BoundaryItem]:
    """Boundary nodes and what they keep."""
    remedy = "give pairs (node, 'full', 'translation' or 'rotation'), or a dict of them"
    pairs = []
    for one in inputs.items(items.items() if isinstance(items, Mapping) else items, "boundary",
                            remedy):
        pair = ((one, "full") if isinstance(one, RigidFace | MeanFace) else
                inputs.items(one, "a boundary node", remedy))
        if len(pair) != 2:
            raise inputs.refusal("a boundary node", one, remedy)
        node = pair[0]
        pairs.append((node if isinstance(node, RigidFace | MeanFace) else
                      inputs.integer(node, "boundary node"), pair[1]))
    if not pairs:
        raise InputError("boundary is empty; name one boundary node at least")
    for item, keep in pairs:
        what, nodes = _named(item)
        count = len(fe_model.coordinates)
        for node in nodes:
            if not 0 <= node < count:
                raise InputError(f"{what.format(node)} unknown: the model has nodes 0 to "
                                 f"{count - 1}{_if_label(fe_model, node)}")
        if not isinstance(keep, str) or keep not in KEEPS:
            called = fe_model.node_name(nodes[0]).removeprefix("node ")
            raise InputError(f"{what.format(called)} keeps {keep!r}; choose one of "
                             f"{', '.join(KEEPS)}")
    _check_shared(fe_model, pairs)
    for item, keep in pairs:
        if isinstance(item, RigidFace):
            _check_rigid(fe_model, item)
        elif isinstance(item, MeanFace):
            _check_dofs(fe_model, f"node {{}} of {item.called}", item.nodes, "translation",
                        "name nodes that have them")
        else:
            _check_node(fe_model, item, keep)
    return pairs


def _named(item: int | RigidFace | MeanFace) -> tuple[str, tuple[int, ...]]:
    """Name of a node of a boundary item in messages, and its nodes."""
    if isinstance(item, RigidFace | MeanFace):
        return f"node {{}} of {item.called}", item.nodes
    return "boundary node {}", (item,)


def _if_label(fe_model: FEModel, node: int) -> str:
    """The remedy where a label was given for an index."""
    if fe_model.labels is None or node not in fe_model.labels:
        return ""
    return f" by their indices; the index of the node with the label {node} is model.node({node})"


def _check_shared(fe_model: FEModel, pairs: list[BoundaryItem]) -> None:
    """Refuse nodes that two interfaces, or one twice, lay claim to."""
    owner: dict[int, int] = {}
    called = [f"'{item.name}'" if not isinstance(item, int) and item.name else str(position)
              for position, (item, _) in enumerate(pairs)]
    for position, (item, _) in enumerate(pairs):
        for node in _named(item)[1]:
            if node in owner:
                whose = ("" if owner[node] == position else
                         f", in the interfaces {called[owner[node]]} and {called[position]}")
                raise InputError(f"boundary {fe_model.node_name(node)} appears more than once"
                                 f"{whose}; name it once")
            owner[node] = position


def _check_node(fe_model: FEModel, node: int, keep: str) -> None:
    if keep != "translation" and "rz" not in fe_model.node_dofs:
        raise InputError(
            f"boundary {fe_model.node_name(node)} keeps {keep!r}, but the model's nodes have no "
            "rotations; use 'translation', or a RigidFace or MeanFace, which turn as a whole"
        )
    kinds = ("translation", "rotation") if keep == "full" else (keep,)
    for kind in kinds:
        _check_dofs(fe_model, "boundary node {}", (node,), kind,
                    f"it keeps {keep!r}: keep what it has, or use a RigidFace or MeanFace")


def _check_dofs(fe_model: FEModel, what: str, nodes: Iterable[int], kind: str, remedy: str) -> None:
    """Refuse nodes that lack a translation or a rotation."""
    dimension = fe_model.coordinates.shape[1]
    part = slice(0, dimension) if kind == "translation" else slice(dimension, None)
    names = fe_model.node_dofs[part]
    for node in nodes:
        missing = [name for name, row in zip(names, fe_model.rows[node, part], strict=True)
                   if row < 0]
        if missing:
            called = what.format(fe_model.node_name(node).removeprefix("node "))
            raise InputError(f"{called} has no {', '.join(missing)}; {remedy}")


def _check_rigid(fe_model: FEModel, face: RigidFace) -> None:
    dimension = fe_model.coordinates.shape[1]
    if face.point.shape != (dimension,):
        raise InputError(f"point of {face.called} is {face.point}: give {dimension} finite numbers")
    turning = fe_model.rows[list(face.nodes), dimension:] >= 0
    if not turning.any() and collinear(fe_model.coordinates[list(face.nodes)]):
        raise InputError(f"the nodes of {face.called} lie on a line, so they do not determine its "
                         "rotation about the line: name more nodes")
