"""Rigid links of a model as arrays, see `sebody.engine.links`."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.batches import Batch
from sebody.assembly.numbering import Numbering
from sebody.engine.links import Links
from sebody.model.mechanism import Mechanism


class _Ends(NamedTuple):
    """Dependent positions at the ends of links, and the axes of all positions."""

    dependent: list[tuple[int, int, int, int]]    # rows of `Links.dependent`
    arms: list[tuple[int, int]]                 # and of `Links.arms`
    vectors: list[NDArray]
    number: dict[int, int]                      # first coordinate -> row of `dependent`
    frame_of: dict[int, int]                    # first coordinate -> frame it is solved for in
    sizes: tuple[int, int]                      # coordinates of a position and of a rotation


def link_arrays(model: Mechanism, numbering: Numbering, batches: list[Batch],
                rotated: NDArray) -> tuple[Links, NDArray, NDArray]:
    """Links without their matrix entries, and rows and columns of these entries."""
    ends, unused = _ends(model, numbering, rotated), numbering.total
    elements, maps, blocks, rows, columns = [], [], [], [], []
    start = 0
    for batch in batches if ends.number else ():
        for unknowns, full in zip(batch.unknowns, batch.full, strict=True):
            if any(u in ends.number for u in unknowns):
                wide, own_map, own_blocks = _expanded(unknowns, ends, len(maps))
                elements.append((start, batch.width, len(wide), len(maps), len(rows),
                                 len(blocks), len(blocks) + len(own_blocks)))
                maps += own_map
                blocks += own_blocks
                apart = set(unknowns[full:])        # internal modes: zeros between them
                rows += [unused if u in apart and other in apart and u != other else u
                         for u in wide for other in wide]
                columns += wide * len(wide)
            start += batch.width ** 2
    d, rotation_size = ends.sizes
    for _, first in ends.arms:
        own = list(range(first, first + rotation_size))
        rows += [u for u in own for _ in own]
        columns += own * rotation_size
    none = np.zeros(0, dtype=np.int64)
    links = Links(_table(ends.dependent, 4), _table(ends.arms, 2),
                  np.array(ends.vectors, dtype=float).reshape(-1, d), _table(elements, 7),
                  _table(maps, 1).ravel(), _table(blocks, 4), none, none)
    return links, _table(rows, 1).ravel(), _table(columns, 1).ravel()


def with_entries(links: Links, entries: NDArray) -> Links:
    """The links with the places of their matrix entries."""
    rotation_size = 3 if links.arm_vectors.shape[1] == 3 else 1
    own = len(entries) - len(links.arms) * rotation_size**2
    return replace(links, entries=entries[:own], arm_entries=entries[own:])


def _ends(model: Mechanism, numbering: Numbering, rotated: NDArray) -> _Ends:
    dependent, arms, vectors = [], [], []
    for triplet in numbering.dependent:
        first = len(arms)
        for rotation, arm in triplet.arms:
            arms.append((numbering.rotations.get(id(rotation), 0),
                         numbering.triplets[id(rotation)]))
            vectors.append(arm)
        dependent.append((numbering.triplets[id(triplet)], numbering.triplets[id(triplet.root)],
                        first, len(arms)))
    return _Ends(dependent, arms, vectors, {row[0]: k for k, row in enumerate(dependent)},
                 dict(rotated.tolist()), (model.dimension, model.rotation_size))


def _expanded(unknowns: list[int], ends: _Ends,
              at_map: int) -> tuple[list[int], list[int], list[tuple[int, int, int, int]]]:
    """Unknowns of an element after replacement; `sebody.engine.links` has map and blocks."""
    d, rotation_size = ends.sizes
    inner = {u + k for u in unknowns if u in ends.number for k in range(d)}
    wide = [u for u in dict.fromkeys(unknowns) if u not in inner]

    def first_of(unknown: int, count: int) -> int:
        for k in range(count):
            if unknown + k not in wide:
                wide.append(unknown + k)
        return wide.index(unknown)
    local = [-1 if u in inner else wide.index(u) for u in unknowns]
    blocks = []
    for i, u in enumerate(unknowns):
        if u in ends.number:
            _, root, first, last = ends.dependent[ends.number[u]]
            blocks.append((i, ends.number[u], at_map + len(local), ends.frame_of.get(root, -1)))
            local.append(first_of(root, d))
            local += [first_of(ends.arms[k][1], rotation_size) for k in range(first, last)]
    return wide, local, blocks


def _table(values: list, width: int) -> NDArray:
    return np.array(values, dtype=np.int64).reshape(-1, width)
