"""State spaces against frequency responses, closed forms, a run, and python-control's LQR."""

import numpy as np
import pytest
from mpmath import findroot, mp, mpc
from numpy.testing import assert_allclose
from scipy.linalg import expm
from scipy.signal import lsim
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Simulation
from sebody.analysis import equilibrium, frequency_response, modes, state_space
from sebody.catalogue import builder, scenes
from sebody.control import state_feedback
from sebody.fem import StiffnessSection, planar_beam, rectangle
from sebody.reduction import craig_bampton

TURN = Rotation.from_rotvec((0.7, -1.1, 0.4)).as_matrix()
UNIT = StiffnessSection(axial=1e4, bending_y=1.0, bending_z=1.0, torsion=1.0, mass=1.0,
                        inertia_x=0.0, inertia_y=0.0, inertia_z=0.0)


def assert_same_response(run, loads, names, omega, spin=None):
    """The state space and `frequency_response` agree, relative to the largest of every quantity.

    Forces are stiffnesses times displacements, which cancel: rounding leaves 1e-10 of them. What
    stiffnesses round by is relative to the highest frequency, which counts far below it.
    """
    system = state_space(run, loads, names, spin=spin)
    G = system.response(omega)
    rounding = np.finfo(float).eps * (np.abs(system.poles).max() / omega)**2
    allowed = np.maximum(2e-10, rounding)[:, None]
    for j, load in enumerate(loads):
        answers, at = frequency_response(run, load, names, omega, spin), 0
        def kind(name):
            quantity = name.rpartition(".")[2]
            return "force" if quantity in ("moment", "reaction") else quantity
        largest = {kind(name): 0.0 for name in names}
        for name in names:
            largest[kind(name)] = max(largest[kind(name)], np.abs(answers[name]).max())
        for name in names:
            expected = answers[name].reshape(len(omega), -1)
            found = G[:, at:at + expected.shape[1], j]
            at += expected.shape[1]
            size = np.abs(expected).max(axis=1, keepdims=True)
            # of those that hardly answer: rounding of the others
            assert (np.abs(found - expected) <= allowed * size + 1e-12 * largest[kind(name)]
                    + 1e-15).all(), (
                name, np.abs(found - expected).max(axis=1) / size[:, 0])
    return system


def quantities(model):
    """Motion of all nodes, forces of all joints and reactions of all supports."""
    found = []
    for name, node in model.nodes.items():
        if node.position is not None:
            found += [f"{name}.{what}" for what in ("position", "velocity", "acceleration")]
            found += [f"{name}.reaction"] if node.position.fixed else []
        if node.rotation is not None:
            found += [f"{name}.{what}" for what in ("rotation", "angular_velocity")]
    return found + [f"{joint.name}.{what}" for joint in model.joints for what in (
        "force", "moment")] + [f"{name}.modes" for name, body in model.bodies.items()
                               if body.reduced.modes]


def frequencies(run, spin=None):
    """Below, between and above the lowest natural frequencies."""
    w = np.sort([abs(one) for one in modes(run, spin).values if abs(one) > 1e-3])
    if not w.size:      # of a mechanism without springs
        return np.array([0.5, 3.0, 20.0])
    return np.array([0.3 * w[0], 1.3 * w[0], 0.5 * (w[1] + w[2]) if len(w) > 2 else 2.0 * w[0]])


def test_every_scene_with_a_load():
    count = 0
    for name in scenes():
        scene = builder(name)()
        loads = [load.name for load in scene.model.loads
                 if load.time_function is not None and not load.time_function.is_time]
        if not loads:
            continue
        count += 1
        run = Simulation(scene.model, scene.h)
        system = assert_same_response(run, loads, quantities(scene.model), frequencies(run))
        less, omega = system.minimal(), frequencies(run)
        assert_allclose(less.response(omega), system.response(omega), rtol=0,
                        atol=1e-8 * np.abs(system.response(omega)).max())
    assert count > 6


def four_bar(planar):
    """A loop of flexible links under its weight; in space with redundant hinges, turned."""
    model = Model(planar=planar)
    size = 2 if planar else 3
    turn = np.eye(size) if planar else TURN
    points = [(0.0, 0.0), (0.3, 1.1), (1.9, 1.4), (2.0, 0.0)]
    places = [turn @ np.array([*point, 0.0][:size]) for point in points]
    # soft: forces of stiff bodies are differences of large ones, in both functions
    section = rectangle(0.03, 0.05, 2e8, 0.3, 900.0)
    ends = []
    for k in range(3):
        a, b = (model.node(f"{side}{k}", place) for side, place in zip(
            "ab", places[k:k + 2], strict=True))
        up = {} if planar else {"up": turn @ (0.3, -0.2, 1.0)}
        model.beam(f"link{k}", (a, b), section, 4, 1, 2, **up)
        ends.append((a, b))
    axis = {} if planar else {"axis": turn @ (0.0, 0.0, 1.0)}
    model.revolute(ends[0][0], name="base", **axis)
    model.revolute(ends[0][1], to=ends[1][0], name="knee", **axis)
    model.revolute(ends[1][1], to=ends[2][0], name="ankle", **axis)
    model.revolute(ends[2][1], name="far", **axis)
    model.torsion_spring(ends[0][0], stiffness=400.0, damping=3.0, name="rest", **axis)
    model.gravity(turn @ np.array([0.0, -9.81, 0.0][:size]))
    model.torque(ends[0][0], 1.0 if planar else turn @ (0.0, 0.0, 1.0), 0.0)
    model.force(ends[1][1], turn @ np.array([0.4, -1.0, 0.0][:size]), 0.0, name="push")
    return model


@pytest.mark.parametrize("planar", [True, False])
def test_a_loop_under_its_weight(planar):
    model = four_bar(planar)
    rest = equilibrium(model, 4)
    system = assert_same_response(rest, ["torque on a0.rotation", "push"], quantities(model),
                                  frequencies(rest))
    assert np.sum(np.abs(system.poles) < 30.0) >= 2     # the mechanism on its spring
    # the poles are those of the modes, which takes another basis of what constraints allow
    for value in modes(rest).values[:6]:
        # eigenvalues of A round relative to the norm of A
        assert np.abs(system.poles - value).min() < 1e-12 * np.abs(system.poles).max()**2 / abs(
            value)


def test_a_spinning_body_with_rigid_links():
    """A flexible blade at the end of an arm of a hub, in its own axes, with a steady rotation."""
    model = Model()
    hub = model.node("hub", (0.0, 0.0, 0.0))
    root = model.attach("root", TURN @ (0.2, 0.1, 0.0), hub)
    tip = model.node("tip", TURN @ (1.2, 0.1, 0.05))
    model.rigid_body("wheel", hub, 5.0, TURN @ np.diag([0.3, 0.3, 0.5]) @ TURN.T)
    model.beam("blade", (root, tip), rectangle(0.02, 0.05, 2e8, 0.3, 900.0), 6, 1, 4,
               up=TURN @ (0.1, 0.3, 1.0))
    model.revolute(hub, axis=TURN @ (0.0, 0.0, 1.0), name="bearing")
    model.force(tip, TURN @ (0.2, 0.5, -1.0), 0.0, follower=True, name="push")
    model.torque(hub, TURN @ (0.0, 0.0, 1.0), 0.0, name="motor")
    spin = TURN @ (0.0, 0.0, 12.0)
    rest = equilibrium(model, 4, spin=spin)
    assert_same_response(rest, ["push", "motor"], quantities(model), frequencies(rest, spin), spin)


def test_a_moved_support():
    """A mass on a spring and a damper whose other end is moved: two states of the motion."""
    model = Model(planar=True)
    support, mass = model.node("support", (0.0, 0.0)), model.node("mass", (1.0, 0.0))
    model.rigid_body("m", mass, 2.0, 1.0)
    model.fix(mass, "rotation")
    model.fix(support, "rotation")
    model.move(support, (1.0, 0.0), lambda t: 0.0 * t, name="shake")
    model.spring(mass, support, stiffness=50.0, damping=3.0)
    above = model.node("above", (1.0, 5.0))
    model.fix(above)
    model.spring(mass, above, stiffness=10.0)
    system = state_space(Simulation(model, 0.01), "shake", ["mass.position", "mass.acceleration"])
    assert system.inputs == ("shake.acceleration",) and system.states[-2:] == ("shake",
                                                                               "shake.rate")
    w = np.array([0.5, 3.0, 5.0, 20.0])
    G = -w[:, None]**2 * system.response(w)[:, :, 0]
    exact = (50 + 3j * w) / (50 - 2 * w**2 + 3j * w)
    assert_allclose(G[:, 0], exact, rtol=0, atol=1e-11)
    assert_allclose(G[:, 2], -w**2 * exact, rtol=1e-11)
    assert_allclose(G[:, 1], 0.0, atol=1e-11)


def hinged(elements=20, count=4, hub=0.1, section=UNIT):
    """Beam of length, bending stiffness and mass one on a hinge."""
    model = Model(planar=True)
    a, b = model.node("hub", (0.0, 0.0)), model.node("tip", (1.0, 0.0))
    body = craig_bampton(planar_beam((0, 0), (1, 0), section, elements=elements),
                         [(0, "full"), (elements, "full")], modes=count)
    model.superelement("beam", body, [a, b])
    if hub:
        model.rigid_body("rotor", a, 1.0, hub)
    model.revolute(a, name="hinge")
    return model


def test_a_driven_hinge():
    """Tip and torque of Euler and Bernoulli's beam that is turned at one end."""
    model = hinged(60, 16, 0.0)
    model.drive_angle("hub", lambda t: 0.0 * t, name="motor")
    system = state_space(Simulation(model, 0.01), "motor", ["tip.position.y", "motor.torque"])
    for w in (1.0, 3.0, 10.0):
        b = np.sqrt(w)
        A = [[-np.sin(b), -np.cos(b), np.sinh(b), np.cosh(b)],
             [-np.cos(b), np.sin(b), np.cosh(b), np.sinh(b)], [0, 1, 0, 1], [b, 0, b, 0]]
        c = np.linalg.solve(A, [0, 0, 0, 1])
        exact = c @ [np.sin(b), np.cos(b), np.sinh(b), np.cosh(b)], w * (c[1] - c[3])
        # 60 elements, 16 modes, a beam that stretches a little: 7e-7
        assert_allclose(-w * w * system.response(w)[0, :, 0].real, exact, rtol=1e-6)


def test_roots_of_a_beam_with_a_controlled_hinge():
    """Proportional and derivative torque at the hinge, against the characteristic equation.

    It is solved here, by Muller's method in 40 digits, about the roots found.
    """
    kp, kd, hub = 2.0, 0.5, 0.1
    model = hinged()
    model.torque("hub", 1.0, 0.0, name="motor")
    system = state_space(Simulation(model, 0.01), "motor", ["hub.rotation",
                                                            "hub.angular_velocity"])
    closed = system.A - system.B @ [[kp, kd]] @ system.C
    found = np.linalg.eigvals(closed)
    loop = hinged()         # the same as a law in the equations of motion
    loop.actuator("motor", joint="hinge")
    loop.controller("law", state_feedback([[kp, kd]]), ["hinge.angle", "hinge.rate"], ["motor"])
    values = modes(Simulation(loop, 0.01)).values
    with mp.workdps(40):
        def characteristic(s):
            b = mp.sqrt(s / mpc(0, 1))
            Z = kp + kd * s + hub * s * s
            return mp.det(mp.matrix([
                [-mp.sin(b), mp.sinh(b), mp.cos(b) + mp.cosh(b)],
                [-mp.cos(b), mp.cosh(b), mp.sinh(b) - mp.sin(b)], [Z, Z, -2 * b]])) / mp.cosh(b)
        for guess, error in ((-0.346 + 1.896j, 1.4e-6), (-1.896 + 7.531j, 8e-6),
                             (-0.219 + 22.97j, 1.6e-4)):
            root = complex(findroot(characteristic, (guess, guess * 1.001, guess + 0.001j),
                                    solver="muller", tol=1e-30))
            assert np.abs(found - root).min() < error * abs(root)   # of four modes
            assert np.abs(values - root).min() < error * abs(root)


def pole_on_a_cart():
    """A flexible pole upright on a cart, held at its place by almost nothing."""
    model = Model(planar=True)
    cart, foot, top = (model.node(name, place) for name, place in (
        ("cart", (0.0, 0.0)), ("foot", (0.0, 0.0)), ("top", (0.0, 1.0))))
    section = StiffnessSection(axial=1e5, bending_y=2.0, bending_z=2.0, torsion=1.0, mass=0.2,
                               inertia_x=0.0, inertia_y=0.0, inertia_z=0.0)
    body = craig_bampton(planar_beam((0, 0), (0, 1), section, elements=20),
                         [(0, "full"), (20, "full")], modes=4).damped(0.005)
    model.superelement("pole", body, [foot, top])
    model.rigid_body("box", cart, 1.0, 1.0)
    model.prismatic(cart, axis=(1.0, 0.0), name="rail")
    model.revolute(foot, to=cart, name="hinge")
    model.gravity((0.0, -9.81))
    model.force(cart, (1.0, 0.0), 0.0, name="motor")
    end = model.node("end", (-5.0, 0.0))
    model.fix(end)
    model.spring(cart, end, stiffness=1e-7)
    return model


SEEN = ("cart.position", "cart.velocity", "foot.rotation", "foot.angular_velocity",
        "top.position", "top.velocity")


def test_a_regulator_of_a_pole_on_a_cart():
    """python-control's regulator on these matrices, and the poles of the loop it closes."""
    pytest.importorskip("control.statesp")  # "control" is a folder of tests, too
    import control

    system = state_space(equilibrium(pole_on_a_cart(), 1), "motor", SEEN)
    unstable = system.poles.real.max()
    assert_allclose(unstable, 4.1041215, rtol=1e-7)     # with 8 modes 4.1041252, rigid 4.1008710
    weights = np.zeros(len(system.outputs))
    for name, weight in (("cart.position.x", 10.0), ("foot.rotation", 20.0)):
        weights[system.outputs.index(name)] = weight
    Q = system.C.T @ np.diag(weights) @ system.C + 1e-6 * np.eye(len(system.A))
    K, _, poles = control.lqr(system.A, system.B, Q, [[0.1]])
    closed = np.linalg.eigvals(system.A - system.B @ K)
    for pole in poles:
        assert np.abs(closed - pole).min() < 1e-9 * max(1.0, np.abs(poles).max())
    assert closed.real.max() < 0.0
    same = system.to_control()
    assert_allclose(same.A, system.A)
    assert same.input_labels == ["motor"] and "cart_position_x" in same.output_labels


def test_a_small_signal_run():
    """SciPy's `lsim` of the matrices and a run under a small torque differ by the step's error."""
    model = hinged()
    size, rate = 1e-5, 9.0
    model.torque("hub", 1.0, lambda t: size * np.sin(rate * t), name="motor")
    system = state_space(Simulation(model, 0.01), "motor", ["tip.position.y", "hub.rotation"])
    errors = []
    for h in (0.02, 0.01):
        result = Simulation(model, h).run_to(2.0).result()
        t = result["t"]
        fine = np.linspace(0.0, 2.0, 16 * (len(t) - 1) + 1)
        _, y, _ = lsim((*system[:2], *system[2:4]), size * np.sin(rate * fine), fine)
        found = np.column_stack([result["tip.position.y"], result["hub.rotation"]])
        errors.append(np.abs(found - y[::16]).max() / np.abs(y).max())
    assert errors[0] < 0.05 and 3.0 < errors[0] / errors[1] < 5.5       # of second order


def test_reductions():
    model = hinged(20, 8)
    model.torque("hub", 1.0, 0.0, name="motor")
    system = state_space(Simulation(model, 0.01), "motor", ["tip.position", "hinge.force"])
    less = system.minimal()
    assert len(less.A) < len(system.A) and less.outputs == system.outputs
    w = np.array([0.7, 9.0, 40.0])
    assert_allclose(less.response(w), system.response(w), rtol=0,
                    atol=1e-9 * np.abs(system.response(w)).max())
    small = system.reduce(6)
    assert len(small.A) == 6 and np.abs(small.poles).max() < 70.0
    exact = system.response(0.7)[0, 1]      # near two modes, the others static
    assert_allclose(small.response(0.7)[0, 1], exact, rtol=1e-3)
    # the response to a step in time, by another way
    t = 0.37
    size = len(less.A)
    E = expm(t * np.block([[less.A, less.B], [np.zeros((1, size + 1))]]))
    n = len(system.A)
    F = expm(t * np.block([[system.A, system.B], [np.zeros((1, n + 1))]]))
    assert_allclose(less.C @ E[:size, size], system.C @ F[:n, n], rtol=1e-7, atol=1e-9)


def test_what_is_refused():
    model = hinged()
    run = Simulation(model, 0.01)
    with pytest.raises(InputError, match="the model has no load, actuator or drive, so no input"):
        state_space(run, "motor", "tip.position")
    model.torque("hub", 1.0, 0.0, name="motor")

    def law(t, x, v, force):
        force[1] = -x[1]
    model.user_force("magnet", ["tip"], law)
    run = Simulation(model, 0.01)
    for inputs, outputs, message in (
            ("motr", "tip.position", "input 'motr' is unknown: use 'motor'"),
            ("magnet", "tip.position", "'magnet' is a user force, which has no amplitude"),
            ("motor", "tip.positon", "did you mean 'tip.position'"),
            ("motor", [], "outputs is .*: name at least one"),
            (["motor", "motor"], "tip.position", "inputs is .*: name each once"),
            ("motor", "motor.power", "'motor.power' is a product of the input 'motor' and a vel"),
            ("motor", "motor.work", "'motor.work' has no linear model: time and work")):
        with pytest.raises(InputError, match=message):
            state_space(run, inputs, outputs)
    model = hinged()
    model.torque("hub", 1.0, 0.0, name="motor")
    system = state_space(Simulation(model, 0.01), "motor", "tip.position")
    with pytest.raises(InputError, match="order is 1: poles at zero and unstable ones alone have"):
        system.reduce(1)
    with pytest.raises(InputError, match="give a Simulation, or the Result"):
        state_space(model, "motor", "tip.position")
