"""Friction that slides: loads change what presses, in state spaces and matrices of small motion."""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from sebody import Model, Simulation
from sebody.analysis import frequency_response, linearize, modes, state_space

TURN = Rotation.from_rotvec((0.4, -0.9, 0.3)).as_matrix()
MU, RADIUS, MASS, ARM, J, G, RATE = 0.5, 0.1, 2.0, 0.6, 0.1, 9.81, 3.0
INERTIA = J + MASS * ARM**2


def pendulum(planar=False, force=0.0, explicit=False):
    """A horizontal pendulum whose hinge slides, with a force across its end."""
    model = Model(planar=planar)
    x, y = ((1.0, 0.0), (0.0, 1.0)) if planar else TURN.T[:2]
    x, y = np.array(x), np.array(y)
    hub = model.node("hub", 0.0 * x)
    if planar:
        model.revolute(hub, name="hinge", explicit=explicit)
    else:
        model.revolute(hub, axis=TURN[:, 2], name="hinge", explicit=explicit)
    model.rigid_body("bob", hub, MASS, J if planar else J * np.eye(3), centre=ARM * x)
    model.gravity(-G * y)
    model.initial_velocity(hub, angular=RATE if planar else RATE * TURN[:, 2])
    model.friction("hinge", MU, radius=RADIUS, name="dry")
    model.force(model.attach("tip", ARM * x, hub), y, force, name="push")
    return model


def acceleration(force):
    """Of the moments about the hinge, with the force in it across its axis."""
    def left(a):
        across = MASS * ARM * a - force + MASS * G
        return (INERTIA * a - (force - MASS * G) * ARM
                + MU * RADIUS * np.hypot(MASS * ARM * RATE**2, across))
    return brentq(left, -1e3, 1e3, xtol=1e-14, rtol=1e-15)


@pytest.mark.parametrize("planar", [False, True])
def test_a_load_changes_what_presses(planar):
    """D against the closed form, and against 0.731707 without the normal force."""
    run = Simulation(pendulum(planar), 1e-4)
    quantity = "hub.angular_acceleration"
    system = state_space(run, ["push"], [quantity])
    found = system.D[0, 0] if planar else system.D[:, 0] @ TURN[:, 2]
    exact = (acceleration(1e-3) - acceleration(-1e-3)) / 2e-3
    assert exact == pytest.approx(0.732782, abs=1e-6)
    assert found == pytest.approx(exact, rel=1e-7)
    fast = frequency_response(run, "push", quantity, [1e6])[quantity]
    assert np.real(fast if planar else fast @ TURN[:, 2])[0] == pytest.approx(exact, rel=1e-5)


@pytest.mark.parametrize("planar", [False, True])
def test_the_matrices_of_the_instant_have_it(planar):
    """Poles of the state space are the eigenvalues; the rate changes the centrifugal force."""
    run = Simulation(pendulum(planar), 1e-4)
    linear = linearize(run)
    assert linear.mass == pytest.approx(linear.mass.T)
    roots = np.sort_complex(np.roots([1.0, (linear.damping / linear.mass).item(),
                                      (linear.stiffness / linear.mass).item()]))
    poles = np.sort_complex(state_space(run, ["push"], ["hub.angular_acceleration"]).poles)
    assert poles == pytest.approx(roots, rel=1e-8)
    with pytest.warns(match="without spin="):
        values = modes(run).values
    assert min(abs(values[0] - roots)) < 1e-8 * abs(values[0])

    def by_rate(rate):      # at the same place
        def left(a):
            return INERTIA * a + MASS * G * ARM + MU * RADIUS * np.hypot(
                MASS * ARM * rate**2, MASS * ARM * a + MASS * G)
        return brentq(left, -1e3, 1e3, xtol=1e-14, rtol=1e-15)
    slope = -(by_rate(RATE + 1e-4) - by_rate(RATE - 1e-4)) / 2e-4
    assert (linear.damping / linear.mass).item() == pytest.approx(slope, rel=1e-6)

