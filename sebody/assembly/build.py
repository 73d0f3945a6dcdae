"""Numbering of the unknowns and the flat arrays the compiled loop runs on."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly import elimination_pattern
from sebody.assembly.links import link_arrays, with_entries
from sebody.assembly.numbering import Numbering, coordinates, number
from sebody.engine.links import Links
from sebody.engine.system import System
from sebody.errors import InputError
from sebody.kernels.abi import padded
from sebody.kernels.layout import LANES, padded_columns
from sebody.kernels.loader import element_kernel
from sebody.model.model import Model, Superelement
from sebody.model.nodes import Element
from sebody.reduction import ReducedBody

DENSE_LIMIT = 24        # above this many unknowns elimination by blocks is faster than an inverse


class Batch(NamedTuple):
    """Elements that share a kernel and a number of unknowns."""

    kernel: object
    width: int
    rows: list[list[int]]           # index rows
    unknowns: list[list[int]]       # unknowns of each element
    owners: list[int]               # id of what each element stands for


def build(model: Model) -> tuple[System, Numbering]:
    """Flat arrays of a model.

    Raises
    ------
    InputError
        No bodies, or a triplet that nothing holds.
    """
    if not (model.bodies or model.rigid_bodies):
        raise InputError("the model has no body: add one with model.superelement(...) or "
                         "model.rigid_body(...)")
    numbering = number(model)
    if numbering.free == 0:
        raise InputError("every node of the model is fixed: nothing is left to move, free one")
    constants: list[NDArray] = []
    batches = _body_batches(model, numbering, constants)
    first_joint = len(batches)
    elements = [*model.rigid_bodies.values(), *model.joints, *model.loads]
    working = [element_kernel(e.kind).POWER for e in elements]
    batches += _element_batches(numbering, constants, [e for e, w in zip(
        elements, working, strict=True) if not w])
    first_power = len(batches)
    batches += _element_batches(numbering, constants, [e for e, w in zip(
        elements, working, strict=True) if w])
    dense = numbering.free <= DENSE_LIMIT
    row, column = _element_places(batches)
    axes = _body_axes(model, numbering, batches, first_joint, first_power)
    links, linked_row, linked_column = link_arrays(model, numbering, batches, axes["turned"])
    all_rows, all_columns = np.r_[row, linked_row], np.r_[column, linked_column]
    layout = (_dense_layout(all_rows, all_columns, numbering.free) if dense else
              _sparse_layout(all_rows, all_columns, numbering))
    entries = layout.pop("entries")
    widths = [b.width for b in batches]
    sizes = [len(b.rows) for b in batches]
    integers = np.array
    multiplier = np.zeros(numbering.total + LANES)
    for joint in model.joints:
        first = numbering.multipliers[id(joint)]
        multiplier[first:first + joint.multipliers] = 1.0
    system = System(
        address=integers([b.kernel.kernel.address for b in batches]),
        count=integers(sizes), stride=integers([len(b.rows[0]) for b in batches]),
        width=integers(widths),
        at_index=_starts([len(b.rows) * len(b.rows[0]) for b in batches]),
        at_g=_starts([s * w for s, w in zip(sizes, widths, strict=True)]),
        at_J=_starts([s * w * w for s, w in zip(sizes, widths, strict=True)]),
        first_joint=integers([first_joint]), first_power=integers([first_power]),
        index=integers([i for b in batches for row in b.rows for i in row]),
        constants=np.concatenate(constants),
        g_unknown=integers([u for b in batches for row in b.unknowns for u in row]),
        J_entry=entries[:len(row)].astype(np.int32), **layout, is_multiplier=multiplier,
        rotation_at=_rotation_starts(model, numbering), **axes,
        summands=_summands(batches, axes["turned_blocks"], links),
        dimension=integers([model.dimension]), magnitude=_magnitude(model, numbering),
        **_items(numbering), links=with_entries(links, entries[len(row):]),
        relaxed=np.zeros(1, dtype=np.int64),
        damped=integers([int(any(b.body.damping is not None for b in model.bodies.values()))]))
    owners = [owner for b in batches for owner in b.owners]
    starts = _starts([b.width for b in batches for _ in b.rows])
    return system, numbering._replace(forces_at=dict(zip(owners, starts.tolist(), strict=False)))


def _starts(sizes: list[int]) -> NDArray:
    return np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)


def _body_batches(model: Model, numbering: Numbering, constants: list) -> list[Batch]:
    batches: dict[tuple, Batch] = {}
    rows_of: dict[int, int] = {}
    at = 0
    for number_, body in enumerate(model.bodies.values()):
        key = id(body.body), body.frame, tuple(body.alpha), tuple(body.alpha_r)
        if key not in rows_of:
            row = _body_constants(body)
            rows_of[key] = at
            constants.append(row)
            at += len(row)
        unknowns = [c for t in (*body.positions, *body.rotations)
                    for c in coordinates(numbering, t)]
        first = numbering.modes[body.name]
        unknowns += range(first, first + body.body.modes)
        nodes = ([] if not model.planar and not body.rotations else
                 [numbering.rotations[id(t)] for t in body.rotations] if not model.planar
                 else [0] * len(body.rotations))
        batch = batches.setdefault((body.kernel.__name__, len(unknowns)),
                                   Batch(body.kernel, len(unknowns), [], [], []))
        item = numbering.items.get(id(body), 0)
        batch.rows.append([rows_of[key], number_, item, *nodes, *unknowns])
        batch.unknowns.append(unknowns)
        batch.owners.append(id(body))
    return list(batches.values())


def _body_constants(body: Superelement) -> NDArray:
    reduced = body.body
    points = reduced.coordinates[list(reduced.position_nodes)]
    local = points - body.alpha @ points
    fit = np.full(len(points), 1.0 / len(points))
    return np.concatenate([body.alpha, fit, body.alpha_r, local.ravel(),
                           padded_columns(reduced.stiffness), padded_columns(reduced.mass),
                           *mass_constants(reduced, body.alpha @ points),
                           *([] if reduced.damping is None else
                             [padded_columns(reduced.damping)])])


def mass_constants(body: ReducedBody, origin: NDArray) -> list[NDArray]:
    """``Mbar r`` by columns and by rows, first moment of mass about the frame's origin, mass."""
    of_translations = body.mass @ body.rigid_modes[:, :len(origin)]
    return [padded_columns(of_translations), padded_columns(of_translations.T),
            body.total_mass * (body.centre_of_mass - origin), np.array([body.total_mass])]


def _element_batches(numbering: Numbering, constants: list,
                     elements: list[Element]) -> list[Batch]:
    batches: dict[tuple, Batch] = {}
    at = sum(map(len, constants))
    for element in elements:
        unknowns = [c for t in element.triplets for c in coordinates(numbering, t)]
        if element.mode is not None:
            unknowns.append(numbering.modes[element.mode[0]] + element.mode[1])
        if element.multipliers:
            first = numbering.multipliers[id(element)]
            unknowns += range(first, first + element.multipliers)
        key = element.kind, len(unknowns)
        batch = batches.setdefault(key, Batch(element_kernel(element.kind), len(unknowns), [], [],
                                              []))
        nodes = [numbering.rotations[id(t)] for t in element.triplets
                 if id(t) in numbering.rotations]
        extra = [] if element.function is None else [element.function.address]
        batch.rows.append([at, 0, numbering.items.get(id(element), 0), *nodes, *unknowns, *extra])
        batch.unknowns.append(unknowns)
        batch.owners.append(id(element))
        constants.append(element.constants)
        at += len(element.constants)
    return list(batches.values())


def _element_places(batches: list[Batch]) -> tuple[NDArray, NDArray]:
    """Row and column of every entry of the element matrices."""
    rows, columns = [], []
    for batch in batches:
        unknowns = np.array(batch.unknowns, dtype=np.int64)
        shape = (len(unknowns), batch.width, batch.width)
        rows.append(np.broadcast_to(unknowns[:, :, None], shape).ravel())
        columns.append(np.broadcast_to(unknowns[:, None, :], shape).ravel())
    return np.concatenate(rows), np.concatenate(columns)


def _dense_layout(row: NDArray, column: NDArray, n: int) -> dict[str, NDArray]:
    """Matrix entry of each element entry, row and column of each; fixed ones go behind the end."""
    columns, rows = np.divmod(np.arange(n * n, dtype=np.int32), n)
    none = np.zeros(0, dtype=np.int64)
    return {"entries": np.where((row < n) & (column < n), column * n + row, n * n),
            "rows": rows, "columns": columns, "diagonal": np.arange(n) * (n + 1), "padding": none,
            "block_starts": none, "block_rows": none, "block_diagonal": none,
            "slot_unknowns": none}


def _sparse_layout(row: NDArray, column: NDArray, numbering: Numbering) -> dict[str, NDArray]:
    """The same in the blocks of an elimination."""
    n = numbering.free
    free = (row < n) & (column < n)
    slot, pattern = elimination_pattern.best_slots(row[free], column[free], numbering.groups, n)
    slots = LANES * len(pattern.diagonal)
    unknowns = np.full(slots, n)
    unknowns[slot] = np.arange(n)
    rows, columns = elimination_pattern.places(pattern)
    entries = np.full(len(row), len(rows))
    entries[free] = elimination_pattern.entries(pattern, slot[row[free]], slot[column[free]])
    diagonal = elimination_pattern.entries(pattern, np.arange(slots), np.arange(slots))
    return {"entries": entries, "rows": unknowns[rows].astype(np.int32),
            "columns": unknowns[columns].astype(np.int32), "diagonal": diagonal[slot],
            "padding": diagonal[unknowns == n], "block_starts": pattern.starts,
            "block_rows": pattern.rows, "block_diagonal": pattern.diagonal,
            "slot_unknowns": unknowns}


def _rotation_starts(model: Model, numbering: Numbering) -> NDArray:
    starts = np.zeros(len(numbering.rotations), dtype=np.int64)
    for key, k in numbering.rotations.items():
        starts[k] = numbering.triplets[key]
    return starts


def _body_axes(model: Model, numbering: Numbering, batches: list[Batch],
               bodies: int, first_power: int) -> dict[str, NDArray]:
    """Free positions are solved for in the axes of the first body they belong to.

    There the tangent of a body hardly changes, so one factorization serves many steps. Matrices of
    superelements are in the axes of their own frame, those of joints and loads in global ones (-1).
    """
    frame_of: dict[int, int] = {}
    for k, body in enumerate(model.bodies.values()):
        for triplet in body.positions:
            if triplet.solved:
                frame_of.setdefault(numbering.triplets[id(triplet)], k)
    for triplet in numbering.hanging:
        frame_of[numbering.triplets[id(triplet)]] = -1
    blocks, start = [], 0
    for k, batch in enumerate(batches):
        for row, unknowns in zip(batch.rows, batch.unknowns, strict=True):
            own = row[1] if k < bodies else -1
            for local, unknown in enumerate(unknowns):
                if frame_of.get(unknown, own) != own:
                    blocks.append((start, batch.width, local, frame_of[unknown], own))
            start += batch.width ** 2
    loads = sum(len(b.rows) * b.width ** 2 for b in batches[first_power:])
    linked = (any(block[0] < start - loads for block in blocks)
              or any(len(joint.triplets) > 1 for joint in model.joints))
    return {"linked": np.array([int(linked)]),
            "turned": np.array([item for item in frame_of.items() if item[1] >= 0],
                               dtype=np.int64).reshape(-1, 2),
            "turned_blocks": np.array(blocks, dtype=np.int64).reshape(-1, 5)}


def _summands(batches: list[Batch], turned: NDArray, links: Links) -> NDArray:
    """Element matrices, and what is done to them before they are summed."""
    width = np.repeat([b.width for b in batches], [len(b.rows) for b in batches])
    start = _starts(width ** 2)
    linked = np.full(len(width), -1)
    linked[np.searchsorted(start, links.elements[:, 0])] = np.arange(len(links.elements))
    return np.column_stack([start[:-1], width, np.searchsorted(turned[:, 0], start[:-1]),
                            np.searchsorted(turned[:, 0], start[1:]), linked])


def _magnitude(model: Model, numbering: Numbering) -> NDArray:
    """Sizes that rounding acts on: the model's extent for positions, one radian for rotations."""
    points = np.array([n.point for n in model.nodes.values()])
    size = np.zeros(numbering.total)
    for node in model.nodes.values():
        if node.position is not None and id(node.position) in numbering.triplets:
            size[coordinates(numbering, node.position)] = np.abs(points).max()
        if node.rotation is not None and id(node.rotation) in numbering.triplets:
            size[coordinates(numbering, node.rotation)] = 1.0
    return size


def _items(numbering: Numbering) -> dict[str, NDArray]:
    """Histories of the items, and the coordinates that some of them move."""
    histories = numbering.histories
    return {"table_at": _starts([len(h.times) for h in histories]),
            "table_times": np.array([t for h in histories for t in h.times], dtype=float),
            "table_cubics": np.array([c for h in histories for c in h.cubics],
                                     dtype=float).reshape(-1, 4),
            "corners": np.unique([t for h in histories for t in h.corners]),
            "functions": np.array([h.addresses for h in histories],
                                  dtype=np.int64).reshape(-1, 3),
            "prescribed": np.array([row[:3] for row in numbering.prescribed],
                                   dtype=np.int64).reshape(-1, 3),
            "prescribed_factor": np.array([row[3] for row in numbering.prescribed], dtype=float)}


def work_size(model: Model) -> int:
    """Scratch memory the kernels of a model need."""
    rows = [b.kernel.WORK_ROWS * padded(max(_width(b), 9 * b.kernel.N_ROTATIONS))
            for b in model.bodies.values()]
    elements = max((sum(t.start.size for t in load.triplets) for load in model.loads), default=0)
    return max([*rows, 64, 4 * elements])


def _width(body: Superelement) -> int:
    return body.body.stiffness.shape[0]


