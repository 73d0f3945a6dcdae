"""Sampled controllers against exact recursions, matrix exponentials and the same loop in Python."""

import numpy as np
import pytest
from controlled_rotor import GAINS, PERIOD, controlled, rotor
from numpy.testing import assert_allclose, assert_array_equal
from scipy.linalg import expm

from sebody import InputError, Model, Simulation, Tolerance, generalized_alpha
from sebody.analysis import Ensemble, resume, save_state, state_space
from sebody.control import computed_torque, pid, state_feedback
from sebody.model.control.laws import _pid


def exact(delay, A, B, C, count):
    """The recursion of the sampled loop, y / reference at the samples."""
    n = len(A)
    E = expm(PERIOD * np.block([[A, B], [np.zeros((1, n + 1))]]))
    x, out = np.zeros(n), []
    integral = rate = last = 0.0
    queue = [0.0] * delay
    for _ in range(count + 1):
        y = C @ x
        out.append(y / GAINS["reference"])
        e = GAINS["reference"] - y
        integral += PERIOD * e
        rate = (rate + GAINS["filter"] * (-y - last)) / (1 + GAINS["filter"] * PERIOD)
        last = -y
        queue.append(GAINS["kp"] * e + GAINS["ki"] * integral + GAINS["kd"] * rate)
        x = E[:n, :n] @ x + E[:n, n] * queue.pop(0)
    return np.array(out)


@pytest.mark.parametrize("delay", [0, 1, 5])
@pytest.mark.parametrize("tolerance", [None, Tolerance(1e-6)])
def test_a_rotor_is_exact(delay, tolerance):
    """Between samples the torque holds, and the scheme integrates constant accelerations exactly.

    Fixed and variable steps; with the prototype's numbers 1.128315865151 and 1.024892860860.
    """
    result = Simulation(controlled(delay), PERIOD, tolerance=tolerance).run_to(4.0).result()
    found = result["hub.rotation"] / GAINS["reference"]
    expected = exact(delay, np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [10.0]]),
                     np.array([1.0, 0.0]), 200)
    # 200 samples of a loop that rounds by 1e-16 of the angle's size
    assert_allclose(found, expected, rtol=0, atol=1e-12)
    if delay == 0:
        assert_allclose(found[[50, 200]], [1.128315865151, 1.024892860860], rtol=0, atol=1e-12)
    if tolerance is None:
        steps, matrices = result.steps, result.matrices
        assert steps == 200 and matrices <= 2 * 200     # at most two factorizations a sample


@pytest.mark.parametrize("delay", [0.3, 2.7])
@pytest.mark.parametrize("tolerance", [None, Tolerance(1e-6)])
def test_a_delay_of_part_of_a_sample_is_exact(delay, tolerance):
    """Constant torques of a rotor between the samples and the times at which outputs act."""
    model = rotor(start=0.02)
    model.controller("law", state_feedback([[2.0, 0.3]]), ["hub.rotation", "hinge.rate"],
                     ["motor"], PERIOD, delay)
    model.controller("copy", state_feedback([[-1.0]]), ["motor"], ["seen"], PERIOD)
    h = PERIOD / 10 if tolerance is None else PERIOD
    result = Simulation(model, h, tolerance=tolerance).run_to(2.0).result()
    whole, part = int(delay), (delay - int(delay)) * PERIOD
    angle, rate, acts, queue, expected, seen = 0.0, 0.02, 0.0, [0.0] * int(delay), [], []
    for _ in range(101):
        expected.append(angle)
        seen.append(acts)
        queue.append(-2.0 * angle - 0.3 * rate)
        for length in (part, PERIOD - part):
            angle += length * rate + 5.0 * length**2 * acts     # J is 0.1
            rate += 10.0 * length * acts
            if length == part:
                acts = queue.pop(0)
    assert len(queue) == whole
    found = result["hub.rotation"][::10 if tolerance is None else 1]
    assert_allclose(found, expected, rtol=0, atol=1e-12)
    # a controller that reads an actuator sees what acts, not what is on its way
    assert_allclose(result["seen.value"][::10 if tolerance is None else 1][1:], seen[1:], rtol=0,
                    atol=1e-11)
    with pytest.raises(InputError, match="has a delay beside whole samples of 0.0[01]"):
        Simulation(model, PERIOD)


@pytest.mark.parametrize("delay", [0, 1])
def test_a_flexible_beam_is_of_second_order(delay):
    """Against the matrix exponential of the state space."""
    model = rotor(True)
    system = state_space(Simulation(model, 0.01), "motor", "hub.rotation")
    expected = exact(delay, system.A, system.B, system.C[0], 200)[[50, 100, 200]]
    found, scheme = [], generalized_alpha(tolerance=1e-9)
    for parts in (64, 128):
        y = Simulation(controlled(delay, True), PERIOD / parts, scheme).run_to(4.0).result()
        found.append(y["hub.rotation"][::parts][[50, 100, 200]] / GAINS["reference"])
    errors = [np.abs(one - expected).max() for one in found]
    assert errors[0] < 3e-6 and 3.6 < errors[0] / errors[1] < 4.4
    # what the fourth order leaves, and the tolerance of Newton's iteration over 25600 steps
    assert_allclose((4 * found[1] - found[0]) / 3, expected, rtol=0, atol=2e-8)
    given = ((1.043135312615, 1.519734821901, 0.836970473157) if delay == 0 else
             (1.062119569889, 1.535973462955, 0.829006273922))
    assert_allclose(expected, given, rtol=0, atol=1e-10)


@pytest.mark.parametrize("tolerance", [None, Tolerance(1e-4)])
def test_the_same_loop_from_python_has_the_same_bits(tolerance):
    """Controllers between pieces of a run, and compiled ones; a load that varies, too."""
    def build(compiled):
        model = rotor(True)
        model.force("tip", (0.0, 1.0), lambda t: 1e-4 * np.sin(7.0 * t))
        if compiled:
            model.controller("pid", pid(**GAINS), ["hub.rotation"], ["motor"], PERIOD)
        return Simulation(model, 0.01, tolerance=tolerance)
    one, other = build(True), build(False)
    one.run_to(1.0)
    x, u, numbers = np.zeros(4), np.zeros(1), pid(**GAINS).packed(PERIOD)
    for k in range(1, 51):
        _pid(other.time, np.array([other.read("hub.rotation")]), x, u, numbers)
        other.set_input("motor", u[0])
        other.run_to(k * PERIOD)
    assert other.time == one.time
    same, found = one.result(), other.result()
    for name in ("tip.position", "hub.rotation", "tip.velocity"):
        assert_array_equal(found[name], same[name])
    # at a sample the compiled run records what is after the jump; so does the other, but at the end
    assert_array_equal(found["tip.acceleration"][:-1], same["tip.acceleration"][:-1])


def test_saved_and_resumed(tmp_path):
    """Bit for bit, with delays, noise and a held sensor."""
    def build():
        model = rotor(True)
        model.sensor("angle", "hinge.angle", rate=100.0, delay=3, noise=1e-6, seed=5, bias=1e-7)
        model.sensor("rate", "hinge.rate", noise=1e-5, seed=6)
        model.controller("feedback", state_feedback([[2.0, 0.4]], [1e-3, 0.0]), ["angle", "rate"],
                         ["motor"], PERIOD, delay=2)
        return model
    whole = Simulation(build(), 0.01).run_to(1.0).result()
    run = Simulation(build(), 0.01).run_to(0.37)
    again = resume(build(), save_state(run, tmp_path / "run.npz")).run_to(1.0).result()
    assert_array_equal(again.rows, whole.rows)
    noise = whole["rate.value"] - np.where(np.arange(101) % 2 == 0, whole["hinge.rate"], np.nan)
    assert 0.5e-5 < np.nanstd(noise) < 2e-5        # of the samples at every second step


def test_ensembles_carry_controllers():
    """Runs of an ensemble are those of single simulations, bit for bit."""
    def build(speed):
        model = controlled(3, True, start=speed)
        return model
    ensemble = Ensemble(build(0.01), 0.01)
    speeds = np.array([0.005, 0.01, 0.02])
    found = ensemble.run({"hub.angular_velocity": speeds[:, None]}, 1.0, {
        "angle": "hub.rotation", "torque": "motor.value"})
    for k, speed in enumerate(speeds):
        result = Simulation(build(speed), 0.01).run_to(1.0).result()
        assert_allclose(found["angle"][k], result["hub.rotation"], rtol=0, atol=1e-17)
        assert_allclose(found["torque"][k], result["motor.value"], rtol=0, atol=1e-15)


def law_of(steps):
    def law(t, y, x, u, parameters):
        u[0] = parameters[0] if t < 0.5 else -2.0
    return law


def test_lag_rate_and_limit():
    """The torque by its closed form, the speed as its integral."""
    model = rotor(lag=0.1, rate=4.0, limit=(-0.7, 1.0))
    model.controller("steps", law_of(2), [], ["motor"], 0.5, parameters=[3.0])
    run = Simulation(model, 0.001).run_to(1.0)
    result = run.result()
    t = result["t"]

    def course(t, value, begun):
        """Ramp of 4 until the gap is 0.4, then an exponential, and its integral."""
        sign, ramp = np.sign(value - begun), (abs(value - begun) - 0.4) / 4.0
        on = np.minimum(t, ramp)
        late = np.maximum(t - ramp, 0.0)
        force = np.where(t < ramp, begun + 4 * sign * t, value - 0.4 * sign * np.exp(-late / 0.1))
        area = begun * on + 2 * sign * on**2 + value * late - 0.04 * sign * (
            1 - np.exp(-late / 0.1))
        return force, area
    first, later = t <= 0.5, t > 0.5
    force, area = course(t[first], 1.0, 0.0)
    assert_allclose(result["hub.angular_acceleration"][first] * 0.1, force, atol=3e-3)
    end = course(np.array([0.5]), 1.0, 0.0)
    second = course(t[later] - 0.5, -0.7, end[0][0])[1]
    momentum = 0.1 * result["hub.angular_velocity"]
    # steps of 1e-3: second order, with a kink in the torque where its ramp ends
    assert_allclose(momentum[first], area, atol=2e-6)
    assert_allclose(momentum[later], end[1][0] + second, atol=2e-6)
    assert_allclose(result["motor.work"][-1], momentum[-1]**2 / 0.2, rtol=1e-5)


def test_reactions_stay_clean_and_work_is_counted():
    """The moment of a hinge in a plane is zero, whatever its motor does."""
    result = Simulation(controlled(0, True), 0.01).run_to(2.0).result()
    assert np.abs(result["hinge.moment"]).max() == 0.0
    assert np.abs(result["motor.moment"]).max() > 1e-5
    assert result.energy_balance() < 2e-3
    assert abs(result["motor.work"][-1]) > 0.0


def arm_dynamics(q, v, mass, bias):
    """Two rods of one metre and one kilogram, absolute angles apart by relative ones."""
    c, s = np.cos(q[1]), np.sin(q[1])
    mass[0, 0] = 5.0 / 3.0 + c
    mass[0, 1] = mass[1, 0] = 1.0 / 3.0 + 0.5 * c
    mass[1, 1] = 1.0 / 3.0
    bias[0] = -0.5 * s * (2.0 * v[0] * v[1] + v[1] * v[1])
    bias[1] = 0.5 * s * v[0] * v[0]


def arm_reference(t, q, v, a):
    q[0], q[1] = 0.5 * (1 - np.cos(2 * t)), 0.8 * np.sin(t)
    v[0], v[1] = np.sin(2 * t), 0.8 * np.cos(t)
    a[0], a[1] = 2 * np.cos(2 * t), -0.8 * np.sin(t)


def test_computed_torque_of_a_rigid_arm():
    """At 1 kHz the motion that is wanted, to the first order of the period's hold."""
    errors = []
    for period in (0.002, 0.001):
        model = Model(planar=True)
        nodes = [model.node(name, (x, 0.0)) for name, x in (("a", 0.5), ("b", 1.5))]
        for node in nodes:
            model.rigid_body(f"rod {node.name}", node, 1.0, 1.0 / 12.0)
        shoulder = model.attach("shoulder", (0.0, 0.0), nodes[0])
        elbow = model.attach("elbow", (1.0, 0.0), nodes[0])
        end = model.attach("end", (1.0, 0.0), nodes[1])
        model.revolute(shoulder, name="first")
        model.revolute(end, to=elbow, name="second")
        model.initial_velocity(nodes[1], (0.0, 0.4), 0.8)
        model.actuator("one", joint="first")
        model.actuator("two", joint="second")
        model.controller("arm", computed_torque(arm_dynamics, arm_reference, 2, 400.0, 40.0),
                         ["first.angle", "second.angle", "first.rate", "second.rate"],
                         ["one", "two"], period)
        result = Simulation(model, 0.001).run_to(1.0).result()
        t = result["t"]
        errors.append(max(np.abs(result["first.angle"] - 0.5 * (1 - np.cos(2 * t))).max(),
                          np.abs(result["second.angle"] - 0.8 * np.sin(t)).max()))
    assert errors[1] < 2e-5 and 1.7 < errors[0] / errors[1] < 2.4


def test_a_million_samples_add_no_memory():
    import tracemalloc
    model = rotor()
    model.controller("pid", pid(**GAINS), ["hub.rotation"], ["motor"], 1e-3, 4)
    run = Simulation(model, 1e-3, output_every=1_000_000)
    run.run_to(0.1)
    tracemalloc.start()
    run.run_to(20.0)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1e5 and run.state.memory.size < 100      # whatever the number of samples
