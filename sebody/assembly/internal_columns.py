"""Columns of blocks with unknowns of one superelement alone, see `sebody.engine.condensation`."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.batches import Shape
from sebody.contract.counts import LANES

_SHARED, _FREE = -1, -2      # of several elements; of a free slot


def internal_columns(shapes: Sequence[Shape], first_joint: int, linked: NDArray, free: int,
                     matrix: dict[str, NDArray]) -> tuple[NDArray, NDArray, NDArray]:
    """The members `internal` and `condensed_ends` of `System`, and where elements begin in it.

    Parameters
    ----------
    linked
        Unknowns in entries of elements with rigid links, which are shared.
    matrix
        Members of `System`, as `sparse_layout` and `dense_layout` make them.

    Returns
    -------
    internal, condensed_ends : ndarray
    firsts : (elements + 1,)
        First row of `internal` of every element, the number of rows at the end.
    """
    elements, starts = sum(len(shape.unknowns) for shape in shapes), matrix["block_starts"]
    if len(starts) == 0:
        return np.zeros((0, LANES + 1), np.int64), starts, np.zeros(elements + 1, np.int64)
    owner, place = _owners(shapes, first_joint, linked, free)
    slots = matrix["slot_unknowns"].reshape(-1, LANES)
    owners = np.append(owner, _FREE)[slots]
    of_column = owners.max(axis=1)
    alone = (of_column >= 0) & ((owners == of_column[:, None]) | (owners == _FREE)).all(axis=1)
    of_column = _without_others_before(np.where(alone, of_column, _SHARED), matrix)
    columns = np.flatnonzero(of_column >= 0)
    columns = columns[np.argsort(of_column[columns], kind="stable")]
    ends = starts[1:].copy()
    ends[columns] = starts[columns]
    return (np.column_stack([columns, np.append(place, -1)[slots[columns]]]), ends,
            np.searchsorted(of_column[columns], np.arange(elements + 1)))


def _owners(shapes: Sequence[Shape], first_joint: int, linked: NDArray,
            free: int) -> tuple[NDArray, NDArray]:
    """The one superelement that an unknown belongs to, or `_SHARED`; its place there."""
    count, owner, place = np.zeros((3, free), dtype=np.int64)
    first = 0
    for number, shape in enumerate(shapes):
        unknowns = np.array(shape.unknowns, dtype=np.int64)
        element, local = np.indices(unknowns.shape)
        solved = unknowns < free
        np.add.at(count, unknowns[solved], 1)
        owner[unknowns[solved]] = first + element[solved] if number < first_joint else _SHARED
        place[unknowns[solved]] = local[solved]
        first += len(unknowns)
    count[linked[linked < free]] += 2
    return np.where(count == 1, owner, _SHARED), place


def _without_others_before(of_column: NDArray, matrix: dict[str, NDArray]) -> NDArray:
    """Leave out columns that are coupled to earlier ones which are not of the same element."""
    rows, starts = matrix["block_rows"], matrix["block_starts"]
    columns = np.repeat(np.arange(len(of_column)), np.diff(starts))
    rows, columns = rows[rows < columns], columns[rows < columns]
    while (late := (of_column[columns] >= 0) & (of_column[rows] != of_column[columns])).any():
        of_column[columns[late]] = _SHARED
    return of_column
