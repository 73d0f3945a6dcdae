"""A model as text and numbers, for a file of results, and the model again.

Parts of the model (nodes, DOF blocks, bodies, joints, loads) are listed in the order in which they
are met, each once; one that belongs to another is given by its place in the list. Compiled
functions are left out: what they gave is in the recorded states.
"""

import json
from dataclasses import is_dataclass
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.fem import materials
from sebody.model import acting, mechanism, numbering, parts, time_functions
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering
from sebody.reduction import invariants, preload, recovery
from sebody.results.saved_checks import check_numbering, check_part, check_tuple, fields_in_files


def _kinds(*modules: ModuleType) -> dict[str, type]:
    """Dataclasses and named tuples by name."""
    return {name: kind for module in modules for name, kind in vars(module).items()
            if isinstance(kind, type) and (is_dataclass(kind) or hasattr(kind, "_fields"))}


KINDS = _kinds(acting, parts, time_functions, mechanism, numbering, invariants, preload, recovery,
               materials)


def described(model: Mechanism, numbers: Numbering) -> tuple[str, NDArray]:
    """A model and its numbering as JSON and an array of all numbers in its arrays."""
    writer = _Writer()
    heads = [writer.of(model), writer.of(numbers)]
    return (json.dumps({"heads": heads, "parts": writer.parts}),
            np.concatenate(writer.arrays) if writer.arrays else np.zeros(0))


def restored(text: dict, numbers: NDArray) -> tuple[Mechanism, Numbering]:
    """The model and numbering of `described`, without compiled functions.

    Parameters
    ----------
    text : dict
        What the JSON says.

    Raises
    ------
    AttributeError, KeyError, IndexError, TypeError, ValueError
        What was written is not what `described` writes.
    """
    model, numbering = _Reader(text, numbers).heads
    check_numbering(model, numbering)
    return model, numbering


class _Writer:
    def __init__(self) -> None:
        self.parts: list[list] = []         # name of the class, fields
        self.arrays: list[NDArray] = []
        self._length = 0
        self._places: dict[int, int] = {}   # id(part) -> place in the list
        self._known: dict[int, tuple[NDArray, list]] = {}   # id(array) -> it, what stands for it

    def of(self, value: Any) -> Any:
        """A value for JSON: plain ones as they are, others as lists that begin with their kind."""
        if value is None or isinstance(value, bool | int | float | str):
            return value
        if isinstance(value, np.generic):
            return value.item()
        if isinstance(value, np.ndarray):
            return self._array(value)
        kind = next((k.__name__ for k in type(value).__mro__ if KINDS.get(k.__name__) is k), None)
        if kind is not None:
            return (["tuple of names", kind, [self.of(v) for v in value]]
                    if isinstance(value, tuple) else ["part", self._part(value, kind)])
        if isinstance(value, dict):
            if value and {id(k) for k in value} <= self._places.keys():     # see Numbering
                return ["by part", [[self._places[id(k)], self.of(v)] for k, v in value.items()]]
            return ["dict", [[self.of(k), self.of(v)] for k, v in value.items()]]
        if isinstance(value, list | tuple):
            return [type(value).__name__, [self.of(v) for v in value]]
        if isinstance(value, set):          # of names, in an order that does not change
            return ["set", sorted(value)]
        return None

    def _part(self, value: Any, kind: str) -> int:
        if id(value) not in self._places:
            place = self._places[id(value)] = len(self.parts)
            self.parts.append([])           # parts may contain each other
            self.parts[place] = [kind, {name: self.of(getattr(value, name))
                                        for name in fields_in_files(KINDS[kind])}]
        return self._places[id(value)]

    def _array(self, value: NDArray) -> list:
        if id(value) not in self._known:        # bodies may share arrays: each is kept once
            first = self._length
            self.arrays.append(value.astype(float).ravel())
            self._length += value.size
            self._known[id(value)] = value, ["array", first, list(value.shape), value.dtype.str]
        return self._known[id(value)][1]


class _Reader:
    def __init__(self, text: dict, numbers: NDArray) -> None:
        self._numbers = numbers
        self._arrays: dict[tuple, NDArray] = {}
        self._parts: list[Any] = [object.__new__(KINDS[kind]) for kind, _ in text["parts"]]
        for part, (_, values) in zip(self._parts, text["parts"], strict=True):
            for name, value in values.items():
                object.__setattr__(part, name, self.made(value))
        for part in self._parts:        # which contain each other
            check_part(part, vars(part))
        self.heads = tuple(map(self.made, text["heads"]))

    def made(self, value: Any) -> Any:
        """The value that `_Writer.of` was given."""
        if not isinstance(value, list):
            return value
        kind, *rest = value
        if kind == "part":
            return self._parts[rest[0]]
        if kind == "array":
            first, shape, dtype = rest
            key = first, *shape
            if key not in self._arrays:
                if type(first) is not int or first < 0 or np.dtype(dtype).hasobject:
                    raise ValueError(f"an array begins at {first}")
                values = self._numbers[first:first + int(np.prod(shape))]
                self._arrays[key] = values.reshape(shape).astype(dtype)
            return self._arrays[key]
        if kind == "tuple of names":
            entries = list(map(self.made, rest[1]))
            check_tuple(KINDS[rest[0]], entries)
            return KINDS[rest[0]](*entries)
        if kind == "by part":
            return {self._parts[place]: self.made(v) for place, v in rest[0]}
        if kind == "dict":
            return {self.made(k): self.made(v) for k, v in rest[0]}
        return {"list": list, "tuple": tuple, "set": set}[kind](map(self.made, rest[0]))
