"""Static modes of unit loads along a path: what slow loads that move along a body need.

Vibration modes converge slowly under a load that moves: of a frame the first ones may not bend the
path at all. The answers to unit loads at a few of its nodes make slow motions along it accurate.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.tabular import counted
from sebody.fem.loads import point_load
from sebody.fem.model import FEModel

COUNT = 7           # loads on a path, unless another number is given
_AXES = "xyz"
_REMEDY = "give the name of a node set, FE nodes in order, or PathLoads(nodes, loads, axis)"


class PathLoads(NamedTuple):
    """Nodes of a path along a body, and the unit loads on it whose answers are modes.

    Parameters
    ----------
    nodes : str or sequence of int
        A node set by its name, whose nodes are put in order from end to end, or FE nodes in order.
    loads : int
        Number of its nodes that are loaded, at equal distances; 5 to 11 are good.
    axis : str
        Direction of the loads, ``x``, ``y`` or ``z`` in FE axes; both directions across the path
        if empty, in a plane the one.
    """

    nodes: str | Sequence[int]
    loads: int = COUNT
    axis: str = ""


class LoadedPath(NamedTuple):
    """Nodes of a path in order, loads on FE DOFs as columns (n_dofs, k), and a note on them."""

    nodes: NDArray
    forces: NDArray
    note: str


def loaded_paths(model: FEModel, paths: Mapping[str, str | Sequence[int] | PathLoads] | None,
                 held: Sequence[int]) -> dict[str, LoadedPath]:
    """Paths of a body by name.

    Parameters
    ----------
    held : sequence of int
        FE nodes of the interfaces, on which loads cause nothing inside.

    Raises
    ------
    InputError
        Sets or nodes that are unknown, nodes that are not in a line or have no translations, and
        counts or axes that there are not.
    """
    given = inputs.mapping({} if paths is None else paths, "paths",
                           f"give a dict by name: {_REMEDY}")
    return {inputs.name(name, "name of a path"): _loaded(model, f"path {name!r}", one, set(held))
            for name, one in given.items()}


def _loaded(model: FEModel, what: str, given: object, held: set[int]) -> LoadedPath:
    asked = given if isinstance(given, PathLoads) else PathLoads(given)     # type: ignore[arg-type]
    count = inputs.integer(asked.loads, f"{what}: number of loads", least=1)
    dimension = model.coordinates.shape[1]
    axes = _AXES[:dimension]
    if not isinstance(asked.axis, str) or asked.axis not in ("", *axes):
        raise inputs.refusal(f"{what}: axis", asked.axis, f"give {', '.join(axes)}, or none for "
                             "all directions across the path")
    nodes = _nodes(model, what, asked.nodes)
    points = model.coordinates[nodes]
    ways = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    free = [k for k, node in enumerate(nodes) if node not in held and _moves(model, int(node))]
    if not free:
        raise InputError(f"{what}: interfaces hold all its nodes, so loads on it bend nothing: "
                         "give a path with nodes inside the body")
    chosen = _spread(ways, free, count, free[0] > 0, free[-1] < len(nodes) - 1)
    forces = [point_load(model, int(nodes[k]), direction) for k in chosen
              for direction in _directions(ways, points, k, asked.axis)]
    return LoadedPath(nodes, np.column_stack(forces),
                      f"{what}: {len(nodes)} nodes from {model.node_name(int(nodes[0]))} to "
                      f"{model.node_name(int(nodes[-1]))}, {ways[-1]:.6g} long; static modes of "
                      f"{counted(len(forces), 'unit load')} at {len(chosen)} of these")


def _nodes(model: FEModel, what: str, given: object) -> NDArray:
    """Nodes of a path in order, each of which moves."""
    if isinstance(given, str):
        try:
            nodes = list(model.node_set(given))
        except InputError as error:
            raise InputError(f"{what}: {error}") from error
    else:
        last = len(model.coordinates) - 1
        nodes = [inputs.integer(one, f"{what}: a node", least=0, most=last,
                                remedy=f"the model has nodes 0 to {last}")
                 for one in inputs.items(given, f"{what}: nodes", _REMEDY)]
    if len(set(nodes)) < max(len(nodes), 2):
        raise InputError(f"{what} has {counted(len(set(nodes)), 'node')}"
                         + " of which some are given twice" * (len(set(nodes)) < len(nodes))
                         + ": give two different ones at least")
    still = [node for node in nodes if not (_moves(model, node) or _follows(model, node))]
    if still:
        raise InputError(f"{what}: {model.node_name(still[0])} has no translations, as no element "
                         "has it: leave it out")
    return np.array(_in_line(model, what, nodes) if isinstance(given, str) else nodes)


def _moves(model: FEModel, node: int) -> bool:
    """True for a node that has all its translations as DOFs, so that it can be loaded."""
    return len(model.dofs(node, "translation")) == model.coordinates.shape[1]


def _follows(model: FEModel, node: int) -> bool:
    """True for a node that the FE program has tied to others."""
    dimension = model.coordinates.shape[1]
    return model.followers is not None and bool(
        model.followers[dimension * node:dimension * (node + 1)].nnz)


def _in_line(model: FEModel, what: str, nodes: list[int]) -> list[int]:
    """Nodes of a set from end to end, along the shortest lines that connect all of them.

    It begins at that end which comes first in the set.
    """
    from scipy.sparse.csgraph import minimum_spanning_tree  # 30 ms that other bodies need not
    from scipy.spatial.distance import cdist

    apart = cdist(model.coordinates[nodes], model.coordinates[nodes])
    if (apart[~np.eye(len(nodes), dtype=bool)] == 0.0).any():
        k, m = np.argwhere((apart == 0.0) & ~np.eye(len(nodes), dtype=bool))[0]
        raise InputError(f"{what}: {model.node_name(nodes[k])} and {model.node_name(nodes[m])} are "
                         "at the same place: leave one of them out of the set")
    tree = minimum_spanning_tree(apart)
    tree = (tree + tree.T).tocsr()
    neighbours = [tree.indices[tree.indptr[k]:tree.indptr[k + 1]] for k in range(len(nodes))]
    forks = [k for k, own in enumerate(neighbours) if len(own) > 2]
    if forks:
        raise InputError(f"{what}: the nodes of its set are not in one line: at "
                         f"{model.node_name(nodes[forks[0]])} {len(neighbours[forks[0]])} lines "
                         "meet; give a set of the nodes along one edge")
    order = [next(k for k, own in enumerate(neighbours) if len(own) == 1)]
    while len(order) < len(nodes):
        order += [int(k) for k in neighbours[order[-1]] if k not in order[-2:]]
    return [nodes[k] for k in order]


def _spread(ways: NDArray, free: list[int], count: int, first_held: bool, last_held: bool
            ) -> list[int]:
    """Places of nodes at equal distances, `count` at most, held ends left out."""
    if count == 1:
        wanted = ways[-1:] / 2
    else:
        wanted = np.linspace(0.0, ways[-1], count + first_held + last_held)
        wanted = wanted[first_held:len(wanted) - last_held]
    return sorted({free[int(np.argmin(np.abs(ways[free] - way)))] for way in wanted})


def _directions(ways: NDArray, points: NDArray, k: int, axis: str) -> list[ArrayLike]:
    """Unit vectors of the loads at a node."""
    dimension = points.shape[1]
    if axis:
        return [np.eye(dimension)[_AXES.index(axis)]]
    before, behind = max(k - 1, 0), min(k + 1, len(points) - 1)
    along = (points[behind] - points[before]) / np.linalg.norm(points[behind] - points[before])
    if dimension == 2:
        return [np.array([-along[1], along[0]])]
    one = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    one /= np.linalg.norm(one)
    return [one, np.cross(along, one)]
