"""Rows of an FE model's matrices: the DOFs of its nodes."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError

SPATIAL = ("x", "y", "z", "rx", "ry", "rz")
PLANAR = ("x", "y", "rz")
SOLID = ("x", "y", "z")


def equal_rows(count: int, node_dofs: tuple[str, ...]) -> NDArray:
    """Rows (count, k) of nodes that have the same k DOFs, node after node."""
    return np.arange(count * len(node_dofs)).reshape(count, -1)


def mapped_rows(dof_map: Iterable, count: int, dimension: int
                ) -> tuple[tuple[tuple[int, str], ...], tuple[str, ...], NDArray]:
    """Rows by node of a model whose nodes have different DOFs.

    Parameters
    ----------
    dof_map : iterable of (node index, DOF name)
        One pair per row of the matrices.
    count, dimension : int
        Number of nodes, and of their coordinates.

    Returns
    -------
    dof_map : tuple of (int, str)
    node_dofs : tuple of str
        `SPATIAL`, `PLANAR`, or `SOLID` where no node turns.
    rows : (count, k) of int
        Row of each of these DOFs; -1 where a node does not have it.

    Raises
    ------
    InputError
        An entry that is no pair, an unknown node or name, or a DOF named twice.
    """
    allowed = SPATIAL if dimension == 3 else PLANAR
    remedy = (f"give one pair per row of the matrices: a node from 0 to {count - 1} and one of "
              f"{', '.join(allowed)}")
    pairs = tuple(_pair(entry, row, remedy)
                  for row, entry in enumerate(inputs.items(dof_map, "dof_map", remedy)))
    node_dofs = allowed
    if dimension == 3 and not any(name.startswith("r") for _, name in pairs):
        node_dofs = SOLID
    place = {name: k for k, name in enumerate(node_dofs)}
    rows = np.full((count, len(node_dofs)), -1)
    for row, (node, name) in enumerate(pairs):
        if not 0 <= node < count or name not in place:
            raise inputs.refusal(f"dof_map[{row}]", (node, name), remedy)
        if rows[node, place[name]] >= 0:
            raise InputError(f"dof_map has {name} of node {node} in the rows "
                             f"{rows[node, place[name]]} and {row}: name each DOF once")
        rows[node, place[name]] = row
    return pairs, node_dofs, rows


def _pair(entry: object, row: int, remedy: str) -> tuple[int, str]:
    """Node and DOF name of one row."""
    if not isinstance(entry, tuple | list) or len(entry) != 2 or not isinstance(entry[1], str):
        raise inputs.refusal(f"dof_map[{row}]", entry, remedy)
    return inputs.integer(entry[0], f"dof_map[{row}]: the node", remedy=remedy), str(entry[1])
