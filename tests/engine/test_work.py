"""Works of loads, dampers, drives and moved nodes, against closed forms and the scheme's identity.

The trapezoidal rule (rho 1) keeps kinetic plus quadratic strain energy less work to the tolerance
of Newton's iteration, at any step: impacts, stiff dampers and short pulses included.
"""

import numpy as np
import pytest
from helpers import order

from sebody import Model, Tolerance, generalized_alpha, harmonic, simulate, trapezoidal
from sebody.fem import Section, straight_beam
from sebody.reduction import craig_bampton

EXACT = generalized_alpha(1.0, tolerance=1e-12)
PULSE = [(0.0, 0.0), (0.0103, 0.0), (0.016, 1.0), (0.02, 0.0), (9.0, 0.0)]
BEAM = Section(area=1e-4, inertia_y=8e-10, inertia_z=8e-10, torsion=1.6e-9, youngs_modulus=7e9,
               poisson_ratio=0.3, density=2.7e3)


def touching(t, x, v, force):
    """A wall of Hunt and Crossley at z = 0."""
    if x[2] < 0.0:
        force[2] = 1e4 * (-x[2])**1.5 * (1.0 - 0.5 * v[2])


def weight(at=(1.0, 0.5, 0.2), mass=1.0):
    model = Model()
    node = model.node("weight", at)
    model.point_mass("weight", node, mass)
    model.fix(node, "rotation")
    return model, node


def thrown():
    model, node = weight((0.0, 0.0, 1e-6))
    model.initial_velocity(node, (0.3, 0.0, -1.0))
    model.user_force("wall", [node], touching)
    return model


def dampers():
    """A spring and damper, a bushing with dampers, a pulse on a weight between fixed nodes."""
    model, node = weight()
    model.fix(model.node("foot", (0.0, 0.0, 0.0)))
    model.spring(node, "foot", 0.0, damping=300.0)
    model.rigid_body("box", model.node("box", (0.3, -0.5, 0.1)), 2.0, (0.02, 0.03, 0.04))
    model.fix(model.node("wall", (0.3, -0.5, 0.1)))
    model.bushing("wall", "box", stiffness=4e3, damping=(20.0, 30.0, 40.0))
    model.force(node, (50.0, 20.0, -10.0), PULSE)
    model.force("box", (0.0, 20.0, -10.0), PULSE)
    return model


def driven():
    """Two rotors on one axis, a stiff damper in between, corners in the rate of the drive."""
    model = Model(planar=True)
    for name, inertia in (("a", 0.1), ("b", 0.05)):
        model.rigid_body(f"rotor {name}", model.node(name, (0.2, 0.1)), 1.0, inertia)
        model.revolute(name)
    model.drive_angle("a", trapezoidal(2.0, 3.0, 30.0), name="motor")
    model.torsion_spring("a", 4e3, 5.0, to="b")
    return model


def moved():
    """A node moved without unknown, a weight on a spring and damper behind it."""
    model, node = weight()
    base = model.node("base", (0.4, 0.1, 0.0), keeps="translation")
    model.move(base, (0.6, 0.8, 0.0), trapezoidal(0.1, 1.0, 30.0), name="shake")
    model.spring(base, node, 2e3, damping=40.0)
    return model


def linear(build):
    """Whether strain energies are quadratic and their directions do not turn."""
    return build in (thrown, driven)


@pytest.mark.parametrize("build, h", [(thrown, 0.01), (thrown, 2e-3), (driven, 5e-3),
                                      (driven, 0.0137), (dampers, 2e-3), (moved, 2e-3)])
def test_balance_of_the_scheme(build, h):
    """What turns during a step leaves the balance to the cube of its angle."""
    result = simulate(build(), h, round(0.5 / h) * h, EXACT)
    assert result.energy_balance() < (1e-9 if linear(build) else 1e-5)
    works = np.ptp(result.recorded("works"), axis=0)
    assert works.max() > 1e-3


@pytest.mark.parametrize("steps, found", [(8, 1e-3), (40, 5e-5)])
def test_balance_of_an_impact(steps, found):
    """With numerical damping, at some steps in contact: a sixtieth of what mean powers give."""
    h = 0.0838531180 / steps
    assert simulate(thrown(), h, round(0.15 / h) * h).energy_balance() < found


@pytest.mark.parametrize("turned", [False, True])
def test_bodies_with_damping(turned):
    """A hinged bar that a pulse strikes: kinetic and strain energy end as work of the damping."""
    start, end = np.array([[0.1, 0.2, 0.3], [0.8, 0.6, -0.1]])
    body = craig_bampton(straight_beam(start, end, BEAM, elements=8),
                         [(0, "full"), (8, "full")], modes=4).damped(0.05)
    balances = []
    for h in (1e-3, 5e-4, 2.5e-4):
        model = Model()
        nodes = model.node("foot", start), model.node("tip", end)
        model.superelement("bar", body, nodes)
        if turned:
            model.revolute("foot", (1.0, 2.0, -1.0))
        else:
            model.fix("foot")
        model.force("tip", (0.0, 3.0, 6.0), PULSE)
        result = simulate(model, h, 0.3, EXACT)
        balances.append(result.energy_balance())
        assert result["damping of bar.work"][-1] < -0.2 * result["force on tip.position.work"][-1]
    assert balances[1] < 4e-3 and 1.7 < order((4, 2, 1), balances) < 2.3


def test_works_are_those_of_closed_forms():
    """A forced oscillator at resonance: ``x = A (1 - exp(-z w t)) ..`` gives and takes as much.

    In the steady state the force does ``pi F A`` in a period, which the damper takes.
    """
    c, k, m, F = 0.8, 40.0, 2.0, 3.0
    w = np.sqrt(k / m)
    model, node = weight((1.0, 0.0, 0.0), m)
    model.fix(model.node("foot", (0.0, 0.0, 0.0)))
    spring = model.spring(node, "foot", k, damping=c, name="spring")
    model.force(node, (1.0, 0.0, 0.0), harmonic(F, w), name="push")
    assert spring.name == "spring"
    period, size = 2.0 * np.pi / w, F / (c * w)
    errors = []
    for count in (50, 100):
        result = simulate(model, period / count, 60 * period, generalized_alpha(1.0))
        push, lost = (result[f"{name}.work"][[59 * count, 60 * count]] @ [-1.0, 1.0]
                      for name in ("push", "spring"))
        errors.append(abs(push / (np.pi * F * size) - 1.0))
        assert push == pytest.approx(-lost, rel=1e-5)
    assert errors[1] < 2e-3 and errors[1] < 0.3 * errors[0]


def test_works_within_variable_steps():
    """On an output grid much finer than the steps works are those of the motion there."""
    model = Model(planar=True)
    node = model.node("weight", (0.2, 0.1))
    model.rigid_body("weight", node, 2.0, 0.1)
    model.fix(node, "rotation")
    model.force(node, (1.0, 0.0), harmonic(3.0, 2.0), name="push")
    model.move(model.node("base", (0.0, 0.1), keeps="translation"), (0.0, 1.0), harmonic(0.2, 3.0),
               name="shake")
    model.spring(node, "base", 5.0, damping=0.5, name="spring")
    result = simulate(model, 1e-3, 3.0, tolerance=Tolerance(1e-4))
    assert result.steps < 500
    fine = simulate(model, 1e-4, 3.0, output_every=10)
    for name in ("push", "shake", "spring"):
        apart = np.abs(result[f"{name}.work"] - fine[f"{name}.work"]).max()
        assert apart < 3e-3 * np.ptp(fine[f"{name}.work"]), name
    assert result.energy_balance() < 5e-3
