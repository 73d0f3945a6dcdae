"""Builders that change a model wholly or not at all."""

from collections.abc import Callable
from copy import copy
from functools import wraps
from inspect import isfunction, signature
from typing import ParamSpec, TypeVar, cast

from sebody.basics.spelling import refuse_arguments
from sebody.model.acting import ACTING
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element, Joint
from sebody.model.switching import note

Arguments = ParamSpec("Arguments")
Built = TypeVar("Built")
Class = TypeVar("Class", bound=type)


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
                refuse_arguments(build, named, 1, ACTING if "acting" in own else ())
            raise
    return built
