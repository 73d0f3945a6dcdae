"""The state that a model is reduced in: its equilibrium, handed to the model that is free."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.basics.tabular import counted
from sebody.contract.layout import RECORD
from sebody.contract.names import IN_PLANE
from sebody.explore.assemblies.inside import OUTER, freed, refuse_outsiders, without_gravity
from sebody.explore.assemblies.wanted import Interfaces
from sebody.model.extent import extent
from sebody.model.model import Model
from sebody.model.numbering import record_counts, stretch
from sebody.model.parts import DofBlock
from sebody.results.result import Result
from sebody.runs.rotating_frame import Spin
from sebody.runs.simulation import Simulation
from sebody.runs.state_derivatives import rotating
from sebody.runs.statics import at_rest, equilibrium
from sebody.small_motion.linearization import Linearization, linearize

AT_REST = 1e-10     # way by which forces inside would move the model, over its size: none


class Given(NamedTuple):
    """A free model in the state that it is reduced in."""

    run: Simulation             # of the free model
    held: Result                # of the model as it was, in the same state
    linear: Linearization
    forces: NDArray             # on the coordinates of the linearization, in this state
    notes: tuple[str, ...]
    sought: bool                # whether it was sought, from the state as built


def given_state(run: Simulation | Result | Model, interfaces: Interfaces, preload: bool) -> Given:
    """The state about which a model is linearized, at rest.

    Of a model, that of its equilibrium under loads on its interfaces, or as built where nothing
    inside is under stress. Without supports the first interface is held meanwhile.

    Raises
    ------
    InputError
        What cannot be inside a superelement, or a state that moves.
    """
    model = run if isinstance(run, Model) else run.model
    refuse_outsiders(model, interfaces)
    if not isinstance(run, Model):
        held = run if isinstance(run, Result) else run.result()
        said = "the state reduced is that of the run"
    else:
        held, said = _of_model(run, interfaces, preload)
    free, left_out = freed(model, interfaces)
    moved = at_rest(free, 0.0)
    _take(moved, held, interfaces)
    forces = rotating(moved, Spin.of(free, None))[1]
    linear = linearize(moved)
    bodies = counted(len(model.bodies) + len(model.rigid_bodies), "body")
    notes = [f"reduced from a model of {bodies} and {len(model.joints)} joints; {said}"]
    notes += [f"left out: {', '.join(left_out)}"] * bool(left_out)
    return Given(moved, held, linear, linear.free.T @ forces, tuple(notes),
                 isinstance(run, Model))


def _of_model(model: Model, interfaces: Interfaces, preload: bool) -> tuple[Result, str]:
    bare = without_gravity(model)
    built = at_rest(bare, 0.0)
    if not preload or _rests(built):
        return built.result(), "the state reduced is that as built"
    if not any(block.fixed for block in interfaces.blocks(bare)):
        _hold(bare, interfaces)
    return equilibrium(bare), "the state reduced is its equilibrium without gravity"


def _rests(run: Simulation) -> bool:
    """Tell if nothing inside is under stress, nor loaded: its forces would move it by nothing."""
    if any(load.kind.removeprefix(IN_PLANE) in OUTER for load in run.model.loads):
        return False
    forces, linear = rotating(run, Spin.of(run.model, None))[1], linearize(run)
    forces = linear.free.T @ forces
    unit = np.sqrt(np.abs(np.diag(linear.stiffness)))
    unit[unit == 0.0] = 1.0
    moved = np.linalg.lstsq(linear.stiffness / np.outer(unit, unit), forces / unit, 1e-12)[0]
    return bool(np.abs(moved / unit).max(initial=0.0) <= AT_REST * max(extent(run.model), 1e-300))


def _hold(model: Model, interfaces: Interfaces) -> None:
    """Hold a free model at its first interface that can be held."""
    for name, keep in zip(*interfaces, strict=True):
        node = model.nodes[name]
        if keep == "full" and node.position is not None and node.position.root is None:
            model.fix(node)
            return
    raise InputError("the model is under stress or loaded, and free: for its equilibrium "
                     "fix an interface, or give one that keeps 'full'")


def _take(run: Simulation, held: Result, interfaces: Interfaces) -> None:
    """Put the last state of a result in that of the free model, without rates."""
    before, after, state = held.numbering, run.numbering, run.state
    row, parts = held.rows[-1], RECORD.slices(record_counts(before))
    q, R, v, frames = (row[parts[name]] for name in ("q", "R", "v", "frames"))
    if np.abs(v).max(initial=0.0) > 0.0:
        raise InputError("the state moves: a superelement is reduced about a state at rest. Give "
                         "the model, whose equilibrium is found, or that of an equilibrium")
    state.q[:], state.v[:], state.a[:] = 0.0, 0.0, 0.0
    for old, new in _blocks(held.model, run.model):
        if new not in after.dof_blocks or old not in before.dof_blocks:
            continue
        k = after.rotations.get(new)
        if k is None:
            state.q[stretch(after, new)] = q[stretch(before, old)]
        else:
            j = before.rotations[old]
            state.R[9 * k:9 * k + 9] = R[9 * j:9 * j + 9]
    for name, body in run.model.bodies.items():
        at, was = after.modes[name], before.modes[name]
        state.q[at:at + body.reduced.modes] = q[was:was + body.reduced.modes]
    state.frames[:9 * len(run.model.bodies)] = frames[:9 * len(run.model.bodies)]
    for old_joint, joint in _matched(held.model.joints, run.model.joints):
        for old_one, one in zip(old_joint.constraints, joint.constraints, strict=True):
            at, was = after.multipliers[one], before.multipliers[old_one]
            state.q[at:at + one.multipliers] = q[was:was + one.multipliers]
            if one in after.memories:
                state.frames[after.memories[one]] = frames[before.memories[old_one]]
    for old_load, load in _matched(held.model.loads, run.model.loads):
        if load in after.memories:
            state.frames[after.memories[load]] = frames[before.memories[old_load]]
    state.q_old[:], state.R_old[:], state.v_old[:] = state.q, state.R, state.v
    state.frames_old[:] = state.frames


def _matched(before: Sequence, after: Sequence) -> Iterator[tuple]:
    """Elements of a model that are left in a copy, with those of the copy, in their order."""
    rest = iter(before)
    for one in after:
        yield next(other for other in rest if (other.name, other.kind) == (one.name, one.kind)), one


def _blocks(before: Model, after: Model) -> Iterator[tuple[DofBlock, DofBlock]]:
    """DOF blocks of the same nodes of two models."""
    nodes = [*zip(before.nodes.values(), after.nodes.values(), strict=True),
             *zip(before.grounds, after.grounds, strict=True)]
    for one, other in nodes:
        for kind in ("position", "rotation"):
            if getattr(one, kind) is not None:
                yield getattr(one, kind), getattr(other, kind)
