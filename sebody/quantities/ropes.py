"""Formulas of ropes and sheaves: tensions, lengths, elongation, angles."""

from sebody.model.parts import Element
from sebody.model.rope_parts import Rope, RopePlace, Sheave, Stretch
from sebody.quantities.algebra import total
from sebody.quantities.expressions import Number, positive
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


def passes(of: Parts, name: str) -> bool:
    """Tell whether a rope passes sheaves between its ends."""
    return any(place.sheave is not None for place in of.model.ropes[name].places[1:-1])


def tension(of: Numbers, name: str) -> list[Number]:
    """Tensions of the spans, in the order of the rope; zero where it is slack."""
    return [pull for stretch in of.model.ropes[name].stretches
            for pull in [_pull(of, stretch)] * len(stretch.spans)]


def _pull(of: Numbers, stretch: Stretch) -> Number:
    """Tension of a stretch: its multiplier, but for what iterations leave where it is slack."""
    found = of.multiplier(of.numbering.multipliers[stretch.law])
    return taut(of, stretch) * positive(found) * found + 0.0        # no -0


def taut(of: Numbers, stretch: Stretch) -> Number:
    """One where a stretch is longer than without force, and zero elsewhere."""
    return positive(_elongation(of, stretch))


def length(of: Numbers, name: str) -> Number:
    """Length of the way of a rope between its ends, without what is wound on drums."""
    rope = of.model.ropes[name]
    passed = [place for place in rope.places[1:-1] if place.sheave is not None]
    held = (abs(place.radius) * wrap for place, wrap in zip(passed, wraps(of, name), strict=True)
            if place.sheave and place.sheave.holds)     # others are in the lengths of stretches
    return total([*(of.coordinates("q", stretch.length)[0] for stretch in rope.stretches), *held])


def elongation(of: Numbers, name: str) -> Number:
    """Length of the way less that of the rope without force: negative where it is slack."""
    return total(_elongation(of, stretch) for stretch in of.model.ropes[name].stretches)


def _elongation(of: Numbers, stretch: Stretch) -> Number:
    law = stretch.law
    s, a, b = (of.coordinates("q", block)[0] for block in law.dof_blocks)
    return (s - law.number("material") - law.number("given_a") * a - law.number("given_b") * b)


def rubs(of: Parts, name: str) -> bool:
    """Tell whether a rope passes sheaves with friction."""
    return bool(of.model.ropes[name].frictions)


def slip(of: Numbers, name: str) -> list[Number]:
    """Ways of a rope on the sheaves with friction that it passes, towards its last place."""
    return [one.number("along") * (of.coordinates("q", one.dof_blocks[0])[0]
                                   - of.coordinates("q", one.dof_blocks[1])[0])
            for one in of.model.ropes[name].frictions]


def wraps(of: Numbers, name: str) -> list[Number]:
    """Angles of contact on the sheaves that a rope passes, in its order.

    Negative where the rope should have left the sheave, on which it is still held here.
    """
    rope = of.model.ropes[name]
    spans = [span for stretch in rope.stretches for span in stretch.spans]
    found = []
    for k, place in enumerate(rope.places[1:-1], 1):
        if place.sheave is not None:
            turned = angle(of, spans[k], place) - angle(of, spans[k - 1], place)
            found.append(place.wrap + (1.0 if place.radius > 0 else -1.0) * turned)
    return found


def angle(of: Numbers, span: Element, place: RopePlace) -> Number:
    """Angle of a span at one of its sheaves from its ray of there, in axes of the node."""
    return of.recorded("frames", of.numbering.memories[span][end(span, place)])


def end(span: Element, place: RopePlace) -> int:
    """Number of the end of a span at a sheave: 0 has the constants ``e1_a``, 1 ``e1_b``."""
    return 0 if span.attachments[0].node is place.node else 1
