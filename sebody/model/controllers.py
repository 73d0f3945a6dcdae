"""Controllers of a model."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from types import FunctionType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs as given
from sebody.basics.errors import InputError
from sebody.basics.spelling import offered
from sebody.model.arguments import refuse_taken
from sebody.model.continuous import law_element
from sebody.model.control.law import Law
from sebody.model.control_order import actuators, order
from sebody.model.control_parts import MOST_DELAY, Controller
from sebody.model.functions import (
    CONTROL,
    LAW,
    compiled_controller,
    compiled_derivatives,
    compiled_law,
)
from sebody.model.mechanism import Mechanism
from sebody.model.sensors import check_new


def controller(model: Mechanism, name: str, law: Law | Callable[..., None],
               inputs: Iterable[str], outputs: Iterable[str], period: float | None = None,
               delay: float = 0, states: ArrayLike = (), parameters: ArrayLike = (),
               derivatives: Callable[..., None] | None = None, corners: Sequence[float] = ()
               ) -> Controller:
    """Set actuators by a function of what sensors measure: at every sample, or continuously.

    A continuous controller, one without a period, is part of the equations of motion: its outputs
    belong to the same instant as the motion, and its states are integrated with it. So
    `state_space`, `modes` and `linearize` see the closed loop.

    Parameters
    ----------
    name : str
    law : Law or callable
        A ready law of `sebody.control`, or a function that Numba compiles. With a period
        ``controller(t, y, x, u, parameters)``: y are the inputs, x its states, which it changes, u
        the outputs, which it sets; those it does not set stay as they are. Without one
        ``law(t, y, x, rates, u, parameters)``: it sets the rates of the states and u; those it
        does not set are zero.
    inputs : iterable of str
        Names of sensors, of quantities, of other controllers' signals, and of actuators, whose
        last value is meant. A quantity of one number need not have a sensor.
    outputs : iterable of str
        Names of actuators. A name that no actuator has is a signal, for other controllers.
    period : float, optional
        Time between two samples [time]; the first is at the start. Fixed steps divide it. Without
        one the controller is continuous.
    delay : float
        Samples after which outputs act, also parts of one, such as 0.3 for the time that a
        controller computes; until then the actuators' start values do.
    states : (n,) array_like
        States at the start; of a ready law its own by default.
    parameters : (m,) array_like
        Numbers the function is given.
    derivatives : callable, optional
        Of a continuous controller, ``derivatives(t, y, x, D, parameters)``, which sets those of
        the rates, then u, by y, then x: D is (states + outputs, inputs + states). By default they
        are central differences.
    corners : sequence of float
        Times at which a continuous law jumps [time]: steps end there.

    Raises
    ------
    InputError
        A function that Numba cannot compile, an actuator that another controller sets, signals
        that depend on each other within a sample, or an input that a continuous controller cannot
        read.
    """
    where = f"controller {given.name(name, 'name of a controller')!r}"
    check_new(model, name, where)
    ins = _names(inputs, f"inputs of {where}", least=0)
    outs = _names(outputs, f"outputs of {where}", least=1)
    delay = given.number(delay, f"{where}: delay", least=0, below=MOST_DELAY)
    states = given.vector(states, f"{where}: states")
    parameters = given.vector(parameters, f"{where}: parameters")
    if period is None:
        return _continuous(model, name, law, ins, outs, delay, states, parameters, derivatives,
                           corners)
    period = given.number(period, f"{where}: period", above=0.0)
    if derivatives is not None or np.size(corners):
        what = "corners" if derivatives is None else "derivatives"
        raise InputError(f"{where} has a period and {what}, which are of continuous controllers: "
                         "leave out one of the two")
    if isinstance(law, Law):
        _check_law(where, law, ins, outs, parameters)
        function, parameters = law.function, law.packed(period)
        states = _own_states(where, states, law.states)
    else:
        function = law
    _check_written(model, name, where, outs)
    compiled = compiled_controller(function, name, (len(ins), len(states), len(outs),
                                                    len(parameters)))
    made = Controller(name, compiled, ins, outs, period, delay, states, parameters,
                      law.refuse if isinstance(law, Law) else None)
    model.controllers[name] = made
    try:
        order(model)
    except InputError:
        del model.controllers[name]
        raise
    return made


def _continuous(model: Mechanism, name: str, law: Law | Callable[..., None], ins: tuple[str, ...],
                outs: tuple[str, ...], delay: float, states: NDArray, parameters: NDArray,
                derivatives: Callable[..., None] | None, corners: Sequence[float]) -> Controller:
    """A controller without a period."""
    where = f"controller {name!r}"
    if delay:
        raise InputError(f"{where} has a delay of {delay:g} samples and no period: give period=, "
                         "or write the delay as states of the law")
    if isinstance(law, Law):
        _check_law(where, law, ins, outs, parameters)
        if law.flow is None:
            raise InputError(f"{where}: {law.title} is a law in discrete time: give period=")
        function, start, parameters, own, at_rest = law.flow
        at_rest = None if states.size else at_rest
        states, derivatives = _own_states(where, states, start), derivatives or own
    else:
        function, at_rest = law, None
    if isinstance(law, FunctionType) and law.__code__.co_argcount == len(CONTROL):
        raise InputError(f"{where} has no period, and its function is that of a sampled one, "
                         f"({', '.join(CONTROL)}): give period=, or for a continuous controller a "
                         f"function of ({', '.join(LAW)})")
    _check_written(model, name, where, outs)
    sizes = len(ins), len(states), len(outs), len(parameters)
    compiled = compiled_law(function, name, sizes)
    by = None if derivatives is None else compiled_derivatives(derivatives, name, sizes)
    made = Controller(name, compiled, ins, outs, 0.0, 0, states, parameters,
                      law.refuse if isinstance(law, Law) else None, at_rest)
    model.loads.append(law_element(model, made, by, corners))
    model.controllers[name] = made
    return made


def _check_law(where: str, law: Law, ins: tuple[str, ...], outs: tuple[str, ...],
               parameters: NDArray) -> None:
    if parameters.size:
        raise InputError(f"{where} has parameters beside those of its law: leave them out")
    law.check(where, len(ins), len(outs))


def _own_states(where: str, states: NDArray, own: NDArray) -> NDArray:
    """States that were given, else those of the law."""
    if states.size and states.size != own.size:
        raise InputError(f"{where} is given {states.size} states, and its law has {own.size}")
    return states if states.size else own


def _check_written(model: Mechanism, name: str, where: str, outs: tuple[str, ...]) -> None:
    """Refuse outputs that something else sets, or that are no inputs."""
    for one in model.controllers.values():
        if both := [out for out in outs if out in one.outputs]:
            raise InputError(f"{where} sets {both[0]!r}, which controller {one.name!r} sets: let "
                             "one controller set it, or add up signals in another one")
    known = actuators(model)
    loads = {load.name for load in model.loads if load.law is None} - known.keys()
    for out in outs:
        if out in loads:
            raise InputError(f"{where}: {out!r} is a load with an amplitude of its own; make it "
                             "an actuator, " + offered(out, known, "there are", "there are none"))
        if out in model.sensors:
            raise InputError(f"{where}: output {out!r} is a sensor: name an actuator, or a signal")
        if out not in known:
            refuse_taken(model, out, f"{where}: a signal", ("signal",))


def _names(wanted: Iterable[str], what: str, least: int) -> tuple[str, ...]:
    names = [wanted] if isinstance(wanted, str) else given.items(wanted, what,
                                                                "give a list of names")
    for one in names:
        given.name(one, what)
    if len(names) < least or len(set(names)) < len(names):
        raise given.refusal(what, wanted, "name each once" if names else "name at least one")
    return tuple(names)
