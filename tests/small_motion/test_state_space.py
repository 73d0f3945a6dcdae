"""State spaces against frequency responses and their own frequencies."""

import numpy as np
import pytest
from noise import noise
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from sebody import Model, Simulation
from sebody.analysis import equilibrium, frequency_response, modes, state_space
from sebody.catalogue import builder, scenes
from sebody.fem import rectangle

TURN = Rotation.from_rotvec((0.7, -1.1, 0.4)).as_matrix()


def assert_same_response(run, loads, names, omega, spin=None, rounded=None):
    """The state space and `frequency_response` agree, relative to the largest of every quantity.

    Forces are stiffnesses times displacements, which cancel: rounding leaves 1e-10 of them. What
    stiffnesses round by is relative to the highest frequency, which counts far below it. Measured
    `noise` of a load's answers, by their names, may be `rounded`, too.
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
            own = rounded[load][name][:, None] if rounded else 0.0
            assert (np.abs(found - expected) <= allowed * size + 1e-12 * largest[kind(name)]
                    + 1e-15 + own).all(), (
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
                 if load.time_function is not None and not load.time_function.is_time
                 and load.series is None]
        if not loads:
            continue
        count += 1
        run = Simulation(scene.model, scene.h)
        system = assert_same_response(run, loads, quantities(scene.model), frequencies(run))
        less, omega = system.minimal(), frequencies(run)
        assert_allclose(less.response(omega), system.response(omega), rtol=0,
                        atol=1e-8 * np.abs(system.response(omega)).max())
    assert count > 6


def four_bar(planar, weight=9.81):
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
    model.gravity(turn @ np.array([0.0, -weight, 0.0][:size]))
    model.torque(ends[0][0], 1.0 if planar else turn @ (0.0, 0.0, 1.0), 0.0)
    model.force(ends[1][1], turn @ np.array([0.4, -1.0, 0.0][:size]), 0.0, name="push")
    return model


@pytest.mark.parametrize("planar", [True, False])
def test_a_loop_under_its_weight(planar):
    model = four_bar(planar)
    rest = equilibrium(model, 4)
    loads, names, omega = ["torque on a0.rotation", "push"], quantities(model), frequencies(rest)

    def largest(weight):
        """The largest answer of each quantity to each load, at each frequency."""
        here = equilibrium(four_bar(planar, float(weight)), 4)
        answers = [frequency_response(here, load, names, omega) for load in loads]
        return [[np.abs(own[name].reshape(len(omega), -1)).max(axis=1) for name in names]
                for own in answers]
    rounded = noise(largest, 9.81, most=1e-9)
    system = assert_same_response(rest, loads, names, omega, rounded={
        load: dict(zip(names, own, strict=True)) for load, own in zip(loads, rounded, strict=True)})
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
