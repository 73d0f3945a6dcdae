"""Couplings without elasticity: a ratio of two coordinates of joints, angles or ways.

``phi = f_1 c_1 + f_2 c_2 = 0``, with one of the factors 1: gears are two angles, a rack and a
pinion an angle and a way, a screw the angle and the way of one cylindrical joint, pulleys two ways.
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

TURN, SLIDE = "turn", "slide"
PAIRS = (TURN, TURN), (TURN, SLIDE), (SLIDE, SLIDE)
MEANINGS = {TURN: "angle", SLIDE: "way"}


def couple(first: str, second: str, planar: bool) -> Element:
    """Derive the coupling of two coordinates; angles count turns from step to step."""
    space, places, turns = Space(planar), [], []
    constants: list[Constant] = []
    memory: list[tuple[str, sp.Expr]] = []
    phi = sp.S.Zero
    for k, (what, names) in enumerate(((first, "ab"), (second, "cd")), 1):
        factor = constant(space, f"f{k}", "scalar", f"factor of the {MEANINGS[what]} {k}")
        constants.append(factor)
        if what == TURN:
            blocks = [rotation(space, name) for name in names]
            turns += blocks
            value, own = _angle(space, blocks, k)
            if not planar:
                memory.append((f"angle_{k}", value))
        else:
            ends, carrier = [position(space, name) for name in names], rotation(space, names[0])
            places, turns = places + ends, [*turns, carrier]
            value, own = _way(space, ends, carrier, k)
        constants += own
        phi += factor.symbols[0] * value
    return element("planar_" * planar + f"couple_{first}_{second}",
                   f"{MEANINGS[first]} and {MEANINGS[second]} of two joints in a ratio", space,
                   (*places, *turns), constants, constraints=[phi], memory=memory)


def _angle(space: Space, blocks: list[Block], k: int) -> tuple[sp.Expr, list[Constant]]:
    """Angle of the first block against the second, zero at the start."""
    a, b = blocks
    if space.planar:
        return a.angle - b.angle, []
    n = constant(space, f"n{k}", "vector", "direction normal to the axis of the angle, body a")
    m = constant(space, f"m{k}", "vector", "direction normal to both, body b")
    seen = b.state.symbols.T * a.state.symbols * n.symbols
    measured = sp.atan2(m.symbols.dot(seen), n.symbols.dot(seen))
    return near_angle(measured, kept(f"angle_{k}")), [n, m]


def _way(space: Space, ends: list[Block], carrier: Block, k: int
         ) -> tuple[sp.Expr, list[Constant]]:
    """Way of the second end along an axis that turns with the first, less that at the start."""
    e = constant(space, f"e{k}", "vector", "axis of the way, in axes of its first body")
    start = constant(space, f"start{k}", "scalar", "way at the start [length]")
    gap = ends[1].state.symbols - ends[0].state.symbols
    way = (carrier.state.symbols * e.symbols).dot(gap)
    return way - start.symbols[0], [e, start]
