"""Winches that actuators or drives move, at the first place of a rope."""

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import unknown
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Attachment
from sebody.model.rope_parts import Rope
from sebody.model.time_functions import TimeFunction


def motion_of_drive(model: Mechanism, what: str, name: str) -> TimeFunction:
    """Motion of a drive along a way, which a winch follows.

    Raises
    ------
    InputError
        No such drive, or one of an angle.
    """
    drives = {one.name: one for one in model.joints if one.kind == "drive"}
    if name not in drives:
        raise unknown("drive", name, drives, f"{what}: the model has", f"{what}: the model has no "
                      "drives; an actuator winds a rope by actuator(..., rope=)")
    equation = drives[name].constraints[0]
    if "slide" not in equation.kind:
        raise InputError(f"{what}: drive {name!r} turns: lead the rope onto a drum that it turns, "
                         "or give one along a way")
    assert equation.time_function is not None
    return equation.time_function


def wound_end(model: Mechanism, where: str, rope: Rope | str) -> Attachment:
    """The unknown of what a winch at the first place of a rope has given, let free for a motor.

    Raises
    ------
    InputError
        No such rope, one that begins on a drum or has a winch.
    """
    if isinstance(rope, str) and rope not in model.ropes:
        raise unknown("rope", rope, model.ropes, f"{where}: the model has",
                      f"{where}: the model has none")
    found = model.ropes[rope] if isinstance(rope, str) else inputs.instance(
        rope, f"{where}: rope", Rope, "give a rope or its name")
    if model.ropes.get(found.name) is not found:
        raise InputError(f"{where}: rope {found.name!r} is of another model: use that of this one")
    if found.places[0].sheave is not None:
        raise InputError(f"{where}: rope {found.name!r} begins on a drum: give the joint that it "
                         "turns in, joint=")
    if found.winch is not None:
        raise InputError(f"{where}: rope {found.name!r} has a winch already: leave one of both out")
    return _freed(model, found)


def _freed(model: Mechanism, rope: Rope) -> Attachment:
    first = rope.stretches[0]
    place = first.law.attachments[1]
    place.dof_block.fixed = False
    first.law.constants = {**first.law.constants, "given_a": 1.0}
    for one in rope.frictions:
        if one.dof_blocks[2] is first.length:       # the stretch is that before the sheave
            one.constants = {**one.constants, "given_1": 1.0}
    model.ropes[rope.name] = rope._replace(winch=place.dof_block)
    return place

