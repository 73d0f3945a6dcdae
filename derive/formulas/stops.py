"""Stops of joints, and gears: limits of an angle, a way or a distance, with or without play."""

from collections.abc import Sequence

import sympy as sp

from sebody.derive.form.spaces import Space
from sebody.derive.formulas.elements import (
    Constant,
    Element,
    amplitude,
    choose,
    constant,
    position,
    rotation,
)
from sebody.derive.formulas.frictions import Angle, turn_vectors
from sebody.derive.formulas.law_elements import Forces, Measures, law_element
from sebody.derive.formulas.laws import impact

IMPACT = {"stiffness": "stiffness k of k d^n (1 + c d')", "exponent": "exponent n",
          "damping": "damping c [time/length]",
          "slow": "speed of impacts so slow that steps do not look at them"}
LIMITS = {"lower": "lower limit", "upper": "upper limit"}


def impact_constants(space: Space) -> list[Constant]:
    """Declare the constants of Hunt and Crossley's law."""
    return [constant(space, name, "scalar", meaning) for name, meaning in IMPACT.items()]


def turn_stop(planar: bool) -> Element:
    """Limits of the angle of body a against b about the axis they share."""
    space = Space(planar)
    blocks = [rotation(space, "a"), rotation(space, "b")]
    vectors = [] if planar else turn_vectors(space)
    measures = Measures(blocks)
    angle = Angle.of(measures, space, blocks, vectors, "angle")
    return _stop("turn_stop", "limits of an angle", space, measures, vectors, angle,
                 [("angle", angle.value)])


def slide_stop(planar: bool) -> Element:
    """Limits of the way of b along an axis of a."""
    space = Space(planar)
    e = constant(space, "e", "vector", "axis, in axes of the first body")
    start = constant(space, "start", "scalar", "way at the start [length]")
    xa, xb, turn = position(space, "a"), position(space, "b"), rotation(space, "a")
    measures = Measures([xa, xb, turn])
    way = (turn.state.symbols * e.symbols).dot(xb.state.symbols - xa.state.symbols)
    value = _named(measures, way - start.symbols[0])
    return _stop("slide_stop", "limits of a way along an axis", space, measures, [e, start], value,
                 [("way", value.value)])


def distance_stop(planar: bool) -> Element:
    """Limits of the distance of two points."""
    space = Space(planar)
    a, b = position(space, "a"), position(space, "b")
    measures = Measures([a, b])
    d = b.state.symbols - a.state.symbols
    value = _named(measures, sp.sqrt(d.dot(d)))
    return _stop("distance_stop", "limits of a distance", space, measures, [], value,
                 [("way", value.value)])


def way_stop() -> Element:
    """Limits of the way along a path."""
    space = Space(False)
    own = amplitude(space, "a")
    measures = Measures([own])
    value = _named(measures, own.state.symbols[0])
    return _stop("way_stop", "limits of the way along a path", space, measures, [], value,
                 [("way", value.value)])


def _named(measures: Measures, way: sp.Expr) -> Angle:
    """A way as a measure, with its rate."""
    velocity = measures.rate(way)
    return Angle(measures.add("way", way), measures.add("way_rate", velocity), velocity)


def gear_play(planar: bool) -> Element:
    """Teeth of a pair of gears, with or without play: limits of ``angle_1 - ratio angle_2``."""
    space = Space(planar)
    measures, ratio, vectors, (first, second) = _mesh(space)
    r = ratio.symbols[0]
    mesh = Angle(first.value - r * second.value, first.rate - r * second.rate,
                 first.velocity - r * second.velocity)
    return _stop("gear_play", "teeth of a pair of gears with play", space, measures,
                 [ratio, *vectors], mesh, [("angle_1", first.value), ("angle_2", second.value)],
                 both_sides=True)


def _mesh(space: Space) -> tuple[Measures, Constant, list[Constant], list[Angle]]:
    """The angles of two pairs of bodies, and what their ratio is."""
    measures = Measures([rotation(space, name) for name in "abcd"])
    ratio = constant(space, "ratio", "scalar", "turns of the first for one turn of the second")
    vectors, angles = [], []
    for k in (1, 2):
        own = [] if space.planar else turn_vectors(space, str(k))
        vectors += own
        angles.append(Angle.of(measures, space, measures.blocks[2 * k - 2:2 * k], own,
                               f"angle_{k}"))
    return measures, ratio, vectors, angles


def _stop(name: str, summary: str, space: Space, measures: Measures, own: Sequence[Constant],
          of: Angle, memory: Sequence[tuple[str, sp.Expr]], both_sides: bool = False) -> Element:
    """The element that keeps an angle or way between two limits.

    Parameters
    ----------
    both_sides : bool
        Whether the limits may be one, where both press.
    """
    constants = impact_constants(space)
    limits = [constant(space, limit, "scalar", meaning) for limit, meaning in LIMITS.items()]
    lower, upper = (c.symbols[0] for c in limits)
    value, side, depth, speed = sp.symbols("value side beyond speed_beyond")
    above, below = value - upper, lower - value
    law = impact(depth, speed, *(c.symbols[0] for c in constants),
                 play=upper - lower if both_sides else None)
    stages = (((value, of.value),),
              ((side, choose(above - below, sp.Float(1.0), sp.Float(-1.0))),
               (depth, choose(above - below, above, below))), ((speed, side * of.rate),),
              *law.stages)
    push = law.forces[0]
    # the rate that is kept changes no sign with the side: teeth without play pass from one to the
    # other in a step, and nothing is struck
    return law_element(
        "planar_" * space.planar + name, summary, space, measures, [*constants, *limits, *own],
        stages, Forces((of.velocity,), (side * push,), (side * (push - law.elastic),)),
        [*memory, ("rate", of.rate), *law.memory[1:], ("normal", push)], law.stored)
