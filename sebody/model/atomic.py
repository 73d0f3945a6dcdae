"""Builders that change a model wholly or not at all."""

from collections.abc import Callable
from copy import copy
from functools import wraps
from typing import ParamSpec, TypeVar

Arguments = ParamSpec("Arguments")
Built = TypeVar("Built")


def atomic(build: Callable[Arguments, Built]) -> Callable[Arguments, Built]:
    """A builder that leaves its model, the first argument, as it was where it raises.

    What it adds is taken out again; DOF blocks that exist are changed only when nothing more is
    checked.
    """
    @wraps(build)
    def built(*args: Arguments.args, **named: Arguments.kwargs) -> Built:
        model, *_ = args
        kept = {name: copy(value) for name, value in vars(model).items()
                if isinstance(value, dict | list | set)}
        try:
            return build(*args, **named)
        except BaseException:
            vars(model).update(kept)
            raise
    return built
