"""Models of which runs are made eight at a time, and their single runs."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from sebody import Model, piecewise, plane, simulate
from sebody.analysis import Ensemble
from sebody.control import pid
from sebody.fem import Section, straight_beam
from sebody.parameters.table import handle
from sebody.reduction import craig_bampton, reduce

TURN = Rotation.from_rotvec((0.4, -0.7, 0.5)).as_matrix()
FOOT = np.array([3.0, -2.0, 1.0])
AXIS = TURN @ (0, 0, 1)
STEP = 1e-3         # of models with controllers
SECTION = Section(area=9.0, inertia_y=6.75, inertia_z=5.1, torsion=11.387, youngs_modulus=2.1e6,
                  poisson_ratio=0.3, density=7.8e-3)


def place(*point: float) -> np.ndarray:
    return FOOT + TURN @ point


def turned_beam() -> Model:
    """A beam on a turned hinge far from the origin, with gravity, a tip mass and a motor."""
    end = np.array([3.0, -2.0, 1.0]) + TURN @ (100.0, 0, 0)
    body = craig_bampton(straight_beam((3.0, -2.0, 1.0), end, SECTION, elements=6),
                         [(0, "full"), (6, "full")], modes=4)
    made = Model()
    base, tip = (made.node(name, point) for name, point in zip(("base", "tip"), body.coordinates,
                                                               strict=True))
    made.superelement("beam", body, [base, tip], inertia="material")
    made.point_mass("weight", tip, 0.5)
    made.gravity((0.0, -3.0, 9.0))
    made.revolute(base, axis=TURN @ (0, 0, 1), name="hinge")
    made.torque(base, TURN @ (0, 0, 1), [(0, 0), (0.01, 9e3), (0.02, 2e3)], name="motor")
    return made


def single(model: Model, values: dict, h: float, t_end: float, scheme=None):
    """The run of a model with some quantities set, by `simulate`."""
    handles = [handle(model, name) for name in values]
    for one, value in zip(handles, values.values(), strict=True):
        one.set(np.asarray(value, dtype=float))
    try:
        return simulate(model, h, t_end, scheme)
    finally:
        for one in handles:
            one.reset()


def linkage(shift: tuple[float, float] = (0.0, 0.0)) -> Model:
    """A planar crank, coupler of option C and rocker in general position, driven by a torque."""
    made = Model(planar=True)

    def at(x: float, y: float) -> tuple[float, float]:
        return x + shift[0], y + shift[1]

    crank = made.node("crank", at(0.3, -0.1))
    made.fix(crank, "position")
    made.rigid_body("wheel", crank, 1.3, 0.05, at(0.35, -0.06))
    pin = made.attach("pin", at(0.55, 0.2), crank)
    foot = made.node("foot", pin.point, at=pin)
    tip = made.node("tip", at(1.6, 0.9))
    section = Section(area=4e-4, inertia_y=1.4e-8, inertia_z=1.4e-8, torsion=2.2e-8,
                      youngs_modulus=7e10, poisson_ratio=0.3, density=2.7e3)
    made.beam("rod", (foot, tip), section, elements=4, bodies=1, modes=2)
    rocker = made.node("rocker", at(1.8, -0.2))
    made.fix(rocker, "position")
    made.rigid_body("arm", rocker, 0.8, 0.09, at(1.7, 0.3))
    made.spherical(made.attach("elbow", tip.point, rocker), tip)
    wall = made.node("wall", at(2.5, 1.5))
    made.fix(wall)
    made.spring(tip, wall, stiffness=30.0, damping=0.4, name="spring")
    made.torque(crank, 1.0, [(0, 0.5), (0.1, 2.0)], name="motor")
    made.gravity((0.4, -9.81))
    return made


def chain(**options) -> Model:
    """Three unequal links on hinges about different axes, created from the tip to the root.

    Their options are those of superelements.
    """
    options = options or {"inertia": "material"}
    made, lengths, nodes = Model(), (40.0, 60.0, 50.0), {}
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    for k in (2, 1, 0):
        ends = place(starts[k], 0, 0), place(starts[k + 1], 0, 0)
        body = craig_bampton(straight_beam(*ends, SECTION, elements=4), [(0, "full"), (4, "full")],
                             modes=4, loads={"wind": np.arange(30.0) % 7.0 - 2.0})
        nodes[k] = [made.node(f"{name} {k}", point)
                    for name, point in zip(("root", "end"), body.coordinates, strict=True)]
        made.superelement(f"link {k}", body, nodes[k], **options)
    for k, axis in enumerate(((0, 0, 1), (0, 0.6, 0.8))):
        made.revolute(nodes[k][1], TURN @ axis, nodes[k + 1][0], name=f"hinge {k}")
    made.revolute(nodes[0][0], axis=TURN @ (0, 1, 0), name="foot")
    made.attach("tip", place(150.0, 1.0, 2.0), nodes[2][1])
    made.force(nodes[2][1], TURN @ (0, 1, 1), [(0, 0), (0.02, 1e4), (0.05, -3e3)], name="load")
    made.gravity((0.0, -400.0, 900.0))
    return made


def beam(modes: int = 4, method: str = "craig-bampton", elements: int = 6) -> Model:
    """A beam on a turned hinge, reduced by some method, whose load has corners."""
    body = reduce(straight_beam(place(0, 0, 0), place(100.0, 0, 0), SECTION, elements),
                  [(0, "full"), (elements, "full")], modes, method)
    made = Model()
    base, tip = (made.node(name, point) for name, point in zip(("base", "tip"), body.coordinates,
                                                               strict=True))
    made.superelement("beam", body, [base, tip], inertia="material")
    made.revolute(base, axis=AXIS, name="hinge")
    made.force(tip, TURN @ (0, 1, 1), [(0, 0), (0.02, 1e4), (0.05, -3e3)], name="load")
    made.gravity((0.0, -400.0, 900.0))
    return made


def twisted() -> Model:
    """A torque twists the beam by a third of a turn: the mean of its nodes is searched for."""
    made = beam()
    made.torque("tip", TURN @ (1, 0, 0), [(0, 0), (0.02, 1.8e5), (0.06, 2.2e5)], name="twist")
    return made


def controlled(made: Model, node: str, joint: str, gain: float, tip: str = "tip",
               axis: ArrayLike = AXIS) -> Model:
    """A slow and noisy sensor, a late one, a motor with a lag and a limit, and a load that jumps.

    The motor of `joint` follows a PID of every third step, which acts late; one without a lag
    turns `node` at every second step, by a signal of the first one's.
    """
    made.sensor("late", f"{joint}.angle", rate=1.0 / (2 * STEP), delay=2, bias=1e-3, noise=1e-4,
                seed=5)
    made.actuator("motor", joint=joint, lag=2.5e-3, rate=400.0 * gain, limit=6.0 * gain)
    made.actuator("wheel", node=node, direction=axis, what="torque")
    made.controller("pid", pid(kp=gain, ki=9.0 * gain, kd=0.02 * gain, reference=0.1),
                    ["late"], ["motor"], 3 * STEP, delay=2 / 3)
    made.controller("damper", pid(kp=0.05 * gain), [f"{tip}.velocity.y"], ["wheel"], 2 * STEP)
    made.torque(node, axis, piecewise((0.0, 0.4 * gain), (0.0217, -gain)), name="jump")
    return made


def flowing(made: Model, node: str, joint: str, gain: float, held: bool = True, tip: str = "tip",
            axis: ArrayLike = AXIS) -> Model:
    """Continuous controllers: a PID of a joint, and a damper with a lag, which also reads a speed.

    It may be that of a sensor with a rate, `held` between samples.
    """
    if held:
        made.sensor("speed", f"{tip}.velocity.y", rate=1.0 / (2 * STEP), noise=1e-3, seed=2)
    made.sensor("biased", f"{joint}.angle", bias=2e-3)
    made.actuator("motor", joint=joint, limit=2.0 * gain)
    made.actuator("wheel", node=node, direction=axis, what="torque")
    made.controller("pid", pid(kp=gain, ki=9.0 * gain, kd=0.02 * gain, reference=0.1), ["biased"],
                    ["motor"])

    def damper(t, y, x, rates, u, parameters):
        rates[0] = (y[0] - x[0]) / 3e-3
        u[0] = -parameters[0] * (x[0] + 1e-3 * y[1] * abs(y[1]))
    read = [f"{tip}.velocity.y", "speed" if held else f"{tip}.velocity.x"]
    made.controller("damper", damper, read, ["wheel"], states=[0.0], parameters=[5e-5 * gain])
    made.torque(node, axis, piecewise((0.0, 0.4 * gain), (0.0217, -gain)), name="jump")
    return made


def pulled(t, x, v, force):
    """A force that grows with the place and brakes."""
    force[0] = -3.0 * x[0] * x[0] - 0.2 * v[0]
    force[1] = -2.0 * x[1] - 0.3 * v[1] * abs(v[1])


def touching_linkage() -> Model:
    """A four-bar with a beam that meets a rough plane and a stop, and whose load jumps."""
    made = linkage()
    made.contact("tip", on=plane((0.1, 1.0), point=(0.0, 1.045)), stiffness=2e5, friction=0.3,
                 name="floor")
    made.stop(("pin", "wall"), upper=2.6, stiffness=1e5, name="buffer")
    made.user_force("air", ["tip"], pulled)
    made.force("tip", (1.0, 0.4), [(0, 0), (0.07, 2.0), (0.07, -6.0), (1.0, 3.0)], name="load")
    return made


def stopped_beam() -> Model:
    """A spatial beam on a turned hinge with a spring that counts turns, between two stops."""
    made = turned_beam()
    made.torsion_spring("base", 2e4, 10.0, axis=TURN @ (0, 0, 1), name="coil")
    made.stop("hinge", lower=-0.015, upper=0.012, stiffness=1e5, restitution=0.5, name="buffer")
    return made


def assert_bits_in_other_company(many: Ensemble, given: dict, t_end: float, outputs: dict,
                                 found) -> None:
    """Runs backwards, and one alone, give the same bits as all of them did."""
    for runs in (slice(None, None, -1), slice(4, 5)):
        other = many.run({name: v[runs] for name, v in given.items()}, t_end, outputs)
        for name, values in other.values.items():
            np.testing.assert_array_equal(values, found.values[name][runs])
