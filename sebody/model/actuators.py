"""Actuators of a model: forces and torques whose amplitude is an input of a run."""

from __future__ import annotations

from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import unknown
from sebody.model.acting import Acting
from sebody.model.arguments import chosen_name, dof_block, known, rotation_vector, vector
from sebody.model.histories import input_history
from sebody.model.mechanism import Mechanism
from sebody.model.pairs import pair
from sebody.model.parts import SLIDES, TURNS, Attachment, Element, Joint, Node, positions, rotations
from sebody.model.rope_parts import Rope
from sebody.model.time_functions import TimeFunction
from sebody.model.winches import wound_end

WAYS = "give joint= the name of one, between= two nodes, rope=, or node= and direction="


def actuator(model: Mechanism, name: str, joint: str | Joint | None = None,
             between: tuple[Node | str, Node | str] | None = None, node: Node | str | None = None,
             direction: ArrayLike | None = None, what: str | None = None,
             limit: float | tuple[float, float] | None = None, rate: float | None = None,
             lag: float = 0.0, inertia: float = 0.0, ratio: float = 1.0,
             start: float = 0.0, rope: Rope | str | None = None,
             **acting: Unpack[Acting]) -> Element:
    """Force or torque that a controller sets, or `Simulation.set_input`.

    It acts along the motion of a joint, on `node` of the joint and opposite on the other one; along
    the line between two nodes, which it pushes apart; on a node, along a direction of space; or at
    the first place of a rope, as a winch that pulls it in.

    Parameters
    ----------
    name : str
        Name of the actuator and of the input.
    joint : str or Joint, optional
        A revolute, prismatic or cylindrical joint, a slider, or a joint on a path.
    between : two nodes, optional
    node : Node or str, optional
    direction : (3,), planar (2,), optional
        With `node`: that of the force. For a torque its axis, in a plane a number.
    what : {'force', 'torque'}, optional
        Which of the two acts on a node, by default a force, or in a cylindrical joint.
    limit : float or two floats, optional
        Largest size of the input, or its least and largest value: what is set beyond is cut off.
    rate : float, optional
        Largest rate of the input [input/time].
    lag : float
        Time constant with which the force follows what is set [time].
    inertia : float
        Moment of inertia of the motor's rotor [mass length^2], which turns with the ratio. At rest
        in its body it is part of this body's inertia.
    ratio : float
        Of a gear, or angle of the motor by displacement: the input is the motor's torque, and
        `ratio` times as much acts.
    start : float
        Value until something is set [force] or [force length].
    rope : Rope or str, optional
        Whose first place is a node, where the winch is; it needs `inertia`, that of its motor and
        drum with `ratio` one over the radius of the drum: the input is the torque on the drum then.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`. What does
        not act has no force; its signal and rotor stay.

    Raises
    ------
    InputError
        A joint that does not move along or about one axis, or numbers that make no sense.
    """
    where = f"actuator {inputs.name(name, 'name of an actuator')!r}"
    if sum(one is not None for one in (joint, between, node, rope)) != 1:
        raise InputError(f"{where} acts on nothing, or on several things: {WAYS}")
    ratio = inputs.number(ratio, f"{where}: ratio")
    if ratio == 0.0:
        raise inputs.refusal(f"{where}: ratio", ratio, "give one that is not zero")
    inertia = inputs.number(inertia, f"{where}: inertia", least=0.0)
    time_function = _history(where, limit, rate, lag, start)
    if node is not None:
        if inertia:
            raise InputError(f"{where} acts on a node from outside, which no rotor turns with: "
                             "add a rigid body, or give a joint")
        return _added(model, _on_node(model, name, where, node, direction, what, ratio,
                                      time_function))
    if direction is not None:
        raise InputError(f"{where}: a direction goes with node= alone; a joint has an axis")
    if rope is not None:
        return _of_rope(model, where, name, rope, inertia, ratio, time_function)
    way, attachments, constants = (
        _of_joint(model, where, joint, what) if joint is not None else
        _between(model, where, between, what))
    made = _added(model, Element(chosen_name(model, name, "actuator", ("signal",)),
                                 model.kind_of(f"{way}_motor"), attachments,
                                 {"gain": ratio, **constants}, time_function=time_function))
    if inertia:
        model.loads.append(Element(
            chosen_name(model, None,
                        f"rotor of {name}"), model.kind_of(f"{way}_rotor"), attachments,
            {"inertia": inertia, "ratio": ratio, **constants}))
    return made


def _of_rope(model: Mechanism, where: str, name: str, rope: Rope | str, inertia: float,
             ratio: float, time_function: TimeFunction) -> Element:
    """A winch, whose unknown is what it has given of the rope."""
    if not inertia:
        raise InputError(f"{where}: its winch needs inertia=, that of motor and drum: what a rope "
                         "pulls without mass has no acceleration")
    called = chosen_name(model, name, "actuator", ("signal",))
    place = wound_end(model, where, rope)
    made = _added(model, Element(called, "way_motor", (place,), {"gain": -ratio},
                                 time_function=time_function))
    model.loads.append(Element(chosen_name(model, None, f"rotor of {name}"), "way_rotor", (place,),
                               {"inertia": inertia, "ratio": ratio}, hidden=place.dof_block))
    return made


def _history(where: str, limit: float | tuple[float, float] | None, rate: float | None,
             lag: float, start: float) -> TimeFunction:
    least, most = -np.inf, np.inf
    if limit is not None and np.ndim(limit) == 0:
        most = inputs.number(limit, f"{where}: limit", above=0.0)
        least = -most
    elif limit is not None:
        least, most = inputs.vector(limit, f"{where}: limit", 2,
                                    remedy="give one number above zero, or the least and the "
                                    "largest value").tolist()
        if not least < most:
            raise inputs.refusal(f"{where}: limit", limit, "give the smaller number first")
    start = inputs.number(start, f"{where}: start")
    if not least <= start <= most:
        raise inputs.refusal(f"{where}: start", start, f"give one from {least:g} to {most:g}")
    fastest = 0.0 if rate is None else inputs.number(rate, f"{where}: rate", above=0.0)
    return input_history(start, inputs.number(lag, f"{where}: lag", least=0.0), fastest,
                         () if limit is None else (least, most))


def _of_joint(model: Mechanism, where: str, joint: str | Joint, what: str | None
              ) -> tuple[str, tuple[Attachment, ...], dict[str, float | NDArray]]:
    """Way, places and constants of an actuator in a joint."""
    names = {one.name: one for one in model.joints}
    if isinstance(joint, str) and joint not in names:
        raise unknown("joint", joint, names, "the model has", "the model has none")
    pair = names[joint] if isinstance(joint, str) else inputs.instance(
        joint, f"{where}: joint", Joint, "give a joint or its name")
    kinds = ["torque"] * (pair.kind in TURNS) + ["force"] * (pair.kind in (*SLIDES, "path"))
    if not kinds:
        raise InputError(f"{where}: {pair.name!r} is a {pair.kind}, in which nothing moves along "
                         f"or about one axis: {WAYS}")
    if what is None and len(kinds) > 1:
        raise InputError(f"{where}: {pair.name!r} slides and turns: give what='force' or 'torque'")
    chosen = inputs.choice(what or kinds[0], f"{where}: what", kinds)
    if chosen == "torque":
        return "turn", rotations(pair.node, pair.to), {} if model.planar else {"e": pair.axis}
    if pair.kind == "path":
        return "way", pair.constraints[0].attachments[-1:], {}
    return "slide", pair.way.attachments, {"e": pair.way.direction}


def _between(model: Mechanism, where: str, between: object,
             what: str | None
             ) -> tuple[str, tuple[Attachment, ...], dict[str, float | NDArray]]:
    if isinstance(between, str) or len(ends := inputs.items(
            between, f"{where}: between", "give two nodes")) != 2 or what == "torque":
        raise InputError(f"{where}: between is {inputs.shown(between)}: give two nodes, which a "
                         "force pushes apart")
    a, b = pair(model, known(model, ends[0]), known(model, ends[1]), where, ("position",))
    if not np.linalg.norm(b.point - a.point) > 0:
        raise InputError(f"{where}: nodes {a.name!r} and {b.name!r} coincide, so it has no "
                         "direction")
    return "line", positions(a, b), {}


def _on_node(model: Mechanism, name: str, where: str, node: Node | str,
             direction: ArrayLike | None, what: str | None, ratio: float,
             time_function: TimeFunction) -> Element:
    node = known(model, node)
    chosen = inputs.choice(what or "force", f"{where}: what", ("force", "torque"))
    if direction is None:
        raise InputError(f"{where} has no direction: give direction=")
    if chosen == "force":
        dof_block(node, "position")
        constants, attachments = {"d": vector(model, direction, where)}, positions(node)
    else:
        dof_block(node, "rotation")
        constants, attachments = {"d": rotation_vector(model, direction, where)}, rotations(node)
    constants["d"] = ratio * np.asarray(constants["d"])
    if not constants["d"].any():
        raise InputError(f"{where} has the direction {inputs.shown(direction)}, along which it "
                         "pushes nothing: give one that is not zero")
    return Element(chosen_name(model, name, "actuator", ("signal",)), model.kind_of(chosen),
                   attachments, constants,
                   time_function=time_function)


def _added(model: Mechanism, element: Element) -> Element:
    model.loads.append(element)
    return element
