"""Thresholds at which parts of a model break or let go, and the instants at which they do."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.model.mechanism import Mechanism

DID = BROKE, LET_GO = "broke", "let go"


class Excess(NamedTuple):
    """By how much the size of a force, or a quantity, is beyond a limit; relative to it."""

    read: Callable[[str], float | NDArray]
    quantity: str
    passes: str
    limit: float

    def __call__(self) -> float:
        value = np.asarray(self.read(self.quantity), dtype=float)
        number = float(np.linalg.norm(value)) if value.ndim else float(value)
        if self.quantity.endswith((".force", ".moment")):
            number = abs(number)
        excess = number - self.limit if self.passes == ">" else self.limit - number
        return excess / (abs(self.limit) or 1.0)


class Threshold(NamedTuple):
    """The part that lets go, and the excess of a quantity over its limit, relative to the limit."""

    name: str
    excess: Excess
    did: str        # one of `DID`, when it is reached


def thresholds_of(model: Mechanism, acts: set[str], read: Callable[[str], float | NDArray]
                  ) -> list[Threshold]:
    """Thresholds of the parts that act.

    Parameters
    ----------
    read : callable
        Gives a quantity in the state reached.

    Raises
    ------
    InputError
        A part without such a force or moment, or a quantity that is no number.
    """
    found = []
    for name in sorted(acts):
        switch = model.switches[name]
        for kind, limit in zip(("force", "moment"), switch.breaks_at, strict=True):
            if limit < math.inf:
                found.append(Threshold(name, Excess(read, f"{name}.{kind}", ">", limit),
                                       BROKE))
        quantity, passes, limit = switch.release_when
        if quantity:
            found.append(Threshold(name, Excess(read, quantity, passes, limit), LET_GO))
            if np.size(_read(name, read, quantity)) != 1:
                raise InputError(f"{name!r}: release_when reads {quantity!r}, which is several "
                                 f"numbers: give one of them, such as {quantity}.x or "
                                 f"{quantity}.norm")
    for one in found:
        _read(one.name, read, one.excess.quantity)
    return found


def _read(name: str, read: Callable[[str], float | NDArray], quantity: str) -> float | NDArray:
    """A quantity; what is wrong with it is said of the part that asks for it."""
    try:
        return read(quantity)
    except InputError as error:
        raise InputError(f"{name!r} cannot tell when to let go: {error}") from error
