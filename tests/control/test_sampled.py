"""Sampled controllers against exact recursions, matrix exponentials and the same loop in Python."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.linalg import expm

from sebody import InputError, Model, Simulation, SimulationError, Tolerance, generalized_alpha
from sebody.analysis import Ensemble, resume, save_state, state_space
from sebody.control import computed_torque, discrete, lookup, low_pass, pid, state_feedback
from sebody.control.laws import _pid
from sebody.fem import StiffnessSection, planar_beam
from sebody.reduction import craig_bampton

GAINS = {"kp": 2.0, "ki": 0.5, "kd": 0.5, "filter": 50.0, "reference": 1e-4}
PERIOD = 0.02
SECTION = StiffnessSection(axial=1e4, bending_y=1.0, bending_z=1.0, torsion=1.0, mass=1.0,
                           inertia_x=0.0, inertia_y=0.0, inertia_z=0.0)
BODY = craig_bampton(planar_beam((0, 0), (1, 0), SECTION, elements=20),
                     [(0, "full"), (20, "full")], modes=4)


def rotor(flexible=False, start=0.0, **options):
    """A rotor on a hinge, perhaps with a beam, and an actuator."""
    model = Model(planar=True)
    hub = model.node("hub", (0.0, 0.0))
    if flexible:
        model.superelement("beam", BODY, [hub, model.node("tip", (1.0, 0.0))])
    model.rigid_body("rotor", hub, 1.0, 0.1)
    model.revolute(hub, name="hinge")
    if start:
        model.initial_velocity(hub, angular=start)
    model.actuator("motor", joint="hinge", **options)
    return model


def controlled(delay=0, flexible=False, **options):
    model = rotor(flexible, **options)
    model.controller("pid", pid(**GAINS), ["hub.rotation"], ["motor"], PERIOD, delay)
    return model


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
        steps, matrices = result.counters[10], result.counters[9]
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


def test_noise_is_normal_and_independent():
    model = rotor()
    model.sensor("angle", "hub.rotation", noise=2.0, bias=0.5, seed=3)
    model.sensor("other", "hub.rotation", noise=2.0, seed=4)
    model.controller("none", state_feedback([[0.0, 0.0]]), ["angle", "other"], ["motor"], 0.01)
    result = Simulation(model, 0.01).run_to(100.0).result()
    one, other = result["angle.value"] - 0.5, result["other.value"]
    n = len(one)
    for values in (one, other):     # five standard deviations of the estimates
        assert abs(values.mean()) < 5 * 2.0 / np.sqrt(n)
        assert abs(values.var() / 4.0 - 1) < 5 * np.sqrt(2.0 / n)
        assert abs((values**4).mean() / 16.0 - 3.0) < 5 * np.sqrt(96.0 / n)
        assert abs((values[1:] * values[:-1]).mean() / 4.0) < 5 / np.sqrt(n)
    assert abs((one * other).mean() / 4.0) < 5 / np.sqrt(n)


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


def two_rates(model):
    """A filter, a table and a compensator between sensor and motor, of three periods."""
    model.controller("filter", low_pass(5.0), ["hub.rotation"], ["smooth"], 0.01)
    model.controller("table", lookup([-1.0, 0.0, 1.0], [-3.0, 0.0, 1.0]), ["smooth"], ["pull"],
                     0.02)
    model.controller("lead", discrete([[0.5]], [[1.0]], [[-0.2]], [[-1.0]]), ["pull"], ["motor"],
                     0.04)


def test_signals_pass_between_controllers():
    """In the order of the signals, whatever the order of creation; against a loop in Python."""
    from scipy.signal import butter, tf2ss

    model = rotor(start=0.7)
    two_rates(model)
    result = Simulation(model, 0.01).run_to(1.0).result()
    A, B, C, D = tf2ss(*butter(2, 2 * 5.0 * 0.01))
    x, z, angle, speed = np.zeros(2), 0.0, 0.0, 0.7
    smooth = pull = torque = 0.0
    for k in range(101):
        smooth = float((C @ x + D[0] * angle)[0])
        x = A @ x + B[:, 0] * angle
        if k % 2 == 0:
            pull = float(np.interp(smooth, [-1.0, 0.0, 1.0], [-3.0, 0.0, 1.0]))
        if k % 4 == 0:
            torque = -0.2 * z - pull
            z = 0.5 * z + pull
        assert_allclose([result["hub.rotation"][k], result["smooth.value"][k],
                         result["pull.value"][k], result["motor.value"][k]],
                        [angle, smooth, pull, torque], rtol=0, atol=1e-13)
        angle += 0.01 * speed + 0.5e-4 * torque / 0.1
        speed += 0.01 * torque / 0.1


def test_sensors_of_any_quantity():
    """Compiled channels and those Python reads give what the result has."""
    model = rotor(True, start=0.3)
    names = ["tip.position.y", "tip.velocity.x", "hub.angular_velocity", "hinge.angle",
             "hinge.rate", "beam.modes.1", "beam.mode_rates.0", "energy.kinetic",
             "hinge.force.x", "tip.position.norm"]
    model.controller("none", state_feedback(np.zeros((1, len(names)))), names, ["motor"], 0.02)
    run = Simulation(model, 0.01)
    run.run_to(0.2)
    result = run.result()
    for name in names:
        assert_allclose(run.read(name), result[name][-1], rtol=1e-14, atol=1e-18)
        # forces are those before the sample's restart, of the last iterate
        assert_allclose(result[f"{name}.value"][-1], result[name][-1], rtol=1e-6, atol=1e-9)
    assert_array_equal(run.read("tip.position"), result["tip.position"][-1])


@pytest.mark.parametrize("planar", [False, True])
def test_sensors_in_axes_of_a_node(planar):
    """Accelerometer and force sensor that turn with a body, compiled and by Python."""
    model = Model(planar=planar)
    size = 2 if planar else 3
    body = model.node("body", np.array([0.3, 0.1, -0.2])[:size])
    model.rigid_body("mass", body, 2.0, 0.3 if planar else np.diag([0.3, 0.4, 0.2]))
    model.attach("tip", np.array([0.8, 0.4, 0.1])[:size], body)
    model.rigid_velocity(np.array([0.4, -1.0, 0.3])[:size], 3.0 if planar else (2.0, 1.0, -3.0))
    model.gravity(np.array([0.0, -9.81, 0.0])[:size])
    model.actuator("push", node=body, direction=np.eye(size)[0])
    names = []
    for k, label in enumerate("xyz"[:size]):
        model.sensor(f"a{k}", f"tip.acceleration.{label}", axes="body")
        model.sensor(f"f{k}", f"body.position.{label}", axes="tip", rate=50.0)
        model.sensor(f"p{k}", f"push.force.{label}", axes=body)
        names += [f"a{k}", f"f{k}", f"p{k}"]
    model.controller("none", state_feedback(np.zeros((1, len(names))), offset=[1.7]), names,
                     ["push"], 0.02)
    result = Simulation(model, 0.01).run_to(0.3).result()
    R = result["body.rotation"]
    if planar:
        R = np.array([[[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]] for a in R])
    for k in range(size):
        for sensor, name in (("a", "tip.acceleration"), ("f", "body.position"),
                             ("p", "push.force")):
            expected = np.einsum("nji,nj->ni", R, result[name])[1:, k]
            assert_allclose(result[f"{sensor}{k}.value"][2::2], expected[1::2], rtol=1e-6,
                            atol=1e-6)
    with pytest.raises(InputError, match="has axes and measures 'energy.kinetic': name a compon"):
        model.sensor("e", "energy.kinetic", axes="body")


def test_a_model_shows_its_loop():
    model = controlled(2)
    model.sensor("angle", "hinge.angle", rate=50.0, noise=1e-3)
    shown = model.summary().splitlines()
    assert "pid   hub.rotation  motor    0.02      2       4" in shown
    assert "angle  hinge.angle             0.02      0  0.001" in shown
    assert repr(model.controllers["pid"]) == (
        "<Controller 'pid' from hub.rotation to motor: period 0.02, 4 states>")


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


def raising(t, y, x, u, parameters):
    u[0] = y[0] if t < 0.1 else np.sqrt(y[0] - 10.0)


def test_faults_of_a_run(tmp_path):
    """What was computed is kept; the message names controller, value and time."""
    model = rotor(start=0.1)
    model.controller("root", raising, ["hub.rotation"], ["motor"], PERIOD)
    with pytest.raises(SimulationError, match=r"stopped at t = 0\.1: controller 'root' gave u = "
                       r".*nan.* at t = 0\.1: correct it; results up to this time") as caught:
        Simulation(model, 0.01).run_to(1.0)
    assert caught.value.result["t"][-1] == pytest.approx(0.09, abs=0.011)

    def outside(t, y, x, u, parameters):
        u[3] = 1.0
    model = rotor()
    model.controller("wide", outside, [], ["motor"], PERIOD)
    with pytest.raises(InputError, match="the run cannot begin: controller 'wide' raised "
                       "IndexError: index 3 is out of bounds for axis 0 with size 1"):
        Simulation(model, 0.01)


def test_what_is_refused():
    def add(**given):
        model = rotor()
        model.sensor("angle", "hub.rotation")
        options = {"name": "c", "law": pid(1.0), "inputs": ["angle"], "outputs": ["motor"],
                   "period": PERIOD}
        model.controller(**options | given)
        return Simulation(model, 0.01)
    add()
    for given, message in (
            ({"period": 0.015}, "controller 'c' has the period 0.015, which the step 0.01 does not "
             "divide: give a step that does, such as 0.0075"),
            ({"inputs": ["angel"]}, "controller 'c': input 'angel' is unknown: give a sensor"),
            ({"inputs": ["hub.rotatoin"]}, "sensor 'hub.rotatoin': .*did you mean 'hub.rotation'"),
            ({"inputs": ["hub.position"]}, "measures 'hub.position', which is several numbers: "
             "give one of them, such as hub.position.x"),
            ({"outputs": ["motor", "other"]}, "controller 'c' has 2 outputs, but pid has 1"),
            ({"inputs": []}, "controller 'c' has 0 inputs, but pid takes 1 or 2"),
            ({"outputs": ["angle"]}, "output 'angle' is a sensor: name an actuator, or a signal"),
            ({"inputs": ["echo"], "outputs": ["echo"]},
             "algebraic loop: controllers c -> c wait for each other's signals"),
            ({"period": -1.0}, "controller 'c': period is -1"),
            ({"law": lambda t, y: None}, r"controller 'c' has the arguments \(t, y\): give a "
             "function of"),
            ({"law": 3}, "controller 'c' is 3: give a function of"),
            ({"states": [1.0]}, "is given 1 states, and its law has 4"),
            ({"name": "angle"}, "the name is taken by a sensor or controller")):
        with pytest.raises(InputError, match=message):
            add(**given)
    model = rotor()
    model.controller("a", state_feedback([[1.0]]), ["q"], ["p"], PERIOD)
    with pytest.raises(InputError, match="algebraic loop: controllers a -> b -> a wait for each "
                       "other's signals in the same sample; give one of them delay=1"):
        model.controller("b", state_feedback([[1.0]]), ["p"], ["q"], PERIOD)
    model.controller("b", state_feedback([[1.0]]), ["p"], ["q"], PERIOD, delay=1)
    model.controller("m", state_feedback([[1.0]]), ["p"], ["motor"], PERIOD)
    with pytest.raises(InputError, match="controller 'n' sets 'motor', which controller 'm' sets"):
        model.controller("n", state_feedback([[1.0]]), ["p"], ["motor"], PERIOD)
    run = Simulation(model, 0.01)
    for call, message in ((lambda: run.set_input("moter", 1.0), "input 'moter' is unknown: use "
                           "'motor'"),
                          (lambda: run.set_input("motor", np.nan), "input 'motor' is nan"),
                          (lambda: run.read("tip"), "'tip' is unknown")):
        with pytest.raises(InputError, match=message):
            call()
    for given, message in (
            ({"joint": "hing"}, "joint 'hing' is unknown: did you mean 'hinge'|'hing' is unknown"),
            ({}, "acts on nothing, or on several things: give joint="),
            ({"node": "hub"}, "has no direction: give direction="),
            ({"joint": "hinge", "limit": -1.0}, "limit is -1"),
            ({"joint": "hinge", "limit": 1.0, "start": 2.0}, "start is 2.*give one from -1 to 1"),
            ({"between": ("hub", "hub")}, "node 'hub' is joined to itself"),
            ({"node": "hub", "direction": (1.0, 0.0), "inertia": 1.0}, "no rotor turns with")):
        with pytest.raises(InputError, match=message):
            rotor().actuator("a", **given)
