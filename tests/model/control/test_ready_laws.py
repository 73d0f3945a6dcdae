"""Ready laws in continuous time, by transfer functions, SciPy's filters and integration."""

import warnings

import numpy as np
import pytest
from controlled_rotor import rotor
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.signal import butter, freqs

from sebody import Model, Simulation, simulate
from sebody.analysis import state_space
from sebody.control import linear, low_pass, pid, state_feedback

J = 0.1             # of the rotor


def test_ready_laws():
    """Transfer functions of loops by their coefficients; a filter beside that of SciPy."""
    omega = np.array([0.3, 2.0, 11.0])
    s = 1j * omega

    def response(law, inputs=("hub.rotation",), signal=False):
        model = rotor()
        model.torque("hub", 1.0, 0.0, name="push")
        model.controller("loop", law, inputs, ["out" if signal else "motor"])
        outputs = ["hub.rotation", *(["loop.states"] if law.flow.states.size else [])]
        return state_space(Simulation(model, 0.01), "push", outputs).response(omega)[:, :, 0]
    C = 2.0 + 0.7 / s + 0.5 * s * 20.0 / (s + 20.0)
    assert_allclose(response(pid(2.0, 0.7, 0.5, filter=20.0))[:, 0], 1 / (J * s * s + C),
                    rtol=1e-9)
    assert_allclose(response(state_feedback([[3.0, 0.4]]), ("hub.rotation", "hinge.rate"))[:, 0],
                    1 / (J * s * s + 0.4 * s + 3.0), rtol=1e-9)
    A, B, c, D = [[-2.0, 1.0], [0.0, -3.0]], [[0.5], [1.0]], [[-1.5, 0.8]], [[-2.5]]
    C = -(np.array([c @ np.linalg.solve(si * np.eye(2) - A, B) + D for si in s])[:, 0, 0])
    assert_allclose(response(linear(A, B, c, D))[:, 0], 1 / (J * s * s + C), rtol=1e-9)
    for order in (1, 2, 3, 5):      # in a loop one of them, as each takes a second to compile
        law = low_pass(0.4, order)
        exact = freqs(*butter(order, 2 * np.pi * 0.4, analog=True), omega)[1]
        if order == 5:
            found = response(law, signal=True)
            assert_allclose(found[:, -1] / found[:, 0], exact, rtol=1e-9)
        B, A, D, c = _blocks(law.flow.parameters.reshape(order + 1, order + 1))
        assert_allclose([(c @ np.linalg.solve(si * np.eye(order) - A, B) + D)[0, 0] for si in s],
                        exact, rtol=1e-9)


def _blocks(whole):
    """B, A, D and C of a law of one input and output: rates, then outputs, by y, then x."""
    return whole[:-1, :1], whole[:-1, 1:], whole[-1:, :1], whole[-1:, 1:]


@pytest.mark.parametrize("inputs", [1, 2])
@pytest.mark.parametrize("y, integral", [
    (0.1, -0.2),                # within limits
    (2.0, -0.2), (-2.0, -0.2),  # cut off, the integral at rest
    (0.6, 9.0), (0.1, -9.0)])   # cut off, while the error takes the output back
def test_derivatives_of_pid(inputs, y, integral):
    """Given in closed form, against differences, which are exact as the law is linear."""
    law = pid(3.0, 0.7, 0.2, filter=20.0, reference=0.4, limit=2.0)
    flow, _, parameters, derivatives, _ = law.flow
    point = np.array([y, 0.3, integral, 0.1])[[0, 2, 3] if inputs == 1 else [0, 1, 2, 3]]

    def found(z):
        rates, u = np.zeros(2), np.zeros(1)
        flow(0.0, z[:inputs], z[inputs:], rates, u, parameters)
        return np.r_[rates, u]
    D = np.zeros((3, inputs + 2))
    derivatives(0.0, point[:inputs], point[inputs:], D, parameters)
    expected = np.array([found(point + d) - found(point - d)
                         for d in 1e-3 * np.eye(inputs + 2)]).T / 2e-3
    assert_allclose(D, expected, atol=1e-10)


def test_the_integral_rests_while_the_output_is_cut_off():
    """Against DOP853 of the same law; without anti-windup the angle overshoots by half."""
    model = rotor(limit=0.6)
    model.controller("loop", pid(1.0, 2.0, 0.5, filter=30.0, reference=1.0, limit=0.6),
                     ["hub.rotation"], ["motor"])
    result = simulate(model, 2e-3, 4.0)

    def rates(t, z):
        angle, rate, integral, last = z
        e, slope = 1.0 - angle, 30.0 * (-angle - last)
        raw = e + 2.0 * integral + 0.5 * slope
        u = min(max(raw, -0.6), 0.6)
        return rate, u / J, e if raw == u or (raw - u) * e <= 0 else 0.0, slope
    exact = solve_ivp(rates, (0, 4), np.zeros(4), rtol=1e-9, atol=1e-10, max_step=2e-3,
                      t_eval=result.t).y
    # the integral stops and goes on within a step: e h of it is left, each time
    assert_allclose(result["hub.rotation"], exact[0], rtol=0, atol=1e-3)
    assert np.abs(result["motor.value"]).max() == 0.6


@pytest.mark.parametrize("gain", [2.0, -2.0])
def test_sampled_integrals_rest_while_the_output_is_cut_off(gain):
    """The law's own numbers, sample by sample; also where the output falls with the integral.

    The error drives the integral beyond the limit, then back: the output leaves the limit at the
    next sample, not after as many as it was cut off.
    """
    law, T = pid(0.0, gain, reference=1.0, limit=(-0.5, 0.3)), 0.1
    states, parameters, u = law.states.copy(), law.packed(T), np.zeros(1)
    integral, found, expected = 0.0, [], []
    for y in [0.0] * 6 + [1.8] * 9 + [0.4] * 4:
        law.function(0.0, np.array([y]), states, u, parameters)
        found.append(u[0])
        e = 1.0 - y
        raw = gain * (integral + T * e)
        expected.append(np.clip(raw, -0.5, 0.3))
        if raw == expected[-1] or abs(gain * integral) > abs(raw):      # it comes back
            integral += T * e
    assert_allclose(found, expected, rtol=1e-14)
    assert {-0.5, 0.3} <= set(found) and len(set(found)) > 6


def test_the_offset_of_a_feedback_is_its_output_at_the_reference():
    law = state_feedback([[2.0, -0.3], [0.4, 1.5]], reference=[0.2, -0.1], offset=[0.7, -1.1])
    u, parameters = np.zeros(2), law.packed(0.1)
    law.function(0.0, np.array([0.2, -0.1]), law.states, u, parameters)
    assert_allclose(u, [0.7, -1.1])
    law.function(0.0, np.array([0.5, 0.4]), law.states, u, parameters)
    assert_allclose(u, [0.7 - 2.0 * 0.3 + 0.3 * 0.5, -1.1 - 0.4 * 0.3 - 1.5 * 0.5])


@pytest.mark.parametrize("states, place, kicks", [
    ((), 10.0, True), ((0.0, -10.0), 10.0, False), ((0.0, 0.0), 10.0, False), ((), 0.0, False)])
def test_a_rate_that_begins_with_a_kick_is_warned_of(states, place, kicks):
    """Unless its input is zero or states are given; with those of the message there is none."""
    model = Model(units="m kg s N")
    model.node("cart", (place, 0, 0))
    model.rigid_body("body", "cart", 100.0, (1.0, 1.0, 1.0))
    model.prismatic("cart", axis="x", name="way")
    model.actuator("motor", joint="way")
    model.controller("law", pid(100.0, kd=300.0, reference=place + 2.0), ["cart.position.x"],
                     ["motor"], states=states)
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        first = simulate(model, 0.01, 0.05)["motor.value"][0]
    said = [str(one.message) for one in seen if "kick" in str(one.message)
            or "as if its input" in str(one.message)]
    assert bool(said) == kicks
    if kicks:
        assert "give states=(0, -10)" in said[0] and first < -1e5
    elif states != (0.0, 0.0):
        assert first == pytest.approx(200.0)
