"""Constants of bodies that all members of an ensemble share, and how lanes hold them.

A kernel for lanes reads eight numbers of a constant, 64 bytes. Of bodies whose constants no
parameter changes another version of the kernel reads one number for all members. Where a parameter
changes few of them, these are lanes: entries of packed matrices, which straight code reads, and
some parts, whose first number among the shared ones is the address of the lanes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from types import ModuleType
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.contracts import counts_of
from sebody.contract.counts import Counts
from sebody.contract.layout import AT_CONSTANTS, AT_FRAME, Part, Row
from sebody.explore.ensembles.choice import kernels_of, matrices_at_once
from sebody.explore.ensembles.start_values import Image
from sebody.kernels.loader import load

if TYPE_CHECKING:
    from sebody.kernels.lanes.kernel import Own

MOST_PARTS = 4      # of a body's constants that parameters change; if more, all are lanes


class Packed(NamedTuple):
    """A row of packed matrices among the constants of a body."""

    batch: int
    place: slice        # in the buffer of all numbers


def kernels_of_batches(image: Image) -> list[tuple[str, Own, bool]]:
    """The kernel of each batch of elements, which of its constants are lanes, whether matrices."""
    names = {load(name).kernel.address: name for name in kernels_of(image.template.model)}
    own, matrices = own_parts(image), matrices_at_once(image.template)
    return [(names[address], own.get(b), matrices)
            for b, address in enumerate(image.template.system.address.tolist())]


def own_parts(image: Image) -> dict[int, Own]:
    """Parts of shared constants of batches of bodies of which members have their own."""
    varied, found = varied_numbers(image), {}
    for packed in packed_rows(image):
        varied[packed.place] = False
    for b in range(int(image.template.system.first_joint[0])):
        parts = {name for index in rows_of(image, b) for name, place in _parts(
            image, index, _read_parts).items() if varied[place].any()}
        own = tuple(sorted(parts))
        if len(parts) <= MOST_PARTS and all(
                part.size(counts) for *_, part, counts in _straight_parts(image, b, own)):
            found[b] = own
    return found


def straight_matrices(image: Image) -> Iterator[tuple[slice, int]]:
    """The places of matrices whose products are straight code, and how many rows they have."""
    for b, own in own_parts(image).items():
        for index, part, counts in _straight_parts(image, b, own):
            place, = _parts(image, index, lambda _, name=part.name: {name}).values()
            yield place, part.own_shape(counts)[0]


def _straight_parts(image: Image, batch: int, own: Own) -> Iterator[tuple[NDArray, Part, Counts]]:
    """These matrices of every element of a batch; index row, part and counts of the body."""
    from sebody.kernels.lanes.text import straight_parts  # imports the lanes

    for index in rows_of(image, batch):
        kernel, counts = _kernel_of(image, index)
        names = straight_parts(kernel, own, matrices_at_once(image.template))
        yield from ((index, part, counts) for part in kernel.CONSTANTS if part.name in names)


def own_places(image: Image) -> Iterator[slice]:
    """The places of these parts in the buffer of all numbers."""
    for b, names in own_parts(image).items():
        for index in rows_of(image, b):
            yield from _parts(image, index, lambda kernel, names=names: names).values()


def packed_rows(image: Image) -> Iterator[Packed]:
    """The packed matrices of all bodies."""
    for b in range(int(image.template.system.first_joint[0])):
        for index in rows_of(image, b):
            yield from (Packed(b, place)
                        for place in _parts(image, index, _packed_parts).values())


def varied_numbers(image: Image) -> NDArray:
    """Tell whether parameters change a number, of all numbers of a run."""
    varied = np.zeros(image.floats.size, dtype=bool)
    varied[image.lines.slots] = True
    return varied


def rows_of(image: Image, batch: int) -> NDArray:
    """The index rows of the elements of a batch, (elements, stride)."""
    system = image.template.system
    first, count = system.at_index[batch], system.count[batch]
    size = int(count * system.stride[batch])
    return system.index[first:first + size].reshape(count, -1)


def _parts(image: Image, index: NDArray, chosen: Callable) -> dict[str, slice]:
    """The places of some parts of the constants of a body in the buffer of all numbers.

    Parameters
    ----------
    chosen : callable
        Names of the parts, from a kernel's module.
    """
    kernel, counts = _kernel_of(image, index)
    row = Row("constants", kernel.CONSTANTS)
    names, places = chosen(kernel), row.slices(counts)
    first = image.offsets.of(image.template.system.constants).start + int(index[AT_CONSTANTS])
    return {part.name: slice(first + places[part.name].start, first + places[part.name].stop)
            for part in row.parts if part.name in names and part.size(counts)}


def _kernel_of(image: Image, index: NDArray) -> tuple[ModuleType, Counts]:
    """The kernel of a body, and the counts of its constants."""
    body = list(image.template.model.bodies.values())[index[AT_FRAME]]
    return load(body.kernel), counts_of(body)


def _packed_parts(kernel: ModuleType) -> set[str]:
    return {part.name for part in kernel.CONSTANTS if part.packed}


def _read_parts(kernel: ModuleType) -> frozenset[str]:
    from sebody.kernels.lanes.text import read_parts  # imports the lanes

    return read_parts(kernel)
