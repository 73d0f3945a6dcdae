"""How cases are written: a call that is right, and what becomes of it with one wrong argument."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
import pytest

NAN, INF = float("nan"), float("inf")
NO_NUMBER = ("1", None, True, 1j, NAN, INF, [1.0])
NO_COUNT = ("2", None, True, 2.5, NAN, [2])
NO_FLAG = (0, "no", None, 1.0)
NO_NAME = ("", " ", None, 3, "a\nb", "n" * 201, ["a"])


class Silent:
    """An object that cannot be shown."""

    def __repr__(self) -> str:
        raise RuntimeError("no text")


class Right(NamedTuple):
    """A function of a fresh model or of nothing, with arguments that are right.

    `wrong` holds, by argument, values and the fragment of the message that each must have.
    """

    function: Callable
    arguments: Mapping[str, Any]
    wrong: Mapping[str, Iterable[tuple[Any, str]]]


def are(what: str, *values: Any, also: str = "") -> list[tuple[Any, str]]:
    """Values that a message shows behind the name of the argument."""
    return [(value, f"{what} is {_short(repr(value))}{also}") for value in values]


def have(fragment: str, *values: Any) -> list[tuple[Any, str]]:
    """Values whose messages share a fragment."""
    return [(value, fragment) for value in values]


def positive(what: str) -> list[tuple[Any, str]]:
    """What is no positive number."""
    return are(what, *NO_NUMBER, 0, -1.0, also=": give a positive number")


def not_negative(what: str) -> list[tuple[Any, str]]:
    """What is no number of zero or more."""
    return are(what, *NO_NUMBER, -1.0, also=": give a finite number >= 0")


def vectors(what: str, size: int) -> list[tuple[Any, str]]:
    """What is no vector of space or of the plane."""
    bad = ("123"[:size], None, 1.0, (1.0,) * (size + 1), [1.0] * (size - 1), ("1",) * size,
           (True,) * size, (1j,) * size, (0.0,) * (size - 1) + (NAN,), [[1.0] * size], {}, [])
    return are(what, *bad, also=f": give {size} finite numbers")


def nodes(*others: Any) -> list[tuple[Any, str]]:
    """What is no node of a model with nodes named by letters."""
    return [*are("node", None, 3, ["a"]), ("far", "node 'far' is unknown: the model has a, b"),
            *others]


def listed(table: Mapping[str, Right]) -> list:
    """Every wrong value of a table, as parameters of a test."""
    return list(_listed(table))


def _listed(table: Mapping[str, Right]) -> Iterator[Any]:
    for name, right in table.items():
        for argument, wrong in right.wrong.items():
            for k, (value, said) in enumerate(wrong):
                yield pytest.param(right, argument, value, said, id=f"{name}-{argument}-{k}")


def _short(text: str) -> str:
    text = " ".join(text.split())
    return text if len(text) <= 60 else text[:57] + "..."


def alike(one: object, other: object) -> bool:
    """Whether two descriptions of a model, nested and with arrays, are equal."""
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other)
    if isinstance(one, tuple | list):
        return len(one) == len(other) and all(map(alike, one, other))
    return one == other
