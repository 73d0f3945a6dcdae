"""Users' functions in a run: whether they are what was compiled, and which of them had a fault.

A function has a fault where it raises, or gives what is not finite.
"""

from collections.abc import Iterator

import numpy as np

from sebody.basics.errors import InputError
from sebody.compiler.user_functions import UserFunction
from sebody.model.mechanism import Mechanism
from sebody.model.outside import changed


def functions(model: Mechanism) -> Iterator[tuple[str, UserFunction]]:
    """The compiled functions of a model, and what each of them is."""
    for element in (*model.constraints, *model.loads):
        if element.function is not None and element.law is None:
            yield f"user force {element.name!r}", element.function
        if element.time_function is not None:
            for function in element.time_function.functions:
                yield f"the function of {element.name!r}", function
    for name, controller in model.controllers.items():
        yield f"controller {name!r}", controller.function
    for element in model.loads:
        if element.law is not None and element.law.derivatives is not None:
            yield f"derivatives of controller {element.law.controller!r}", element.law.derivatives
    for dof_block in model.dof_blocks():
        for motion in dof_block.motions:
            for function in motion.time_function.functions:
                yield f"the function of {motion.name!r}", function


def refuse_changed(model: Mechanism) -> None:
    """Refuse a model of which a function reads a value that is not what it was compiled with.

    Raises
    ------
    InputError
        The message names the function, the value as it was and as it is, and the remedy.
    """
    for what, function in functions(model):
        if found := changed(function.read, function.function):
            raise InputError(f"{what} reads {found}: functions are compiled with the values they "
                             "read; make the load or drive again, or give each function its own "
                             "value by a default argument, as in lambda t, a=a: a * t")


def forget(model: Mechanism) -> None:
    """Forget faults of other runs."""
    for _, function in functions(model):
        function.forget()


def fault(model: Mechanism, since: float, until: float = np.inf) -> str:
    """The first function whose last fault was between two times, and what it did; empty if none.
    """
    for what, function in functions(model):
        if did := function.fault(since, until):
            return f"{what} {did}: correct it"
    return ""
