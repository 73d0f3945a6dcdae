"""A beam in a plane of space, and the comparison of spatial with planar runs."""

from functools import cache

import numpy as np
from scipy.spatial.transform import Rotation

from sebody import Model, generalized_alpha, simulate
from sebody.fem import Section, straight_beam
from sebody.reduction import craig_bampton

H, STEPS = 0.002, 40
TURN = Rotation.from_rotvec((0.4, -0.7, 0.5)).as_matrix()
START = np.array([3.0, -2.0, 1.0])
X, Y, Z = TURN.T
# bending frequencies in both planes differ, and in the second section are the same
FLAT = Section(area=9.0, inertia_y=4.0, inertia_z=6.75, torsion=8.0, youngs_modulus=2.1e6,
               poisson_ratio=0.3, density=7.8e-3)
SQUARE = Section(area=9.0, inertia_y=6.75, inertia_z=6.75, torsion=11.387, youngs_modulus=2.1e6,
                 poisson_ratio=0.3, density=7.8e-3)
# iterations of Newton's method end at 1e-12 of the loads; what differs is their rounding
EXACT = generalized_alpha(tolerance=1e-12)
CLOSE = 2e-8        # works add up over the steps


def at(*place: float) -> np.ndarray:
    """A point of the scene, turned and shifted."""
    return START + TURN @ place


def reduced(first, last, modes: int, section: Section = SQUARE, up=Y, damping: float = 0.0):
    """A beam with a load inside, in the plane."""
    fe_model = straight_beam(first, last, section, 6, up)
    wind = np.zeros(fe_model.stiffness.shape[0])
    wind[fe_model.rows[3]] = [*(TURN @ (30.0, 200.0, 0.0)), *(500.0 * Z)]
    body = craig_bampton(fe_model, [(6, "full"), (0, "full")], modes, loads={"wind": wind})
    return body.damped(damping) if damping else body


def wind(t):
    return 1.0 + 2.0 * t


def assert_same(model: Model, made: Model, quantities, h: float = H) -> None:
    expected, found = (simulate(one, h, STEPS * h, EXACT) for one in (model, made))
    for name in quantities:
        own = made.plane.to_space(name, found[name])
        size = max(np.abs(expected[name] - expected[name][0]).max(), 1e-2 * np.abs(
            expected[name]).max())
        assert np.abs(own - expected[name]).max() <= CLOSE * size, name


@cache
def beam_from_tip(section: Section, up: tuple[float, ...], damping: float):
    return reduced(at(100, 40, 0), at(0, 0, 0), 4, section, up, damping)


def beam(section: Section = SQUARE, up=Y, **options) -> Model:
    """A beam that a torque turns about a hinge."""
    model = Model()
    base, tip = model.node("base", at(0, 0, 0)), model.node("tip", at(100, 40, 0))
    # damped bodies of option b have kernels of their own
    body = beam_from_tip(section, tuple(up), 0.0 if "b" in options.values() else 0.01)
    model.superelement("beam", body, [base, tip], **options)
    model.revolute(base, Z, name="hinge")
    model.torque(base, -2e3 * Z, wind, name="motor")
    model.rigid_velocity(np.zeros(3), 0.1 * Z, about=base.point)
    return model


def rigid(model: Model, name: str, node, mass: float = 1.0, **options) -> None:
    """A rigid body with a principal axis that is normal to the plane."""
    model.rigid_body(name, node, mass, TURN @ np.diag([400.0, 300.0, 600.0]) @ TURN.T, **options)
