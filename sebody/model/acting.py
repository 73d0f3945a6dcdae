"""When parts of a model act: until a time, from a time, or both."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple, TypedDict

from sebody.basics import inputs
from sebody.basics.errors import InputError


class Acting(TypedDict, total=False):
    """Arguments of joints and springs that say when they act.

    Attributes
    ----------
    until : float
        Time at which the part lets go [time]; it has no equation and no force from then on.
    from_ : float
        Time from which it acts [time]. Before `until` it acts between the two times; after
        `until` it acts from the start, lets go, and acts again. A `weld` or `distance` locks the
        pose that its nodes have then; other joints keep their geometry, which must be met.
    """

    until: float
    from_: float


class Switch(NamedTuple):
    """When a part acts, see `Acting`."""

    until: float = math.inf
    from_: float = 0.0

    @property
    def times(self) -> tuple[float, ...]:
        """Times at which it lets go or locks."""
        return tuple(t for t in self if 0.0 < t < math.inf)

    def acts(self, t: float) -> bool:
        """Tell whether the part acts from a time on."""
        if self.until < self.from_:
            return t < self.until or t >= self.from_
        return self.from_ <= t < self.until

    def words(self) -> str:
        """When, for messages."""
        said = {"until": self.until < math.inf, "from": self.from_ > 0.0}
        return " ".join(f"{word} t = {t:.6g}" for (word, has), t in zip(
            said.items(), self, strict=True) if has)


def switch_of(given: Mapping[str, Any], what: str) -> Switch:
    """The times among the arguments of a builder.

    Raises
    ------
    InputError
        No times, times that are equal, or a name that is none of `Acting`.
    """
    if odd := [name for name in given if name not in Acting.__annotations__]:
        raise TypeError(f"{what} has no {'=, '.join(odd)}=: of when it acts there are "
                        f"{', '.join(Acting.__annotations__)}")
    times = {name: inputs.number(value, f"{what}: {name}", above=0.0, remedy="give a time > 0")
             for name, value in given.items()}
    switch = Switch(**times)
    if switch.until == switch.from_:
        raise InputError(f"{what}: until and from_ are both {switch.until:.6g}: give two times, or "
                         "one of them")
    return switch
