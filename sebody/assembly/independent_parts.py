"""Parts of an elimination that do not wait for each other, for threads to share.

The subtrees of an elimination tree are independent: no factor of one has an entry of another. What
several of them are coupled to, the rest, is eliminated last. A chain that is eliminated from both
ends to its middle has two parts and a rest of one body.
"""

from heapq import heapify, heappush, heapreplace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

FEWEST = 1000       # unknowns from which on an elimination is divided
MOST = 16           # parts
REST = 0.1          # most unknowns of the rest, relative to all


class Parts(NamedTuple):
    """Unknowns, part by part, then the rest."""

    order: NDArray      # (n,) unknowns in the order of their elimination
    firsts: NDArray     # (parts + 1,) where in this order each part begins, and the rest


def whole(n: int) -> Parts:
    """No parts: all is rest."""
    return Parts(np.arange(n), np.zeros(1, dtype=np.int64))


def independent_parts(below: list[set[int]], groups: NDArray, n: int) -> Parts:
    """Parts of an elimination of n unknowns.

    Parameters
    ----------
    below : list of set of int
        Of every group of unknowns, later groups that it is coupled to in the elimination.
    groups : (number of groups,)
        First unknown of every group, ascending from 0.
    """
    ends = np.append(groups[1:], n)
    sizes = (ends - groups).tolist()
    tops, rest = _subtrees(below, sizes)
    if len(tops) < 2:
        return whole(n)
    part_of = [-1] * len(sizes)
    for part, top in enumerate(sorted(tops)):
        part_of[top] = part
    for group in range(len(sizes) - 1, -1, -1):     # parents before children
        if part_of[group] < 0 and group not in rest:
            part_of[group] = part_of[min(below[group])]
    of_unknown = np.repeat(part_of, sizes)
    of_unknown[of_unknown < 0] = len(tops)
    return Parts(np.argsort(of_unknown, kind="stable"),
                 np.searchsorted(np.sort(of_unknown), np.arange(len(tops) + 1)))


def _subtrees(below: list[set[int]], sizes: list[int]) -> tuple[list[int], set[int]]:
    """Groups that subtrees end with, and the groups of the rest.

    The largest subtree is divided where it forks, as long as the rest stays small.
    """
    children: list[list[int]] = [[] for _ in range(len(sizes) + 1)]
    weights = list(sizes)
    for group, rows in enumerate(below):
        parent = min(rows, default=-1)
        children[parent].append(group)
        if rows:
            weights[parent] += weights[group]
    queue = [(-weights[top], top) for top in children[-1]]
    heapify(queue)
    rest: set[int] = set()
    left = REST * sum(sizes)
    while queue and len(queue) < MOST:
        path = [queue[0][1]]
        while len(children[path[-1]]) == 1:
            path.append(children[path[-1]][0])
        forks = children[path[-1]]
        left -= sum(sizes[group] for group in path)
        if not forks or left < 0:
            break
        rest.update(path)
        heapreplace(queue, (-weights[forks[0]], forks[0]))
        for top in forks[1:]:
            heappush(queue, (-weights[top], top))
    return [top for _, top in queue], rest
