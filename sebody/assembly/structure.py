"""Index arrays of a model: these depend on its structure alone, and are remembered by it.

Many runs are of the same few models with other numbers. Their index arrays are computed once and
shared: nothing writes to them.
"""

from collections.abc import Iterable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.axes import rotated_blocks, summands
from sebody.assembly.batches import Shape, starts
from sebody.assembly.internal_columns import internal_columns
from sebody.assembly.links import Ends, link_tables
from sebody.assembly.scatter import dense_layout, element_scatter, sparse_layout
from sebody.contract.counts import LANES

REMEMBERED = 16         # structures


class Structure(NamedTuple):
    """All that index arrays depend on; structures that are equal have equal ones."""

    free: int                       # number of unknowns
    total: int                      # number of coordinates
    dense: bool                     # whether the loop keeps an inverse of the iteration matrix
    groups: tuple[int, ...]         # where the unknowns of each body begin
    equations: tuple[tuple[int, int], ...]      # first multiplier and number of them
    coupling: bool                  # whether an equation acts on several DOF blocks
    frame_of: tuple[tuple[int, int], ...]       # of positions: first coordinate, frame or -1
    ends: Ends
    shapes: tuple[Shape, ...]       # of all batches
    first_joint: int                # first batch that is not of superelements
    first_power: int                # first batch of elements with a power port


class Indices(NamedTuple):
    """Members of `System` and of `Links`, by name."""

    system: dict[str, NDArray]
    links: dict[str, NDArray]


@lru_cache(maxsize=REMEMBERED)
def indices(of: Structure) -> Indices:
    """The index arrays of a structure."""
    is_multiplier = _multipliers(of)
    own_row, own_column = element_scatter(of.shapes, of.total)
    rotated, blocks = rotated_blocks(of.shapes, dict(of.frame_of))
    links, linked_row, linked_column = link_tables(of.shapes, of.ends, rotated, of.total)
    row = np.concatenate([own_row, linked_row])
    column = np.concatenate([own_column, linked_column])
    entries, matrix = (dense_layout(row, column, of.free) if of.dense else
                       sparse_layout(row, column, of.free, np.array(of.groups)))
    own_entries, linked_entries = entries[:len(own_row)], entries[len(own_row):]
    kept = np.flatnonzero(own_entries < len(matrix["rows"]))
    places, to, table = summands(of.shapes, blocks, links["elements"], kept, own_entries[kept])
    internal, condensed_ends, firsts = internal_columns(of.shapes, of.first_joint, linked_row,
                                                        of.free, matrix)
    table[:, 8], table[:, 9] = firsts[:-1], firsts[1:]
    order, first_summands = _by_parts(of, matrix, links["elements"], table)
    first_load = sum(len(s.unknowns) * s.width ** 2 for s in of.shapes[:of.first_power])
    linked = of.coupling or bool((blocks[:, 0] < first_load).any())
    arms = len(linked_entries) - len(of.ends.arms) * of.ends.rotation_size**2
    return Indices(
        {**_batch_arrays(of.shapes), **matrix, "J_place": places, "J_entry": to,
         "is_multiplier": is_multiplier,
         "constraint_columns": _constraint_columns(matrix, is_multiplier, of.free),
         "rotated": rotated,
         "rotated_blocks": blocks, "summands": table[order], "linked": np.array([int(linked)]),
         "part_summands": first_summands, "internal": internal, "condensed_ends": condensed_ends,
         "first_joint": np.array([of.first_joint]), "first_power": np.array([of.first_power])},
        {**links, "entries": linked_entries[:arms], "arm_entries": linked_entries[arms:]})


def _by_parts(of: Structure, matrix: dict[str, NDArray], linked: NDArray,
              table: NDArray) -> tuple[NDArray, NDArray]:
    """Elements by the part of the elimination they are in, the rest behind; where each begins."""
    parts = len(matrix["part_blocks"]) - 1
    of_unknown = np.full(of.total, parts)
    slots = np.flatnonzero(matrix["slot_unknowns"] < of.free)
    of_unknown[matrix["slot_unknowns"][slots]] = np.searchsorted(
        matrix["part_blocks"], slots // LANES, side="right") - 1
    of_unknown[of.free:] = -1           # fixed: in none
    of_element = [_part([int(of_unknown[u]) for u in row], parts)
                  for shape in of.shapes for row in shape.unknowns]
    found = np.where(table[:, 4] >= 0, parts, of_element)      # of rigid links: the rest
    return (np.argsort(found, kind="stable"),
            np.searchsorted(np.sort(found), np.arange(parts + 1)))


def _part(parts: list[int], rest: int) -> int:
    """The part that all free unknowns of an element are in, else the rest."""
    own = {part for part in parts if part >= 0}
    return own.pop() if len(own) == 1 else rest


def _batch_arrays(shapes: Iterable[Shape]) -> dict[str, NDArray]:
    """The members of `System` that describe the batches."""
    widths, sizes = [s.width for s in shapes], [len(s.unknowns) for s in shapes]
    strides = [s.stride for s in shapes]
    return {"count": np.array(sizes), "stride": np.array(strides), "width": np.array(widths),
            "at_index": starts(s * t for s, t in zip(sizes, strides, strict=True)),
            "at_g": starts(s * w for s, w in zip(sizes, widths, strict=True)),
            "at_J": starts(s * w * w for s, w in zip(sizes, widths, strict=True)),
            "g_unknown": np.array([u for s in shapes for row in s.unknowns for u in row])}


def _multipliers(of: Structure) -> NDArray:
    """1.0 for every multiplier, and zeros behind the last coordinate."""
    flags = np.zeros(of.total + LANES)
    for first, count in of.equations:
        flags[first:first + count] = 1.0
    return flags


def _constraint_columns(matrix: dict[str, NDArray], is_multiplier: NDArray, free: int) -> NDArray:
    """Entries in rows of coordinates and columns of multipliers."""
    moving, pulling = is_multiplier == 0.0, is_multiplier > 0.0
    moving[free:] = pulling[free:] = False
    return np.flatnonzero(moving[matrix["rows"]] & pulling[matrix["columns"]])
