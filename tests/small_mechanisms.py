"""Mechanisms of few flexible bodies, written with the public interface alone."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from sebody import Model
from sebody.catalogue import builder
from sebody.fem import straight_beam
from sebody.reduction import craig_bampton
from sebody.scenes import chain

AXES = (0.0, 0.6, 0.8), (0.0, -0.6, 0.8), (0.0, 0.8, 0.6), (0.6, 0.0, 0.8), (0.0, 0.0, 1.0)
PLANE = (0.0, 0.0, 1.0)


def beam(a, b, wide: float = 1.0):
    """A beam with four modes; its section is that of the chain, so many times as wide and high."""
    of = chain.SECTION
    section = replace(of, area=of.area * wide**2, inertia_y=of.inertia_y * wide**4,
                      inertia_z=of.inertia_z * wide**4, torsion=of.torsion * wide**4)
    return craig_bampton(straight_beam(np.array(a, float), np.array(b, float), section, 10),
                         [(0, "full"), (10, "full")], 4)


def links(count: int, inertia: str | None = None) -> Model:
    """Equal links on parallel hinges."""
    return chain.build(links=count, inertia=inertia).model


def hinged(bodies: list, axes) -> Model:
    """Bodies in a row, each of a length, on hinges about some axes."""
    model, at = Model(), 0.0
    model.gravity((0.0, -9.81, 3.0))
    last = model.node("base", np.zeros(3))
    model.revolute(last, axis=axes[0])
    for k, (body, length) in enumerate(bodies):
        at += length
        end = model.node(f"end {k}", (at, 0.0, 0.0))
        model.superelement(f"link {k}", body, [last, end])
        if k < len(bodies) - 1:
            last = model.node(f"begin {k}", end.point, at=end)
            model.revolute(end, axes[(k + 1) % len(axes)], to=last)
    return model


def skew(count: int) -> Model:
    """Equal links on hinges that are not parallel: a motion in space."""
    return hinged([(chain.link_body(4), 1.0)] * count, AXES)


def unequal() -> Model:
    """Five links, each shorter and slimmer than the one before."""
    bodies, at = [], 0.0
    for k in range(5):
        length = 1.0 - 0.08 * k
        bodies.append((beam((at, 0, 0), (at + length, 0, 0), 1.3 - 0.12 * k), length))
        at += length
    return hinged(bodies, [PLANE])


def four_bar() -> Model:
    """Crank, coupler and rocker in space, moved by a torque."""
    model = Model()
    model.gravity((0.0, -9.81, 0.0))
    points = [np.array(p, float) for p in ((0, 0, 0), (0, 0.5, 0), (1.2, 0.9, 0), (1.4, 0, 0))]
    first = last = model.node("begin 0", points[0])
    model.revolute(last, axis=PLANE)
    for k in range(3):
        end = model.node(f"end {k}", points[k + 1])
        model.superelement(f"link {k}", beam(points[k], points[k + 1]), [last, end])
        if k < 2:
            last = model.node(f"begin {k + 1}", points[k + 1], at=end)
            model.revolute(end, PLANE, to=last)
    model.revolute(end, axis=PLANE)
    for node in (end, first):
        model.fix(node, "position")
    model.torque(first, PLANE, lambda t: 20.0 * np.sin(3.0 * t))
    return model


def arm() -> Model:
    """Six joints with springs and dampers in place of motors; two links are flexible."""
    model, joints = Model(), []
    model.gravity((0.0, 0.0, -9.81))

    def joint(node, axis, to, stiffness):
        model.revolute(node, axis, to=to)
        joints.append((to, axis, node, stiffness))

    base = model.node("base", (0.0, 0.0, 0.0))
    model.fix(base, "position")
    model.revolute(base, axis=PLANE)
    model.torsion_spring(base, 400.0, 20.0, axis=PLANE)
    model.rigid_body("turret", base, 20.0, np.diag([0.3, 0.3, 0.3]))
    shoulder = model.node("shoulder", (0.0, 0.0, 0.0), at=base)
    joint(base, (0.0, 1.0, 0.0), shoulder, 900.0)
    elbow = model.node("elbow", (1.0, 0.0, 0.0))
    model.superelement("upper", beam((0, 0, 0), (1, 0, 0)), [shoulder, elbow])
    below = model.node("below", (1.0, 0.0, 0.0), at=elbow)
    joint(elbow, (0.0, 1.0, 0.0), below, 500.0)
    last = model.node("wrist", (2.0, 0.0, 0.0))
    model.superelement("lower", beam((1, 0, 0), (2, 0, 0)), [below, last])
    for name, axis, mass in (("roll", (1.0, 0.0, 0.0), 0.5), ("pitch", (0.0, 1.0, 0.0), 0.5),
                             ("spin", PLANE, 1.0)):
        node = model.node(name, (2.0, 0.0, 0.0), at=last)
        joint(last, axis, node, 30.0)
        model.rigid_body(f"of {name}", node, mass, np.diag([0.02, 0.02, 0.02]) * mass)
        last = node
    for to, axis, node, stiffness in joints:
        model.torsion_spring(to, stiffness, 0.04 * stiffness, axis=axis, to=node)
    model.torque(base, PLANE, lambda t: 100.0 * np.sin(4.0 * t))
    model.torque(last, (0.0, 1.0, 0.0), lambda t: 5.0 * np.sin(11.0 * t))
    return model


def scene(name: str, steps: int, **parameters) -> tuple[Model, float, int]:
    """Model, step and number of steps of a shipped scene."""
    built = builder(name)(**parameters)
    return built.model, built.h, min(steps, round(built.t_end / built.h))


# name: what gives model, step, number of steps
MECHANISMS: dict[str, Callable[[], tuple[Model, float, int]]] = {
    **{f"{n} links": (lambda n=n: (links(n), 0.01, 100)) for n in (*range(2, 11), 16)},
    **{f"{n} links, fine": (lambda n=n: (links(n), 0.002, 500)) for n in (2, 4)},
    **{f"{n} links, b": (lambda n=n: (links(n, "b"), 0.01, 100)) for n in (2, 4, 6)},
    **{f"{n} skew links": (lambda n=n: (skew(n), 0.005, 200)) for n in (3, 5)},
    "5 unequal links": lambda: (unequal(), 0.005, 200),
    "four-bar in space": lambda: (four_bar(), 0.002, 500),
    "arm": lambda: (arm(), 0.002, 500),
    "slider-crank": lambda: scene("slider-crank", 1000),
    "slider-crank, 4 bodies": lambda: (*scene("slider-crank", 1000, bodies=4)[:1], 2e-5, 1000),
    **{name: (lambda name=name: scene(name, 1500)) for name in (
        "hinged-beam", "planar-hinged-beam", "spherical-beam", "flexible-arm")},
}
