"""Index rows of elements that lanes evaluate member by member: see `contract.member_row`."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.contract.layout import AT_CONSTANTS, AT_FRAME, AT_PORT, AT_ROTATIONS, HEADER
from sebody.contract.member_row import ENERGIES, RUNNING
from sebody.explore.ensembles.shared_constants import kernels_of_batches, rows_of
from sebody.explore.ensembles.start_values import Image
from sebody.kernels.loader import load, takes_one_member


class Rows(NamedTuple):
    """Index rows of all batches."""

    index: NDArray
    at_index: NDArray
    stride: NDArray
    kept: NDArray       # (B,) numbers that an element keeps, of those evaluated member by member


def with_places(image: Image, table: NDArray) -> Rows:
    """The index rows of a model, with what the kernel `member_by_member` reads behind them.

    Parameters
    ----------
    table : ndarray
        The table of `contract.member_row`.
    """
    system = image.template.system
    rows, kept = [], np.zeros(len(system.address), dtype=np.int64)
    starts = np.unique([row[AT_CONSTANTS] for b in range(len(system.address))
                        for row in rows_of(image, b)] + [system.constants.size])
    for b, (name, *_) in enumerate(kernels_of_batches(image)):
        own = rows_of(image, b)
        if takes_one_member(name):
            kept[b] = len(load(name).MEMORY)
            places = [_places(image, row, int(system.width[b]), int(kept[b]), starts)
                      for row in own]
            most = max(map(len, places))
            behind = [system.address[b], table.ctypes.data, most, kept[b]]
            own = np.array([[*row, *one, *[one[-1]] * (most - len(one)), *behind]
                            for row, one in zip(own, places, strict=True)])
        rows.append(own)
    sizes = [one.size for one in rows]
    return Rows(np.concatenate([one.ravel() for one in rows]),
                np.concatenate([[0], np.cumsum(sizes)]),
                np.array([one.shape[1] for one in rows]), kept)


def new_table(in_lanes: NDArray, alone: NDArray, energies: int) -> NDArray:
    """The table of `contract.member_row`, for the buffers of a thread."""
    table = np.array([in_lanes.ctypes.data, alone.ctypes.data, 0, 0])
    table[ENERGIES], table[RUNNING] = energies, 0
    return table


def _places(image: Image, row: NDArray, width: int, kept: int, starts: NDArray) -> list[int]:
    """Where what an element reads is in the buffer of all numbers, what it keeps first.

    Kernels that have numbers of their own behind their row read what only they know: they get all
    coordinates and frames.
    """
    system, state, of = image.template.system, image.template.state, image.offsets.of
    behind = HEADER + row[AT_ROTATIONS] + width
    begin, port = row[AT_CONSTANTS], 3 * row[AT_PORT] + np.arange(3)
    own = row[AT_FRAME] + np.arange(kept)
    read = {"q": row[behind - width:behind], "frames": own, "frames_old": own,
            "R": (9 * row[HEADER:behind - width, np.newaxis] + np.arange(9)).ravel(),
            "loads": port[port < state.loads.size],
            "coefficients": np.arange(state.coefficients.size)}
    read |= {"v": read["q"], "a": read["q"], "T": read["R"]}
    if len(row) > behind:
        read |= {name: np.arange(getattr(state, name).size) for name in read}
    first = of(system.constants).start
    constants = np.arange(begin, starts[np.searchsorted(starts, begin, side="right")])
    return np.concatenate([of(state.frames).start + own, first + constants, *(
        of(getattr(state, name)).start + places for name, places in read.items())]).tolist()
