"""Two beams that are hinged together in general position, under loads of every kind."""

import numpy as np
from scipy.spatial.transform import Rotation

from sebody import Model, harmonic
from sebody.fem import Section, straight_beam
from sebody.reduction import craig_bampton

TURN = Rotation.from_rotvec((0.4, -0.7, 0.5)).as_matrix()
START = np.array([3.0, -2.0, 1.0])
SECTION = Section(area=9.0, inertia_y=6.75, inertia_z=6.75, torsion=11.387, youngs_modulus=2.1e6,
                  poisson_ratio=0.3, density=7.8e-3)
LOAD = np.zeros((7, 6))         # on the nodes of a beam
LOAD[1:, :3] = 200.0 * TURN @ (0.2, 1.0, -0.4)
LOAD[4, 3:] = 900.0 * TURN @ (0.0, 0.3, 1.0)


def at(*place: float) -> np.ndarray:
    """A point of the scene, turned and shifted."""
    return START + TURN @ place


def reduced(first: np.ndarray, last: np.ndarray, modes: int):
    """A beam with a load inside."""
    fe_model = straight_beam(first, last, SECTION, 6)
    wind = np.zeros(fe_model.stiffness.shape[0])
    wind[fe_model.rows] = LOAD
    return craig_bampton(fe_model, [(6, "full"), (0, "full")], modes, loads={"wind": wind})


def rigid_beam(model: Model, name: str, node, first: np.ndarray, last: np.ndarray) -> None:
    """A beam as a rigid body, by the closed forms for a rod with rotary inertia."""
    length = np.linalg.norm(last - first)
    mass = SECTION.density * SECTION.area * length
    rotary = SECTION.density * SECTION.inertia_y * length
    axis = (last - first) / length
    along, across = 2 * rotary, rotary + mass * length**2 / 12
    J = across * np.eye(3) + (along - across) * np.outer(axis, axis)
    model.rigid_body(name, node, mass, J, (first + last) / 2)


def wind(t):
    return 1.0 + 2.0 * t


def drag(t, x, v, force):
    for i in range(3):
        force[i] = -0.3 * v[i]


def linkage(modes: int = 4, options: dict | None = None, rigid: tuple[str, ...] = ()) -> Model:
    """Two beams that are hinged together, with a rigid link, springs and loads of every kind.

    The second body is built first, and nodes do not follow the order of the chain.
    """
    model, a, b, c = Model(), at(0, 0, 0), at(40, 0, 0), at(40, 30, 10)
    base, anchor = model.node("base", a), model.node("anchor", at(45, 10, -20))
    if rigid == ("second",):
        tip = model.node("tip", c)
        elbow2 = model.attach("elbow2", b, tip)
        elbow = model.node("elbow", b, at=elbow2)
    else:
        elbow = model.attach("elbow", b, base) if rigid else model.node("elbow", b)
        elbow2 = model.node("elbow2", b, at=elbow)
        tip = model.attach("tip", c, elbow2) if "second" in rigid else model.node("tip", c)
    if "second" in rigid:
        rigid_beam(model, "second", elbow2, b, c)
    else:
        model.superelement("second", reduced(b, c, 2), [tip, elbow2])
    if "first" in rigid:
        rigid_beam(model, "first", base, a, b)
    else:
        model.superelement("first", reduced(a, b, modes), [elbow, base], **(options or {}))
    hook = model.attach("hook", at(45, 3, 0), elbow)
    model.fix(anchor)
    model.revolute(base, TURN @ (0, 0, 1), name="hinge")
    model.spring(hook, anchor, stiffness=900.0, damping=2.0)
    model.point_mass("weight", hook, 0.8)
    model.torsion_spring(tip, stiffness=300.0, axis=TURN @ (1, 0, 0), to=elbow)
    model.force(tip, TURN @ (30, 80, 10), harmonic(1.0, 12.0))
    model.force(elbow, TURN @ (0, 60, 20), wind, follower=True)
    if "first" in rigid:
        points = np.linspace(a, b, 7)
        moment = LOAD[:, 3:] + np.cross(points - a, LOAD[:, :3])
        model.force(base, LOAD[:, :3].sum(axis=0), wind, follower=True)
        model.torque(base, moment.sum(axis=0), wind, follower=True)
    else:
        model.body_load("first", "wind", wind, name="gale")
    model.user_force("drag", [tip], drag)
    model.gravity(TURN @ (0.0, -9.0, 3.0))
    return model


def slender(bodies: int, elements: int = 8, planar: bool = False) -> Model:
    """A beam between other bodies' nodes, that spins from the start."""
    model = Model(planar=planar)
    d = 2 if planar else 3
    tip, base = model.node("tip", at(70, 5, 0)[:d]), model.node("base", at(0, 0, 0)[:d])
    up = {} if planar else {"up": TURN @ (0, 1, 2)}
    model.beam("rod", (base, tip), SECTION, elements, bodies, modes=2, damping=0.01, **up)
    other = model.node("other", at(70, 40, 0)[:d])
    model.beam("arm", (tip, other), SECTION, 4, 2, **up)
    model.point_mass("weight", other, 0.7)
    model.rigid_velocity(np.zeros(d), 2.0 if planar else TURN @ (0, 0, 2.0), about=base.point)
    model.revolute(base, (0, 0, 1) if planar else TURN @ (0, 0, 1))
    model.gravity((TURN @ (0.0, -9.0, 3.0))[:d])
    return model
