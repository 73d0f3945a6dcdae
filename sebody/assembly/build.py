"""From a model to the flat arrays that the compiled loop runs on."""

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.axes import body_axes, summands
from sebody.assembly.batches import Batches, make_batches, starts
from sebody.assembly.links import link_arrays, with_entries
from sebody.assembly.numbering import Numbering, number, stretch
from sebody.assembly.places import dense_layout, element_places, sparse_layout
from sebody.assembly.ports import port_arrays
from sebody.engine.system import System
from sebody.errors import InputError
from sebody.kernels.layout import LANES, scratch_size
from sebody.kernels.loader import element_kernel, load
from sebody.model.mechanism import Mechanism

DENSE_LIMIT = 24        # unknowns above which elimination by blocks is faster than an inverse


def build(model: Mechanism) -> tuple[System, Numbering]:
    """Flat arrays of a model.

    Raises
    ------
    InputError
        No bodies, a triplet that nothing holds, or an element that does not fit its kernel.
    """
    if not (model.bodies or model.rigid_bodies):
        raise InputError("the model has no body: add one with model.superelement(...) or "
                         "model.rigid_body(...)")
    numbering = number(model)
    is_multiplier = _multipliers(model, numbering)
    if is_multiplier[:numbering.free].all():
        raise InputError("every node of the model is fixed: nothing is left to move, free one")
    batches = make_batches(model, numbering)
    axes = body_axes(model, numbering, batches)
    own_row, own_column = element_places(batches.all, numbering.total)
    links, linked_row, linked_column = link_arrays(model, numbering, batches.all, axes["rotated"])
    row = np.concatenate([own_row, linked_row])
    column = np.concatenate([own_column, linked_column])
    entries, matrix = (dense_layout(row, column, numbering.free)
                       if numbering.free <= DENSE_LIMIT else
                       sparse_layout(row, column, numbering))
    own_entries, linked_entries = entries[:len(own_row)], entries[len(own_row):]
    kept = np.flatnonzero(own_entries < len(matrix["rows"]))
    places, table = summands(batches, axes["rotated_blocks"], links, kept)
    system = System(
        **_batch_arrays(batches), J_place=places, J_entry=own_entries[kept].astype(np.int32),
        **matrix, **axes,
        is_multiplier=is_multiplier, pulls=_pulls(matrix, is_multiplier, numbering.free),
        rotation_at=_rotation_starts(numbering), summands=table,
        routines=np.zeros(1, dtype=np.int64),
        dimension=np.array([model.dimension]), part=_parts(model, numbering),
        inertias=np.zeros(numbering.total), thin=np.zeros(numbering.total),
        magnitude=_magnitude(model, numbering),
        **port_arrays(numbering.histories, numbering.prescribed),
        links=with_entries(links, linked_entries), relaxed=np.zeros(1, dtype=np.int64),
        damped=np.array([int(any(b.body.damping is not None for b in model.bodies.values()))]))
    owners = [owner for batch in batches.all for owner in batch.owners]
    first_force = starts(b.width for b in batches.all for _ in b.rows).tolist()
    return system, numbering._replace(forces_at=dict(zip(owners, first_force, strict=False)))


def work_size(model: Mechanism) -> int:
    """Scratch memory the kernels of a model need."""
    rows = []
    for body in model.bodies.values():
        kernel = load(body.kernel)
        rows.append(scratch_size(kernel.WORK_ROWS, kernel.WORK_SQUARES, len(body.body.stiffness),
                                 len(body.rotations)))
    rows += [scratch_size(element_kernel(one.kind).WORK_ROWS, 0, len(one.body.body.stiffness),
                          len(one.body.rotations)) for one in model.loads if one.body is not None]
    elements = max((sum(t.start.size for t in one.triplets) for one in model.loads), default=0)
    return max([*rows, 64, 4 * elements])


def _batch_arrays(batches: Batches) -> dict[str, NDArray]:
    """The members of `System` that describe the batches."""
    found, integers = batches.all, np.array
    widths, sizes = [b.width for b in found], [len(b.rows) for b in found]
    return {"address": integers([b.kernel.kernel.address for b in found]),
            "count": integers(sizes), "stride": integers([len(b.rows[0]) for b in found]),
            "width": integers(widths),
            "at_index": starts(len(b.rows) * len(b.rows[0]) for b in found),
            "at_g": starts(s * w for s, w in zip(sizes, widths, strict=True)),
            "at_J": starts(s * w * w for s, w in zip(sizes, widths, strict=True)),
            "first_joint": integers([batches.first_joint]),
            "first_power": integers([batches.first_power]),
            "index": integers([i for b in found for row in b.rows for i in row]),
            "constants": batches.constants,
            "g_unknown": integers([u for b in found for row in b.unknowns for u in row])}


def _multipliers(model: Mechanism, numbering: Numbering) -> NDArray:
    """1.0 for every multiplier, and zeros behind the last coordinate."""
    found = np.zeros(numbering.total + LANES)
    for equation in model.constraints:
        first = numbering.multipliers[id(equation)]
        found[first:first + equation.multipliers] = 1.0
    return found


def _pulls(matrix: dict[str, NDArray], is_multiplier: NDArray, free: int) -> NDArray:
    """Entries in rows of coordinates and columns of multipliers."""
    moving, pulling = is_multiplier == 0.0, is_multiplier > 0.0
    moving[free:] = pulling[free:] = False
    return np.flatnonzero(moving[matrix["rows"]] & pulling[matrix["columns"]])


def _parts(model: Mechanism, numbering: Numbering) -> NDArray:
    """First coordinate of the position, rotation or equation each coordinate belongs to."""
    found = np.arange(numbering.total)
    for node in model.nodes.values():
        for triplet in (node.position, node.rotation):
            if triplet is not None and id(triplet) in numbering.triplets:
                own = stretch(numbering, triplet)
                found[own] = own.start
    for equation in model.constraints:
        first = numbering.multipliers[id(equation)]
        found[first:first + equation.multipliers] = first
    return found


def _rotation_starts(numbering: Numbering) -> NDArray:
    """First coordinate of every rotation matrix."""
    found = np.zeros(len(numbering.rotations), dtype=np.int64)
    for key, k in numbering.rotations.items():
        found[k] = numbering.triplets[key]
    return found


def _magnitude(model: Mechanism, numbering: Numbering) -> NDArray:
    """Magnitudes of coordinates: the model's extent for positions, one radian for rotations."""
    extent = np.abs([n.point for n in model.nodes.values()]).max()
    size = np.zeros(numbering.total)
    for node in model.nodes.values():
        for triplet, magnitude in ((node.position, extent), (node.rotation, 1.0)):
            if triplet is not None and id(triplet) in numbering.triplets:
                size[stretch(numbering, triplet)] = magnitude
    return size
