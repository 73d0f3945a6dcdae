"""Changes of loads, springs, contacts, drives and laws of a model that is built."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.close_rows import Grid, close_corners
from sebody.basics.errors import InputError
from sebody.model.control_parts import Controller
from sebody.model.histories import time_function
from sebody.model.history_rows import rows_of
from sebody.model.impacts import LEAST, SLOW, damping_of, restitution_of
from sebody.model.model import Model
from sebody.model.parts import COUPLING, DofBlock, Element, Joint, Motion
from sebody.model.time_functions import TimeFunction
from sebody.parameters.changes import LOADS, MOTION, Handle, attribute_of, constants_of

# what can be varied of springs, and the constant of their kernels
OF_SPRINGS = {"stiffness": "k", "damping": "c", "cubic": "k3", "length": "length", "rest": "rest",
              "turning_stiffness": "kt", "turning_damping": "ct"}
SIGNED = {"rest"}       # of these, what may be negative
# what can be varied of contacts, stops, gears and friction: constants of their kernels, and those
# of them that may be negative
OF_CONTACTS = ("coefficient", "static", "radius", "preload", "bristle", "stiffness", "exponent",
               "lower", "upper", "ratio", "level", "size")
SIGNED_LIMITS = {"lower", "upper", "ratio", "level"}


def law_parameters(model: Model, controller: Controller, name: str) -> Handle:
    """Handle of the numbers of a controller's law; infinite ones, such as limits, stay."""
    numbers = np.array(controller.parameters, dtype=float)
    finite = np.isfinite(numbers)
    if not finite.any():
        raise InputError(f"{name}: the law of {controller.name!r} has no parameters")

    def assign(value: NDArray) -> None:
        changed = numbers.copy()
        changed[finite] = value
        model.controllers[controller.name] = replace(controller, parameters=changed)

    def put_back() -> None:
        model.controllers[controller.name] = controller
    return Handle(numbers[finite], assign, put_back, LOADS)


def load_amplitude(model: Model, load: Element, name: str) -> Handle:
    """Factor of a force, torque, mode force or load on a body."""
    if load.body is not None and load.time_function is not None:
        on_body = {c: np.array(load.constants[c], dtype=float) for c in ("P", "columns")
                   if c in load.constants}
        return constants_of(load, lambda factor: {c: factor * one for c, one in on_body.items()},
                            LOADS, np.array(1.0))
    direction = next((c for c in ("d", "factor") if c in load.constants), None)
    if direction is None or load.time_function is None:     # stops and friction have an axis d
        raise InputError(f"{name}: {load.name!r} is not a force or torque: it has no amplitude")
    before = np.array(load.constants[direction], dtype=float)
    return constants_of(load, lambda factor: {direction: factor * before}, LOADS, np.array(1.0))


def spring_constant(quantity: str) -> Callable[[Model, Element, str], Handle]:
    """Handle of a constant of springs and dampers."""
    constant = OF_SPRINGS[quantity]

    def make(model: Model, spring: Element, name: str) -> Handle:
        if constant not in spring.constants:
            raise InputError(f"{name}: {spring.name!r} has no {quantity}")
        bound = {} if quantity in SIGNED else {"least": 0.0}
        return constants_of(spring, lambda value: {constant: value}, LOADS,
                          np.array(spring.constants[constant], dtype=float), **bound)
    return make


def contact_constant(constant: str) -> Callable[[Model, Element, str], Handle]:
    """Handle of a constant of contacts and friction; break-away stays in proportion to sliding."""
    def make(model: Model, contact: Element, name: str) -> Handle:
        if constant not in contact.constants or not np.isfinite(contact.constants[constant]):
            raise InputError(f"{name}: {contact.name!r} has no {constant}")
        base = np.array(contact.constants[constant], dtype=float)
        bound = {} if constant in SIGNED_LIMITS else {"least": 0.0}
        if constant != "coefficient":
            return constants_of(contact, lambda value: {constant: value}, LOADS, base, **bound)
        more = float(contact.constants["static"]) / float(base) if base > 0 else 1.0
        return constants_of(contact, lambda value: {"coefficient": value, "static": more * value},
                          LOADS, base, **bound)
    return make


def restitution(model: Model, contact: Element, name: str) -> Handle:
    """Handle of the restitution of a contact, stop or gear, at the speed it was given for."""
    if "damping" not in contact.constants or "slow" not in contact.constants:
        raise InputError(f"{name}: {contact.name!r} has no restitution")
    v = contact.number("slow") / SLOW
    base = np.array(restitution_of(contact.number("damping"), v))
    return constants_of(contact, lambda e: {"damping": damping_of(float(e), v, name)}, LOADS, base,
                      least=LEAST, most=1.0)


def backlash(model: Model, gear: Element, name: str) -> Handle:
    """Handle of the play of a pair of gears."""
    if "ratio" not in gear.constants:
        raise InputError(f"{name}: {gear.name!r} is no gear")
    return constants_of(gear, lambda play: {"lower": -play / 2, "upper": play / 2}, LOADS,
                      np.array(2.0 * float(gear.constants["upper"])), least=0.0)


def coupling_ratio(model: Model, joint: Joint, name: str) -> Handle:
    """Handle of the ratio of a coupling: of its first coordinate to the second."""
    if joint.kind != COUPLING:
        raise InputError(f"{name}: {joint.name!r} is a {joint.kind}, which has no ratio")
    equation = joint.constraints[0]
    return constants_of(equation, lambda value: {"ratio": value}, MOTION,
                        np.array(equation.number("ratio")))


def load_table(model: Model, load: Element, name: str) -> Handle:
    """Values of a load's table, at its times."""
    if load.time_function is None:
        raise InputError(f"{name}: {load.name!r} has no time function")
    return _table(load, name, LOADS)


def _table(element: Element, name: str, touches: str) -> Handle:
    before = element.time_function
    rows = None if before.functions or before.waves else rows_of(before.times, before.pieces)
    if rows is None or len(rows) < 2:
        raise InputError(f"{name}: the time function of {element.name!r} is not a table of values: "
                         "vary the amplitude instead")

    def made(values: NDArray) -> TimeFunction:
        return time_function(np.column_stack([rows[:, 0], values]))

    def as_built(values: NDArray, grid: Grid | None) -> None:
        if grid is not None and not np.array_equal(
                close_corners(before, grid),
                close_corners(replace(before, corners=before.times), grid)):
            raise InputError(f"{name}: rows closer than steps may bend which do not as built")
        element.time_function = replace(made(values), corners=before.corners)
    return replace(attribute_of(element, "time_function", touches, rows[:, 1], made),
                   as_built=as_built)


def drive_amplitude(model: Model, drive: Joint | tuple[DofBlock, Motion], name: str) -> Handle:
    """Factor of a prescribed motion."""
    motion = drive if isinstance(drive, Joint) else drive[1]
    before = motion.time_function
    if before.functions:
        raise InputError(f"{name}: the motion of {motion.name!r} is a function of time: give a "
                         "table or a ready profile to vary its amplitude")

    def made(factor: NDArray) -> TimeFunction:
        f = float(factor)
        return replace(before, pieces=tuple(tuple(f * c for c in p) for p in before.pieces),
                       waves=tuple((f * A, w, p) for A, w, p in before.waves))
    if isinstance(drive, Joint):
        return attribute_of(drive.constraints[0], "time_function", MOTION, np.array(1.0), made)
    dof_block, motions = drive[0], list(drive[0].motions)

    def assign(value: NDArray) -> None:
        dof_block.motions = [motion._replace(time_function=made(value)) if m is motion else m
                           for m in dof_block.motions]

    def put_back() -> None:
        dof_block.motions = motions
    return Handle(np.array(1.0), assign, put_back, MOTION)
