"""Index rows of elements that lanes evaluate member by member: see `contract.member_row`."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.contract.law_row import (
    ANGLES,
    AT,
    AT_OUTPUTS,
    KIND,
    LAW_HEADER,
    OUTPUT_PLACES,
    OUTPUTS,
    PLACE,
    PORT,
    READ_PLACES,
    READS,
)
from sebody.contract.layout import AT_CONSTANTS, AT_FRAME, AT_PORT, AT_ROTATIONS, HEADER
from sebody.contract.member_row import ENERGIES, RUNNING
from sebody.contract.read_numbers import OF_NOTHING, OF_Q, OF_R, OF_V
from sebody.explore.ensembles.shared_constants import kernels_of_batches, rows_of
from sebody.explore.ensembles.start_values import Image
from sebody.kernels.loader import element_kernel_name, load, takes_one_member

LAW = element_kernel_name("continuous")     # kernel of laws of continuous controllers
READ = {OF_Q: "q", OF_V: "v", OF_R: "R"}            # of the state, by kinds of numbers


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
            places = [_places(image, row, int(system.width[b]), name, starts) for row in own]
            written, read = (_of_equal_length(one) for one in zip(*places, strict=True))
            behind = np.tile([system.address[b], table.ctypes.data,
                              written.shape[1] + read.shape[1], written.shape[1]], (len(own), 1))
            own = np.hstack([own, written, read, behind])
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


def _of_equal_length(places: Sequence[list[int]]) -> NDArray:
    """Rows of places, the last one repeated where a row has fewer."""
    most = max(map(len, places))
    return np.array([[*one, *one[-1:] * (most - len(one))] for one in places],
                    dtype=np.int64).reshape(len(places), most)


def _places(image: Image, row: NDArray, width: int, name: str, starts: NDArray
            ) -> tuple[list[int], list[int]]:
    """The places of what an element keeps or sets, and reads, in the buffer of all numbers.

    Kernels that have numbers of their own behind their row read what only they know: they get all
    coordinates and frames, but for laws of controllers.
    """
    system, state, of = image.template.system, image.template.state, image.offsets.of
    behind = HEADER + row[AT_ROTATIONS] + width
    begin, port = row[AT_CONSTANTS], 3 * row[AT_PORT] + np.arange(3)
    law = row[behind:] if name == LAW else None
    own = row[AT_FRAME] + np.arange(len(load(name).MEMORY) if law is None else law[ANGLES])
    read = {"q": row[behind - width:behind], "frames": own, "frames_old": own,
            "R": (9 * row[HEADER:behind - width, np.newaxis] + np.arange(9)).ravel(),
            "loads": port[port < state.loads.size],
            "coefficients": np.arange(state.coefficients.size)}
    read |= {"v": read["q"], "a": read["q"], "T": read["R"]}
    written = {"frames": own}
    if law is not None:
        reads, ends = _parts_of_law(law)
        for kind, name in READ.items():
            read[name] = np.union1d(read[name], reads[reads[:, KIND] == kind, AT])
        held = reads[reads[:, KIND] == OF_NOTHING, AT]
        driving = ends[ends[:, PORT] >= 0]
        read["frames"] = np.concatenate([own, held])
        written = {"frames": np.concatenate([own, ends[:, PLACE], driving[:, PLACE] + 2]),
                   "loads": 3 * driving[:, PORT]}
    elif len(row) > behind:
        read |= {name: np.arange(getattr(state, name).size) for name in read}
    first = of(system.constants).start
    constants = np.arange(begin, starts[np.searchsorted(starts, begin, side="right")])
    written, read = ([of(getattr(state, name)).start + places for name, places in parts.items()]
                     for parts in (written, read))
    return np.concatenate(written).tolist(), np.concatenate([first + constants, *read]).tolist()


def _parts_of_law(law: NDArray) -> tuple[NDArray, NDArray]:
    """Inputs and outputs of a continuous controller, see `contract.law_row`."""
    reads = law[LAW_HEADER:LAW_HEADER + READ_PLACES * law[READS]]
    first = law[AT_OUTPUTS]
    ends = law[first:first + OUTPUT_PLACES * law[OUTPUTS]]
    return reads.reshape(-1, READ_PLACES), ends.reshape(-1, OUTPUT_PLACES)
