"""Checks of the kind of an object: flags, choices, functions, instances, lists, mappings."""

from collections.abc import Callable, Iterable, Mapping
from types import UnionType
from typing import Any, TypeVar

import numpy as np

from sebody.basics.errors import InputError
from sebody.basics.inputs.refusals import refusal, shown

Kind = TypeVar("Kind")


def flag(value: Any, what: str) -> bool:
    """True or False; numbers and texts are neither."""
    if not isinstance(value, bool | np.bool_):
        raise refusal(what, value, "give True or False")
    return bool(value)


def mapping(value: Any, what: str, remedy: str) -> dict:
    """Contents of a dict or other mapping.

    Raises
    ------
    InputError
        Anything else, an empty text or list included.
    """
    if not isinstance(value, Mapping):
        raise refusal(what, value, remedy)
    return dict(value)


def choice(value: Any, what: str, options: Iterable[Kind], remedy: str | None = None) -> Kind:
    """One of some options, which are texts or numbers.

    Raises
    ------
    InputError
        Anything else; the message names the options.
    """
    options = list(options)
    for option in options:
        same_kind = isinstance(value, str) == isinstance(option, str)
        if same_kind and not isinstance(value, bool) and np.ndim(value) == 0 and value == option:
            return option
    if remedy:
        raise refusal(what, value, remedy)
    *most, last = map(repr, options)
    listed = f"{', '.join(most)} or {last}" if most else last
    raise InputError(f"{what} {shown(value)} is unknown: use {listed}")


def function(value: Any, what: str, remedy: str) -> Callable:
    """Something that can be called.

    Raises
    ------
    InputError
        Anything else.
    """
    if not callable(value):
        raise refusal(what, value, remedy)
    return value


def instance(value: Any, what: str, kind: type[Kind] | UnionType, remedy: str) -> Kind:
    """An object of a class of this package, or of one of several.

    Raises
    ------
    InputError
        Anything else, the class itself included.
    """
    if not isinstance(value, kind):
        raise refusal(what, value, remedy)
    return value


def items(value: Any, what: str, remedy: str) -> list:
    """Contents of a list, tuple or other iterable; a text is none.

    Raises
    ------
    InputError
        Anything that cannot be iterated.
    """
    if isinstance(value, str | bytes) or not isinstance(value, Iterable) or (
            isinstance(value, np.ndarray) and not value.ndim):
        raise refusal(what, value, remedy)
    return list(value)
