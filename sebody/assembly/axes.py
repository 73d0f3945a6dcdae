"""The axes that unknowns are solved for in, and which element matrices are rotated into them.

Free positions are solved for in the frame of the first body they belong to. In these axes the
tangent of the body hardly changes, so one factorization serves many steps. Element matrices of
superelements are in the axes of their own frame, all others in global axes (-1).
"""

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.batches import Batches, starts
from sebody.assembly.numbering import Numbering
from sebody.engine.links import Links
from sebody.model.mechanism import Mechanism


def body_axes(model: Mechanism, numbering: Numbering, batches: Batches) -> dict[str, NDArray]:
    """The members `rotated`, `rotated_blocks` and `linked` of `System`."""
    frame_of = _frames(model, numbering)
    blocks, start = [], 0
    for batch in batches.all:
        for own, unknowns in zip(batch.frames, batch.unknowns, strict=True):
            for local, unknown in enumerate(unknowns):
                if frame_of.get(unknown, own) != own:
                    blocks.append((start, batch.width, local, frame_of[unknown], own))
            start += batch.width ** 2
    first_load = sum(len(b.rows) * b.width ** 2 for b in batches.all[:batches.first_power])
    linked = (any(block[0] < first_load for block in blocks)
              or any(len(equation.triplets) > 1 for equation in model.constraints))
    return {"linked": np.array([int(linked)]),
            "rotated": np.array([item for item in frame_of.items() if item[1] >= 0],
                               dtype=np.int64).reshape(-1, 2),
            "rotated_blocks": np.array(blocks, dtype=np.int64).reshape(-1, 5)}


def _frames(model: Mechanism, numbering: Numbering) -> dict[int, int]:
    """First coordinates of positions -> number of the frame they are solved for in."""
    frame_of: dict[int, int] = {}
    for k, body in enumerate(model.bodies.values()):
        for triplet in body.positions:
            if triplet.solved:
                frame_of.setdefault(numbering.triplets[id(triplet)], k)
    for triplet in numbering.dependent:
        frame_of[numbering.triplets[id(triplet)]] = -1
    return frame_of


def summands(batches: Batches, rotated: NDArray, links: Links,
             kept: NDArray) -> tuple[NDArray, NDArray]:
    """The members `J_place` and `summands` of `System`, from the `kept` entries of `State.J`."""
    width = [b.width for b in batches.all for _ in b.rows]
    start = starts(w * w for w in width)
    found = np.full((len(width), 7), -1)
    found[:, 0], found[:, 1] = start[:-1], width
    firsts = np.searchsorted(rotated[:, 0], start)
    found[:, 2], found[:, 3] = firsts[:-1], firsts[1:]
    found[np.searchsorted(start, links.elements[:, 0]), 4] = np.arange(len(links.elements))
    ends = np.searchsorted(kept, start)
    found[:, 5], found[:, 6] = ends[:-1], ends[1:]
    return (kept - np.repeat(start[:-1], np.diff(ends))).astype(np.int32), found
