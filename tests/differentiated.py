"""Scenes in general position for gradients, and Richardson differences of their runs."""

from functools import cache

import numpy as np
from scipy.spatial.transform import Rotation

from sebody import Model, plane
from sebody.analysis import Ensemble, gradient
from sebody.control import pid
from sebody.fem import Section, rectangle, straight_beam
from sebody.gradients.parameters import columns_of
from sebody.model import profiles
from sebody.reduction import craig_bampton
from sebody.runs.schemes import generalized_alpha

TURN = Rotation.from_rotvec((0.4, -0.9, 0.3)).as_matrix()
SHIFT = np.array([3.0, -1.0, 2.0])
X, Y, Z = TURN.T                                            # axes of the scenes
EXACT = generalized_alpha(tolerance=1e-13)
STEPS = 1, -1, 2, -2, 3, -3
WEIGHTS = np.array([45, -45, -9, 9, 1, -1]) / 60           # of differences of the sixth order


def place(*point):
    return SHIFT + TURN @ np.array(point)


@cache
def slender(modes=3, length=1.0, height=0.03, planar=False, wind=False):
    """A beam along the first axis of the scenes, with two full interfaces."""
    section = rectangle(height, 0.02, 2e9, 0.3, 1200.0)
    a, b = (np.zeros(2), np.array([length, 0.0])) if planar else (
        place(0, 0, 0), place(length, 0, 0))
    fe = straight_beam(a, b, section, 6) if not planar else straight_beam(
        np.zeros(3), np.array([length, 0.0, 0.0]), section, 6)
    loads = {}
    if wind:
        load = np.zeros((7, 6))
        load[:, :3] = 0.3 * Y + 0.2 * Z
        loads = {"wind": load.ravel()}
    more = {"loads": loads} if wind else {}
    return craig_bampton(fe, [(0, "full"), (6, "full")], modes, **more)


def hinged(inertia=None, frame="converged_mean", **others):
    """A flexible beam on a turned hinge with a torque, a damper and a spring to the ground."""
    m = Model()
    m.gravity(-9.81 * Y)
    base, tip = m.node("base", place(0, 0, 0)), m.node("tip", place(1, 0, 0))
    m.superelement("beam", slender(**others), [base, tip], inertia=inertia, frame=frame)
    m.revolute(base, axis=Z, name="hinge")
    m.torque(base, 3.0 * Z, [(0, 0), (0.1, 1), (0.3, -1), (0.5, 0.2)], name="torque")
    wall = m.node("wall", place(0.4, 1.2, 0.3))
    m.fix(wall)
    m.spring(tip, wall, stiffness=20.0, damping=0.3, length=1.0, name="spring")
    return m


def spinning():
    """The beam with given velocities of a rigid rotation about its hinge."""
    m = hinged()
    m.rigid_velocity(np.zeros(3), 1.5 * Z, about=place(0, 0, 0))
    return m


def four_bar(modes=0, coil=True):
    """Spatial four-bar on four parallel hinges, its coupler flexible where there are modes.

    Three constraints are redundant if it is rigid.
    """
    p = [place(0, 0, 0), place(0, 1, 0), place(2, 1.5, 0), place(2, 0, 0)]
    m = Model()
    m.gravity(-9.81 * Y)

    def rod(name, node, a, b, mass):
        d = np.subtract(b, a)
        e = d / np.linalg.norm(d)
        m.rigid_body(name, node, mass, mass * (d @ d) / 12 * (np.eye(3) - np.outer(e, e))
                     + 1e-3 * mass * np.eye(3), centre=np.add(a, b) / 2)
    a = m.node("a", p[0])
    rod("crank", a, p[0], p[1], 1.0)
    m.revolute(a, axis=Z, name="A")
    b = m.attach("b", p[1], a)
    d = m.node("d", p[3])
    rod("rocker", d, p[3], p[2], 1.5)
    m.revolute(d, axis=Z, name="D")
    c = m.attach("c", p[2], d)
    k1 = m.node("k1", p[1], at="b")
    if modes:
        k2 = m.node("k2", p[2])
        m.beam("coupler", (k1, k2), rectangle(0.05, 0.04, 2.0e9, 0.3, 1000.0), 6, 1, modes)
    else:
        rod("coupler", k1, p[1], p[2], 2.0)
        k2 = m.attach("k2", p[2], k1)
    m.revolute(k1, axis=Z, to=b, name="B")
    m.revolute(k2, axis=Z, to=c, name="C", explicit=not modes)
    if coil:
        m.torsion_spring(a, stiffness=3.0, damping=0.2, axis=Z, name="coil")
    m.torque(d, 2.0 * Z, [(0, 0), (0.3, 1.0), (0.6, 0.0)], name="torque")
    m.initial_velocity(a, angular=2.0 * Z)
    return m


def moved():
    """A beam whose base is moved along a line and turned at once, with a link at its tip."""
    m = Model()
    base, tip = m.node("base", place(0, 0, 0)), m.node("tip", place(1, 0, 0))
    m.superelement("beam", slender(), [base, tip])
    m.move(base, 0.1 * Y, profiles.harmonic(1.0, 7.0), name="shake")
    m.move(base, Z + 0.3 * X, profiles.harmonic(0.4, 5.0), what="rotation", name="swing")
    end = m.attach("end", place(1.2, 0.1, -0.2), tip)
    m.point_mass("ball", end, 0.2)
    m.gravity((0.5, -9.0, 1.0))
    return m


def thrown():
    """A body that is free, with a spring at its node and a point at the end of a rigid link."""
    m = Model()
    m.gravity((0.3, -9.81, 0.2))
    a, wall = m.node("a", place(0.1, 0.2, 0.3)), m.node("wall", place(0.5, 1.0, 0))
    m.rigid_body("top", a, 2.0, TURN @ np.diag([0.2, 0.3, 0.4]) @ TURN.T,
                 centre=place(0.15, 0.2, 0.3))
    m.initial_velocity(a, (1.0, 0.2, 0.0), angular=(5.0, 2.0, -3.0))
    m.fix(wall)
    m.spring(a, wall, stiffness=80.0, damping=0.5, length=0.4, name="spring")
    m.attach("end", place(0.4, 0.5, 0.1), a)
    return m


def driven():
    """A rotor driven by an equation, with a beam on it and a slide with a spring."""
    m = Model()
    hub = m.node("hub", place(0, 0, 0))
    m.rigid_body("rotor", hub, 2.0, np.diag([0.2, 0.3, 0.4]))
    m.revolute(hub, axis=Z, name="bearing")
    m.drive_angle(hub, profiles.rest_to_rest(1.2, 0.6), axis=Z, name="motor")
    tip = m.node("tip", place(1, 0, 0))
    m.superelement("beam", slender(), [hub, tip])
    slide = m.node("slide", place(0, 0, 0.5))
    m.rigid_body("carriage", slide, 0.7, 0.1 * np.eye(3))
    m.prismatic(slide, axis=X, name="rail")
    m.spring(tip, slide, stiffness=30.0, damping=0.5, name="spring")
    m.gravity(-3.0 * X - 9.0 * Y)
    return m


def struck():
    """A double pendulum on links and ball joints; loads jump off the grid, once just before it."""
    m = Model()
    a = m.node("a", place(0, 0, 0))
    m.rigid_body("upper", a, 1.0, np.diag([0.02, 0.3, 0.3]), centre=place(0.5, 0.1, 0))
    m.spherical(a, name="top")
    end = m.attach("end", place(1, 0.2, 0.1), a)
    b = m.node("b", place(1, 0.2, 0.1))
    m.rigid_body("lower", b, 0.6, np.diag([0.2, 0.02, 0.2]), centre=place(1, -0.3, 0))
    m.spherical(b, to=end, name="middle")
    m.gravity(-9.81 * Y)
    m.force(end, 2.0 * Z, [(0.0, 0.5), (0.0833, 0.5), (0.0833, 2.0), (0.31, 1.0)], name="gust")
    m.torque(b, 1.0 * X + 0.5 * Y, [(0.0, 0.0), (0.1089, 1.0), (0.1089, -1.0), (0.4, 0.0)],
             name="kick")
    return m


def blown():
    """A beam under a load of its own body, its base on a bushing."""
    m = Model()
    base, tip = m.node("base", place(0, 0, 0)), m.node("tip", place(1, 0, 0))
    m.superelement("beam", slender(wind=True), [base, tip], inertia="b")
    ground = m.node("ground", place(0, 0, 0))
    m.fix(ground)
    m.bushing(base, ground, stiffness=500.0, damping=2.0, turning_stiffness=40.0,
              turning_damping=0.5, name="bush")
    m.body_load("beam", "wind", [(0, 1), (0.2, 3), (0.5, 0)], name="gale")
    m.gravity(-9.81 * Y)
    return m


def flat():
    """A planar flexible crank with a rod and a slider."""
    m = Model(planar=True)
    section = Section(area=6e-4, inertia_y=4.5e-8, inertia_z=4.5e-8, torsion=1e-8,
                      youngs_modulus=2e9, poisson_ratio=0.3, density=1200.0)
    a, b = m.node("a", (0.2, 0.1)), m.node("b", (0.2, 0.6))
    m.beam("crank", (a, b), section, 4, 1, 2)
    m.revolute(a, name="bearing")
    c, d = m.node("c", (0.2, 0.6), at=b), m.node("d", (1.3, 0.1))
    m.beam("rod", (c, d), section, 6, 1, 3)
    m.point_mass("piston", d, 0.4)
    guide = m.node("guide", (0.0, 0.1))
    m.fix(guide)
    m.distance(d, guide, name="bar")
    m.torque(a, 2.0, [(0, 1), (0.2, -1)], name="torque")
    m.gravity((0.0, -9.81))
    m.initial_velocity(a, angular=-3.0)
    return m


def joined():
    """Bodies on a cylindrical and a universal joint, a spring, and a mass on a rope."""
    m = Model()
    m.gravity(-9.81 * Y + 2 * Z)
    a = m.node("a", place(0, 0, 0))
    m.rigid_body("upper", a, 1.0, np.diag([0.1, 0.2, 0.3]), centre=place(0.3, 0.1, 0))
    m.cylindrical(a, axis=Z + 0.2 * X, name="tube")
    end = m.attach("end", place(0.8, 0.1, 0.1), a)
    b = m.node("b", place(0.8, 0.1, 0.1))
    m.rigid_body("lower", b, 0.7, np.diag([0.1, 0.05, 0.1]), centre=place(0.8, -0.4, 0.1))
    m.universal(b, X, Y, to=end, name="cross")
    wall = m.node("wall", place(0, 0, -1))
    m.fix(wall)
    m.spring(a, wall, stiffness=40, damping=1, name="spring")
    c, d = m.attach("c", place(0.8, -0.9, 0.1), b), m.node("d", place(1.6, -0.9, 0.1))
    m.point_mass("ball", d, 0.4)
    m.fix(d, "rotation")
    m.distance(c, d, name="rope")
    m.torque(b, 0.4 * Z, [(0, 1), (0.2, -1)], name="torque")
    return m


def lifted():
    """A planar beam whose base is moved and turned, with a link at its tip."""
    m = Model(planar=True)
    a, b = m.node("a", (0.1, 0.2)), m.node("b", (1.0, 0.5))
    m.beam("beam", (a, b), rectangle(0.03, 0.02, 2e9, 0.3, 1200.0), 4, 1, 2, damping=0.02)
    m.move(a, (0.03, 0.1), profiles.harmonic(1.0, 6.0), name="lift")
    m.move(a, 1.0, profiles.harmonic(0.5, 5.0), what="rotation", name="swing")
    m.point_mass("ball", m.attach("end", (1.2, 0.3), b), 0.3)
    m.gravity((0.4, -9.0))
    return m


def chain(links):
    """Links on hinges in turned directions, beyond the size of full matrices."""
    m = Model()
    m.gravity(-9.81 * Y)
    body, last = slender(modes=1), m.node("base", place(0, 0, 0))
    m.revolute(last, axis=Z)
    for k in range(links):
        end = m.node("tip" if k == links - 1 else f"joint {k + 1}", place(k + 1.0, 0, 0))
        m.superelement(f"link {k + 1}", body, [last, end])
        if k < links - 1:
            last = m.node(f"base {k + 2}", end.point, at=end)
            m.revolute(end, Z, to=last)
    m.torque("base", 5.0 * Z, [(0, 0), (0.05, 1)], name="torque")
    return m


def journal(**friction):
    """A pendulum with friction in its bearing, pressed by what the hinge carries; a torque jumps.
    """
    m = Model(planar=True)
    m.gravity((0.3, -9.81))
    a = m.node("a", (0.2, 0.1))
    m.rigid_body("bob", a, 1.3, 0.05, centre=(0.8, -0.2))
    m.revolute(a, name="hinge", explicit=True)
    m.friction("hinge", **{"coefficient": 0.3, "radius": 0.04, "name": "dry"} | friction)
    m.initial_velocity(a, angular=2.0)
    m.torque(a, 1.0, [(0, 0.4), (0.033, 1), (0.033, -1), (0.072, 0.5), (0.072, 2), (0.2, 0.5)],
             name="kick")
    return m


def ball():
    """A turning ball on the ground: it bounces, slides and rolls."""
    m = Model()
    m.gravity(-9.81 * Z + 2.0 * X)
    a = m.node("a", place(0.1, 0.2, 0.099))
    m.rigid_body("body", a, 1.2, TURN @ np.diag([4e-3, 5e-3, 6e-3]) @ TURN.T)
    m.initial_velocity(a, 0.5 * X + 0.2 * Y, angular=Y + 2.0 * Z)
    m.contact(a, on=plane(Z, place(0, 0, 0)), radius=0.1, stiffness=1e4, restitution=0.4,
              friction=0.3, name="floor")
    return m


def gears():
    """Two wheels whose teeth have play."""
    m = Model(planar=True)
    for k, (x, inertia, speed) in enumerate(((0.1, 0.02, 3.0), (0.5, 0.05, 0.0))):
        node = m.node(f"n{k}", (x, 0.2))
        m.rigid_body(f"wheel {k}", node, 1.0, inertia)
        m.revolute(node, name=f"shaft {k}")
        m.initial_velocity(node, angular=speed)
    m.gear("shaft 0", "shaft 1", ratio=-2.5, backlash=0.01, name="mesh", stiffness=200.0)
    m.torque("n0", 0.5, [(0, 0.5), (0.1, 1.0), (0.5, -1)], name="motor")
    m.torsion_spring("n1", stiffness=1.0, damping=0.05, name="coil")
    return m


@cache      # compiling a law takes a second
def arm():
    """A flexible arm, moved to an angle by a motor with a rotor."""
    m = Model(planar=True)
    m.gravity((0.4, -9.0))
    hub, tip = m.node("hub", (0.1, 0.2)), m.node("tip", (1.0, 0.5))
    m.beam("beam", (hub, tip), rectangle(0.03, 0.02, 2e9, 0.3, 1200.0), 4, 1, 2)
    m.rigid_body("rotor", hub, 1.0, 0.02)
    m.revolute(hub, name="hinge")
    m.actuator("motor", joint="hinge", inertia=0.01, ratio=3.0)
    m.controller("loop", pid(20.0, 5.0, 2.0, 80.0, 0.7), ["hinge.angle"], ["motor"])
    return m


def differences(model, h, t_end, outputs, parameters, relative=1e-3, scheme=None):
    """Derivatives by differences of the sixth order of runs."""
    ensemble = Ensemble(model, h, scheme or EXACT)
    columns = []
    for column in columns_of(model, parameters):
        base = np.array(column.handle.base, dtype=float)
        step = relative * max(np.abs(base).max(), 1.0)
        values = np.repeat(base[None], 6, axis=0)
        values.reshape(6, -1)[:, column.component] += step * np.array(STEPS)
        found = ensemble.run({column.name: values}, t_end, outputs, threads=1)
        assert not found.failures, found.failures
        values = np.concatenate([found[name].reshape(6, -1) for name in outputs], axis=1)
        columns.append(WEIGHTS @ values / step)
    return np.array(columns).T


def rows(matrix):
    """Largest entry of each row."""
    return np.maximum(np.abs(matrix).max(axis=1, keepdims=True), 1e-300)


def both(model, h, t_end, objectives, parameters):
    """Gradient by both recursions, and how far they differ."""
    one, other = (gradient(model, h, t_end, objectives, parameters, mode, scheme=EXACT)
                  for mode in ("adjoint", "forward"))
    return one, float((np.abs(one.matrix - other.matrix) / rows(other.matrix)).max())
