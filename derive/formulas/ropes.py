"""Ropes over points and sheaves: lengths between them, and the law of the rope.

A rope consists of stretches of one tension. Each has an unknown of its own, its length s between
the places where its material is held, with the equation

    sum_spans lambda - s = 0

whose multiplier is the tension, and the law of the rope as an energy of s. A span leads from one
point or circle to the next. With d from centre to centre, radii r with the sign of the side on
which the rope passes, ``D = r_b - r_a`` and ``l^2 = d . d - D^2`` the rope leaves circle a and
meets circle b in the direction of the angle ``gamma = arg d - atan2(D, l)``, and

    lambda = l + r_a gamma_a - r_b gamma_b

counts the arcs up to rays that are fixed in the nodes of the circles, from which gamma is measured;
its variation is that of the distance of the two points of contact along the rope.

A sheave that holds the rope parts two stretches. What they have wound on it are the lengths w of
`grip`, so that the angle of contact is ``alpha + (w_1 + w_2) / r``, and the rope on it has turned
by theta. With friction this is an angle of its own, and `friction_rope` acts between both.
"""

import sympy as sp

from sebody.derive.form.spaces import Space
from sebody.derive.formulas.elements import (
    Block,
    Constant,
    Element,
    amplitude,
    choose,
    constant,
    element,
    in_time,
    kept,
    near_angle,
    position,
    rotation,
    varied,
)
from sebody.derive.formulas.frictions import BRISTLE
from sebody.derive.formulas.law_elements import Forces, Measures, law_element
from sebody.derive.formulas.laws import Bristle, friction
from sebody.derive.symbolic.rotations import cross
from sebody.derive.symbolic.variation import differential

SOFT = sp.Float(0.25)       # of a grip's trial force, relative to the rope's: else iterations go to
                            # and fro between both directions of sliding
SPANS = "line", "end", "span"       # by the number of sheaves at their ends


def span(planar: bool, sheaves: int) -> Element:
    """Length of a rope from a to b, of which none, the first or both are sheaves."""
    space = Space(planar)
    places = [position(space, name) for name in "ab"]
    turns = [rotation(space, name) for name in "ab"[:sheaves]]
    d = places[1].state.symbols - places[0].state.symbols
    radii = [constant(space, f"r_{name}", "scalar", f"radius of sheave {name}, negative where "
                      "the rope passes it clockwise") for name in "ab"[:sheaves]]
    r = [one.symbols[0] for one in radii] + [sp.S.Zero] * (2 - sheaves)
    straight = sp.sqrt(d.dot(d) - (r[1] - r[0])**2)
    own, memory, length = [], [], straight
    for k, (name, turn) in enumerate(zip("ab", turns, strict=False)):
        angle, axes = _direction(space, name, turn, d, r[1] - r[0], straight)
        counted = constant(space, f"arc_{name}", "scalar", f"1 if the arc on {name} is of this "
                           "stretch, 0 if the sheave holds the rope")
        own += [counted, *axes]
        memory.append((f"angle_{name}", angle))
        length += (1 - 2 * k) * counted.symbols[0] * r[k] * angle
    arc = constant(space, "arc", "scalar", "length of arcs at the start [length]")
    return element("planar_" * planar + f"rope_{SPANS[sheaves]}",
                   "a rope's length from one point or sheave to the next", space,
                   (*places, *turns), (*radii, *own, arc),
                   constraints=[length + arc.symbols[0]], memory=memory)


def grip(planar: bool) -> Element:
    """Rope w that a sheave a has taken up, held on it: ``r_a gamma_a - turn theta - w = 0``.

    The sheave turns by theta relative to its node.
    """
    space = Space(planar)
    a, b, turn = position(space, "a"), position(space, "b"), rotation(space, "a")
    taken, angle = amplitude(space, "w"), amplitude(space, "t")
    d = b.state.symbols - a.state.symbols
    radii = [constant(space, f"r_{name}", "scalar", "radius with sign") for name in "ab"]
    by = constant(space, "turn", "scalar", "rope that the sheave gives in a turn by one radian")
    r = [one.symbols[0] for one in radii]
    straight = sp.sqrt(d.dot(d) - (r[1] - r[0])**2)
    gamma, axes = _direction(space, "a", turn, d, r[1] - r[0], straight)
    return element("planar_" * planar + "rope_grip", "rope that a sheave takes up", space,
                   (a, b, taken, angle, turn), (*radii, by, *axes),
                   constraints=[r[0] * gamma - by.symbols[0] * angle.state.symbols[0]
                                - taken.state.symbols[0]],
                   memory=[("angle_a", gamma)])


def wheel(planar: bool) -> Element:
    """Inertia of a sheave that turns by theta about the axis n of its node.

    ``T = J (Omega . n + theta')^2 / 2``
    """
    space = Space(planar)
    angle, turn = amplitude(space, "t"), rotation(space, "a")
    inertia = constant(space, "inertia", "scalar", "moment of inertia about the axis")
    axis = constant(space, "n", "axial", "axis, in axes of the node")
    spin = angle.rate.symbols[0] + axis.symbols.dot(turn.rate.symbols)
    return element("planar_" * planar + "rope_wheel", "inertia of a sheave", space, (angle, turn),
                   (inertia, axis), kinetic=inertia.symbols[0] * spin**2 / 2)


def friction_rope(planar: bool) -> Element:
    """Friction of a rope on a sheave: of tensions T at both sides, of which one is

        max T = e^(mu alpha) min T

    where it slips, and less where it sticks. With the slip ``u = r (p - t)`` of the rope, which
    turns by p, on the sheave, which turns by t,

        T_2 - T_1 = F,  |F| <= (e^(mu alpha) - 1) min T

    by `laws.friction`. So a rope that is slack on one side is slack on both. To keep its place then
    the equation has, in place of tensions, what would press it in a rope that pushes: the parts of
    ``E A e / m`` and ``(E A e + c e') / m`` that are negative, which are equal on both sides.

    The bristles of the law are no springs here: their trial force is ``T_2 - T_1`` and what resists
    the slip of the step, so where it is the force the rope does not slip.

    What is wound is without force, see `rope`: from there material comes with the multipliers of
    the grips, ``P = T + E A e^2 / (2 m^2)``. So the force on the slip is ``P_2 - P_1``, and its
    work includes the energy that is lost by what slips to less tension.
    """
    space = Space(planar)
    blocks = [amplitude(space, name) for name in ("p", "t", "s1", "w1", "v1", "s2", "w2", "v2")]
    (own, sheave), sides = blocks[:2], (blocks[2:5], blocks[5:])
    meanings = {
        "along": "radius, negative where a positive turn takes the rope to its first end",
        "arm": "radius of the sheave [length]", "wrap": "angle of contact at the start",
        "axial": "E A [force]", "axial_damping": "c [force time]",
        "settling": "time in which a slip ends where the rope sticks",
        **{f"{what}_{side}": meaning for side in (1, 2) for what, meaning in (
            ("material", "of the stretch on this side at the start [length]"),
            ("given", "material by what the unknown of its far end has become"))}}
    of = {name: constant(space, name, "scalar", meaning) for name, meaning in meanings.items()}
    along, radius, wrap, stiffness, damping, settling = (
        one.symbols[0] for one in list(of.values())[:6])
    measures = Measures(blocks)
    u = measures.add("way", along * (own.state.symbols[0] - sheave.state.symbols[0]))
    speed = along * (own.rate.symbols[0] - sheave.rate.symbols[0])
    rate = measures.add("way_rate", speed)
    angle = measures.add("contact", wrap + sum(
        side[1].state.symbols[0] for side in sides) / radius)
    elastic, whole, materials = [], [], []
    for k, (length, near, far) in enumerate(sides, 1):
        material = (of[f"material_{k}"].symbols[0] - near.state.symbols[0]
                    + of[f"given_{k}"].symbols[0] * far.state.symbols[0])
        materials.append(measures.add(f"free_{k}", material))
        stretched = length.state.symbols[0] - material
        elastic.append(measures.add(f"elastic_{k}", stiffness * stretched / material))
        whole.append(measures.add(f"whole_{k}", (
            stiffness * stretched + damping * measures.rate(stretched)) / material))
    multipliers = sp.symbols("tension_1:3 passed_1:3")
    constants = [constant(space, name, "scalar", BRISTLE[name]) for name in (
        "coefficient", "static", "speed")]
    mu, mu_static, smooth = (one.symbols[0] for one in constants)
    pulls, presses = sp.symbols("pull_1:3"), sp.symbols("presses_1:3")
    dynamic, static, difference, increment, slip, passed = sp.symbols(
        "dynamic_share static_share difference increment slip passed")
    held, brake = (one / sum(materials) for one in (
        SOFT * stiffness, damping + settling * stiffness))
    law = friction([increment], [slip], presses, Bristle(held, brake, dynamic, static, smooth))
    touching = choose(angle, angle, sp.S.Zero)
    slack = [sum(choose(one, sp.S.Zero, one) for one in both)
             for both in zip(elastic, whole, strict=True)]
    stages = (
        (*zip(pulls, (T + t for T, t in zip(multipliers, slack, strict=False)), strict=True),
         (dynamic, sp.exp(mu * touching) - 1), (static, sp.exp(mu_static * touching) - 1),
         (slip, rate)),
        (*((one, choose(pull, pull, sp.S.Zero)) for one, pull in zip(presses, pulls, strict=True)),
         (difference, pulls[1] - pulls[0])),
        ((increment, u - kept("way") + difference / held - kept("bent")),),
        *law.stages,
        ((passed, law.forces[0] + (multipliers[3] - multipliers[2]) - difference),))
    least = choose(presses[0] - presses[1], presses[1], presses[0])
    return law_element(
        "planar_" * planar + "friction_rope", "friction of a rope on a sheave", space, measures,
        [*constants, *of.values()], stages, Forces((speed,), (passed,), (passed,)),
        [("way", u), *law.memory, ("normal", least)], reads=multipliers)


def _direction(space: Space, name: str, turn: Block, d: sp.Matrix, D: sp.Expr, straight: sp.Expr
               ) -> tuple[sp.Expr, list[Constant]]:
    """Angle of a rope's direction from a ray of a sheave, and the axes it is measured in."""
    axes = [constant(space, f"e1_{name}", "vector", "ray, in axes of the node")]
    first = axes[0].symbols
    if space.planar:
        second = cross(sp.Matrix([0, 0, 1]), first)
    else:
        axes.append(constant(space, f"e2_{name}", "vector", "axis of the sheave x ray"))
        second = axes[1].symbols
    seen = turn.state.symbols.T * d
    angle = sp.atan2(second.dot(seen), first.dot(seen)) - sp.atan2(D, straight)
    return near_angle(angle, kept(f"angle_{name}")), axes


def rope(planar: bool) -> Element:
    """The law of a stretch of rope, whose multiplier is its tension.

    With the material m between its ends, ``e = s - m``, ``T = (E A e + F) / m`` where ``e > 0``,
    with the energy ``E A e^2 / (2 m)``; slack it is free of force. The damping ``F = c e'`` is
    limited to the elastic part, so that a rope never pushes, and its force is continuous where it
    becomes taut. The material is that of the start, and what sheaves or a winch at its ends have
    given since then.
    """
    space = Space(planar)
    meanings = {"stiffness": "E A [force]", "damping": "c [force time]",
                "material": "material at the start [length]",
                "given_a": "material by what the unknown of the first end has become",
                "given_b": "and of that of the other end"}
    constants = [constant(space, name, "scalar", meaning) for name, meaning in meanings.items()]
    stiffness, damping, start, by_a, by_b = (one.symbols[0] for one in constants)
    blocks = [amplitude(space, name) for name in ("s", "wa", "wb")]
    s, a, b = (one.state.symbols[0] for one in blocks)
    material = start + by_a * a + by_b * b
    e = s - material
    elastic, viscous = stiffness * e, damping * differential(e, in_time(blocks))
    taut, above, below = (choose(one, sp.Float(1.0), sp.Float(0.0)) for one in (
        e, viscous - elastic, -viscous - elastic))
    limited = (above - below) * elastic + (1 - above) * (1 - below) * viscous
    return element("planar_" * planar + "rope", "law of a rope", space, blocks,
                   constants, constraints=[-s],
                   strain=taut * stiffness * e**2 / (2 * material),
                   load=-taut * limited / material * differential(e, varied(blocks)))
