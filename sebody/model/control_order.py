"""Controllers of a model, their kinds, and the order in which a sample calls them."""

from sebody.basics.errors import InputError
from sebody.basics.spelling import alike
from sebody.model.control_parts import Controller
from sebody.model.mechanism import Mechanism


def sampled(model: Mechanism) -> list[Controller]:
    """Controllers that are called at samples."""
    return [one for one in model.controllers.values() if one.period]


def continuous(model: Mechanism) -> list[Controller]:
    """Controllers in the equations of motion."""
    return [one for one in model.controllers.values() if not one.period]


def order(model: Mechanism) -> list[Controller]:
    """Controllers in the order in which they are called in a sample.

    One that gives another a signal comes first, unless the signal is delayed.

    Raises
    ------
    InputError
        Some wait for each other: an algebraic loop.
    """
    of = {signal: one for one in sampled(model) if not one.delay
          for signal in one.outputs}
    ordered: list[Controller] = []
    path: list[Controller] = []

    def visit(one: Controller) -> None:
        if one in ordered:
            return
        if one in path:
            names = [p.name for p in path[path.index(one):]] + [one.name]
            raise InputError(f"algebraic loop: controllers {' -> '.join(names)} wait for each "
                             "other's signals in the same sample; give one of them delay=1")
        path.append(one)
        for signal in one.inputs:
            if signal in of and not is_actuator(model, signal):
                visit(of[signal])
        path.pop()
        ordered.append(one)
    for one in sampled(model):
        visit(one)
    return ordered


def signals(model: Mechanism) -> list[str]:
    """Outputs of controllers that are no actuators."""
    return list(dict.fromkeys(name for one in model.controllers.values() for name in one.outputs
                              if not is_actuator(model, name)))


def misspelt(model: Mechanism) -> dict[str, str]:
    """Signals that nothing reads and whose names are like those of inputs that nothing sets.

    Such a name is a new signal, so that a misspelt one moves nothing. The message by the signal.
    """
    read = {name for one in model.controllers.values() for name in one.inputs}
    read |= {one.quantity.removesuffix(".value") for one in model.sensors.values()}
    written = {name for one in model.controllers.values() for name in one.outputs}
    unset = [name for name in actuators(model) if name not in written]
    remarks = {}
    for one in model.controllers.values():
        for name in one.outputs:
            near = alike(name, unset)
            if near and name not in read and not is_actuator(model, name):
                remarks[name] = (
                    f"controller {one.name!r} sets {name!r}, which no actuator is called and no "
                    f"controller reads: did you mean {' or '.join(map(repr, near))}? If it is a "
                    "signal to be recorded, give it a name that is less like an actuator's")
    return remarks


def actuators(model: Mechanism) -> dict[str, object]:
    """Loads that are inputs, by name."""
    return {load.name: load for load in model.loads
            if load.time_function is not None and load.time_function.is_input}


def is_actuator(model: Mechanism, name: str) -> bool:
    """Tell whether an actuator has this name."""
    return name in actuators(model)
