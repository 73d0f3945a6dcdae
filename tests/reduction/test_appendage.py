"""Appendages of participation factors against full FE models and textbook oscillators."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import linalg
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Simulation, simulate
from sebody.analysis import modes, vibrations
from sebody.fem import Section, straight_beam
from sebody.reduction import appendage

PANEL = Section(2e-3, 4e-7, 9e-7, 6e-7, 7e10, 0.3, 2700.0)
TURN = Rotation.from_rotvec((0.3, 0.9, -0.5)).as_matrix()
ROOT = np.array([0.4, -0.2, 1.1])
HUB, INERTIA = 60.0, np.diag([9.0, 12.0, 15.0])


def panel():
    """Dense matrices of a clamped panel, and rigid motions of its nodes about the root."""
    fe = straight_beam(ROOT, ROOT + TURN @ (4.0, 0, 0), PANEL, 8)
    K, M = fe.stiffness.toarray(), fe.mass.toarray()
    arms, R = fe.coordinates - ROOT, np.zeros((len(K), 6))
    for k, (x, y, z) in enumerate(arms):
        R[6 * k:6 * k + 6] = np.eye(6)
        R[6 * k:6 * k + 3, 3:] = [[0, z, -y], [-z, 0, x], [y, -x, 0]]
    return K, M, R


def test_a_panel_on_a_satellite_is_its_fe_model():
    """All modes of the clamped panel, on a free hub: against FE matrices with its mass."""
    K, M, R = panel()
    squares, shapes = linalg.eigh(K[6:, 6:], M[6:, 6:])
    participation = shapes.T @ (M @ R)[6:]
    body = appendage(R.T @ M @ R, np.sqrt(squares) / (2 * np.pi), participation, point=ROOT)
    model = Model()
    hub = model.node("hub", ROOT)
    model.rigid_body("satellite", hub, HUB, INERTIA)
    model.superelement("panel", body, [hub])
    found = vibrations(Simulation(model, 0.01)).frequency
    M[:3, :3] += HUB * np.eye(3)
    M[3:6, 3:6] += INERTIA
    exact = np.sqrt(linalg.eigh(K, M, eigvals_only=True).clip(0)) / (2 * np.pi)
    count = 12      # elastic ones: of these rounding of the stiff ones is 1e-10
    assert_allclose(found[found > 1e-3][:count], exact[exact > 1e-3][:count], rtol=1e-10)
    assert body.total_mass == pytest.approx(PANEL.density * PANEL.area * 4.0, rel=1e-12)


def test_a_sloshing_mass_is_a_mass_on_a_spring():
    """In a turned and damped tank that is pushed: against a model of masses and a spring."""
    tank, water, rate, ratio, way = 50.0, 20.0, 0.8, 0.03, TURN[:, 1]
    arm = np.array([0.0, 0.0, 0.0])
    factor = np.sqrt(water) * np.r_[way, np.cross(arm, way)]
    body = appendage(np.diag([water] * 3 + [5.0] * 3), [rate], [factor], [ratio])
    model = Model()
    node = model.node("tank", (0, 0, 0))
    model.rigid_body("shell", node, tank, (5.0, 5.0, 5.0))
    model.superelement("water", body, [node])
    model.force(node, 30.0 * way, lambda t: np.sin(3.0 * t))
    found = simulate(model, 0.005, 3.0)["tank.position"] @ way
    w = 2 * np.pi * rate
    A, B = np.array([[tank + water, np.sqrt(water)], [np.sqrt(water), 1.0]]), np.diag([0, w * w])
    C = np.diag([0, 2 * ratio * w])
    inverse = np.linalg.inv(A)
    from scipy.integrate import solve_ivp
    t = 0.005 * np.arange(601)
    exact = solve_ivp(lambda t, y: np.r_[y[2:], inverse @ (
        [30.0 * np.sin(3.0 * t), 0.0] - B @ y[:2] - C @ y[2:])], (0, 3), np.zeros(4), t_eval=t,
        rtol=1e-10, atol=1e-12).y[0]
    assert_allclose(found, exact, rtol=0, atol=3e-5 * np.abs(exact).max())      # h^2


def test_in_a_plane_damped_and_mass_alone():
    body = appendage([3.0, 3.0, 0.4], [2.0, 5.0], [[1.0, 0.0, 0.2], [0.0, 1.2, 0.1]], [0.01, 0.02])
    model = Model(planar=True)
    node = model.node("floor", (0.0, 0.0))
    model.superelement("equipment", body, [node])
    model.fix(node)
    found = modes(Simulation(model, 0.01))
    assert_allclose(np.abs(found.values) / (2 * np.pi), [2.0, 5.0], rtol=1e-9)
    assert_allclose(found.damping, [0.01, 0.02], rtol=1e-6)
    assert appendage(3.0, [1.0], [[1.0, 0, 0, 0, 0, 0]]).total_mass == pytest.approx(3.0)


@pytest.mark.parametrize("changed, message", [
    ({"frequencies": [0.0]}, "frequencies"), ({"frequencies": []}, "frequencies"),
    ({"participation": [[1.0, 0.0, 0.0]]}, "participation has shape (1, 3): give 1 x 6 finite"),
    ({"masses": [1.0, 2.0]}, "masses has shape (2,): give a mass, its 6"),
    ({"masses": np.triu(np.ones((6, 6)))}, "masses is not symmetric"),
    ({"damping": -0.1}, "damping is -0.1: give a ratio >= 0"),
    ({"damping": [0.1, 0.2]}, "one for each of 1 modes"),
    ({"participation": [[2.0, 0, 0, 0, 0, 0]]},
     "the modes have the effective mass 4 in x, and masses 3")])
def test_refused(changed, message):
    with pytest.raises(InputError) as caught:
        appendage(**{"masses": 3.0, "frequencies": [1.0], "participation": [[1.0, 0, 0, 0, 0, 0]],
                     **changed})
    assert message in str(caught.value)
