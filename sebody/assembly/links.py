"""Rigid links of a model as arrays, see `sebody.engine.links`."""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.batches import Shape
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering


class Ends(NamedTuple):
    """Dependent positions at the ends of links: what index arrays depend on."""

    dependent: tuple[tuple[int, int, int, int], ...]    # rows of `Links.dependent`
    arms: tuple[tuple[int, int], ...]                   # and of `Links.arms`
    dimension: int                                      # coordinates of a position
    rotation_size: int                                  # and of a rotation


def link_ends(model: Mechanism, numbering: Numbering) -> tuple[Ends, NDArray]:
    """Ends of the links of a model, and the member `arm_vectors` of `Links`."""
    dependent, arms, vectors = [], [], []
    for dof_block in numbering.dependent:
        first = len(arms)
        for rotation, arm in dof_block.arms:
            arms.append((numbering.rotations.get(rotation, 0),
                         numbering.dof_blocks[rotation]))
            vectors.append(arm)
        dependent.append((numbering.dof_blocks[dof_block], numbering.dof_blocks[dof_block.root],
                          first, len(arms)))
    return (Ends(tuple(dependent), tuple(arms), model.dimension, model.rotation_size),
            np.array(vectors, dtype=float).reshape(-1, model.dimension))


def link_tables(shapes: Iterable[Shape], ends: Ends, rotated: NDArray,
                unused: int) -> tuple[dict[str, NDArray], NDArray, NDArray]:
    """Members of `Links`, and row and column of each of their matrix entries.

    The row is `unused` where the entry is zero in all states. `rotated` is `System.rotated`.
    """
    number = {row[0]: k for k, row in enumerate(ends.dependent)}
    frame_of = dict(rotated.tolist())
    elements, maps, blocks, rows, columns = [], [], [], [], []
    start = 0
    for shape in shapes if number else ():
        for unknowns, full in zip(shape.unknowns, shape.full, strict=True):
            if any(u in number for u in unknowns):
                wide, own_map, own_blocks = _expanded(unknowns, ends, number, frame_of, len(maps))
                elements.append((start, shape.width, len(wide), len(maps), len(rows),
                                 len(blocks), len(blocks) + len(own_blocks)))
                maps += own_map
                blocks += own_blocks
                apart = set(unknowns[full:])        # internal modes: zeros between them
                rows += [unused if u in apart and other in apart and u != other else u
                         for u in wide for other in wide]
                columns += wide * len(wide)
            start += shape.width ** 2
    for _, first in ends.arms:
        own = list(range(first, first + ends.rotation_size))
        rows += [u for u in own for _ in own]
        columns += own * ends.rotation_size
    links = {"dependent": _table(ends.dependent, 4), "arms": _table(ends.arms, 2),
             "elements": _table(elements, 7), "maps": _table(maps, 1).ravel(),
             "blocks": _table(blocks, 4)}
    return links, _table(rows, 1).ravel(), _table(columns, 1).ravel()


def _expanded(unknowns: Sequence[int], ends: Ends, number: Mapping[int, int],
              frame_of: Mapping[int, int],
              at_map: int) -> tuple[list[int], list[int], list[tuple[int, int, int, int]]]:
    """Unknowns of an element after replacement; `sebody.engine.links` has map and blocks.

    Dependent positions have numbers and free ones frames, by their first coordinates.
    """
    d = ends.dimension
    inner = {u + k for u in unknowns if u in number for k in range(d)}
    wide = [u for u in dict.fromkeys(unknowns) if u not in inner]

    def first_of(unknown: int, count: int) -> int:
        for k in range(count):
            if unknown + k not in wide:
                wide.append(unknown + k)
        return wide.index(unknown)
    local = [-1 if u in inner else wide.index(u) for u in unknowns]
    blocks = []
    for i, u in enumerate(unknowns):
        if u in number:
            _, root, first, last = ends.dependent[number[u]]
            blocks.append((i, number[u], at_map + len(local), frame_of.get(root, -1)))
            local.append(first_of(root, d))
            local += [first_of(ends.arms[k][1], ends.rotation_size) for k in range(first, last)]
    return wide, local, blocks


def _table(values: Sequence, width: int) -> NDArray:
    return np.array(values, dtype=np.int64).reshape(-1, width)
