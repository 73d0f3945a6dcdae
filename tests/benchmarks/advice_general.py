"""Eleven more scenes for `advise`, as engineers bring them: in general position, none tuned on.

Damped, preloaded, spinning, with rigid parts, with the default division of `Model.beam`, of 3 to
30 bodies, unequal, turned and shifted, some in other units.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from sebody import Model, harmonic, rest_to_rest

sys.path.insert(0, str(Path(__file__).parent))
from advice_place import ALUMINIUM, Place
from advice_scenes import GRAVITY, AdviceScene

SHORT = {"elements": 8, "bodies": 1}


def slack_rope() -> Model:
    """Twelve unequal, damped links between a winch and a hook, let go from a bow."""
    place = Place.plane(0.35, 1.0, -2.0)
    model = place.model(0.0, -GRAVITY)
    last = model.node("winch", place.point(0.0, 0.0))
    model.fix(last, "position")
    x = np.array([0.0, 0.0])
    for k in range(12):
        x = x + (0.2 + 0.02 * (k % 3)) * np.array([np.cos(0.1 * k - 1.2), np.sin(0.1 * k - 1.2)])
        end = model.node("hook" if k == 11 else f"pin {k + 1}", place.point(*x))
        model.beam(f"link {k + 1}", (last, end), place.bar(0.006 + 0.001 * (k % 2), 0.02),
                   modes=2, damping=0.02, **SHORT)
        if k < 11:
            last = model.node(f"begin {k + 2}", end.point, at=end)
            last = model.nodes[f"begin {k + 2}"]
    model.point_mass("load", "hook", 3.0)
    return model


def gust_on_a_mast() -> Model:
    """A mast of the default division under a heavy head; a gust after it has come to rest."""
    place = Place.space(17, 0.4, 3.0, -1.0)
    model = place.model(0.3, 0.0, -GRAVITY)
    foot, head = (model.node(name, place.point(*at)) for name, at in (
        ("foot", (0, 0, 0)), ("head", (0.1, 0.05, 2.4))))
    model.beam("mast", (foot, head), place.bar(0.03, 0.05, ALUMINIUM), elements=24,
               up=place.turned(0, 1, 0), damping=0.02)
    J = place.rotation @ np.diag((0.3, 0.2, 0.25)) @ place.rotation.T
    model.rigid_body("nacelle", head, 6.0, J, place.point(0.15, 0.05, 2.45))
    model.fix(foot)
    model.force(head, place.force(12.0, -5.0, 0.0), [(0, 0), (0.2, 1.0), (0.5, 0.3), (0.8, 0.0)])
    return model


def spinning_blade() -> Model:
    """A slender blade on a rigid hub that spins at nearly twice its first frequency; a gust."""
    place = Place.space(4, 0.0, 0.0, 0.0, length=1e3, mass=1e-3)
    model = place.model()
    hub, tip = (model.node(name, place.point(*at)) for name, at in (
        ("hub", (0, 0, 0)), ("tip", (1.7, 0.0, 0.0))))
    root = model.attach("root", place.point(0.2, 0, 0), to=hub)
    model.rigid_body("boss", hub, 4.0 * place.mass, 0.1 * place.mass * place.length**2 * np.eye(3))
    model.beam("blade", (root, tip), place.bar(0.012, 0.08, ALUMINIUM), elements=24, bodies=1,
               modes=4, up=place.turned(0, 0, 1), damping=0.01)
    model.fix(hub, "position")
    model.move(hub, place.turned(0, 0, 1), lambda t: 40.0 * t, "rotation")
    model.rigid_velocity(np.zeros(3), place.turned(0, 0, 40.0), about=hub.point)
    model.force(tip, place.force(0.0, 0.0, 6.0), [(0, 0), (0.05, 1.0), (0.15, 0.2), (0.3, 0.0)])
    return model


def gripper() -> Model:
    """Three links with rigid ends on servo joints, of unequal stoutness, in mm and t."""
    place = Place.space(29, 1.0, 1.0, 0.2, length=1e3, mass=1e-3)
    model = place.model(0.0, 0.0, -GRAVITY)
    points = [(0, 0, 0), (0.1, 0, 0.5), (0.55, 0.1, 0.6), (0.8, 0.0, 0.35)]
    base = model.node("base", place.point(*points[0]))
    model.fix(base)
    last, unit = base, place.mass * place.length**2
    for k, height in enumerate((0.05, 0.03, 0.018)):
        start = model.node(f"servo {k + 1}", place.point(*points[k]), at=last if k else None)
        start = model.nodes[f"servo {k + 1}"]
        end = model.node("grip" if k == 2 else f"end {k + 1}", place.point(*points[k + 1]))
        axis = place.turned(0, 0, 1) if k == 0 else place.turned(0.1, 1, 0)
        if k == 0:
            model.revolute(start, axis, to=base, name="joint 1")
        else:
            model.revolute(start, axis, to=last, name=f"joint {k + 1}")
        model.torsion_spring(start, 4e3 * unit / (k + 1), 20.0 * unit / (k + 1), axis, to=last,
                             name=f"drive {k + 1}")
        model.beam(f"arm {k + 1}", (start, end), place.bar(height, 0.03, ALUMINIUM), elements=16,
                   bodies=1, modes=2, damping=0.02)
        model.rigid_body(f"block {k + 1}", end, 0.8 * place.mass / (k + 1), 1e-3 * unit * np.eye(3))
        last = end
    model.force("grip", place.force(5.0, -20.0, 8.0), [(0, 0), (0.1, 1.0), (0.3, -0.5), (0.4, 0)])
    return model


def tower_frame() -> Model:
    """A plane tower of fifteen unequal, welded bars, shaken at its feet."""
    place = Place.plane(-0.5, 4.0, -6.0)
    model = place.model()
    levels, bars = 4, 0
    for k in range(levels):
        for side, x in (("left", 0.1 * k), ("right", 2.0 - 0.15 * k)):
            model.node(f"{side} {k}", place.point(x, 1.2 * k))
    for k in range(levels - 1):
        for one, other, height in (("left", "left", 0.05), ("right", "right", 0.045),
                                   ("left", "right", 0.03), ("right", "left", 0.03)):
            bars += 1
            model.beam(f"bar {bars}", (f"{one} {k}", f"{other} {k + 1}"),
                       place.bar(height, 0.04), modes=2, damping=0.02, **SHORT)
        bars += 1
        model.beam(f"bar {bars}", (f"left {k + 1}", f"right {k + 1}"), place.bar(0.03, 0.04),
                   modes=2, damping=0.02, **SHORT)
    for foot in ("left 0", "right 0"):
        model.fix(foot)
    for k, top in enumerate(("left 3", "right 3")):
        model.point_mass(f"tank {k}", top, 40.0 + 15.0 * k)
    model.force("left 3", place.force(3000.0, 400.0), [(0, 0), (0.05, 1.0), (0.12, -0.7), (0.2, 0)])
    return model


def suspension() -> Model:
    """Two unequal arms and an upright on a spring with damper, which a road lifts."""
    place = Place.plane(0.12, -1.0, 2.0)
    model = place.model(0.0, -GRAVITY)
    unit = place.mass
    for name, at in (("lower mount", (0, 0)), ("upper mount", (0.1, 0.3)),
                     ("spring mount", (0.2, 0.55)), ("wheel", (0.48, 0.1))):
        model.node(name, place.point(*at))
    for name, at in (("lower ball", (0.42, -0.03)), ("upper ball", (0.4, 0.28))):
        model.node(name, place.point(*at))
        model.node(f"{name} end", place.point(*at), at=name)
    model.node("seat", place.point(0.25, -0.02))
    for name, ends, height in (("lower inner", ("lower mount", "seat"), 0.03),
                               ("lower outer", ("seat", "lower ball"), 0.028),
                               ("upper arm", ("upper mount", "upper ball"), 0.018),
                               ("upright low", ("lower ball end", "wheel"), 0.035),
                               ("upright high", ("wheel", "upper ball end"), 0.03)):
        model.beam(name, ends, place.bar(height, 0.03), modes=2, damping=0.02, **SHORT)
    for foot in ("lower mount", "upper mount"):
        model.fix(foot, "position")
    model.fix("spring mount")
    model.rigid_body("hub", "wheel", 18.0 * unit, 0.4)
    model.spring("seat", "spring mount", place.stiffness(6e4), place.stiffness(2500.0),
                 name="strut")
    road = model.node("road", place.point(0.48, -0.2), keeps="translation")
    model.move(road, place.turned(0, 1), rest_to_rest(0.05, 0.15))
    model.spring(road, "wheel", place.stiffness(1.8e5), place.stiffness(300.0), name="tyre")
    return model


def scissor_lift() -> Model:
    """Two stages of crossed beams of unequal height on pins, that a drive pushes together."""
    place = Place.plane(0.05, 0.0, 0.0, length=1e3, mass=1e-3)
    model = place.model(0.0, -GRAVITY)
    half, rise = 0.4, 0.25

    def joined(name: str, x: float, y: float, to: str | None = None) -> str:
        model.node(name, place.point(x, y), at=to)
        return name
    below = (joined("foot", 0, 0), joined("slide", 2 * half, 0))
    model.fix("foot", "position")
    for k in range(2):
        y = 2 * rise * k
        middle = joined(f"pin {k}", half, y + rise)
        other = joined(f"hole {k}", half, y + rise, middle)
        ends = (joined(f"left {k}", 0, y + 2 * rise), joined(f"right {k}", 2 * half, y + 2 * rise))
        starts = below if k == 0 else (joined("left begin", 0, y, below[0]),
                                       joined("right begin", 2 * half, y, below[1]))
        for name, one, mid, end in ((f"rising {k}", starts[0], middle, ends[1]),
                                    (f"falling {k}", starts[1], other, ends[0])):
            section = place.bar(0.05 - 0.01 * k, 0.02, ALUMINIUM)
            model.beam(f"{name} low", (one, mid), section, modes=2, damping=0.02, **SHORT)
            model.beam(f"{name} high", (mid, end), section, modes=2, damping=0.02, **SHORT)
        below = ends
    guide = joined("guide", 2 * half, 0.0)
    model.fix(guide)
    model.slider("slide", place.turned(1, 0), to=guide, name="rail")
    model.drive_slide("slide", rest_to_rest(0.1 * place.length, 0.8), place.turned(1, 0),
                      to=guide, name="ram")
    model.point_mass("pallet", "left 1", 15.0 * place.mass)
    model.point_mass("crate", "right 1", 25.0 * place.mass)
    return model


def satellite() -> Model:
    """A free hub with two unequal panels of three beams each on springs, turned by a wheel."""
    place = Place.space(41, 7.0, -3.0, 2.0)
    model = place.model()
    hub = model.node("hub", place.point(0, 0, 0))
    J = place.rotation @ np.diag((30.0, 20.0, 25.0)) @ place.rotation.T
    model.rigid_body("bus", hub, 120.0, J, place.point(0.05, -0.02, 0.1))
    for side, sign, height in (("east", 1.0, 0.012), ("west", -1.0, 0.009)):
        last = model.attach(f"{side} mount", place.point(sign * 0.5, 0, 0), to=hub)
        for k in range(3):
            start = model.node(f"{side} hinge {k}", last.point, at=last)
            start = model.nodes[f"{side} hinge {k}"]
            end = model.node(f"{side} tip" if k == 2 else f"{side} end {k}",
                             place.point(sign * (1.3 + 0.8 * k), 0.02 * k, 0.0))
            axis = place.turned(0, 1, 0)
            model.revolute(start, axis, to=last, name=f"{side} line {k}")
            model.torsion_spring(start, 60.0 - 10.0 * k, 0.5, axis, to=last,
                                 name=f"{side} latch {k}")
            model.beam(f"{side} panel {k}", (start, end), place.bar(height, 0.3, ALUMINIUM),
                       up=place.turned(0, 0, 1), modes=2, damping=0.01, **SHORT)
            last = end
    model.torque(hub, place.moment(2.0, 30.0, 8.0), [(0, 0), (0.2, 1.0), (0.8, 1.0), (1.0, -1.0),
                                                     (1.6, -1.0), (1.8, 0.0)])
    return model


def crank_press() -> Model:
    """A crank, a damped rod of the default division and a slide, which meets a short load."""
    place = Place.plane(1.1, 0.3, 0.7)
    model = place.model()
    for name, at in (("shaft", (0, 0)), ("crank pin", (0.1, 0.12)), ("slide", (0.75, 0.0))):
        model.node(name, place.point(*at))
    model.node("rod end", place.point(0.1, 0.12), at="crank pin")
    model.node("rail", place.point(0.75, 0.0))
    model.fix("rail"), model.fix("shaft", "position")
    model.beam("rod", ("rod end", "slide"), place.bar(0.02, 0.025), elements=16, damping=0.03)
    model.beam("crank", ("shaft", "crank pin"), place.bar(0.05, 0.03), modes=2, **SHORT)
    model.slider("slide", place.turned(1, 0), to="rail", name="guide")
    model.point_mass("ram", "slide", 6.0)
    model.move("shaft", 1.0, rest_to_rest(-4.0, 0.5), "rotation")
    model.force("slide", place.force(-800.0, 0.0), [(0, 0), (0.3, 0), (0.32, 1.0), (0.36, 0.0)])
    return model


def loaded_column() -> Model:
    """A column under half of its buckling load, at rest, pushed aside in two directions."""
    place = Place.space(11, 0.0, 2.0, 5.0)
    model = place.model()
    foot, top = (model.node(name, place.point(*at)) for name, at in (
        ("foot", (0, 0, 0)), ("top", (0.0, 0.0, 1.5))))
    modulus, height, width = 7e10, 0.02, 0.03
    model.beam("column", (foot, top), place.bar(height, width, ALUMINIUM), elements=24, bodies=2,
               modes=2, up=place.turned(1, 0, 0), damping=0.01)
    model.point_mass("cap", top, 4.0)
    model.fix(foot)
    euler = np.pi**2 * modulus * width * height**3 / 12.0 / (2.0 * 1.5)**2
    model.force(top, place.force(0.0, 0.0, -0.5 * euler), name="dead load")
    model.force(top, place.force(4.0, 7.0, 0.0), harmonic(1.0, 9.0), name="shaking")
    return model


def chain_of_thirty() -> Model:
    """Thirty equal links that swing down in space."""
    place = Place.space(2, 1.0, 2.0, 3.0)
    model = place.model(0.0, 0.0, -GRAVITY)
    last = model.node("top", place.point(0, 0, 0))
    model.fix(last, "position")
    for k in range(30):
        end = model.node("end" if k == 29 else f"joint {k}",
                         place.point(0.1 * (k + 1), 0.02 * (k + 1), 0.0))
        model.beam(f"link {k + 1}", (last, end), place.bar(0.01, 0.01), modes=2, damping=0.01,
                   **SHORT)
        if k < 29:
            model.node(f"begin {k + 1}", end.point, at=end)
            last = model.nodes[f"begin {k + 1}"]
    return model


GENERAL: Sequence[AdviceScene] = (
    AdviceScene("slack rope", "twelve unequal links", slack_rope, 0.005, 0.5,
                ("hook.position",), False, exact=16),
    AdviceScene("gust on a mast", "a preloaded beam of the default division", gust_on_a_mast, 0.01,
                1.2, ("head.position", "foot.reaction_moment"), False, start="equilibrium"),
    AdviceScene("spinning blade", "stresses of a spin, a rigid hub", spinning_blade, 0.002, 0.4,
                ("tip.position.z", "tip.velocity"), False),
    AdviceScene("gripper", "unequal links, rigid blocks, servo joints", gripper, 0.005, 0.6,
                ("grip.position",), False, start="equilibrium", exact=16),
    AdviceScene("tower frame", "fifteen welded bars", tower_frame, 0.002, 0.4,
                ("left 3.position", "right 3.velocity rms"), False, exact=12),
    AdviceScene("suspension", "stout arms on soft springs", suspension, 0.005, 0.5,
                ("wheel.position", "strut.force"), False, start="equilibrium", exact=16),
    AdviceScene("scissor lift", "eight beams in closed loops", scissor_lift, 0.01, 0.8,
                ("left 1.position", "ram.force rms"), False, start="equilibrium", exact=16),
    AdviceScene("satellite", "six panels on a free body", satellite, 0.02, 2.0,
                ("east tip.position", "hub.position"), False, exact=16),
    AdviceScene("crank press", "a rod of the default division in a closed loop", crank_press,
                0.002, 0.5, ("slide.position", "crank pin.velocity"), False),
    AdviceScene("loaded column", "a preload that softens", loaded_column, 0.01, 1.0,
                ("top.position",), False, start="equilibrium"),
    AdviceScene("chain of thirty", "thirty equal links", chain_of_thirty, 0.005, 0.4,
                ("end.position",), False, exact=16),
)
