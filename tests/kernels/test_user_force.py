"""Forces of users, compiled into the loop, and forces on internal modes."""

import numpy as np
import pytest

from sebody import InputError, Model, Simulation, generalized_alpha, simulate
from sebody.fem import planar_beam
from sebody.reduction import craig_bampton
from sebody.scenes.hinged_beam import SECTION
from sebody.small_motion.linearization import modes

FINE = generalized_alpha(0.95, 1e-11)


def two_masses():
    model = Model()
    for k, x in enumerate((0.0, 1.0)):
        node = model.node(f"m{k}", (x, 0.1 * k, 0.0), keeps="translation")
        model.point_mass(f"m{k}", node, 1.0 + k)
    model.initial_velocity("m0", (0.0, 0.5, -0.3))
    return model


def spring_and_damper(t, x, v, force):
    """Stiffness 30, cubic 40, damping 0.5, length 0.8 between two points."""
    gap, rate, now, along = np.empty(3), np.empty(3), 0.0, 0.0
    for i in range(3):
        gap[i], rate[i] = x[3 + i] - x[i], v[3 + i] - v[i]
        now += gap[i] ** 2
    now = np.sqrt(now)
    for i in range(3):
        along += gap[i] * rate[i] / now
    u = now - 0.8
    pull = 30.0 * u + 40.0 * u**3 + 0.5 * along
    for i in range(3):
        force[i] = pull * gap[i] / now
        force[3 + i] = -pull * gap[i] / now


def test_user_function_equals_the_generated_spring():
    own, generated = two_masses(), two_masses()
    own.user_force("rope", ["m0", "m1"], spring_and_damper)
    generated.spring("m0", "m1", 30.0, 0.5, 0.8, cubic=40.0)
    a, b = (simulate(m, 2e-3, 2.0, FINE) for m in (own, generated))
    for name in ("m0.position", "m1.velocity"):
        assert np.abs(a[name] - b[name]).max() < 1e-9
    assert a.iterations_per_step < b.iterations_per_step + 0.2      # differences are exact enough
    lost = b["spring at m0.work"] - (b["energy.strain"] - b["energy.strain"][0])
    assert np.abs(a["rope.work"] - lost).max() < 1e-4 * np.abs(lost).max()    # trapezoids


def test_user_function_sees_the_time():
    model = Model(planar=True)
    model.point_mass("ball", model.node("ball", (0.0, 0.0), keeps="translation"), 2.0)

    def push(t, x, v, force):
        force[0] = 6.0 * t
    model.user_force("push", ["ball"], push)
    result = simulate(model, 1e-3, 1.0)
    assert result["ball.position"][-1] == pytest.approx([0.5, 0.0], abs=1e-6)


def test_force_on_a_mode():
    """A clamped beam: the mode answers as an oscillator of its own frequency."""
    body = craig_bampton(planar_beam((0, 0), (100.0, 0), SECTION, 10),
                         [(0, "full"), (10, "full")], 2)
    model = Model(planar=True)
    nodes = [model.node("base", (0, 0)), model.node("tip", (100.0, 0))]
    model.superelement("beam", body, nodes)
    model.fix("base")
    model.fix("tip")
    model.mode_force("beam", 1, 50.0)
    omega = np.sqrt(body.stiffness[7, 7])
    result = simulate(model, 1e-3 / omega * 10, 10 / omega, FINE)
    exact = 50.0 / omega**2 * (1 - np.cos(omega * result.t))
    amplitude = result["beam.modes"]
    assert np.abs(amplitude[:, 1] - exact).max() < 1e-4 * exact.max()
    assert np.abs(amplitude[:, 0]).max() < 1e-12    # orthogonal modes: rounding of a reduced mass
    assert result["force on mode 1 of beam.work"][-1] == pytest.approx(50.0 * exact[-1], rel=1e-3)


def needs_a_file(t, x, v, force):
    open("nothing")


@pytest.mark.parametrize("action, message", [
    (lambda m: m.user_force("u", [], spring_and_damper), "user force 'u' has no nodes"),
    (lambda m: m.user_force("u", ["m0"], needs_a_file), "user force 'u' cannot be compiled: write "
                                                        "function.t, x, v, force. with"),
    (lambda m: m.user_force("u", ["m0"], lambda t: t), "user force 'u' has the arguments .t."),
    (lambda m: m.mode_force("beam", 0, 1.0), "superelement 'beam' is unknown: the model has none"),
])
def test_wrong_forces(action, message):
    model = two_masses()
    with pytest.raises(InputError, match=message):
        action(model)
    assert not model.loads


def test_tangent_of_a_user_function():
    """Derivatives by place and rate, from the eigenvalues ``m s^2 + c s + k = 0``.

    The function is linear: central differences have no error of their own, only rounding over
    the step of 1e-6, about 1e-10.
    """
    mass, damping, stiffness = 2.0, (0.8, 3.0), (50.0, 18.0)
    model = Model(planar=True)
    model.point_mass("ball", model.node("ball", (0.0, 0.0), keeps="translation"), mass)

    def pull(t, x, v, force):
        force[0] = -50.0 * x[0] - 0.8 * v[0]
        force[1] = -18.0 * x[1] - 3.0 * v[1]
    model.user_force("pull", ["ball"], pull)
    found = modes(Simulation(model, 0.01))
    half = np.array(damping) / (2 * mass)
    exact = -half + 1j * np.sqrt(np.array(stiffness) / mass - half**2)
    assert found.values == pytest.approx(exact[np.argsort(exact.imag)], rel=1e-8)
