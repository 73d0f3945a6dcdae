"""The axes that unknowns are solved for in, and which element matrices are rotated into them.

Free positions are solved for in the frame of the first body they belong to, and with them the
force that holds such a position to another one or to the ground. In these axes the tangent of the
body hardly changes, so one factorization serves many steps. Element matrices of superelements are
in the axes of their own frame, all others in global axes (-1).
"""

from collections.abc import Iterable, Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.batches import Shape, starts
from sebody.engine.system import System
from sebody.kernels.loader import element_kernel
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering


def frames(model: Mechanism, numbering: Numbering) -> dict[int, int]:
    """First unknowns of positions and of forces that hold them -> frame they are solved for in."""
    frame_of: dict[int, int] = {}
    for k, body in enumerate(model.bodies.values()):
        for dof_block in body.positions:
            if dof_block.solved:
                frame_of.setdefault(numbering.dof_blocks[dof_block], k)
    for dof_block in numbering.dependent:
        frame_of[numbering.dof_blocks[dof_block]] = -1
    for constraint, first in numbering.multipliers.items():
        if element_kernel(constraint.kind).VECTOR:
            held = (frame_of.get(numbering.dof_blocks[t.dof_block], -1)
                    for t in constraint.attachments)
            frame_of[first] = next((frame for frame in held if frame >= 0), -1)
    return frame_of


def in_frames(model: Mechanism, numbering: Numbering, system: System) -> NDArray:
    """Tell whether the element matrices of each batch are in the axes of frames: (batches,) bool.

    Those of superelements, and of loads on bodies.
    """
    turned = np.arange(system.address.size) < system.first_joint[0]
    for load in model.loads:
        if load.body is not None:
            turned[np.searchsorted(system.at_g, numbering.forces_at[load], side="right") - 1] = True
    return turned


def rotated_blocks(shapes: Iterable[Shape],
                   frame_of: Mapping[int, int]) -> tuple[NDArray, NDArray]:
    """The members `rotated` and `rotated_blocks` of `System`."""
    blocks, start = [], 0
    for shape in shapes:
        for numbers, unknowns in zip(shape.frames, shape.unknowns, strict=True):
            for local, unknown in enumerate(unknowns):
                if frame_of.get(unknown, numbers) != numbers:
                    blocks.append((start, shape.width, local, frame_of[unknown], numbers))
            start += shape.width ** 2
    return (np.array([item for item in frame_of.items() if item[1] >= 0],
                     dtype=np.int64).reshape(-1, 2),
            np.array(blocks, dtype=np.int64).reshape(-1, 5))


def summands(shapes: Iterable[Shape], rotated: NDArray, linked: NDArray, kept: NDArray,
             entries: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """The members `J_place`, `J_entry` and `summands` of `System`, without its last two columns.

    Parameters
    ----------
    rotated, linked
        `System.rotated_blocks` and `Links.elements`.
    kept, entries
        Entries of `State.J` that are summed, and what entries of the matrix they belong to.
    """
    width = [s.width for s in shapes for _ in s.unknowns]
    start = starts(w * w for w in width)
    rows = np.full((len(width), 10), -1)
    rows[:, 0], rows[:, 1] = start[:-1], width
    firsts = np.searchsorted(rotated[:, 0], start)
    rows[:, 2], rows[:, 3] = firsts[:-1], firsts[1:]
    rows[np.searchsorted(start, linked[:, 0]), 4] = np.arange(len(linked))
    ends = np.searchsorted(kept, start)
    places = (kept - np.repeat(start[:-1], np.diff(ends))).astype(np.int32)
    return *_shared(places, entries.astype(np.int32), ends, rows), rows


def _shared(places: NDArray, entries: NDArray, ends: NDArray,
            rows: NDArray) -> tuple[NDArray, NDArray]:
    """Places and entries of elements; those that only lie elsewhere in the matrix share theirs.

    The links of a chain do, whose lists would fill a processor's cache otherwise.
    """
    known: dict[bytes, int] = {}
    size, pieces = 0, []
    for row, (first, end) in zip(rows, pairwise(ends.tolist()), strict=True):
        own, to = places[first:end], entries[first:end]
        shift = to[0] if end > first else 0
        key = own.tobytes() + (to - shift).tobytes()
        if key not in known:
            known[key] = size
            pieces.append((own, to - shift))
            size += end - first
        row[5], row[6], row[7] = known[key], known[key] + end - first, shift
    return tuple(np.concatenate([piece[k] for piece in pieces]) for k in range(2))
