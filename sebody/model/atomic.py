"""Builders that change a model wholly or not at all."""

from collections.abc import Callable, Collection, Mapping
from copy import copy
from functools import wraps
from inspect import isfunction, signature
from typing import ParamSpec, TypeVar, cast

from sebody.basics.errors import InputError
from sebody.basics.spelling import refuse_arguments
from sebody.model.acting import ACTING
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element, Joint
from sebody.model.switching import note

Arguments = ParamSpec("Arguments")
Built = TypeVar("Built")
Class = TypeVar("Class", bound=type)

_INSTEAD = {     # of builders without equations: what has times
    "move": "give drive_slide or drive_angle, which have times, for the motion against the ground",
    "drive_way": "give the path_joint the times, or an actuator or a spring in place of the drive",
    "fix": "give weld(node) with its times, which holds the node at the ground"}


def atomic_builders(model: Class) -> Class:
    """A class whose methods that are functions of other modules are `atomic`.

    In its text they are these functions themselves, so that editors show their signatures.
    """
    for name, build in list(vars(model).items()):
        if isfunction(build) and build.__module__ != model.__module__:
            setattr(model, name, atomic(build))
    return model


def atomic(build: Callable[Arguments, Built]) -> Callable[Arguments, Built]:
    """A builder that leaves its model, the first argument, as it was where it raises.

    What it adds is taken out again; DOF blocks that exist are changed only when nothing more is
    checked.
    """
    own = signature(build).parameters.keys()

    @wraps(build)
    def built(*args: Arguments.args, **named: Arguments.kwargs) -> Built:
        model, *_ = args
        kept = {name: copy(value) for name, value in vars(model).items()
                if isinstance(value, dict | list | set)}
        try:
            made = build(*args, **named)
            if "acting" in own:
                when = {key: value for key, value in named.items() if key not in own}
                for one in made if isinstance(made, list | tuple) else (made,):
                    note(cast(Mechanism, model), cast(Element | Joint, one).name, when)
            return made
        except BaseException as error:
            vars(model).update(kept)
            if isinstance(error, TypeError):
                _refuse_times(build, named, own)
                refuse_arguments(build, named, 1, ACTING if "acting" in own else ())
            raise
    return built


def _refuse_times(build: Callable, named: Mapping[str, object], own: Collection[str]) -> None:
    """Refuse times of what is held without an equation, and so cannot let go."""
    times = [name for name in named if name in ACTING]
    if times and "acting" not in own and build.__name__ in _INSTEAD:
        raise InputError(f"{build.__name__} has no {times[0]}=: it holds without an equation, so "
                         f"nothing can let go; {_INSTEAD[build.__name__]}")
