"""Rigid links of a model as arrays, see `sebody.engine.links`."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.numbering import Numbering
from sebody.engine.links import Links
from sebody.model.mechanism import Mechanism


def link_arrays(model: Mechanism, numbering: Numbering, batches: list,
                turned: NDArray) -> tuple[Links, NDArray, NDArray]:
    """Links without their matrix entries, and rows and columns of these."""
    d = model.dimension
    hanging, arms, vectors = [], [], []
    for triplet in numbering.hanging:
        first = len(arms)
        for rotation, arm in triplet.arms:
            arms.append((numbering.rotations.get(id(rotation), 0),
                         numbering.triplets[id(rotation)]))
            vectors.append(arm)
        hanging.append((numbering.triplets[id(triplet)], numbering.triplets[id(triplet.root)],
                        first, len(arms)))
    which = {row[0]: k for k, row in enumerate(hanging)}
    frame_of = dict(turned.tolist())
    elements, maps, blocks, rows, columns = [], [], [], [], []
    start = 0
    for batch in batches:
        for unknowns in batch.unknowns:
            if any(u in which for u in unknowns):
                element = _expanded(unknowns, which, hanging, arms, frame_of, d,
                                    model.rotation_size, len(maps))
                wide, own_map, own_blocks = element
                elements.append((start, batch.width, len(wide), len(maps), len(rows),
                                 len(blocks), len(blocks) + len(own_blocks)))
                maps += own_map
                blocks += own_blocks
                rows += np.repeat(wide, len(wide)).tolist()
                columns += wide * len(wide)
            start += batch.width ** 2
    size = model.rotation_size
    for _, first in arms:
        own = list(range(first, first + size))
        rows += np.repeat(own, size).tolist()
        columns += own * size

    def table(values, width):
        return np.array(values, dtype=np.int64).reshape(-1, width)
    none = np.zeros(0, dtype=np.int64)
    links = Links(table(hanging, 4), table(arms, 2),
                  np.array(vectors, dtype=float).reshape(-1, d), table(elements, 7),
                  table(maps, 1).ravel(), table(blocks, 4), none, none)
    return links, table(rows, 1).ravel(), table(columns, 1).ravel()


def with_entries(links: Links, entries: NDArray) -> Links:
    """The links with the places of their matrix entries."""
    turning = 3 if links.arm_vectors.shape[1] == 3 else 1
    own, of_arms = np.split(entries, [len(entries) - len(links.arms) * turning**2])
    return replace(links, entries=own, arm_entries=of_arms)


def _expanded(unknowns, which, hanging, arms, frame_of, d, turning, at_map):
    """Unknowns of an element with links replaced; see `link_arrays` for map and blocks."""
    inner = {u + k for u in unknowns if u in which for k in range(d)}
    wide = [u for u in dict.fromkeys(unknowns) if u not in inner]

    def first_of(unknown, count):
        for k in range(count):
            if unknown + k not in wide:
                wide.append(unknown + k)
        return wide.index(unknown)
    local = [-1 if u in inner else wide.index(u) for u in unknowns]
    blocks = []
    for i, u in enumerate(unknowns):
        if u in which:
            _, root, first, last = hanging[which[u]]
            blocks.append((i, which[u], at_map + len(local), frame_of.get(root, -1)))
            local.append(first_of(root, d))
            local += [first_of(arms[k][1], turning) for k in range(first, last)]
    return wide, local, blocks
