"""Couplings without elasticity: a ratio of two coordinates of joints, angles or ways.

``phi = c_1 - ratio c_2 = 0``: gears are two angles, a rack and a pinion a way and an angle, a screw
the way and the angle of one cylindrical joint, pulleys two ways.
"""

import sympy as sp

from sebody.derive.form.spaces import Space
from sebody.derive.formulas.elements import (
    Block,
    Constant,
    Element,
    constant,
    element,
    kept,
    near_angle,
    position,
    rotation,
)
from sebody.derive.formulas.frictions import turn_vectors

TURN, SLIDE = "turn", "slide"
PAIRS = (TURN, TURN), (SLIDE, TURN), (SLIDE, SLIDE)
MEANINGS = {TURN: "angle", SLIDE: "way"}


def couple(first: str, second: str, planar: bool) -> Element:
    """Derive the coupling of two coordinates; angles count turns from step to step."""
    space = Space(planar)
    ratio = constant(space, "ratio", "scalar", "first coordinate over the second")
    places: list[Block] = []
    turns: list[Block] = []
    constants, values = [ratio], []
    memory: list[tuple[str, sp.Expr]] = []
    for k, (what, names) in enumerate(((first, "ab"), (second, "cd")), 1):
        if what == TURN:
            blocks = [rotation(space, name) for name in names]
            value, own = _angle(space, blocks, k)
            turns += blocks
            memory += [] if planar else [(f"angle_{k}", value)]
        else:
            ends, carrier = [position(space, name) for name in names], rotation(space, names[0])
            value, own = _way(space, ends, carrier, k)
            places, turns = places + ends, [*turns, carrier]
        constants += own
        values.append(value)
    return element("planar_" * planar + f"couple_{first}_{second}",
                   f"{MEANINGS[first]} and {MEANINGS[second]} of two joints in a ratio", space,
                   (*places, *turns), constants, memory=memory,
                   constraints=[values[0] - ratio.symbols[0] * values[1]])


def _angle(space: Space, blocks: list[Block], k: int) -> tuple[sp.Expr, list[Constant]]:
    """Angle of the first block against the second, zero at the start."""
    a, b = blocks
    if space.planar:
        rest = constant(space, f"rest{k}", "scalar", "angle that counts as none [rad]")
        return a.angle - b.angle - rest.symbols[0], [rest]
    vectors = turn_vectors(space, str(k))
    d, n, m = (one.symbols for one in vectors)
    seen = b.state.symbols.T * a.state.symbols * d
    return near_angle(sp.atan2(m.dot(seen), n.dot(seen)), kept(f"angle_{k}")), vectors


def _way(space: Space, ends: list[Block], carrier: Block, k: int
         ) -> tuple[sp.Expr, list[Constant]]:
    """Way of the second end along an axis that turns with the first, less that at the start."""
    e = constant(space, f"e{k}", "vector", "axis of the way, in axes of its first body")
    start = constant(space, f"start{k}", "scalar", "way at the start [length]")
    gap = ends[1].state.symbols - ends[0].state.symbols
    way = (carrier.state.symbols * e.symbols).dot(gap)
    return way - start.symbols[0], [e, start]
