"""Models of which runs are made eight at a time, and their single runs."""

import numpy as np
from scipy.spatial.transform import Rotation

from sebody import Model, simulate
from sebody.analysis import Ensemble
from sebody.fem import Section, straight_beam
from sebody.parameters.table import handle
from sebody.reduction import craig_bampton

TURN = Rotation.from_rotvec((0.4, -0.7, 0.5)).as_matrix()
SECTION = Section(area=9.0, inertia_y=6.75, inertia_z=5.1, torsion=11.387, youngs_modulus=2.1e6,
                  poisson_ratio=0.3, density=7.8e-3)


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


def assert_bits_in_other_company(many: Ensemble, given: dict, t_end: float, outputs: dict,
                                 found) -> None:
    """Runs backwards, and one alone, give the same bits as all of them did."""
    for runs in (slice(None, None, -1), slice(4, 5)):
        other = many.run({name: v[runs] for name, v in given.items()}, t_end, outputs)
        for name, values in other.values.items():
            np.testing.assert_array_equal(values, found.values[name][runs])
