"""From a model to the flat arrays that the compiled loop runs on."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.axes import frames
from sebody.assembly.batches import Batches, make_batches, starts
from sebody.assembly.close_rows import Grid, given_to_steps, series_given_to_steps
from sebody.assembly.contracts import check_joints
from sebody.assembly.control import control_arrays
from sebody.assembly.equal_bodies import room_of
from sebody.assembly.grounded import check_grounded
from sebody.assembly.independent_parts import FEWEST
from sebody.assembly.law_inputs import dependences
from sebody.assembly.links import Ends, link_ends
from sebody.assembly.numbering import number
from sebody.assembly.ports import port_arrays, series_arrays
from sebody.assembly.structure import Structure, indices
from sebody.basics.errors import InputError
from sebody.contract.counts import LANES, scratch_size
from sebody.contract.law_row import scratch
from sebody.contract.layout import AT_CONSTANTS
from sebody.engine.links import Links
from sebody.engine.mailbox import Shared
from sebody.engine.system import System
from sebody.kernels.loader import element_kernel, load
from sebody.model.extent import extent
from sebody.model.hinges import check_axes
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering, stretch
from sebody.model.parts import Element
from sebody.model.switching import refuse_switches

DENSE_LIMIT = 24        # unknowns above which elimination by blocks is faster than an inverse


def build(model: Mechanism, threads: int = 1, grid: Grid | None = None
          ) -> tuple[System, Numbering]:
    """Flat arrays of a model; of a large one also what some threads need to share its steps.

    Loads are as they were given, or with a `grid` as its steps are given them.

    Raises
    ------
    InputError
        No bodies, a node that is not connected to anything, or an element that does not fit its
        kernel.
    """
    if not (model.bodies or model.rigid_bodies):
        raise InputError("the model has no body: add one with model.superelement(...) or "
                         "model.rigid_body(...)")
    refuse_switches(model)
    check_joints(model)
    check_grounded(model)
    numbering = number(model)
    if numbering.free == sum(equation.multipliers for equation in model.constraints):
        raise InputError("every node of the model is fixed: nothing is left to move, free one")
    batches = make_batches(model, numbering)
    check_axes(model)       # of elements whose constants are known to fit
    ends, vectors = link_ends(model, numbering)
    own = indices(_structure(model, numbering, batches, ends))
    time_functions, jumps = given_to_steps(numbering, grid)
    series = series_given_to_steps(numbering, grid)
    ports = port_arrays(time_functions, numbering, jumps, series.values())
    slots = own.system["slot_unknowns"].size
    owners = [owner for batch in batches.all for owner in batch.owners]
    first_force = starts(b.width for b in batches.all for _ in b.rows).tolist()
    rows = [row[AT_CONSTANTS] for batch in batches.all for row in batch.rows]
    numbering = numbering._replace(
        forces_at=dict(zip(owners, first_force, strict=False)),
        constants_at=dict(zip(owners, rows, strict=True)), bristles={})
    alone = numbering.free < FEWEST or reads_tangents(model)
    system = System(
        shared=Shared.of(1 if alone else threads, work_size(model),
                         LANES * slots, int(own.system["width"].max()) ** 2),
        **own.system, **ports, **series_arrays(numbering.series, numbering.ports, series),
        links=Links(arm_vectors=vectors, **own.links),
        control=control_arrays(model, numbering, ports["table_at"]),
        address=np.array([batch.kernel.kernel.address for batch in batches.all]),
        index=np.array([i for batch in batches.all for row in batch.rows for i in row]),
        constants=batches.constants, rotation_at=_rotation_starts(numbering),
        aid=np.zeros(2, dtype=np.int64), routines=np.zeros(4, dtype=np.int64),
        dimension=np.array([model.dimension]), part=_parts(model, numbering),
        inertias=np.zeros(numbering.total), massless_axes=np.zeros(numbering.total),
        magnitude=_magnitude(model, numbering),
        regularized=np.zeros(1, dtype=np.int64), massless=np.zeros(1, dtype=np.int64),
        body_stiffness=_diagonals(b.reduced.stiffness for b in model.bodies.values()),
        body_mass=_diagonals(b.reduced.mass for b in model.bodies.values()),
        damped=np.array([int(any(b.reduced.damping is not None for b in model.bodies.values()))]),
        guarded=_guarded(model, numbering))
    return system, numbering


def reads_tangents(model: Mechanism) -> bool:
    """Tell whether elements read what others have just found, and so wait for these."""
    return any(load.seen is not None for load in model.loads)


def _structure(model: Mechanism, numbering: Numbering, batches: Batches, ends: Ends) -> Structure:
    """Key of the index arrays of a model."""
    return Structure(
        numbering.free, numbering.total, numbering.free <= DENSE_LIMIT,
        tuple(numbering.groups.tolist()),
        tuple([(numbering.multipliers[c], c.multipliers) for c in model.constraints]),
        any(len(c.dof_blocks) > 1 for c in model.constraints),
        tuple(frames(model, numbering).items()), ends,
        tuple([batch.shape for batch in batches.all]), batches.first_joint, batches.first_power)


def work_size(model: Mechanism) -> int:
    """Scratch memory the kernels of a model need."""
    rows = []
    for body in model.bodies.values():
        kernel = load(body.kernel)
        rows.append(scratch_size(kernel.WORK_ROWS, kernel.WORK_SQUARES, len(body.reduced.stiffness),
                                 len(body.rotations)))
    rows += [scratch_size(element_kernel(one.kind).WORK_ROWS, 0, len(one.body.reduced.stiffness),
                          len(one.body.rotations)) for one in model.loads if one.body is not None]
    rows += [scratch_size(element_kernel(one.kind).WORK_ROWS, 0,
                          one.width, len(one.point.body.rotations))
             for one in model.loads if one.point is not None]
    rows += [scratch_size(element_kernel(one.kind).WORK_ROWS, 0, one.width,
                          max(sum(place.kind == "rotation" for place in one.attachments), 1))
             for one in (*model.constraints, *model.loads) if one.path is not None]
    elements = max((sum(t.start.size for t in one.dof_blocks) for one in model.loads), default=0)
    laws = dependences(model, [one for one in model.loads if one.law is not None])
    rows += [_law_scratch(model, law, depends.numbers) for law, depends in laws.items()]
    return max([*rows, 64, 4 * elements, room_of(model)])


def _law_scratch(model: Mechanism, element: Element, numbers: int) -> int:
    """Scratch memory of a continuous controller with a tape of so many numbers."""
    controller = model.controllers[element.law.controller]
    width = sum(t.start.size for t in element.dof_blocks) + len(element.law.modes)
    return scratch(len(controller.inputs), controller.states.size, len(controller.outputs), width,
                   width, numbers)


def _diagonals(matrices: Iterable[NDArray]) -> NDArray:
    """Diagonals of some matrices, one after the other."""
    return np.concatenate([np.zeros(0), *map(np.diag, matrices)])


def _parts(model: Mechanism, numbering: Numbering) -> NDArray:
    """First coordinate of the position, rotation or equation each coordinate belongs to."""
    firsts = np.arange(numbering.total)
    for node in model.nodes.values():
        for dof_block in (node.position, node.rotation):
            if dof_block is not None and dof_block in numbering.dof_blocks:
                own = stretch(numbering, dof_block)
                firsts[own] = own.start
    for equation in model.constraints:      # those that share multipliers have none of their own
        first = numbering.multipliers[equation]
        firsts[first:first + equation.multipliers] = first
    return firsts


def _guarded(model: Mechanism, numbering: Numbering) -> NDArray:
    """Places of the rates that contacts keep."""
    kept = ((element_kernel(e.kind).MEMORY, numbering.memories.get(e)) for e in model.loads)
    return np.array([own[names.index("rate")] for names, own in kept if "rate" in names],
                    dtype=np.int64)


def _rotation_starts(numbering: Numbering) -> NDArray:
    """First coordinate of every rotation matrix."""
    starts = np.zeros(len(numbering.rotations), dtype=np.int64)
    for key, k in numbering.rotations.items():
        starts[k] = numbering.dof_blocks[key]
    return starts


def _magnitude(model: Mechanism, numbering: Numbering) -> NDArray:
    """Magnitudes: the characteristic length for positions, one radian for rotations."""
    length = extent(model)
    size = np.zeros(numbering.total)
    for node in model.nodes.values():
        for dof_block, magnitude in ((node.position, length), (node.rotation, 1.0)):
            if dof_block is not None and dof_block in numbering.dof_blocks:
                size[stretch(numbering, dof_block)] = magnitude
    for way in model.ways():
        size[stretch(numbering, way)] = length
    return size
