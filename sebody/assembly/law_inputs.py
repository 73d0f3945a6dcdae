"""Inputs of continuous controllers: tapes of quantities, and what these read of the motion."""

from collections import defaultdict
from collections.abc import Iterable
from itertools import accumulate
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.contract.read_numbers import OF_NOTHING, OF_Q, OF_R, OF_V
from sebody.model.control_order import actuators, signals
from sebody.model.control_parts import Controller
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import MemoryMap, Numbering
from sebody.model.parts import Attachment, Element
from sebody.quantities.expressions import Tape
from sebody.quantities.symbols import NoTape, Recorded

KINDS = {"q": OF_Q, "v": OF_V, "R": OF_R, "frames": OF_NOTHING}
MEASURED = ("position, velocity, rotation and angular velocity of nodes, modes of bodies and their "
            "rates, angles, rates, displacements and speeds of joints")


class Read(NamedTuple):
    """A number of the state that a tape reads."""

    kind: int           # as of `contract.read_numbers`, OF_NOTHING of one in the frames
    place: int          # in q, v, R or the frames
    number: int         # its place on the tape
    coordinate: int     # that it varies with, of a rotation matrix the first of the rotation


class LawInputs(NamedTuple):
    """Inputs of a continuous controller: ``scale output + bias`` of the outputs of a tape."""

    tape: Tape
    reads: list[Read]
    scales: NDArray     # (inputs, 2)


class Depends(NamedTuple):
    """Dependences of the inputs of a continuous controller, and the numbers of their tape."""

    places: list[Attachment]
    modes: tuple[tuple[str, int], ...]      # superelement and internal mode
    angles: int
    numbers: int


def law_inputs(model: Mechanism, numbering: Numbering, controller: Controller) -> LawInputs:
    """The inputs of a continuous controller.

    Raises
    ------
    InputError
        A quantity that nothing has, or that is more than motion.
    """
    of, scales = Recorded(model, numbering), []
    held = {numbering.memory.values[name] for name in _held(model)}
    for name in controller.inputs:
        sensor = model.sensors.get(name)
        if name in _held(model):
            of.tape.put(of.recorded("frames", numbering.memory.values[name]))
            scales.append((1.0, 0.0))
            continue
        quantity, axes = (name, "") if sensor is None else (sensor.quantity, sensor.axes)
        before = len(of.tape.outputs)
        try:
            shape = of.put(quantity, axes)
            reads = _reads(of, numbering, held, before)
        except InputError as error:
            raise InputError(f"controller {controller.name!r}: {error}") from error
        except (NoTape, LookupError):       # the latter of what has no number before all have one
            reads, shape = None, ()
        if reads is None:
            raise InputError(f"controller {controller.name!r} is continuous and cannot read "
                             f"{quantity!r}: it reads {MEASURED}, and what follows from these "
                             "alone; for anything else give a sensor with rate=, between whose "
                             "samples its value holds")
        if shape:
            raise InputError(f"controller {controller.name!r} reads {quantity!r}, which is several "
                             f"numbers: give one of them, such as {quantity}.x")
        scales.append((1.0, 0.0) if sensor is None else (sensor.gain, sensor.bias))
    found = _reads(of, numbering, held)
    assert found is not None        # as of every input
    return LawInputs(of.tape, found, np.array(scales, dtype=float).reshape(-1, 2))


def dependences(model: Mechanism, laws: Iterable[Element]) -> dict[Element, Depends]:
    """Dependences of the inputs of continuous controllers, before coordinates have numbers."""
    laws = list(laws)
    if not laws:
        return {}
    numbering = _provisional(model)
    blocks = {first + k: block for block, first in numbering.dof_blocks.items()
              for k in range(block.start.size)}
    places = {place.dof_block: place for node in model.nodes.values()
              for place in (Attachment(node, "position"), Attachment(node, "rotation"))
              if place.dof_block is not None}
    places |= {one.dof_blocks[-1]: one.attachments[-1] for one in model.constraints
               if one.path is not None}     # the way of a point
    modes = {first + k: (body, k) for body, first in numbering.modes.items()
             for k in range(model.bodies[body].reduced.modes)}
    found = {}
    for law in laws:
        assert law.law is not None
        inputs = law_inputs(model, numbering, model.controllers[law.law.controller])
        read = [one.coordinate for one in inputs.reads if one.kind != OF_NOTHING]
        found[law] = Depends(
            list(dict.fromkeys(places[blocks[x]] for x in read if x in blocks)),
            tuple(dict.fromkeys(modes[x] for x in read if x in modes)),
            len(inputs.tape.angles), inputs.tape.size)
    return found


def _held(model: Mechanism) -> dict[str, None]:
    """Names of numbers that hold between samples: inputs, signals, and sensors with a period."""
    return dict.fromkeys([*actuators(model), *signals(model),
                          *(name for name, one in model.sensors.items() if one.period)])


def _reads(of: Recorded, numbering: Numbering, held: set[int], before: int = 0
           ) -> list[Read] | None:
    """Numbers that outputs from one on read; None where these are more than motion."""
    turns = {k: numbering.dof_blocks[block] for block, k in numbering.rotations.items()}
    found = []
    for (_, place), number in of.tape.read_for(before):
        part = next(name for name, own in of.parts.items() if own.start <= place < own.stop)
        k = place - of.parts[part].start
        if part not in KINDS or part == "frames" and k not in held:
            return None
        found.append(Read(KINDS[part], k, number, turns[k // 9] if part == "R" else k))
    return found


def _provisional(model: Mechanism) -> Numbering:
    """Numbers of coordinates of all nodes and modes, in no special order."""
    blocks = [block for block in dict.fromkeys(
        block for node in model.nodes.values() for block in (node.position, node.rotation))
        if block is not None]
    blocks += model.ways()
    *firsts, end = accumulate((block.start.size for block in blocks), initial=0)
    bodies = list(model.bodies)
    *modes, total = accumulate((model.bodies[name].reduced.modes for name in bodies), initial=end)
    turned = [] if model.planar else [block for block in blocks if block.rotational]
    values = {name: k for k, name in enumerate(_held(model))}
    driven = {one.name: one.time_function for one in model.loads if one.time_function is not None}
    return Numbering(
        0, total, dict(zip(blocks, firsts, strict=True)),
        {block: k for k, block in enumerate(turned)}, dict(zip(bodies, modes, strict=True)), {},
        [], [], {}, list(driven), list(driven.values()), [], np.zeros(0), defaultdict(int),
        MemoryMap({}, {}, {}, [], values, {}, len(values)))
