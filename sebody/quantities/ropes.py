"""Formulas of ropes and sheaves: tensions, lengths, elongation, angles."""

from sebody.model.parts import Rope, Sheave, Stretch
from sebody.quantities.algebra import total
from sebody.quantities.expressions import Number
from sebody.quantities.numbers import Numbers, Parts


def ropes(of: Parts) -> dict[str, Rope]:
    """Ropes by name."""
    return of.model.ropes


def sheaves(of: Parts) -> dict[str, Sheave]:
    """Sheaves with inertia, by name."""
    return {name: one for name, one in of.model.sheaves.items() if one.wheel is not None}


def turned(of: Numbers, name: str, part: str) -> Number:
    """Angle of a sheave about its axis relative to its node, or the rate of this."""
    angle = of.model.sheaves[name].angle
    assert angle is not None
    return of.coordinates(part, angle)[0]


def tension(of: Numbers, name: str) -> list[Number]:
    """Tensions of the spans, in the order of the rope; zero where it is slack."""
    return [of.multiplier(of.numbering.multipliers[stretch.law])
            for stretch in of.model.ropes[name].stretches for _ in stretch.spans]


def length(of: Numbers, name: str) -> Number:
    """Length of the way of a rope between its ends, without what is wound on drums."""
    return total(of.coordinates("q", stretch.length)[0]
                 for stretch in of.model.ropes[name].stretches)


def elongation(of: Numbers, name: str) -> Number:
    """Length of the way less that of the rope without force: negative where it is slack."""
    return total(_elongation(of, stretch) for stretch in of.model.ropes[name].stretches)


def _elongation(of: Numbers, stretch: Stretch) -> Number:
    law = stretch.law
    s, a, b = (of.coordinates("q", block)[0] for block in law.dof_blocks)
    return (s - law.number("material") - law.number("given_a") * a - law.number("given_b") * b)
