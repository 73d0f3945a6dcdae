"""Values that users' functions read: global and enclosing variables, defaults, helpers.

Numba compiles the values in. Names whose values it cannot compile in are refused with the remedy
(`refuse`), and a run is refused once a value is no longer what it was (`changed`): a function that
kept the old value without a word would be a surprise, and so would one of several functions made in
a loop that took up the last value of the loop's variable.
"""

import builtins
import dis
from collections import ChainMap
from collections.abc import Callable, Hashable, Iterator, Mapping
from enum import Enum
from functools import cache
from hashlib import sha256
from itertools import takewhile
from types import BuiltinFunctionType, CellType, CodeType, FunctionType, ModuleType
from typing import Any, NamedTuple, TypeGuard

import numpy as np

from sebody.basics import inputs
from sebody.basics.errors import InputError

LOOKUPS = {"LOAD_GLOBAL", "LOAD_NAME", "LOAD_DEREF"}    # instructions of Python
ATTRIBUTES = {"LOAD_ATTR", "LOAD_METHOD"}
CONSTANTS = bool, int, float, complex, str, bytes, tuple, type(None), np.generic, np.ndarray
LIBRARIES = {"numpy", "scipy", "numba", "math", "builtins"}     # Numba has its own versions of them
ABSENT = object()       # in place of the value of a name that does not exist


class Read(NamedTuple):
    """A name that a function reads, and its value."""

    name: str           # with the modules it is found in, as settings.gain
    value: object
    attribute: str      # of the value, where the function reads one
    helper: str         # name of the helper that reads it
    options: str = ""   # with which Numba compiles it, where the user gave some

    @property
    def said(self) -> str:
        """The name in a message."""
        return self.name + (f" in {self.helper}()" if self.helper else "")


class Code(NamedTuple):
    """Code of a function, comparable."""

    instructions: bytes
    names: tuple[str, ...]
    constants: tuple[object, ...]

    @classmethod
    def of(cls, code: CodeType) -> "Code":
        """That of a function's code object."""
        return cls(code.co_code, code.co_names, tuple(
            [cls.of(one) if isinstance(one, CodeType) else repr(one) for one in code.co_consts]))


def values_read(function: Callable) -> dict[str, object]:
    """Everything a function computes with: its code, and copies of what it and its helpers read."""
    read: dict[str, object] = {"its code": Code.of(function.__code__)}
    for one in _reads(function):
        read[one.said] = (Code.of(one.value.__code__) if is_helper(one.value) else
                          _copy(one.value))
    return read


def compiled_from(function: Callable) -> Hashable:
    """All that the compiled code of a function depends on: its code and the values it reads."""
    return function.__code__, *[(one.said, one.options, _identity(one.value))
                                for one in _reads(function)]


def _identity(value: object) -> Hashable:
    """A key that is equal for values that are compiled to the same code."""
    if is_helper(value):
        return value.__code__
    if isinstance(value, np.ndarray):
        layout = str(value.dtype), value.shape, value.flags.c_contiguous, value.flags.f_contiguous
        return *layout, sha256(value.tobytes()).digest()
    if isinstance(value, tuple):
        return type(value), *map(_identity, value)
    if isinstance(value, CONSTANTS):
        return type(value), repr(value)         # 0.0 equals -0.0, and 1 equals True
    if isinstance(value, BuiltinFunctionType | FunctionType | np.ufunc | type | Enum):
        return value
    return object()         # nothing tells whether another one is the same: it equals none


def changed(before: Mapping[str, object], function: Callable) -> str:
    """The first value read that has changed, in words; empty if there is none."""
    now = values_read(function)
    for name, old in before.items():
        new = now.get(name, ABSENT)
        if _same(old, new):
            continue
        if new is ABSENT:
            return f"{name}, which no longer exists"
        if isinstance(old, Code) or isinstance(new, Code):
            return f"{name}, which has been defined anew since"
        texts = inputs.shown(old), inputs.shown(new)
        return f"{name}, " + ("whose entries have changed since" if texts[0] == texts[1] else
                              f"which was {texts[0]} then and is {texts[1]} now")
    return ""


def refuse(function: Callable, what: str) -> None:
    """Refuse a function that reads what cannot be compiled in.

    Raises
    ------
    InputError
        It reads a list, a set, a dict or an attribute of an object, calls a function by the module
        it is in, or reads a name that does not exist.
    """
    for one in _reads(function):
        name, value, attribute = one.name, one.value, one.attribute
        short = f"{name}.{attribute}" if attribute else name
        if value is ABSENT:
            raise InputError(f"{what} reads {one.said}, which does not exist: define it before")
        if isinstance(value, list | set):
            raise InputError(f"{what} reads {one.said}, a {type(value).__name__}, which may "
                             f"change: make it a tuple, or an array, {name} = numpy.array({name})")
        if isinstance(value, dict):
            raise InputError(f"{what} reads {one.said}, a dict, which may change: read it before, "
                             f"as in value = {name}[...], and use the value in the function")
        if attribute and not isinstance(value, CONSTANTS) and _is_object(value):
            raise InputError(f"{what} reads {short}, which may change: read it before, as in "
                             f"{attribute} = {short}, and use {attribute} in the function")
        if is_helper(value) and "." in name:
            module, _, own = name.rpartition(".")
            raise InputError(f"{what} calls {one.said}: import it by its name, from "
                             f"{module} import {own}")


def is_helper(value: object) -> TypeGuard[FunctionType]:
    """Tell whether a value is a function written in Python that is no library's."""
    return isinstance(value, FunctionType) and (
        (value.__module__ or "").partition(".")[0] not in LIBRARIES)


def _is_object(value: object) -> bool:
    """Tell whether a value is a class of a user, or an instance of one."""
    kind = value if isinstance(value, type) else type(value)
    return not issubclass(kind, Enum) and kind.__module__.partition(".")[0] not in LIBRARIES


def _reads(function: Callable, helper: str = "",
           known: set[Callable] | None = None) -> Iterator[Read]:
    """Everything that a function and its helpers read; each helper is examined once."""
    known = set() if known is None else known
    known.add(function)
    for name, value in defaults(function).items():
        yield Read(name, value, "", helper)
    enclosing = {name: _content(cell) for name, cell in zip(
        function.__code__.co_freevars, function.__closure__ or (), strict=True)}
    names = ChainMap(enclosing, function.__globals__, vars(builtins))
    for path in _lookups(function.__code__):
        name, value, attribute = _resolved(path, names)
        options = getattr(value, "targetoptions", "")
        value = getattr(value, "py_func", value)        # of what Numba has compiled
        if isinstance(value, ModuleType) or value is vars(builtins).get(name, names):
            continue
        yield Read(name, value, attribute, helper, str(options))
        if is_helper(value) and value not in known:
            yield from _reads(value, value.__name__, known)


def _content(cell: CellType) -> object:
    """The value of an enclosing variable."""
    try:
        return cell.cell_contents
    except ValueError:          # it has not been given a value yet
        return ABSENT


def defaults(function: Callable) -> dict[str, object]:
    """Values of the arguments that a function has defaults for, by name."""
    code = function.__code__
    given = function.__defaults__ or ()
    positional = code.co_varnames[code.co_argcount - len(given):code.co_argcount]
    return dict(zip(positional, given, strict=True)) | (function.__kwdefaults__ or {})


def _resolved(path: tuple[str, ...], names: Mapping[str, object]) -> tuple[str, object, str]:
    """Name with its modules, value and next attribute, of a name and attributes of it."""
    name, value = path[0], names.get(path[0], ABSENT)
    for attribute in path[1:]:
        if not isinstance(value, ModuleType):
            return name, value, attribute
        name, value = f"{name}.{attribute}", getattr(value, attribute, ABSENT)
    return name, value, ""


@cache
def _lookups(code: CodeType, own: frozenset[str] = frozenset()) -> tuple[tuple[str, ...], ...]:
    """Names from outside that code looks up, each with the attributes that it reads of it."""
    own = own | set(code.co_cellvars)
    steps = [one for one in dis.get_instructions(code) if one.opname != "EXTENDED_ARG"]
    lookups = []
    for k, step in enumerate(steps):
        if step.opname in LOOKUPS and not (step.opname == "LOAD_DEREF" and step.argval in own):
            attributes = takewhile(lambda one: one.opname in ATTRIBUTES, steps[k + 1:])
            lookups.append((step.argval, *[one.argval for one in attributes]))
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            lookups += _lookups(inner, own)
    return tuple(dict.fromkeys(lookups))


def _copy(value: object) -> object:
    """A value that stays as it is when its owner changes it."""
    if isinstance(value, np.ndarray):
        return value.copy()
    if isinstance(value, tuple):
        return tuple([_copy(one) for one in value])
    return value


def _same(one: Any, other: Any) -> bool:
    if one is other:
        return True
    if type(one) is not type(other):
        return False
    if isinstance(one, np.ndarray):
        return (one.dtype == other.dtype and one.shape == other.shape
                and one.tobytes() == other.tobytes())
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(_same, one, other))
    return isinstance(one, CONSTANTS) and (one == other or (one != one and other != other))
