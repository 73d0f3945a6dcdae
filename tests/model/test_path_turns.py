"""Nodes that turn with the tangent of a path: other formulations, closed forms, malformed input."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sebody import InputError, Model, simulate
from sebody.analysis import equilibrium, vibrations
from sebody.fem import rectangle

G = 9.81


def carriage(half=None, elements=20, bodies=1, modes=4):
    """A carriage on an arm that falls, its centre beside the path; or the same on two wheels."""
    model, c = Model(planar=True), np.array([np.cos(0.5), np.sin(0.5)])
    base, tip = model.node("base", 0 * c), model.node("tip", 2 * c)
    model.beam("arm", (base, tip), rectangle(0.01, 0.04, youngs_modulus=7e10, poisson_ratio=0.0,
                                             density=2700.0), elements=elements, bodies=bodies,
               modes=modes)
    model.revolute(base)
    car = model.node("car", 1.2 * c)
    model.rigid_body("carriage", car, 0.3, 0.02, centre=(0.0, 0.15))
    model.gravity((0.0, -G))
    model.path("rail", on="arm")
    if half is None:
        model.path_joint(car, "rail", turns="with", name="runs")
    else:
        for name, place in (("rear", 1.2 - half), ("front", 1.2 + half)):
            model.path_joint(model.attach(name, place * c, car), "rail", name=name)
    return model


@pytest.mark.filterwarnings("ignore")
def test_a_carriage_turns_with_the_arm_it_runs_on():
    """Way, angle and force along the path of another program of these equations, in one table.

    The moment times the curvature pushes along the path as much as the force there holds back, and
    the joint does no work.
    """
    result = simulate(carriage(), 5e-4, 0.3)
    assert result["runs.way"][-1] == pytest.approx(0.977405, abs=2e-5)
    assert result["car.rotation"][-1] == pytest.approx(-0.288214, abs=5e-6)
    assert result["runs.local_force"][-1, 0] == pytest.approx(0.203625, abs=2e-4)
    assert np.abs(result["runs.moment"]).max() > 1.0
    assert np.abs(result["runs.thrust"]).max() < 1e-8 * np.abs(result["runs.force"]).max()
    assert np.abs(result["runs.power"]).max() < 1e-6
    energy = sum(result[f"energy.{part}"] for part in ("kinetic", "strain", "potential"))
    assert np.ptp(energy) < 1e-5


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("bodies", "modes"), [(1, 4), (4, 4)])
def test_two_wheels_of_a_shorter_and_shorter_base_do_the_same(bodies, modes):
    """By one body, and by several that are welded, whose modes bend between the wheels, too.

    A base is wrong by its square where modes are long against it and in proportion to it where
    they are short, so a quarter of it leaves at most a quarter of the error.
    """
    result = simulate(carriage(None, 40, bodies, modes), 1e-3, 0.3)
    limit, errors = np.array([result["runs.way"][-1], result["car.rotation"][-1]]), []
    for half in (0.05, 0.0125):
        one = simulate(carriage(half, 40, bodies, modes), 1e-3, 0.3)
        errors.append(np.linalg.norm(np.array([(one["rear.way"] + one["front.way"])[-1] / 2,
                                               one["car.rotation"][-1]]) - limit))
    assert errors[1] < errors[0] / 4


MASS, INERTIA, RADIUS = 2.0, 0.3, 1.5
ANGLES = np.linspace(-0.5, 4.0, 121)


def ring(start, on=None, shift=(3.0, -1.0), field=(1.0, -5.0), held=False):
    """A body on a circle to which it keeps its angle; on the ground or on a node."""
    model, centre = Model(planar=True), np.array(shift)
    points = centre + RADIUS * np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=1)
    if on:
        model.fix(model.node(on, centre - 0.3))
    model.path("ring", on=on, points=points)
    node = model.node("node", centre + RADIUS * np.array([np.cos(start), np.sin(start)]))
    model.rigid_body("body", node, MASS, INERTIA)
    model.gravity(field)
    model.path("other", points=[centre, centre + 1.0])
    model.path_joint(node, "ring", turns="with", name="runs")
    if held:
        model.spring("runs", stiffness=400.0, damping=3.0, length=3.0)
    return model


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("on", [None, "hub"])
def test_a_body_on_a_ring_is_a_pendulum(on):
    """Of the inertia about the centre of the ring, in general position."""
    model, field, begin = ring(0.4 * np.pi, on), np.array([1.0, -5.0]), 0.4 * np.pi
    found = solve_ivp(lambda _, z: [z[1], MASS * RADIUS / (MASS * RADIUS**2 + INERTIA) * field @ (
        -np.sin(begin + z[0]), np.cos(begin + z[0]))], (0.0, 0.6), [0.0, 0.0], "DOP853",
        rtol=1e-10, atol=1e-12)
    result = simulate(model, 1e-3, 0.6)
    angle, rate = found.y[:, -1]
    assert result["node.rotation"][-1] == pytest.approx(angle, abs=3e-6)
    assert abs(angle) > 0.1
    turned = MASS * RADIUS / (MASS * RADIUS**2 + INERTIA) * field @ (
        -np.sin(begin + angle), np.cos(begin + angle))
    assert result["runs.moment"][-1] == pytest.approx(INERTIA * turned, rel=2e-3)
    assert result["node.angular_velocity"][-1] == pytest.approx(rate, abs=1e-5)


@pytest.mark.filterwarnings("ignore")
def test_small_motions_on_a_ring():
    """Stiffness of a spring along the ring and of gravity, about the equilibrium."""
    model = ring(0.4 * np.pi, field=(0.0, -G), held=True)
    state = equilibrium(model)
    way = simulate(model, 1e-3, 2e-3, start=state)["runs.way"][0]
    step = ANGLES[1] - ANGLES[0]
    angle = way * step / (2 * RADIUS * np.sin(step / 2)) + ANGLES[0]    # ways are along chords
    assert 400.0 * (way - 3.0) == pytest.approx(-MASS * G * np.cos(angle), rel=2e-4)
    stiffness = 400.0 - MASS * G * np.sin(angle) / RADIUS
    omega = np.sqrt(stiffness / (MASS + INERTIA / RADIUS**2))
    found = vibrations(state).omega[0]
    assert found == pytest.approx(omega, rel=2e-3)


@pytest.mark.filterwarnings("ignore")
def test_friction_takes_the_force_of_a_path_that_turns_a_node():
    """It slows the body by the coefficient times what presses, which is all energy that is lost."""
    model = ring(0.4 * np.pi)
    model.friction("runs", 0.1, name="rubs")
    result = simulate(model, 5e-4, 0.6)
    energy = result["energy.kinetic"] + result["energy.potential"]
    lost = energy[0] - energy[-1]
    assert lost > 0.1
    rub = 0.1 * result["runs.normal_force"] * np.abs(result["runs.rate"])
    assert np.trapezoid(rub, result.t) == pytest.approx(lost, rel=1e-3)


def test_malformed_turns_are_refused():
    model = ring(0.4 * np.pi, "hub")
    point = model.node("point", model.nodes["node"].point, "translation")
    with pytest.raises(InputError, match="path joint at 'point'|node 'point' has no rotation"):
        model.path_joint(point, "ring", turns="with")
    free = model.node("free", model.nodes["node"].point)
    for wrong in ("without", 3, "", True):
        with pytest.raises(InputError, match="path joint at 'free': turns"):
            model.path_joint(free, "ring", turns=wrong)
    follows = model.attach("follows", model.nodes["node"].point, "hub")
    with pytest.raises(InputError, match="turns as a node of 'hub' does"):
        model.path_joint(follows, "ring", turns="with")
    assert len(model.joints) == 1
