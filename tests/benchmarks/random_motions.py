"""Sixty random models in general position: thirty with joints by equations, ten each free of
these, with friction or contacts, and with controllers.

Every model is scaled, rotated and shifted at random, with random masses, stiffnesses and rates.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sebody import Model, plane
from sebody.control import pid
from sebody.fem import Section, circle

COUNT = 60


@dataclass
class Place:
    """Random numbers of a model, and its position, orientation and scale."""

    seed: int
    rng: np.random.Generator = field(init=False)

    def __post_init__(self) -> None:
        rng = self.rng = np.random.default_rng(7000 + self.seed)
        self.length = 10.0**rng.uniform(-1.0, 0.7)
        self.axes = Rotation.random(random_state=self.seed).as_matrix()
        self.offset = rng.uniform(-2.0, 2.0, 3) * self.length
        self.gravity = 9.81 * self.length
        self.time = rng.uniform(1.5, 3.0)
        radius = self.length * rng.uniform(0.01, 0.03)
        density = rng.uniform(1000.0, 8000.0)
        self.section: Section = circle(radius, 10.0**rng.uniform(9.5, 11.3) * self.length, 0.3,
                                       density)
        self.mass = density * np.pi * radius**2 * self.length

    def point(self, *x: float) -> NDArray:
        """A point given in lengths of the model."""
        return self.axes @ (np.array(x) * self.length) + self.offset

    def along(self, *x: float) -> NDArray:
        """A direction."""
        return self.axes @ np.array(x, dtype=float)

    def any_direction(self) -> NDArray:
        """A random direction."""
        vector = self.rng.normal(size=3)
        return vector / np.linalg.norm(vector)

    def inertia(self, *moments: float) -> NDArray:
        """A tensor with these moments, in masses times square lengths."""
        return self.axes @ np.diag(moments) @ self.axes.T * self.mass * self.length**2

    def model(self, *gravity: float) -> Model:
        """An empty model; gravity in lengths a second."""
        model = Model()
        if gravity:
            model.gravity(self.along(*gravity) * self.gravity)
        return model


def four_bar(at: Place) -> Model:
    """Three hinges by equations, the coupler bends; redundant in space."""
    model = at.model(0.3, -1.0, 0.0)
    A, B, C, D = (at.point(*x) for x in ((0, 0, 0), (0.4, 0.3, 0), (1.2, 0.5, 0), (1.0, 0, 0)))
    axis = at.along(0, 0, 1)
    crank, coupler, end, rocker = (model.node(name, point) for name, point in (
        ("crank", A), ("coupler", B), ("end", C), ("rocker", D)))
    model.revolute(crank, axis)
    model.revolute(rocker, axis)
    model.rigid_body("crank body", crank, at.mass, at.inertia(0.02, 0.02, 0.02), centre=(A + B) / 2)
    model.rigid_body("rocker body", rocker, at.mass, at.inertia(0.02, 0.02, 0.02),
                     centre=(C + D) / 2)
    model.beam("beam", (coupler, end), at.section, 10, 1, 4)
    model.revolute(coupler, axis, to=model.attach("crank end", B, crank), explicit=True)
    model.revolute(end, axis, to=model.attach("rocker end", C, rocker), explicit=True)
    model.torque(crank, axis, [(0, 0), (0.5 * at.time, 0.4 * at.mass * at.gravity * at.length),
                               (at.time, 0)])
    return model


def slider_crank(at: Place) -> Model:
    """Driven crank, a rod that bends, a slider."""
    model = at.model(0.0, -0.2, 0.0)
    axis = at.along(0, 0, 1)
    crank, rod, end = (model.node(name, at.point(*x)) for name, x in (
        ("crank", (0, 0, 0)), ("rod", (0.3, 0, 0)), ("end", (1.2, 0.1, 0))))
    model.drive_angle(crank, [(0, 0), (0.2 * at.time, 0.2), (0.6 * at.time, at.rng.uniform(2, 5)),
                              (at.time, 6)], axis=axis)
    model.revolute(crank, axis)
    model.rigid_body("crank body", crank, at.mass, at.inertia(0.02, 0.02, 0.02),
                     centre=at.point(0.15, 0, 0))
    model.beam("beam", (rod, end), at.section, 10, 1, 4)
    model.revolute(rod, axis, to=model.attach("pin", at.point(0.3, 0, 0), crank), explicit=True)
    model.slider(end, at.along(1, 0, 0))
    model.point_mass("piston", end, at.mass)
    return model


def two_hinges(at: Place) -> Model:
    """A double pendulum on skew hinges by equations; its first part bends."""
    model = at.model(0.0, 0.7, -0.7)
    top, elbow, second = (model.node(name, at.point(*x)) for name, x in (
        ("top", (0, 0, 0)), ("elbow", (1, 0, 0)), ("second", (1, 0, 0))))
    model.revolute(top, at.any_direction(), explicit=True)
    model.beam("beam", (top, elbow), at.section, 10, 1, 4)
    model.revolute(second, at.any_direction(), to=elbow, explicit=True)
    model.rigid_body("end", second, 1.5 * at.mass, at.inertia(0.02, 0.1, 0.11),
                     centre=at.point(1.4, 0.3, 0.1))
    return model


def light_rod(at: Place) -> Model:
    """Two arms on skew hinges, coupled by a light rod between ball joints."""
    model = at.model(0.0, -0.3, -1.0)
    a, b = model.node("a", at.point(0, 0, 0)), model.node("b", at.point(1.1, 0.2, 0.1))
    for arm, axis, centre in ((a, at.along(0, 0, 1), (0.1, 0.2, 0)),
                              (b, at.along(0.2, 1, 0.3), (1.2, 0.2, 0.3))):
        model.revolute(arm, axis)
        model.rigid_body(f"{arm.name} body", arm, at.mass * at.rng.uniform(0.5, 2.0),
                         at.inertia(0.02, 0.03, 0.04), centre=at.point(*centre))
    A, B = at.point(0.2, 0.4, 0), at.point(1.3, 0.3, 0.6)
    rod = model.node("rod", (A + B) / 2)
    model.rigid_body("light", rod, 0.02 * at.mass, at.inertia(1e-4, 2e-4, 3e-4))
    for name, point, arm in (("first ball", A, a), ("second ball", B, b)):
        model.spherical(model.attach(f"{name} of the arm", point, arm),
                        to=model.attach(f"{name} of the rod", point, rod))
    model.initial_velocity(a, angular=at.along(0, 0, at.rng.uniform(1.0, 3.0)))
    return model


def top_by_equations(at: Place) -> Model:
    """A heavy top that spins fast on a spherical joint."""
    model = at.model(0.0, 0.0, -1.0)
    foot = model.node("foot", at.point(0, 0, 0))
    model.rigid_body("top", foot, at.mass, at.inertia(0.3, 0.31, 0.12) * 0.3,
                     centre=at.point(0.1, 0, 0.5))
    model.spherical(foot)
    model.initial_velocity(foot, angular=at.axes @ (
        (0, 0, at.rng.uniform(8.0, 20.0)) + at.rng.normal(size=3)))
    return model


def links(at: Place) -> Model:
    """Three rigid links on parallel hinges by equations, with springs, thrown."""
    model, axis = at.model(0.2, -1.0, 0.0), at.along(0, 0, 1)
    before = None
    for k in range(3):
        node = model.node(f"hinge {k}", at.point(0.5 * k, 0.1 * k, 0))
        model.revolute(node, axis, explicit=True, name=f"pin {k}", **(
            {} if before is None else {"to": before}))
        model.rigid_body(f"link {k}", node, at.mass * at.rng.uniform(0.3, 1.5),
                         at.inertia(0.01, 0.02, 0.03),
                         centre=at.point(0.5 * k + 0.25, 0.1 * k + 0.05, 0))
        model.torsion_spring(node, 0.2 * at.mass * at.gravity * at.length, axis=axis, to=before,
                             name=f"spring {k}")
        before = model.attach(f"end {k}", at.point(0.5 * k + 0.5, 0.1 * k + 0.1, 0), node)
    return model


def dry_hinge(at: Place) -> Model:
    """A pendulum whose hinge sticks and slides, pushed to and fro."""
    model, axis = at.model(0.0, -1.0, 0.1), at.along(0, 0, 1)
    node = model.node("pin", at.point(0, 0, 0))
    model.rigid_body("bob", node, at.mass, at.inertia(0.1, 0.1, 0.12), centre=at.point(0.6, 0.2, 0))
    model.revolute(node, axis, name="hinge")
    model.friction("hinge", at.rng.uniform(0.1, 0.3), static=0.4, radius=0.2 * at.length)
    rate, size = at.rng.uniform(1.5, 3.0), float(0.5 * at.mass * at.gravity * at.length)
    model.torque(node, axis, lambda t, size=size, rate=float(rate): size * np.sin(rate * t))
    return model


def bouncing(at: Place) -> Model:
    """A pendulum that falls on a plane and bounces."""
    model = at.model(0.0, -1.0, 0.0)
    node = model.node("pin", at.point(0, 0, 0))
    model.rigid_body("bob", node, at.mass, at.inertia(0.1, 0.1, 0.12), centre=at.point(0.6, 0.1, 0))
    model.revolute(node, at.along(0, 0, 1))
    ball = model.attach("ball", at.point(0.9, 0.1, 0), node)
    model.contact(ball, on=plane(at.along(0, 1, 0.2), point=at.point(0.7, -0.6, 0)),
                  radius=0.05 * at.length, stiffness=1e4 * at.mass * at.gravity / at.length**1.5,
                  restitution=at.rng.uniform(0.3, 0.7), at_speed=at.length)
    return model


def controlled(at: Place) -> Model:
    """A flexible arm that a motor turns, by a sampled or a continuous controller."""
    model, axis = at.model(0.0, -0.3, 0.0), at.along(0, 0, 1)
    hub, tip = model.node("hub", at.point(0, 0, 0)), model.node("tip", at.point(1, 0, 0))
    model.beam("beam", (hub, tip), at.section, 12, 1, 2)
    model.rigid_body("rotor", hub, at.mass, at.inertia(0.1, 0.1, 0.1))
    model.revolute(hub, axis, name="hinge")
    model.actuator("motor", joint="hinge")
    stiff = at.mass * at.length**2 * at.rng.uniform(5.0, 15.0)
    law = pid(stiff, kd=0.1 * stiff, filter=50.0, reference=at.rng.uniform(0.3, 1.0))
    period = () if at.seed % 2 else (at.time / 100,)
    model.controller("loop", law, ["hinge.angle"], ["motor"], *period)
    return model


def swinging_beam(at: Place) -> Model:
    """A beam on a ball joint, with a mass and a spring at its end."""
    model = at.model(0.0, 0.0, -1.0)
    a, b = model.node("a", at.point(0, 0, 0)), model.node("b", at.point(1, 0, 0))
    anchor = model.node("anchor", at.point(0.2, 0.9, 0.3), keeps="translation")
    model.fix(a, "position")
    model.fix(anchor, "position")
    model.beam("beam", (a, b), at.section, 12, 1, 4)
    model.point_mass("bob", b, at.mass * at.rng.uniform(0.2, 2.0))
    model.spring(anchor, b, 20.0 * at.mass, 0.3 * at.mass, length=0.4 * at.length)
    return model


def free_bar(at: Place) -> Model:
    """A bar that flies and is struck."""
    model = at.model()
    a, b = model.node("a", at.point(0, 0, 0)), model.node("b", at.point(1, 0, 0))
    model.beam("beam", (a, b), at.section, 12, 1, 6)
    model.rigid_velocity(at.rng.normal(size=3) * 0.3 * at.length, at.rng.normal(size=3) * 2.0,
                         about=at.point(0.5, 0, 0))
    model.force(b, at.any_direction(), [(0.3 * at.time, 0), (0.35 * at.time, at.mass * at.gravity),
                                        (0.4 * at.time, 0)])
    return model


# five models of each, and ten of the last but two: see `build`
KINDS: tuple[Callable[[Place], Model], ...] = (
    four_bar, slider_crank, two_hinges, light_rod, top_by_equations, links, dry_hinge, bouncing,
    controlled, controlled, swinging_beam, free_bar)


def build(seed: int) -> tuple[str, Model, float]:
    """Kind, model and end of the run, of a number below `COUNT`."""
    at, kind = Place(seed), KINDS[seed // 5]
    return kind.__name__, kind(at), at.time
