"""Modes over the speed where their frequencies cross, and constraints that contradict others."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sebody import InputError, Model, Simulation, spline
from sebody.analysis import campbell

MASS, ALONG = 2.0, 110.0
TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])


def test_modes_that_cross_are_followed_by_their_shapes():
    """The softer whirl in the plane falls with the speed, below the motion along the axis.

    ``(kx / m - W^2 - w^2) (ky / m - W^2 - w^2) = 4 W^2 w^2``, and along the axis kz / m.
    """
    model = Model()
    model.node("middle", (0.0, 0.0, 0.0), keeps="translation")
    model.point_mass("mass", "middle", MASS)
    for axis, stiffness in enumerate((150.0, 400.0, ALONG)):
        for sign in (-1.0, 1.0):
            end = model.node(f"end {axis} {sign}", TURN @ (sign * np.eye(3)[axis]),
                             keeps="translation")
            model.fix(end, "position")
            model.spring("middle", end, stiffness / 2)
    speeds = np.linspace(0.0, 6.0, 9)
    found = campbell(model, speeds, TURN @ (0, 0, 2.0), 3)
    a, b = 150.0 / MASS - speeds**2, 400.0 / MASS - speeds**2
    middle = (a + b + 4 * speeds**2) / 2
    root = np.sqrt(middle**2 - a * b)
    along, slow, fast = np.full(9, np.sqrt(ALONG / MASS)), np.sqrt(middle - root), np.sqrt(
        middle + root)
    assert slow[0] > along[0] and slow[-1] < along[-1] - 1.0      # they cross
    # in the order at rest
    assert_allclose(found.omega, np.stack([along, slow, fast], axis=1), rtol=1e-8)


def driven(other: float) -> Model:
    """A crank with two drives of its angle, alike in place and rate at the start."""
    model = Model(planar=True)
    model.node("base", (1.0, -2.0))
    model.rigid_body("crank", "base", 2.0, 0.4, centre=(1.5, -1.2))
    model.revolute("base", name="hinge")
    for name, amplitude in (("one", 0.2), ("two", other)):
        # 3 a t^2 - 2 a t^3: the accelerations at the start are 6 a
        model.drive_angle("base", spline([(0.0, 0.0), (1.0, amplitude)], rates=(0.0, 0.0)),
                          name=name)
    return model


def test_redundant_drives_that_demand_different_accelerations():
    assert set(Simulation(driven(0.2), 0.01).start.redundant)
    for other in (0.3, -0.2, 0.2 * (1 + 1e-4)):
        with pytest.raises(InputError, match="the constraints of one, two contradict each "
                                             "other: they demand different values of the "
                                             "same acceleration"):
            Simulation(driven(other), 0.01)


def test_growth_of_a_rigid_spin_is_rounding():
    """About its largest principal axis it is stable: what grows does so by rounding alone."""
    model = Model()
    model.rigid_body("top", model.node("top", (0.0, 0.0, 0.0)), 2.0,
                     TURN @ np.diag([0.1, 0.2, 0.25]) @ TURN.T)
    found = campbell(model, [50.0, 1e4], TURN[:, 2], 5)
    assert np.abs(found.growth).max() > 0.0
    assert (np.abs(found.growth) <= found.rounding).all()
    assert "1e4" not in repr(found) and repr(found).split()[-1] == "0"
