"""Nested dissection of a sparse matrix whose rows have places: an order of little fill.

A. George, SIAM J. Numer. Anal. 10, 1973: parts are halved by a plane, the rows on one side with a
neighbour beyond it are eliminated after both halves.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

_LEAF = 40      # places that are not parted any more


def dissection(matrix: sparse.csc_array, places: NDArray) -> NDArray:
    """Order (n,) of elimination of the rows of a symmetric matrix.

    Parameters
    ----------
    matrix : (n, n), sparse
    places : (n, D)
        Of each row; rows at one place stay together.
    """
    points, group = np.unique(places, axis=0, return_inverse=True)
    group = group.ravel()
    entries = matrix.tocoo()
    first, second = group[entries.row], group[entries.col]
    apart = first != second
    count = len(points)
    graph = sparse.csr_array(sparse.coo_array(
        (np.ones(int(apart.sum()), dtype=np.int8), (first[apart], second[apart])),
        shape=(count, count)))
    pairs = graph.tocoo()
    rank = _rank(points, pairs.row, pairs.col)
    return np.argsort(rank[group], kind="stable")


def _rank(points: NDArray, first: NDArray, second: NDArray) -> NDArray:
    """Position of each place in the order; `first` and `second` are neighbours."""
    count = len(points)
    rank = np.empty(count, dtype=np.intp)
    beyond = np.zeros(count, dtype=bool)
    part = np.zeros(count, dtype=np.intp)       # first position of the part, -1 when placed
    parts = {0: np.arange(count)}
    while parts:
        for nodes in parts.values():
            axis = np.argmax(np.ptp(points[nodes], axis=0))
            middle = len(nodes) // 2
            beyond[nodes] = False
            beyond[nodes[np.argpartition(points[nodes, axis], middle)[middle:]]] = True
        within = (part[first] == part[second]) & (part[first] >= 0)
        first, second = first[within], second[within]
        cut = np.zeros(count, dtype=bool)
        cut[first[~beyond[first] & beyond[second]]] = True
        halves = {}
        for start, nodes in parts.items():
            for half in (nodes[~beyond[nodes] & ~cut[nodes]], nodes[beyond[nodes]]):
                if len(half) > _LEAF:
                    halves[start] = half
                    part[half] = start
                else:
                    rank[half] = start + np.arange(len(half))
                    part[half] = -1
                start += len(half)
            last = nodes[cut[nodes]]
            rank[last] = start + np.arange(len(last))
            part[last] = -1
        parts = halves
    return rank
