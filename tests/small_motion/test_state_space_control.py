"""State spaces for control: closed loops, regulators, reductions, runs; what is refused."""

import numpy as np
import pytest
from mpmath import findroot, mp, mpc
from numpy.testing import assert_allclose
from scipy.linalg import block_diag, expm
from scipy.signal import lsim

from sebody import InputError, Model, Simulation
from sebody.analysis import equilibrium, modes, state_space
from sebody.control import state_feedback
from sebody.fem import StiffnessSection, planar_beam
from sebody.reduction import craig_bampton
from sebody.small_motion.realization import reduced

UNIT = StiffnessSection(axial=1e4, bending_y=1.0, bending_z=1.0, torsion=1.0, mass=1.0,
                        inertia_x=0.0, inertia_y=0.0, inertia_z=0.0)


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

    system = state_space(equilibrium(pole_on_a_cart(), 1, unstable="keep"), "motor", SEEN)
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


def test_reductions_keep_the_largest_shares_and_the_static_response():
    """Five modes of known shares, in mixed states: three stay, the others answer without delay."""
    w, gain = np.array([1.0, 3.0, 7.0, 20.0, 60.0]), np.array([0.2, 3.0, 0.5, 900.0, 40.0])
    A = block_diag(*([[0.0, 1.0], [-one**2, -0.02 * one]] for one in w))
    B, C = np.kron(gain, [0.0, 1.0])[:, None], np.kron(np.ones(5), [1.0, 0.0])[None]
    mixed = np.random.default_rng(4).normal(size=(10, 10))
    members = reduced(np.linalg.solve(mixed, A @ mixed), np.linalg.solve(mixed, B), C @ mixed,
                      np.array([[0.25]]), 6)
    kept = np.sort(w[np.argsort(-gain / w**2)[:3]])
    poles = np.linalg.eigvals(members["A"])
    assert_allclose(np.sort(np.abs(poles[poles.imag > 0])), kept, rtol=1e-9)

    def response(A, B, C, D, s):
        return (C @ np.linalg.solve(s * np.eye(len(A)) - A, B) + D)[0, 0]
    numbers = [members[name] for name in "ABCD"]
    assert_allclose(response(*numbers, 0.0), 0.25 + (gain / w**2).sum(), rtol=1e-9)
    left = ~np.isin(w, kept)
    assert_allclose(numbers[3], 0.25 + (gain / w**2)[left].sum(), rtol=1e-9)


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
    with pytest.raises(InputError, match="give a Simulation, the Result of"):
        state_space("model", "motor", "tip.position")
