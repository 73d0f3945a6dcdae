"""The state of another model: what has the same names is taken over.

A payload is dropped, a latch opens or a clutch locks where one model follows another: the second
one lacks a joint, or has one more, and starts at the end of the first.
"""

from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.contract.layout import INPUT_NUMBERS, RECORD
from sebody.model.extent import extent
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering, record_counts, stretch
from sebody.model.parts import DofBlock
from sebody.results.recording import Recording

APART = 1e-9        # of the extent: by which nodes of the same name may differ as they are built
REMEDY = "give the Result of a model with nodes and bodies of the same names, built in one place"


class Side(NamedTuple):
    """A model, its numbering, and a row of its states, or several."""

    model: Mechanism
    numbering: Numbering
    row: NDArray

    def part(self, name: str) -> NDArray:
        """A part of the row, to be read or written."""
        return self.row[..., RECORD.slices(record_counts(self.numbering))[name]]


def have_same_order(model: Mechanism, numbering: Numbering, given: Recording) -> bool:
    """Tell whether states of a model and of a result have the same numbers in the same places."""
    return _order(Side(model, numbering, given.rows[-1])) == _order(
        Side(given.model, given.numbering, given.rows[-1]))


def _order(side: Side) -> tuple[Any, ...]:
    """The owners of the numbers of a state, in their order."""
    numbering = side.numbering
    return (numbering.names, record_counts(numbering), list(side.model.bodies),
            [block.name for block in numbering.rotations], _places(side))


def taken_over(model: Mechanism, numbering: Numbering, start: NDArray,
               given: Recording) -> tuple[NDArray, tuple[str, ...]]:
    """A row of `layout.RECORD` with what a model has in common with that of a result.

    Nodes, modes and frames of bodies, numbers that joints, springs, contacts and controllers keep,
    and inputs and sensors are found by name; all others begin as the model is built.

    Parameters
    ----------
    start : (numbers of a state,)
        The row of the model as it is built.
    given : Recording
        The last state of which is taken.

    Returns
    -------
    tuple
        The row, and what could not be taken over, in words: what only one of the models has, and
        what has another form.

    Raises
    ------
    InputError
        A planar model and one in space, models that have no node in common, or nodes of the same
        name that are built in different places.
    """
    new = Side(model, numbering, start.copy())
    old = Side(given.model, given.numbering, given.rows[-1])
    if model.planar != old.model.planar:
        raise InputError("start is a state of another model, of which one is planar and one in "
                         f"space: {REMEDY}")
    if not model.nodes.keys() & old.model.nodes.keys():
        raise InputError(f"start is a state of another model, with no node in common: {REMEDY}")
    left = take_states(new, old)
    names = (_element_names(side.model) for side in (new, old))
    return new.row, (*left, *_alone("joint, load or rigid body", *names))


def take_states(new: Side, old: Side) -> list[str]:
    """Take over what has the same names, but for works and multipliers; what cannot be, in words.
    """
    return [*_nodes(new, old), *_ways(new, old), *_bodies(new, old), *_kept(new, old)]


def _element_names(model: Mechanism) -> list[str]:
    """Names of rigid bodies, joints, loads and springs, each once."""
    return list(dict.fromkeys([*model.rigid_bodies, *(joint.name for joint in model.joints),
                               *(load.name for load in model.loads)]))


def _nodes(new: Side, old: Side) -> Iterator[str]:
    """Take positions and rotations over."""
    near = APART * max(extent(new.model), 1e-300)
    for name, node in new.model.nodes.items():
        other = old.model.nodes.get(name)
        if other is None:
            continue
        if np.abs(node.point - other.point).max() > near:
            raise InputError(f"start is a state of another model, whose node {name!r} is built in "
                             f"another place, {_shown(other.point)} in place of "
                             f"{_shown(node.point)}: {REMEDY}")
        for kind in ("position", "rotation"):
            block, was = getattr(node, kind), getattr(other, kind)
            if block is None or block not in new.numbering.dof_blocks:
                continue
            if was is None or was not in old.numbering.dof_blocks:
                yield f"the {kind} of node {name} (not in the start)"
            else:
                _block(new, old, block, was)
    yield from _alone("node", new.model.nodes, old.model.nodes)


def _block(new: Side, old: Side, block: DofBlock, was: DofBlock) -> None:
    """Take coordinates, rates and the rotation matrix of a block over."""
    for name in ("q", "v", "a"):
        new.part(name)[..., stretch(new.numbering, block)] = old.part(name)[
            ..., stretch(old.numbering, was)]
    if block in new.numbering.rotations:
        at, before = 9 * new.numbering.rotations[block], 9 * old.numbering.rotations[was]
        new.part("R")[..., at:at + 9] = old.part("R")[..., before:before + 9]


def _ways(new: Side, old: Side) -> Iterator[str]:
    """Take ways of points on paths over."""
    own, others = ({way.name: way for way in side.model.ways()} for side in (new, old))
    for name, way in own.items():
        if name in others:
            _block(new, old, way, others[name])
    yield from _alone("", own, others)


def _bodies(new: Side, old: Side) -> Iterator[str]:
    """Take modes and frames of superelements over."""
    for number, (name, body) in enumerate(new.model.bodies.items()):
        other = old.model.bodies.get(name)
        if other is None:
            continue
        modes = body.reduced.modes
        if modes != other.reduced.modes:
            yield (f"{modes} modes of body {name} (the start has {other.reduced.modes})")
            continue
        at, before = new.numbering.modes[name], old.numbering.modes[name]
        for part in ("q", "v", "a"):
            new.part(part)[..., at:at + modes] = old.part(part)[..., before:before + modes]
        if (body.frame, len(body.nodes)) == (other.frame, len(other.nodes)):
            frame = 9 * list(old.model.bodies).index(name)
            new.part("frames")[..., 9 * number:9 * number + 9] = old.part("frames")[
                ..., frame:frame + 9]
    yield from _alone("body", new.model.bodies, old.model.bodies)


def _kept(new: Side, old: Side) -> Iterator[str]:
    """Take over what elements, inputs, sensors, signals and controllers keep."""
    own, others = (_places(side) for side in (new, old))
    for key, places in own.items():
        if key in others and len(others[key]) == len(places):
            new.part("frames")[..., places] = old.part("frames")[..., others[key]]
        elif key[0] != "element" or key in others:
            yield f"the state of {key[1]} (not in the start)"


def _places(side: Side) -> dict[tuple[str, ...], list[int]]:
    """Places in `State.frames` by what they belong to."""
    memory = side.numbering.memory
    found: dict[tuple[str, ...], list[int]] = {
        ("element", one.name, one.kind): list(places) for one, places in memory.memories.items()}
    for name, port in memory.ports.items():
        first = memory.inputs[port]
        found["input", name] = list(range(first, first + INPUT_NUMBERS))
    for name, place in memory.values.items():
        found.setdefault(("input", name), [place])
    for name, place in memory.states.items():
        count = len(side.model.controllers[name].states)
        found["controller", name] = list(range(place, place + count))
    return found


def _alone(what: str, own: Iterable[str], others: Iterable[str]) -> Iterator[str]:
    """Name what only one of two models has."""
    own, others = list(own), list(others)
    yield from (f"{what} {name} (not in the start)".strip() for name in own if name not in others)
    yield from (f"{what} {name} (of the start alone)".strip()
                for name in others if name not in own)


def _shown(point: NDArray) -> str:
    return "(" + ", ".join(f"{x:.6g}" for x in point) + ")"


def take_multipliers(new: Side, old: Side) -> None:
    """Take over the multipliers of constraints of the same names."""
    others = dict(named(old.model.constraints))
    for key, one in named(new.model.constraints):
        if key in others:
            at, before = (side.numbering.multipliers[c] for side, c in (
                (new, one), (old, others[key])))
            new.part("q")[..., at:at + one.multipliers] = old.part("q")[
                ..., before:before + one.multipliers]


def numbered(names: Iterable[str]) -> Iterator[tuple[tuple[str, int], int]]:
    """Names, each with how often it came before, and their places."""
    found: Counter[str] = Counter()
    for k, name in enumerate(names):
        yield (name, found[name]), k
        found[name] += 1


def named(elements: Iterable[Any]) -> Iterator[tuple[tuple[str, int], Any]]:
    """Elements by their names and by how many of the same name come before."""
    elements = list(elements)
    for key, k in numbered(one.name for one in elements):
        yield key, elements[k]
