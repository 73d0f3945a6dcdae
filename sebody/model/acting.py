"""Times and loads at which parts of a model begin or cease to act."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Mapping
from typing import Any, NamedTuple, TypedDict

from sebody.basics import inputs
from sebody.basics.errors import InputError

CONDITION = re.compile(r"\s*(\S.*?)\s*([<>])\s*(\S+)\s*")
LARGEST = sys.float_info.max     # in place of a limit that is not given


class Acting(TypedDict, total=False):
    """Arguments of joints and springs that say when they act.

    Attributes
    ----------
    breaks_at : float or mapping
        Size of the force at which the part breaks for good, ``{"force": F, "moment": M}`` those of
        force and moment; of what gives a moment alone a number is the moment.
    release_when : str
        A sensor or quantity and its limit, ``"swing > 0.6"`` or ``"tip.position.y < -1.2"``: the
        part lets go for good when it is reached.
    until : float
        Time at which the part lets go [time]; it has no equation and no force from then on.
    from_ : float
        Time from which it acts [time]. Before `until` it acts between the two times; after
        `until` it acts from the start, lets go, and acts again. A `weld` or `distance` locks the
        pose that its nodes have then, and a coupling counts from there; other joints keep their
        geometry, which must be met.
    """

    breaks_at: float | Mapping[str, float]
    release_when: str
    until: float
    from_: float


ACTING = tuple(Acting.__annotations__)


class Switch(NamedTuple):
    """The times and loads of a part, see `Acting`."""

    until: float = math.inf
    from_: float = 0.0
    breaks_at: tuple[float, float] = (math.inf, math.inf)   # force, moment
    release_when: tuple[str, str, float] = ("", ">", 0.0)   # quantity, how it passes, limit

    @property
    def times(self) -> tuple[float, ...]:
        """Times at which it lets go or locks."""
        return tuple(t for t in self[:2] if 0.0 < t < math.inf)

    def acts(self, t: float) -> bool:
        """Tell whether the part acts from a time on."""
        if self.until < self.from_:
            return t < self.until or t >= self.from_
        return self.from_ <= t < self.until

    def words(self) -> str:
        """The time, for messages."""
        said = {"until": self.until < math.inf, "from": self.from_ > 0.0}
        words = [f"{word} t = {t:.6g}" for (word, has), t in zip(
            said.items(), self[:2], strict=True) if has]
        words += [f"until its {name} is {limit:.6g}" for name, limit in zip(
            ("force", "moment"), self.breaks_at, strict=True) if limit < math.inf]
        name, passes, limit = self.release_when
        return " and ".join(words + [f"until {name} {passes} {limit:.6g}"] * bool(name))


def switch_of(given: Mapping[str, Any], what: str, turns: bool = False) -> Switch:
    """Times and limits among the arguments of a builder.

    Parameters
    ----------
    turns : bool
        Whether the part gives a moment alone.

    Raises
    ------
    InputError
        No times or limits, or times that are equal.
    TypeError
        A name that is none of `Acting`.
    """
    if odd := [name for name in given if name not in ACTING]:
        raise TypeError(f"{what} has no {'=, '.join(odd)}=: of when it acts there are "
                        f"{', '.join(ACTING)}")
    found: dict[str, Any] = {
        name: inputs.number(given[name], f"{what}: {name}", above=0.0, remedy="give a time > 0")
        for name in ("until", "from_") if name in given}
    if "breaks_at" in given:
        found["breaks_at"] = _limits(given["breaks_at"], f"{what}: breaks_at", turns)
    if "release_when" in given:
        found["release_when"] = _condition(given["release_when"], f"{what}: release_when")
    switch = Switch(**found)
    if switch.until == switch.from_:
        raise InputError(f"{what}: until and from_ are both {switch.until:.6g}: give two times, or "
                         "one of them")
    return switch


def _limits(given: Any, what: str, turns: bool) -> tuple[float, float]:
    """Largest force and moment."""
    remedy = 'give a force, or {"force": F, "moment": M} or one of them, each > 0'
    if not isinstance(given, Mapping):
        given = {"moment" if turns else "force": given}
    if not given or not given.keys() <= {"force", "moment"}:
        raise inputs.refusal(what, given, remedy)
    force, moment = (inputs.number(given.get(name, LARGEST), f"{what} of the {name}", above=0.0,
                                   remedy=remedy) for name in ("force", "moment"))
    return (math.inf if force == LARGEST else force,
            math.inf if moment == LARGEST else moment)


def _condition(given: Any, what: str) -> tuple[str, str, float]:
    """Quantity, how it passes its limit, and the limit."""
    found = CONDITION.fullmatch(given) if isinstance(given, str) else None
    try:
        name, passes, limit = found.groups() if found else ("", "", "none")
        return name, passes, inputs.number(float(limit), what)
    except ValueError:
        raise inputs.refusal(what, given, "give a sensor or quantity and its limit, such as "
                             "'swing > 0.6'") from None
