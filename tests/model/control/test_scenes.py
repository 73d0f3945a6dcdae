"""Scenes with controllers: what they promise, by linear recursions and closed forms."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sebody import Simulation, simulate
from sebody.analysis import equilibrium, resume, save_state
from sebody.assembly import allocation
from sebody.control import state_feedback
from sebody.scenes import flexible_arm, half_car, pole_on_cart, two_link_arm
from sebody.scenes.regulators import regulator, sampled


def run(scene, t_end=None):
    return simulate(scene.model, scene.h, t_end or scene.t_end)


def test_a_regulator_damps_the_tip():
    found = {}
    for name in ("pd", "regulator"):
        result = run(flexible_arm.build(name))
        late = result["t"] > 1.0
        found[name] = np.abs(result["tip.rotation"] - result["hinge.angle"])[late].max()
        assert abs(result["hinge.angle"][-1] - flexible_arm.TURN) < 0.02
        assert np.abs(result["motor.value"]).max() <= 5.0
        assert result.energy_balance() < 1e-3
    assert found["regulator"] < 0.02 * found["pd"]


def test_a_pole_stands_up():
    """A small kick follows the sampled linear loop; a large one ends upright, too."""
    system, _, K = pole_on_cart.design()
    assert_allclose(system.poles.real.max(), 4.1041215, rtol=1e-7)
    A, B = sampled(system, pole_on_cart.PERIOD)
    assert np.abs(np.linalg.eigvals(A - B @ K)).max() < 1.0
    kick, rest = 1e-3, equilibrium(pole_on_cart.pole(), 1, unstable="keep")
    scene = pole_on_cart.build(kick)
    result = simulate(scene.model, scene.h / 4, 2.0)
    x = np.array([result[name][0] - rest[name][-1] for name in system.measurements])
    cart, expected = system.measurements.index("cart.position.x"), []
    for _ in range(201):
        expected.append(x[cart])
        x = (A - B @ K) @ x
    # second order of the step; the pole starts unstrained, in rest it is shorter by 1e-5
    assert_allclose(result["cart.position.x"][::8], expected, rtol=0,
                    atol=2e-3 * np.abs(expected).max())
    large = run(pole_on_cart.build(1.5))
    assert abs(large["foot.rotation"][-1]) < 0.01
    assert 0.3 < np.abs(large["cart.position.x"]).max() / 1.5 < 0.5


def test_the_regulator_is_that_of_python_control():
    pytest.importorskip("control.statesp")  # "control" is a folder of tests, too
    import control

    system, Q, K = pole_on_cart.design()
    A, B = sampled(system, pole_on_cart.PERIOD)
    exact = control.c2d(control.ss(*system[:4]), pole_on_cart.PERIOD)
    assert_allclose(A, exact.A, atol=1e-12 * np.abs(A).max())
    expected, _, poles = control.dlqr(exact.A, exact.B, Q, np.array([[0.1]]))
    assert_allclose(K, expected, rtol=0, atol=1e-6 * np.abs(expected).max())
    closed = np.linalg.eigvals(A - B @ K)
    assert max(np.abs(closed - pole).min() for pole in poles) < 1e-9
    assert regulator(system, Q, np.array([[0.1]]), 0.01).shape == (1, len(A))
    assert state_feedback(K).inputs == (len(A),)


def test_a_two_link_arm_follows():
    result = run(two_link_arm.build(0.0), 2.0)
    t = result["t"]
    assert np.abs(result["shoulder.angle"] - 0.8 * np.sin(1.5 * t)**2).max() < 5e-5
    assert np.abs(result["elbow.angle"] - 1.2 * np.sin(t)**2).max() < 5e-5
    loaded = run(two_link_arm.build(0.2), 2.0)
    assert 1e-3 < np.abs(loaded["shoulder.angle"] - 0.8 * np.sin(1.5 * t)**2).max() < 1e-2


def test_an_active_suspension_is_softer():
    rms = {}
    for kind in ("passive", "active"):
        result = run(half_car.build(kind))
        rms[kind] = np.sqrt(np.mean(result["base.acceleration.y"]**2))
        assert result.energy_balance() < 2e-3
        assert abs(result["base.position.y"][-1] - half_car.AXLE) < 2e-3
    assert rms["active"] < 0.7 * rms["passive"]
    work = sum(result[f"{axle} valve.work"][-1] for axle in ("front", "rear"))
    assert work < 0.0       # the valves take energy out


@pytest.mark.parametrize(("scene", "few"), [(flexible_arm.build("regulator"), 0.1),
                                            (two_link_arm.build(), 0.2)],
                         ids=["flexible arm", "two links"])
def test_factors_are_kept_between_samples(monkeypatch, scene, few):
    """The motion is that of a run that factorizes at every sample and after it.

    Newton's iteration leaves parts of the tolerance 1e-8 in a step, and a loop that is closed
    passes them on.
    """
    steps, count = 0, 400
    rows, matrices = {}, {}
    for kept in (True, False):
        if not kept:
            monkeypatch.setattr(allocation, "spare", lambda *given: np.zeros(0))
        run = Simulation(scene.model, scene.h).run_to(count * scene.h)
        rows[kept] = run.rows.all()[:, run.state.recorded_parts["v"]]
        matrices[kept], steps = int(run.state.control.matrices), int(run.state.control.steps)
    assert matrices[False] >= steps and matrices[True] < few * steps
    assert_allclose(rows[True], rows[False], atol=3e-6 * np.abs(rows[False]).max())


def test_kept_factors_are_resumed(tmp_path):
    """A run from a file makes the steps of one that was not ended: with the factors it kept."""
    scene = two_link_arm.build()
    whole = Simulation(scene.model, scene.h).run_to(100 * scene.h)
    begun = Simulation(scene.model, scene.h).run_to(50 * scene.h)
    resumed = resume(two_link_arm.build().model, save_state(begun, tmp_path / "half.npz"))
    resumed.run_to(100 * scene.h)
    assert np.array_equal(resumed.rows.all(), whole.rows.all())
