"""Gradients of runs with friction, contacts, gears, actuators and controllers."""

from functools import cache

import differentiated as scenes
import numpy as np
import pytest
from differentiated import TURN, X, Y, Z, place

from sebody import InputError, Model, plane, simulate
from sebody.analysis import Ensemble, calibrate, final, gradient, integral, rms
from sebody.control import pid
from sebody.fem import rectangle
from sebody.gradients import segments
from sebody.gradients.gradient import Differentiated
from sebody.gradients.point import Point
from sebody.runs.schemes import generalized_alpha

EXACT = generalized_alpha(tolerance=1e-13)


def journal(**friction):
    """A pendulum with friction in its bearing, pressed by what the hinge carries; a torque jumps.
    """
    m = Model(planar=True)
    m.gravity((0.3, -9.81))
    a = m.node("a", (0.2, 0.1))
    m.rigid_body("bob", a, 1.3, 0.05, centre=(0.8, -0.2))
    m.revolute(a, name="hinge", explicit=True)
    m.friction("hinge", **{"coefficient": 0.3, "radius": 0.04, "name": "dry"} | friction)
    m.initial_velocity(a, angular=2.0)
    m.torque(a, 1.0, [(0, 0.4), (0.033, 1), (0.033, -1), (0.072, 0.5), (0.072, 2), (0.2, 0.5)],
             name="kick")
    return m


def ball():
    """A turning ball on the ground: it bounces, slides and rolls."""
    m = Model()
    m.gravity(-9.81 * Z + 2.0 * X)
    a = m.node("a", place(0.1, 0.2, 0.099))
    m.rigid_body("body", a, 1.2, TURN @ np.diag([4e-3, 5e-3, 6e-3]) @ TURN.T)
    m.initial_velocity(a, 0.5 * X + 0.2 * Y, angular=Y + 2.0 * Z)
    m.contact(a, on=plane(Z, place(0, 0, 0)), radius=0.1, stiffness=1e4, restitution=0.4,
              friction=0.3, name="floor")
    return m


def gears():
    """Two wheels whose teeth have play."""
    m = Model(planar=True)
    for k, (x, inertia, speed) in enumerate(((0.1, 0.02, 3.0), (0.5, 0.05, 0.0))):
        node = m.node(f"n{k}", (x, 0.2))
        m.rigid_body(f"wheel {k}", node, 1.0, inertia)
        m.revolute(node, name=f"shaft {k}")
        m.initial_velocity(node, angular=speed)
    m.gear("shaft 0", "shaft 1", ratio=-2.5, backlash=0.01, name="mesh", stiffness=200.0)
    m.torque("n0", 0.5, [(0, 0.5), (0.1, 1.0), (0.5, -1)], name="motor")
    m.torsion_spring("n1", stiffness=1.0, damping=0.05, name="coil")
    return m


@cache      # compiling a law takes a second
def arm():
    """A flexible arm, moved to an angle by a motor with a rotor."""
    m = Model(planar=True)
    m.gravity((0.4, -9.0))
    hub, tip = m.node("hub", (0.1, 0.2)), m.node("tip", (1.0, 0.5))
    m.beam("beam", (hub, tip), rectangle(0.03, 0.02, 2e9, 0.3, 1200.0), 4, 1, 2)
    m.rigid_body("rotor", hub, 1.0, 0.02)
    m.revolute(hub, name="hinge")
    m.actuator("motor", joint="hinge", inertia=0.01, ratio=3.0)
    m.controller("loop", pid(20.0, 5.0, 2.0, 80.0, 0.7), ["hinge.angle"], ["motor"])
    return m


# of each scene: what builds it, step and end, objectives, parameters, and the steps of differences
SCENES = {
    "bearing": (journal, 0.005, 0.15, {
        "x": final("a.rotation"), "v": integral("a.angular_velocity"), "f": final("hinge.force")}, [
        "dry.coefficient", "dry.radius", "bob.mass", "gravity", "kick.table",
        "a.angular_velocity"], 1e-3),
    "smooth law": (lambda: journal(speed=0.3), 0.005, 0.1, {
        "x": final("a.rotation"), "m": final("dry.moment")}, [
        "dry.coefficient", "dry.radius", "bob.mass", "gravity.y"], 1e-3),
    "ball": (ball, 0.002, 0.07, {"x": final("a.position"), "v": final("a.velocity")}, [
        "floor.coefficient", "floor.stiffness", "floor.restitution", "floor.level", "body.mass",
        "gravity", "a.velocity"], 1e-6),
    "gears": (gears, 0.002, 0.1, {
        "x": final("n0.rotation"), "v": final("n1.angular_velocity")}, [
        "mesh.ratio", "mesh.stiffness", "mesh.backlash", "wheel 0.mass", "wheel 1.mass",
        "motor.table", "coil.stiffness"], 1e-6),
    "arm": (arm, 0.005, 0.1, {
        "tip": final("tip.position"), "hub": rms("hub.angular_velocity")}, [
        "loop.parameters", "beam.mass", "beam.stiffness", "gravity"], 1e-4),
}


def rows(matrix):
    """Largest entry of each row."""
    return np.maximum(np.abs(matrix).max(axis=1, keepdims=True), 1e-300)


@pytest.mark.filterwarnings("ignore::sebody.LimitWarning")
@pytest.mark.parametrize("name", SCENES)
def test_adjoint_forward_and_differences_of_runs_agree(name):
    """Differences of contacts are short, since steps are cut elsewhere beyond: noise is 4e-7."""
    build, *run, step = SCENES[name]
    m = build()
    one, other = (gradient(m, *run, mode, scheme=EXACT) for mode in ("adjoint", "forward"))
    assert (np.abs(one.matrix - other.matrix) / rows(other.matrix)).max() < 1e-11
    expected = scenes.differences(m, *run, relative=step)
    apart = (np.abs(one.matrix - expected) / rows(expected)).max()
    assert apart < (1e-8 if step > 1e-5 else 2e-6)


def test_steps_in_which_friction_turns_round_are_differentiated_as_they_are():
    """Three returns, in two of which it sticks; differences within the branches."""
    m = journal(coefficient=3.0)
    run = 0.005, 2.0, {"x": final("a.rotation"), "s": integral("a.rotation")}, [
        "dry.coefficient", "gravity", "a.angular_velocity"]
    result = simulate(m, *run[:2], scheme=EXACT)
    assert (np.diff(np.sign(result["a.angular_velocity"])) != 0).sum() == 3
    assert result["dry.sticks"].sum() >= 2
    found = gradient(m, *run, scheme=EXACT)
    expected = scenes.differences(m, *run, relative=1e-5)
    assert (np.abs(found.matrix - expected) / rows(expected)).max() < 1e-6


def test_the_coefficient_of_friction_of_a_measured_decay():
    """A pendulum with noise of a milliradian: within three standard deviations."""
    run = simulate(journal(coefficient=0.21), 0.005, 1.0)
    noise = 1e-3 * np.random.default_rng(3).standard_normal(len(run["t"]))
    found = calibrate(journal(), 0.005, {"a.rotation": np.column_stack(
        [run["t"], run["a.rotation"] + noise])}, ["dry.coefficient"])
    assert abs(found.value[0] - 0.21) < 3 * found.deviation[0] < 0.02


def test_parameters_of_a_law_in_an_ensemble():
    values = np.array([[20.0, 5.0, 2.0, 80.0, 0.7], [25.0, 4.0, 1.0, 70.0, 0.6]])
    found = Ensemble(arm(), 0.005).run({"loop.parameters": values}, 0.1, {
        "tip": final("tip.position")})["tip"]
    with Point(arm(), ["loop.parameters"]).at(values[1]):
        assert found[1] == pytest.approx(simulate(arm(), 0.005, 0.1)["tip.position"][-1], rel=1e-9)
    assert abs(found[0] - found[1]).max() > 1e-3


def _law(t, y, x, rates, u, parameters):
    rates[0] = y[0]
    u[0] = -parameters[0] * y[0] - x[0]


def _samples(t, y, x, u, parameters):
    u[0] = -parameters[0] * y[0]


@pytest.mark.parametrize("sampled", [True, False])
def test_controllers_without_derivatives_are_refused_by_their_names(sampled):
    m = scenes.hinged("b", modes=2)
    m.actuator("motor", joint="hinge")
    with pytest.raises(InputError, match="actuator 'motor'.*table"):
        gradient(m, 0.01, 0.05, {"x": final("tip.position")}, ["gravity"])
    m.controller("loop", _samples if sampled else _law, ["hinge.angle"], ["motor"],
                 period=0.01 if sampled else None, states=[] if sampled else [0.1],
                 parameters=[2.0])
    words = "is sampled.*period=" if sampled else "without derivatives: give derivatives="
    with pytest.raises(InputError, match=f"controller 'loop'.*{words}"):
        gradient(m, 0.01, 0.05, {"x": final("tip.position")}, ["gravity"])


def test_what_jumps_or_is_kept_is_refused():
    m = journal(coefficient=3.0, static=4.0)
    with pytest.raises(InputError, match="'dry' breaks away at t = .*4 to 3.*speed="):
        gradient(m, 0.005, 2.0, {"x": final("a.rotation")}, ["gravity"])
    with pytest.raises(InputError, match="'dry.normal_force' depends on what friction.*keep"):
        gradient(m, 0.005, 0.02, {"f": final("dry.normal_force")}, ["gravity"])
    with pytest.raises(InputError, match="'dry' keeps numbers.*index=3"):
        gradient(m, 0.005, 0.02, {"x": final("a.rotation")}, ["gravity"],
                 scheme=generalized_alpha(index=2))


@pytest.mark.parametrize("mode", ["adjoint", "forward"])
def test_what_laws_keep_goes_on_from_segment_to_segment(mode, monkeypatch):
    m, (_, *run, _) = journal(), SCENES["bearing"]
    whole = gradient(m, *run, mode, scheme=EXACT)
    row = Differentiated(m, *run[:2], EXACT).history.rows[0]
    monkeypatch.setattr(segments, "STATES", 7 * row.nbytes)
    parts = gradient(m, *run, mode, scheme=EXACT)
    assert np.array_equal(parts.value, whole.value)
    assert (np.abs(parts.matrix - whole.matrix) / rows(whole.matrix)).max() < 1e-11
