"""Gradients of runs: adjoint against forward, and both against differences of runs and theory."""

import differentiated as scenes
import numpy as np
import pytest
from helpers import multipliers_first
from readings import TABLE

from sebody import InputError, Model, Simulation, Tolerance
from sebody.analysis import at_time, final, gradient, integral, rms, soft_maximum
from sebody.assembly import build as assembly
from sebody.gradients import course, segments
from sebody.gradients.gradient import Differentiated
from sebody.model import profiles
from sebody.runs.schemes import generalized_alpha, hht
from sebody.scenes import chain


@pytest.mark.filterwarnings("ignore::sebody.LimitWarning")
@pytest.mark.parametrize("name", [name for name, row in TABLE.items()
                                  if row.objectives or "gradient" in row.refused])
def test_adjoint_forward_and_differences_of_runs_agree(name):
    """Differences of the sixth order have noise of 1e-13 of the runs over their steps."""
    row = TABLE[name]
    model, words = row.build(), row.refused.get("gradient")
    if words:
        with pytest.raises(InputError, match=words):
            gradient(model, row.h, 3 * row.h, {"x": final(row.followed)}, ["gravity"],
                     scheme=scenes.EXACT)
        return
    found, apart = scenes.both(model, *row.run)
    assert apart < 1e-11
    expected = scenes.differences(model, *row.run, relative=row.step)
    assert (np.abs(found.matrix - expected) / scenes.rows(expected)).max() < row.noise


def test_both_sweeps_give_the_same_with_the_usual_tolerance():
    """States of laws have small weights."""
    row = TABLE["law in a loop"]
    back, forth = (gradient(row.build(), *row.run, mode=mode).matrix
                   for mode in ("adjoint", "forward"))
    assert (np.abs(back - forth).max(axis=0) < 1e-9 * np.abs(forth).max(axis=0)).all()


@pytest.mark.filterwarnings("ignore::sebody.LimitWarning")
@pytest.mark.parametrize("name", ["flexible loop", "jumps of loads", "moved in a plane"])
@pytest.mark.parametrize("mode", ["adjoint", "forward"])
def test_products_give_what_matrices_in_every_step_do(name, mode, monkeypatch):
    """Old inverses and refinement, against a factorized exact matrix in every step."""
    build, run = TABLE[name].build, TABLE[name].run
    found = gradient(build(), *run, mode, scheme=scenes.EXACT)
    monkeypatch.setattr(course.Course, "refined", lambda *_, **others: None)
    exact = gradient(build(), *run, mode, scheme=scenes.EXACT)
    assert (np.abs(found.matrix - exact.matrix) / scenes.rows(exact.matrix)).max() < 1e-11


# runs of scenes, whose segments have few events: parameters of which forces are polynomials
LONG = {
    "jumps of loads": TABLE["jumps of loads"].run,
    "given velocities": TABLE["given velocities"].run,
    "moved base": (*TABLE["moved base"].run[:2], {
        "end": final("end.velocity"), "way": rms("tip.position"),
        "far": soft_maximum("energy.kinetic")}, ["swing.amplitude", "ball.mass"])}


def in_segments(monkeypatch, events, *run, **others):
    """Gradients of a run as a whole, and in segments."""
    whole = gradient(*run, **others)
    row = Differentiated(run[0], run[1], run[1], scenes.EXACT).history.rows[0]
    monkeypatch.setattr(segments, "STATES", events * row.nbytes)
    return whole, gradient(*run, **others)


@pytest.mark.filterwarnings("ignore::sebody.LimitWarning")
@pytest.mark.parametrize("name", LONG)
@pytest.mark.parametrize("mode", ["adjoint", "forward"])
def test_segments_that_are_run_again_give_the_same(name, mode, monkeypatch):
    """Segments are computed again to the last digit; sums over them are rounded otherwise."""
    whole, parts = in_segments(monkeypatch, 7, TABLE[name].build(), *LONG[name], mode=mode,
                               scheme=scenes.EXACT)
    assert np.array_equal(parts.value, whole.value)
    assert (np.abs(parts.matrix - whole.matrix) / scenes.rows(whole.matrix)).max() < 1e-12
    assert parts.growth == pytest.approx(whole.growth, rel=1e-9)


@pytest.mark.parametrize("mode", ["adjoint", "forward"])
def test_segments_of_variable_steps(mode, monkeypatch):
    whole, parts = in_segments(monkeypatch, 10, oscillator(), 0.02, 1.2, {
        "x": final("a.position.x"), "v": rms("a.velocity.x"),
        "a": at_time("a.acceleration.x", 0.77), "far": soft_maximum("a.position.x", 6),
        "sum": integral("spring.force.x")}, [
        "spring.stiffness", "spring.damping", "ball.mass", "push.amplitude"], mode=mode,
        tolerance=Tolerance(1e-4), scheme=scenes.EXACT)
    assert np.array_equal(parts.value, whole.value)
    assert (np.abs(parts.matrix - whole.matrix) / scenes.rows(whole.matrix)).max() < 1e-12


def test_segments_of_runs_with_row_exchanges(monkeypatch):
    """Factors, which are no part of a state, are made again."""
    monkeypatch.setattr(assembly, "number", multipliers_first(assembly.number))
    model = chain.build(4).model
    tip, body = list(model.nodes)[-1], next(iter(model.bodies))
    run = model, 1e-3, 0.02, {"tip": final(f"{tip}.position")}, [f"{body}.mass", "gravity"]
    assert Simulation(*run[:2], scenes.EXACT).run_to(0.02).state.control.pivoted == 1
    whole, parts = in_segments(monkeypatch, 5, *run, scheme=scenes.EXACT)
    assert np.array_equal(parts.value, whole.value)
    assert (np.abs(parts.matrix - whole.matrix) / scenes.rows(whole.matrix)).max() < 1e-12


def test_angles_beyond_a_turn_are_followed_from_segment_to_segment(monkeypatch):
    """A rotor under a constant moment: ``M t^2 / (2 J)``, which is linear in M."""
    m, inertia = Model(), np.diag([0.2, 0.3, 0.4])
    angle = 0.9 * 4.0**2 / 2 / (scenes.Z @ inertia @ scenes.Z)
    assert angle > 6 * np.pi
    a = m.node("a", (0.3, 0.0, 0.0))
    m.rigid_body("rotor", a, 1.0, inertia)
    m.revolute(a, axis=scenes.Z, name="bearing")
    m.torque(a, 0.9 * scenes.Z, [(0, 1), (9, 1)], name="torque")
    monkeypatch.setattr(segments, "STATES", 1e4)
    found = gradient(m, 0.02, 4.0, {"angle": final("bearing.angle"), "z": final("a.rotation.z")},
                     ["torque.amplitude"], scheme=scenes.EXACT)
    assert found.value == pytest.approx([angle, angle * scenes.Z[2]], rel=1e-9)
    assert found.matrix[0, 0] == pytest.approx(angle, rel=1e-9)


@pytest.mark.parametrize("scheme", [hht(-0.1, 1e-13), generalized_alpha(0.3, 1e-13)])
def test_other_schemes(scheme):
    run = scenes.hinged("b", modes=2), 0.005, 0.1, {"tip": final("tip.velocity")}, ["beam.mass"]
    one, other = (gradient(*run, mode, scheme=scheme) for mode in ("adjoint", "forward"))
    assert (np.abs(one.matrix - other.matrix) / scenes.rows(other.matrix)).max() < 1e-11
    expected = scenes.differences(*run, scheme=scheme)
    assert (np.abs(one.matrix - expected) / scenes.rows(expected)).max() < 1e-7


def test_forces_stiffness_and_mass_together_change_nothing():
    """Of a model without gravity, loads, stiffness and mass times one factor leave the motion."""
    m = scenes.hinged("b")
    m.gravity((0.0, 0.0, 0.0))
    m.loads = [one for one in m.loads if one.name == "torque"]
    found, _ = scenes.both(
        m, 0.005, 0.2, {"tip": final("tip.position"), "sum": integral("tip.velocity")},
        ["torque.amplitude", "beam.stiffness", "beam.mass"])
    assert (np.abs(found.matrix.sum(axis=1)) / scenes.rows(found.matrix)[:, 0]).max() < 1e-10


def oscillator(stiffness=40.0, damping=0.6, mass=1.3, amplitude=2.0):
    """A mass on a spring with a damper along a line, under a harmonic force."""
    m = Model()
    a, wall = m.node("a", (1.0, 0.0, 0.0)), m.node("wall", (0.0, 0.0, 0.0))
    m.fix(wall)
    m.fix(a, "rotation")
    m.point_mass("ball", a, mass)
    m.spring(a, wall, stiffness=stiffness, damping=damping, length=1.0, name="spring")
    m.force(a, (amplitude, 0, 0), profiles.harmonic(1.0, 5.0), name="push")
    return m


@pytest.mark.parametrize("tolerance", [None, Tolerance(1e-4)])
def test_a_linear_oscillator_against_its_own_recursion(tolerance):
    """The scheme applied to m x'' + c x' + k x = f, differentiated by complex steps.

    With variable steps the sequence of their lengths is that of the run.
    """
    t_end, s = 1.2, generalized_alpha()
    steps = Differentiated(oscillator(), 0.02, t_end, scenes.EXACT, tolerance).history.steps[1:]
    assert (np.ptp(steps) > 0.5 * steps.max()) == (tolerance is not None)

    def last(k, c, m, f):
        x = v = t = 0.0
        a = aux = (f * np.sin(0.0) - c * v - k * x) / m
        before = steps[0]
        for h in steps:
            # aux' = ((1 - af) a' + af a - am aux) / (1 - am) in x', v'; m a' = f' - c v' - k x'
            aux = a + h / before * (aux - a)
            t, before = t + h, h
            on = (s.alpha_f * a - s.alpha_m * aux) / (1 - s.alpha_m)
            share = (1 - s.alpha_f) / (1 - s.alpha_m)
            x1 = x + h * v + h * h * ((0.5 - s.beta) * aux + s.beta * on)
            v1 = v + h * ((1 - s.gamma) * aux + s.gamma * on)
            a1 = (f * np.sin(5.0 * t) - c * v1 - k * x1) / (
                m + c * h * s.gamma * share + k * h * h * s.beta * share)
            x, v = x1 + h * h * s.beta * share * a1, v1 + h * s.gamma * share * a1
            a, aux = a1, on + share * a1
        return x
    values = dict(k=40.0, c=0.6, m=1.3, f=2.0)
    exact = [np.imag(last(**(values | {name: values[name] + 1e-30j}))) / 1e-30 for name in "kcmf"]
    for mode in ("adjoint", "forward"):
        found = gradient(oscillator(), 0.02, t_end, {"x": final("a.position.x")},
                         ["spring.stiffness", "spring.damping", "ball.mass", "push.amplitude"],
                         mode, tolerance, scenes.EXACT)
        assert found.value[0] == pytest.approx(1.0 + last(**values), rel=1e-9)
        # factors of mass and load count from one; times are rounded
        assert found.matrix[0] / (1, 1, 1.3, 2.0) == pytest.approx(exact, rel=1e-8)


def test_components_of_parameters():
    """Components of parameters have names, and the shipped scene is in general position enough."""
    from sebody.scenes.hinged_beam import build

    found = gradient(build().model, 0.01, 1.0, {"tip": final("tip.position.y")}, [
        "torque on base.rotation.amplitude", "gravity.x", "base.angular_velocity.z"],
        scheme=scenes.EXACT)
    assert found.columns[1:] == ("gravity.x", "base.angular_velocity.z")
    expected = scenes.differences(build().model, 0.01, 1.0, {"tip": final("tip.position.y")}, [
        "torque on base.rotation.amplitude", "gravity.x"], relative=1e-2)
    assert found.matrix[:, :2] == pytest.approx(expected, rel=1e-7)


def test_the_model_is_as_before():
    m = scenes.hinged()
    before = gradient(m, 0.01, 0.05, {"x": final("tip.position")}, ["gravity", "beam.mass"])
    after = gradient(m, 0.01, 0.05, {"x": final("tip.position")}, ["gravity", "beam.mass"])
    assert np.array_equal(before.value, after.value)
    assert np.array_equal(before.matrix, after.matrix)
    assert before.of("x", "beam.mass").shape == (3, 1)
