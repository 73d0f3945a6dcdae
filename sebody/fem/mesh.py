"""Labels, named sets and elements of an FE model's nodes, checked."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError


def labels(values: ArrayLike | None, count: int) -> NDArray | None:
    """Different whole numbers, one for each of `count` nodes."""
    if values is None:
        return None
    numbers = _whole(values, "labels", f"give {count} different whole numbers, one per node")
    if numbers.shape != (count,):
        raise InputError(f"labels have shape {numbers.shape}; {count} nodes need ({count},)")
    unique, places, times = np.unique(numbers, return_index=True, return_counts=True)
    if len(unique) < count:
        twice = unique[np.argmax(times > 1)]
        first, second = np.flatnonzero(numbers == twice)[:2]
        raise InputError(f"label {twice} is that of the nodes {first} and {second}: give each node "
                         "a label of its own")
    return numbers


def node_sets(sets: Mapping[str, Sequence[int]], count: int) -> dict[str, tuple[int, ...]]:
    """Named sets of nodes from 0 to `count` - 1."""
    remedy = "give a dict of names and node indices"
    if not isinstance(sets, Mapping):
        raise inputs.refusal("node_sets", sets, remedy)
    checked = {}
    for name, nodes in sets.items():
        what = f"node set {inputs.shown(inputs.name(name, 'name of a node set'))}"
        nodes = _nodes(inputs.items(nodes, what, remedy), what, count)
        if len(np.unique(nodes)) < nodes.size:
            raise InputError(f"{what} names a node more than once: name it once")
        checked[name] = tuple(nodes.tolist())
    return checked


def cells(groups: Sequence[tuple[str, ArrayLike]], count: int) -> tuple[tuple[str, NDArray], ...]:
    """Elements by kind, of nodes from 0 to `count` - 1."""
    remedy = "give pairs (kind, array of nodes of shape (n, k)), as meshio does"
    checked = []
    for group in inputs.items(groups, "cells", remedy):
        pair = inputs.items(group, "cells: one kind", remedy)
        if len(pair) != 2:
            raise inputs.refusal("cells: one kind", group, remedy)
        kind = inputs.name(pair[0], "cells: a kind")
        nodes = _nodes(pair[1], f"cells of kind {kind!r}", count)
        if nodes.ndim != 2:
            raise InputError(f"cells of kind {kind!r} have shape {nodes.shape}: {remedy}")
        nodes.flags.writeable = False
        checked.append((kind, nodes))
    return tuple(checked)


def _nodes(values: ArrayLike, what: str, count: int) -> NDArray:
    remedy = f"give node indices from 0 to {count - 1}"
    nodes = _whole(values, what, remedy)
    outside = (nodes < 0) | (nodes >= count)
    if outside.any():
        raise InputError(f"{what} has the node {nodes[outside][0]}: {remedy}")
    return nodes


def _whole(values: ArrayLike, what: str, remedy: str) -> NDArray:
    """An array of whole numbers."""
    numbers = inputs.reals(values, what, remedy)
    if not (numbers == np.floor(numbers)).all():
        raise inputs.refusal(what, values, remedy)
    return numbers.astype(np.int64)
