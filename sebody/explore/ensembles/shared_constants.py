"""Which constants of bodies all members of an ensemble share, and how lanes hold them.

A kernel for lanes reads eight numbers of a constant, 64 bytes. Of bodies that no parameter changes
another version of the kernel reads one number for all members.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.contracts import counts_of
from sebody.contract.layout import AT_CONSTANTS, AT_FRAME, Row
from sebody.explore.ensembles.choice import kernels_of
from sebody.explore.ensembles.start_values import Image
from sebody.kernels.loader import load


class Packed(NamedTuple):
    """A row of packed matrices among the constants of a body."""

    batch: int
    place: slice        # in the buffer of all numbers


def kernels_of_batches(image: Image) -> list[tuple[str, bool]]:
    """The kernel of each batch of elements, and whether its constants are shared."""
    names = {load(name).kernel.address: name for name in kernels_of(image.template.model)}
    shared = shared_rows(image)
    return [(names[address], b in shared)
            for b, address in enumerate(image.template.system.address.tolist())]


def shared_rows(image: Image) -> dict[int, dict[int, int]]:
    """Of batches of bodies that no parameter changes, the sizes of rows of constants by place."""
    system, found = image.template.system, {}
    varied = varied_numbers(image)
    first = image.offsets.of(system.constants).start
    for b in range(int(system.first_joint[0])):
        rows = {int(index[AT_CONSTANTS]): _row(image, index)[0] for index in rows_of(image, b)}
        others = {int(index[AT_CONSTANTS]) for other in range(len(system.address)) if other != b
                  for index in rows_of(image, other)}
        if not others.intersection(rows) and not any(
                varied[first + start:first + start + size].any() for start, size in rows.items()):
            found[b] = rows
    return found


def packed_rows(image: Image) -> Iterator[Packed]:
    """The packed matrices of all bodies."""
    system = image.template.system
    for b in range(int(system.first_joint[0])):
        for index in rows_of(image, b):
            first = image.offsets.of(system.constants).start + int(index[AT_CONSTANTS])
            for place in _row(image, index)[1]:
                yield Packed(b, slice(first + place.start, first + place.stop))


def varied_numbers(image: Image) -> NDArray:
    """Whether parameters change a number, of all numbers of a run."""
    varied = np.zeros(image.floats.size, dtype=bool)
    varied[image.lines.slots] = True
    return varied


def rows_of(image: Image, batch: int) -> NDArray:
    """The index rows of the elements of a batch, (elements, stride)."""
    system = image.template.system
    first, count = system.at_index[batch], system.count[batch]
    size = int(count * system.stride[batch])
    return system.index[first:first + size].reshape(count, -1)


def _row(image: Image, index: NDArray) -> tuple[int, list[slice]]:
    """Size of the constants of a body, and where the packed matrices are among them."""
    body = list(image.template.model.bodies.values())[index[AT_FRAME]]
    counts, row = counts_of(body), Row("constants", load(body.kernel).CONSTANTS)
    places = row.slices(counts)
    return row.size(counts), [places[part.name] for part in row.parts
                              if part.packed and part.size(counts)]
