"""Inputs of an exported model by name: actuators, loads, drives and parameters."""

from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple, cast

import numpy as np

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import unknown
from sebody.engine.actuator_inputs import VALUE
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.export.image import Image
from sebody.export.settings import Settings
from sebody.model.control_order import continuous
from sebody.model.histories import input_history
from sebody.model.model import Model
from sebody.model.numbering import Numbering
from sebody.model.parts import Element, Motion
from sebody.model.time_functions import TimeFunction
from sebody.model.variants.copying import copied
from sebody.parameters.changes import MOTION
from sebody.parameters.table import GRAVITY, handles, parameter
from sebody.quantities.names import AXES

INPUT, ACCELERATION, PARAMETER = range(3)       # kinds, as runtime.h counts them


class Input(NamedTuple):
    """An input, and where its value is."""

    name: str
    kind: int
    number: int         # of the input or parameter, or offset of the time at which an
                        # acceleration was set
    at: int             # offset of the value in the image
    factor: float       # by which the number there is multiplied
    start: float
    unit: str           # in words
    least: float        # bounds of what can be set
    most: float


class Asked(NamedTuple):
    """An input that was asked for, and what it is an input of."""

    name: str
    kind: int
    owner: Element | Motion | None


def with_inputs(model: Model, names: Iterable[str]) -> tuple[Model, list[Asked]]:
    """A copy of a model in which some loads and drives are inputs.

    Loads and actuators keep the value of t = 0 until they are set. Inputs of drives are their
    accelerations, constant until they are set again: a drive that jumps would need impulses.

    Raises
    ------
    InputError
        A name that nothing has, or of something that cannot be set.
    """
    made, asked = cast(Model, copied(model)), list[Asked]()
    loads = {load.name: load for load in made.loads if load.time_function is not None}
    joints = {drive.name: (joint.name, drive) for joint in made.joints
              for drive in joint.constraints if drive.time_function is not None}
    drives = {name: drive for name, drive in joints.values()} | {
        name: drive for name, (_, drive) in joints.items()}
    motions = {motion.name: (block, motion) for block in made.dof_blocks()
               for motion in block.motions}
    driven = {out: one.name for one in continuous(made) for out in one.outputs}
    for name in names:
        inputs.name(name, "name of an input")
        if name in driven:
            raise InputError(f"input {name!r} is what the continuous controller {driven[name]!r} "
                             "sets, so another value would have no effect: leave it or the "
                             "controller out")
        if any(name == one.name for one in asked):
            raise InputError(f"input {name!r} is given twice: leave one out")
        if name in loads:
            asked.append(Asked(name, INPUT, _as_input(loads[name])))
        elif name in drives:
            drives[name].time_function = _begun(name, drives[name].time_function)
            asked.append(Asked(name, ACCELERATION, drives[name]))
        elif name in motions:
            block, motion = motions[name]
            changed = motion._replace(time_function=_begun(name, motion.time_function))
            block.motions[block.motions.index(motion)] = changed
            asked.append(Asked(name, ACCELERATION, changed))
        elif "." in name or name == GRAVITY:
            asked += [Asked(one, PARAMETER, None) for one in _numbers(made, name)]
        else:
            raise unknown("input", name, [*loads, *drives, *motions, *handles(made)],
                          "the model has")
    return made, asked


def _as_input(load: Element) -> Element:
    own = load.time_function
    if load.function is not None or own is None or own.is_time:
        raise InputError(f"input {load.name!r} is a force by a function of positions and "
                         "velocities, which nothing can be set of: add an actuator")
    if not own.is_input:
        load.time_function = input_history(float(own.at(0.0)[0]), 0.0, 0.0, ())
    return load


def _begun(name: str, own: TimeFunction | None) -> TimeFunction:
    """A motion that goes on with the acceleration of t = 0."""
    assert own is not None
    value, rate, second = own.at(0.0)
    if own.functions and len(own.functions) < 3:
        raise InputError(f"input {name!r} is a drive by a function without rates: give the "
                         "function with its two rates")
    return replace(TimeFunction(), pieces=((float(value), float(rate), 0.5 * float(second), 0.0),))


def _numbers(model: Model, name: str) -> list[str]:
    """Names of the numbers of a parameter, which can be set while a model runs.

    Raises
    ------
    InputError
        A name that nothing has, whole bodies, or what runs begin with.
    """
    owner, handle, component = parameter(model, name)
    if handle.whole:
        raise InputError(f"input {name!r} has whole bodies for values: give stiffness or mass of "
                         "the body, or export a model for each body")
    if handle.touches == MOTION:
        raise InputError(f"input {name!r} is what runs begin with, or where a motion leads, which "
                         "cannot jump during a run: give start=, or the drive, whose acceleration "
                         "is set")
    if component is not None or handle.base.ndim == 0:
        return [name]
    return [f"{name}.{AXES[k] if owner == GRAVITY else k}" for k in range(handle.base.size)]


def placed(asked: list[Asked], numbering: Numbering, system: System, state: State, image: Image,
           set_by: Settings) -> list[Input]:
    """The places of the values of inputs."""
    places, ports = [], list(numbering.memory.inputs)
    for one in asked:
        least, most = -np.inf, np.inf
        if one.kind == INPUT:
            port = numbering.memory.ports[one.name]
            place = numbering.memory.inputs[port] + VALUE
            at, number, factor = image.at(state.frames, place), ports.index(port), 1.0
            start = float(state.frames[place])
        elif one.kind == ACCELERATION:
            assert one.owner is not None
            row = int(system.table_at[numbering.port_names.index(one.owner.name)])
            at = image.at(system.table_pieces, system.table_pieces.shape[1] * row + 2)
            number, factor = image.at(system.table_times, row), 2.0
            start = 2.0 * float(system.table_pieces[row, 2])
        else:
            number, factor = set_by.names.index(one.name), 1.0
            at, start = image.at(set_by.values.values, number), float(set_by.values.values[number])
            least, most = float(set_by.least[number]), float(set_by.most[number])
        places.append(Input(one.name, one.kind, number, at, factor, start, _unit(one), least,
                            most))
    return places


def _unit(one: Asked) -> str:
    if one.kind == PARAMETER:
        return "length/time^2" if one.name.startswith("gravity.") else ""
    turns = _kind(one.owner) == "rotation"
    if one.kind == INPUT:
        return "force length" if turns else "force"
    return "rad/time^2" if turns else "length/time^2"


def _kind(owner: Element | Motion | None) -> str:
    if isinstance(owner, Motion):
        return owner.place.kind
    assert owner is not None
    return "rotation" if "turn" in owner.kind else owner.attachments[0].kind
