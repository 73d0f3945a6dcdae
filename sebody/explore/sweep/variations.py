"""Variations of a sweep, from texts: lists of values, ranges, and distributions to sample."""

import ast
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError

RANGE = re.compile(r"^(-?[^:]+):(-?[^:]+)(?::(.+))?$")
CALL = re.compile(r"^(\w+)\((.*)\)$")
MOST_VALUES = 100_000       # of a range
SAMPLERS = ("lhs", "sobol", "random")


@dataclass(frozen=True)
class Distribution:
    """A distribution of one number.

    Parameters
    ----------
    name : str
        Of `DISTRIBUTIONS`.
    numbers : tuple of float
        Its parameters in their order there.
    """

    name: str
    numbers: tuple[float, ...]

    def at(self, shares: NDArray) -> NDArray:
        """Values below which given shares of the distribution lie."""
        return DISTRIBUTIONS[self.name][1](*self.numbers).ppf(shares)

    def __str__(self) -> str:
        return f"{self.name}({', '.join(f'{n:g}' for n in self.numbers)})"


def _frozen(name: str, *arguments: float) -> Any:
    from scipy import stats  # takes half a second to import

    return getattr(stats, name)(*arguments)


DISTRIBUTIONS: dict[str, tuple[tuple[str, ...], Callable[..., Any]]] = {
    "normal": (("mean", "deviation"), lambda m, s: _frozen("norm", m, s)),
    "uniform": (("low", "high"), lambda a, b: _frozen("uniform", a, b - a)),
    "loguniform": (("low", "high"), lambda a, b: _frozen("loguniform", a, b)),
    "triangular": (("low", "mode", "high"),
                   lambda a, c, b: _frozen("triang", (c - a) / (b - a), a, b - a)),
}


def values_of(text: str) -> tuple[str, list]:
    """A name and values from ``NAME=1,2,5``, ``NAME=0:8`` or ``NAME=0:1:0.25``, ends included.

    Raises
    ------
    InputError
        Something else.
    """
    name, values = _halves(text, "--vary NAME=VALUES, such as modes=0:8 or step=0.01,0.005")
    match = RANGE.match(values)
    if not match:
        return name, [_literal(v) for v in values.split(",")]
    low, high, step = (_literal(t) for t in (match[1], match[2], match[3] or "1"))
    if not all(isinstance(n, int | float) for n in (low, high, step)) or not (
            step > 0 and high >= low):
        raise InputError(f"{text}: a range is LOW:HIGH or LOW:HIGH:STEP, with HIGH above LOW")
    count = np.floor((high - low) / step + 1e-9) + 1
    if not count <= MOST_VALUES:
        raise InputError(f"{text} are {count:.3g} values: give at most {MOST_VALUES}")
    count = int(count)
    return name, [low + step * k for k in range(count)]


def distribution_of(text: str) -> tuple[str, Distribution]:
    """A name and distribution from ``NAME=normal(1e4, 500)``.

    Raises
    ------
    InputError
        An unknown distribution, or numbers it cannot have.
    """
    name, call = _halves(text, "--sample NAME=DISTRIBUTION, such as torque=normal(1e4,500)")
    match = CALL.match(call.replace(" ", ""))
    if not match:
        raise InputError(f"{text}: write a distribution, such as {name}=normal(1e4,500)")
    return name, distribution(match[1], [_literal(v) for v in match[2].split(",")], text)


def distribution(kind: str, numbers: Sequence[float], what: str) -> Distribution:
    """A checked distribution; `what` names it in the message.

    Raises
    ------
    InputError
        An unknown distribution, or numbers it cannot have.
    """
    inputs.text(what, "name of a distribution")
    numbers = inputs.items(numbers, f"{what}: numbers", "give a list")
    if not isinstance(kind, str) or kind not in DISTRIBUTIONS:
        raise InputError(f"{what}: distribution {kind!r} is unknown, there are "
                         f"{', '.join(DISTRIBUTIONS)}")
    wanted = DISTRIBUTIONS[kind][0]
    if len(numbers) != len(wanted):
        raise InputError(f"{what}: {kind} takes {', '.join(wanted)}")
    numbers = tuple(inputs.number(n, f"{what}: {name}")
                    for n, name in zip(numbers, wanted, strict=True))
    rising = numbers if kind != "normal" else (0.0, numbers[1])
    if not all(a <= b for a, b in zip(rising, rising[1:], strict=False)) or rising[0] == rising[-1]:
        raise InputError(f"{what}: give {', '.join(wanted)} in rising order" if kind != "normal"
                         else f"{what}: the deviation must be above 0")
    if kind == "loguniform" and numbers[0] <= 0:
        raise InputError(f"{what}: {kind} has values above 0")
    return Distribution(kind, numbers)


def _halves(text: str, form: str) -> tuple[str, str]:
    # names of loads may have equals signs in them, values have none
    name, equals, value = text.rpartition("=")
    if not equals or not name.strip() or not value.strip():
        raise InputError(f"cannot read {text!r}: write {form}")
    return name.strip(), value.strip()


def _literal(text: str) -> Any:
    try:
        return ast.literal_eval(text.strip())
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        return text.strip()
