"""Twelve scenes for `advise`, fixed before anybody tuned it: what each needs is known beforehand.

Half of them, with `tuning`, may be looked at while the search is improved; the other half only
measures it. All are in general position: turned, shifted, some in other units.
"""

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sebody import Model, harmonic, rest_to_rest, trapezoidal
from sebody.fem import Section, hexahedral_block, planar_beam
from sebody.reduction import RigidFace, craig_bampton

sys.path.insert(0, str(Path(__file__).parent))
from advice_place import ALUMINIUM, Place

GRAVITY = 9.81


@dataclass(frozen=True)
class AdviceScene:
    """A model with what is asked of it; `build` makes it anew.

    Parameters
    ----------
    name : str
    shows : str
        What it is meant to show, in a sentence.
    build : callable
        Makes the model as a user would; the reference model follows from it.
    h, t_end : float
        Usual step and end [s].
    quantities : tuple of str
        What is to be kept.
    tuning : bool
        Whether the search may be tuned on it; the others are held back.
    start : str, optional
        As of `advise`.
    exact : int
        Bodies of each beam in the model that is taken for the truth.
    """

    name: str
    shows: str
    build: Callable[[], Model]
    h: float
    t_end: float
    quantities: tuple[str, ...]
    tuning: bool
    start: str | None = None
    exact: int = 24


def stout_four_bar() -> Model:
    """A four-bar of thick steel bars, a crank that makes less than half a turn in a second."""
    place = Place.plane(0.7, 0.2, -0.4, length=1e3, mass=1e-3)
    model = place.model()
    thick = place.bar(0.03, 0.03)
    for name, at in (("D", (0.55, 0.0)), ("C", (0.6, 0.45)), ("A", (0.0, 0.0)), ("B", (0.1, 0.3))):
        model.node(name, place.point(*at))
    model.node("rocker end", place.point(0.6, 0.45))
    model.node("coupler begin", place.point(0.1, 0.3), at="B")
    for name, ends in (("rocker", ("D", "rocker end")), ("crank", ("A", "B")),
                       ("coupler", ("coupler begin", "C"))):
        model.beam(name, ends, thick, elements=24, bodies=1, modes=4, damping=0.05)
    model.revolute("C", to="rocker end", explicit=True)     # so that all parts may be rigid
    for foot in "AD":
        model.fix(foot, "position")
    model.move("A", 1.0, rest_to_rest(-1.2, 1.0), "rotation")
    return model


def arm_in_a_plane() -> Model:
    """Two slender links on parallel axes, which swing in a plane of space."""
    place = Place.space(3, 1.0, 2.0, -0.5)
    model, axis = place.model(-2.0, -GRAVITY, 0.0), place.turned(0, 0, 1)
    shoulder = model.node("shoulder", place.point(0.0, 0.0, 0.0))
    elbow = model.node("elbow", place.point(0.6, -0.4, 0.0))
    wrist = model.node("wrist", elbow.point, at=elbow)
    tip = model.node("tip", place.point(1.1, 0.1, 0.0))
    for name, ends, height in (("upper", (shoulder, elbow), 0.012), ("lower", (wrist, tip), 0.008)):
        model.beam(name, ends, place.bar(height, 0.02, ALUMINIUM), elements=24, bodies=1, modes=4,
                   up=place.turned(0, 0, 1))
    model.point_mass("load", tip, 0.3 * place.mass)
    model.revolute(shoulder, axis, name="shoulder joint")
    model.revolute(elbow, axis, to=wrist, name="elbow joint")
    model.torque(shoulder, place.moment(0, 0, 6.0), [(0, 0), (0.2, 1.0), (0.6, -0.5), (0.8, 0)])
    return model


def struck_cantilever() -> Model:
    """A clamped FE beam with sixteen modes, struck at its end for a millisecond."""
    place = Place.plane(-0.6, 0.3, 0.1)
    model = place.model()
    root, tip = model.node("root", place.point(0, 0)), model.node("tip", place.point(0.9, 0.25))
    fe_model = planar_beam(root.point, tip.point, place.bar(0.02, 0.03), 32)
    body = craig_bampton(fe_model, [(0, "full"), (32, "full")], 16).damped(0.01)
    model.superelement("beam", body, [root, tip])
    model.fix(root)
    model.force(tip, place.force(-30.0, 120.0), [(0, 0), (5e-4, 1.0), (1e-3, 0)])
    return model


def bent_strip() -> Model:
    """A strip of spring steel that a force and gravity bend by more than a radian."""
    place = Place.space(8, -1.0, 0.5, 3.0, length=1e3, mass=1e-3)
    model = place.model(0.0, 0.0, -GRAVITY)
    tip = model.node("tip", place.point(0.9, 0.0, 0.1))
    root = model.node("root", place.point(0.0, 0.0, 0.0))
    model.beam("strip", (root, tip), place.bar(0.0015, 0.02), elements=24, bodies=1, modes=4,
               up=place.turned(-0.1, 0, 0.9), damping=0.02)
    model.fix(root)
    model.force(tip, place.force(-0.3, 0.2, 2.5), [(0, 0), (0.8, 1.0), (1.5, 1.0), (2.0, 0.4)])
    return model


def spun_up_arm() -> Model:
    """Simo and Vu-Quoc's arm, turned from rest to rest in six seconds, at most by 6 rad/s."""
    place = Place.plane(1.9, -3.0, 2.0, length=1e3, mass=1e-3)
    model = place.model()
    tip, root = model.node("tip", place.point(10.0, 0.0)), model.node("root", place.point(0, 0))
    unit = place.mass / place.length
    section = Section(area=place.length**2, inertia_y=5e-4 * place.length**4,
                      inertia_z=5e-4 * place.length**4, torsion=1e-3 * place.length**4,
                      youngs_modulus=2.8e7 * unit, poisson_ratio=0.3,
                      density=1.2 * unit / place.length**2, shear_factor=1e7 / (2.8e7 / 2.6))
    model.beam("arm", (root, tip), section, elements=24, bodies=1, modes=4)
    model.fix(root, "position")
    model.move(root, 1.0, rest_to_rest(19.0, 6.0), "rotation")
    return model


def stiff_drives() -> Model:
    """Two stout links on stiff elastic drives, whose motors follow profiles with corners."""
    place = Place.plane(0.25, 5.0, 1.0)
    model = place.model()
    for name, at, on in (("motor", (0, 0), None), ("shoulder", (0, 0), "motor"),
                         ("elbow", (0.5, 0.2), None), ("gear", (0.5, 0.2), "elbow"),
                         ("wrist", (0.5, 0.2), "elbow"), ("tip", (0.9, -0.1), None)):
        model.node(name, place.point(*at), at=on)
    for name, ends, height in (("forearm", ("wrist", "tip"), 0.03),
                               ("arm", ("shoulder", "elbow"), 0.05)):
        model.beam(name, ends, place.bar(height, 0.03), elements=24, bodies=1, modes=3)
    model.rigid_body("gear", "gear", 0.4, 4e-3)
    model.point_mass("tool", "tip", 1.5)
    model.fix("motor", "position")
    model.move("motor", 1.0, trapezoidal(0.9, 2.0, 12.0), "rotation")
    model.drive_angle("gear", trapezoidal(-1.2, 3.0, 20.0, start=0.1), to="elbow",
                      name="elbow axis")
    for spring, node, to, k in (("shoulder spring", "shoulder", "motor", 1e5),
                                ("elbow spring", "wrist", "gear", 3e4)):
        model.torsion_spring(node, k, damping=5e-4 * k, to=to, name=spring)
    return model


def struck_pendulum() -> Model:
    """A slender pendulum that swings for six seconds and is struck once, for four milliseconds."""
    place = Place.plane(2.4, 0.0, -7.0)
    model = place.model(1.0, -GRAVITY)
    bob, pivot = model.node("bob", place.point(0.5, -0.9)), model.node("pivot", place.point(0, 0))
    model.beam("rod", (pivot, bob), place.bar(0.012, 0.02), elements=24, bodies=1, modes=6,
               damping=0.02)
    model.point_mass("bob weight", bob, 0.5)
    model.fix(pivot, "position")
    model.force(bob, place.force(250.0, 90.0), [(0, 0), (3.1, 0), (3.102, 1), (3.104, 0)])
    return model


def five_beams() -> Model:
    """A portal frame of five unequal beams, which a force at its ridge shakes near resonance."""
    place = Place.plane(-0.15, 2.0, 9.0, length=1e3, mass=1e-3)
    model = place.model()
    for name, at in (("ridge", (2.1, 4.4)), ("left foot", (0, 0)), ("left", (0.1, 3.0)),
                     ("right", (4.2, 2.8)), ("right foot", (4.0, 0))):
        model.node(name, place.point(*at))
    sections = {"column": place.bar(0.1, 0.06), "rafter": place.bar(0.08, 0.05)}
    for name, kind, ends in (
            ("tie", "rafter", ("left", "right")), ("left column", "column", ("left foot", "left")),
            ("left rafter", "rafter", ("left", "ridge")),
            ("right rafter", "rafter", ("right", "ridge")),
            ("right column", "column", ("right", "right foot"))):
        model.beam(name, ends, sections[kind], elements=24, bodies=1, modes=2, damping=0.03)
    for foot in ("right foot", "left foot"):
        model.fix(foot)
    model.force("ridge", place.force(900.0, -300.0), harmonic(1.0, 34.0))
    return model


def solid_lever() -> Model:
    """A lever of hexahedra with twelve stored modes, turned by a drive and let swing."""
    place = Place.space(21, 0.4, -0.2, 0.9)
    block = hexahedral_block((0.0, -0.02, -0.03), (0.8, 0.04, 0.06), (10, 1, 2), *ALUMINIUM)
    faces = [(RigidFace((x, 0.0, 0.0), np.flatnonzero(abs(block.coordinates[:, 0] - x) < 1e-9)),
              "full") for x in (0.0, 0.8)]
    model = place.model()
    end, hub = model.node("end", place.point(0.8, 0, 0)), model.node("hub", place.point(0, 0, 0))
    model.superelement("lever", craig_bampton(block, faces, 12).damped(0.03), [hub, end],
                       rotation=place.rotation)
    model.rigid_body("load", end, 1.5, place.rotation @ np.diag((4e-3, 2e-3, 3e-3))
                     @ place.rotation.T, place.point(0.83, 0.05, 0.0))
    model.fix(hub, "position")
    model.move(hub, place.turned(0.0, 0.3, 1.0) / np.hypot(0.3, 1.0), rest_to_rest(1.6, 0.25),
               "rotation")
    return model


def jib_on_a_mast() -> Model:
    """A stout mast that a torque turns, and a slender jib with a weight welded on it."""
    place = Place.space(5, -2.0, 1.0, 0.0, length=1e3, mass=1e-3)
    model = place.model(0.0, 0.0, -GRAVITY)
    tip = model.node("tip", place.point(1.3, 0.4, 1.2))
    foot = model.node("foot", place.point(0.0, 0.0, 0.0))
    top = model.node("top", place.point(0.0, 0.0, 0.8))
    model.beam("jib", (top, tip), place.bar(0.03, 0.02), elements=24, bodies=1, modes=4)
    model.beam("mast", (foot, top), place.bar(0.12, 0.12), elements=24, bodies=1, modes=4)
    model.point_mass("weight", tip, 2.0 * place.mass)
    model.revolute(foot, place.turned(0, 0, 1), name="slewing ring")
    model.torque(foot, place.moment(0, 0, 25.0),
                 [(0, 0), (0.1, 1.0), (0.5, 1.0), (0.6, -1.0), (1, 0)])
    return model


def hanging_chain() -> Model:
    """Four flexible links on ball joints, let go from a bent, oblique position."""
    place = Place.space(13, 0.0, 4.0, -1.0)
    model = place.model(0.0, 0.0, -GRAVITY)
    points = np.array([[0, 0, 0], [0.45, 0.05, -0.1], [0.8, 0.3, -0.15], [1.1, 0.35, -0.5],
                       [1.6, 0.3, -0.6]])
    last = model.node("top", place.point(*points[0]))
    model.fix(last, "position")
    for k, (point, height) in enumerate(zip(points[1:], (0.008, 0.006, 0.006, 0.004), strict=True)):
        end = model.node("tip" if k == 3 else f"joint {k + 1}", place.point(*point))
        model.beam(f"link {k + 1}", (last, end), place.bar(height, 0.02), elements=24, bodies=1,
                   modes=2, damping=0.01)
        if k < 3:
            last = model.node(f"begin {k + 2}", end.point, at=end)
    return model


def unbalanced_rotor() -> Model:
    """A shaft with an eccentric disc on elastic bearings, spinning below its first critical."""
    place = Place.space(34, 0.1, 0.2, 0.3)
    model, speed = place.model(0.0, -GRAVITY, 0.0), 150.0
    nodes = [model.node(name, place.point(0, 0, z)) for name, z in (
        ("right", 0.9), ("disc", 0.4), ("left", 0.0))]
    right, disc, left = nodes
    shaft = place.bar(0.022, 0.022)
    model.beam("short half", (left, disc), shaft, elements=24, bodies=1, modes=4)
    model.beam("long half", (disc, right), shaft, elements=24, bodies=1, modes=4)
    J = place.rotation @ np.diag((0.02, 0.02, 0.04)) @ place.rotation.T
    model.rigid_body("wheel", disc, 8.0, J, place.point(5e-4, 0.0, 0.4))
    for bearing in (left, right):
        housing = model.node(f"{bearing.name} housing", bearing.point)
        model.fix(housing)
        model.bushing(housing, to=bearing, stiffness=2e6, damping=800.0,
                      name=f"{bearing.name} bearing")
    model.rigid_velocity(np.zeros(3), place.turned(0, 0, speed), about=left.point)
    return model


SCENES: Sequence[AdviceScene] = (
    AdviceScene("stout four-bar", "bodies all rigid are enough",
                stout_four_bar, 0.01, 1.0, ("C.position", "C.velocity"), True),
    AdviceScene("arm in a plane", "a spatial model whose motion stays in a plane",
                arm_in_a_plane, 0.005, 1.0, ("tip.position", "tip.velocity"), False),
    AdviceScene("struck cantilever", "a body needs many of its modes",
                struck_cantilever, 5e-6, 0.03, ("tip.velocity", "root.reaction_moment"), True),
    AdviceScene("bent strip", "a member bends so far that it must be divided",
                bent_strip, 0.005, 2.0, ("tip.position",), False),
    AdviceScene("spun-up arm", "stresses must stiffen what spins",
                spun_up_arm, 0.01, 8.0, ("tip.position",), True),
    AdviceScene("stiff drives", "stiff joint drives set the step, the links may be rigid",
                stiff_drives, 2.5e-4, 0.8, ("tip.position", "elbow spring.moment"), False),
    AdviceScene("struck pendulum", "long quiet motion with one impact wants variable steps",
                struck_pendulum, 0.002, 6.0, ("bob.position",), True),
    AdviceScene("five beams", "a frame of five beams, and its first frequency",
                five_beams, 0.001, 0.8,
                ("ridge.position", "left foot.reaction_moment", "frequency 1"), False),
    AdviceScene("solid lever", "a solid from an FE program, which cannot be divided",
                solid_lever, 2.5e-4, 0.6, ("end.position", "hub.reaction_moment"), True),
    AdviceScene("jib on a mast", "one of two bodies may be rigid",
                jib_on_a_mast, 0.01, 1.2, ("tip.position",), True),
    AdviceScene("hanging chain", "a pendulum of four links under gravity",
                hanging_chain, 0.005, 1.0, ("tip.position",), False),
    AdviceScene("unbalanced rotor", "a rotor whirls in its bearings",
                unbalanced_rotor, 2.5e-4, 0.25, ("disc.position", "right bearing.force"), False),
)
