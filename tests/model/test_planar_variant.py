"""A planar model in the place of a spatial one: both move alike, and what is not planar is said."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import Model, generalized_alpha, simulate
from sebody.fem import Section, straight_beam
from sebody.model.variants import planar
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
CLOSE = 1e-8


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


def beam(section: Section = SQUARE, up=Y, **options) -> Model:
    """A beam that a torque turns about a hinge."""
    model = Model()
    base, tip = model.node("base", at(0, 0, 0)), model.node("tip", at(100, 40, 0))
    body = reduced(tip.point, base.point, 4, section, up, damping=0.01)
    model.superelement("beam", body, [base, tip], **options)
    model.revolute(base, Z, name="hinge")
    model.torque(base, -2e3 * Z, wind, name="motor")
    model.rigid_velocity(np.zeros(3), 0.1 * Z, about=base.point)
    return model


QUANTITIES = ("tip.position", "tip.velocity", "tip.rotation", "base.angular_velocity",
              "energy.kinetic", "energy.strain", "motor.power", "hinge.force", "beam.base.moment",
              "momentum")


@pytest.mark.parametrize("section", [FLAT, SQUARE])
@pytest.mark.parametrize("options", [{}, {"inertia": "b"}, {"inertia": "d"},
                                     {"frame": "node", "frame_node": 1}])
def test_a_beam_moves_in_its_plane_as_in_space(section, options):
    model = beam(section, **options)
    made, sentence = planar(model)
    assert made.planar and not model.planar
    # base: an angle in the place of three and two multipliers; tip: three; two of four modes
    assert sentence.startswith("the model is planar, normal to (")
    assert sentence.endswith(": 6 instead of 15 unknowns")
    assert made.bodies["beam"].body.modes == 2
    assert_same(model, made, QUANTITIES)


def test_modes_of_one_frequency_are_turned_until_they_are_in_the_plane():
    model = beam()
    body = model.bodies["beam"].body
    frequencies = np.sqrt(np.diag(body.stiffness)[-4:])
    assert abs(frequencies[1] / frequencies[0] - 1) < 1e-6      # a pair, in any direction
    kept = planar(model).model.bodies["beam"].body
    assert np.allclose(np.sqrt(np.diag(kept.stiffness)[-2:]), frequencies[[0, 2]], rtol=1e-6)
