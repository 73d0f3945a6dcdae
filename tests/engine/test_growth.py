"""The guard against energy that grows: it halves steps where it is needed, and nowhere else."""

import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import (
    LimitWarning,
    Model,
    Simulation,
    Tolerance,
    generalized_alpha,
    piecewise,
)
from sebody.engine import growth
from sebody.fem import Section, straight_beam
from sebody.reduction import craig_bampton
from sebody.scenes import chain, hinged_beam, spin_up

sys.path.insert(0, str(Path(__file__).parents[1]))
from struck_frames import OVER, cross, t_frame, u_frame, vibration

SOFT = {"frame": "converged_mean", "stiffening": False}     # gains without end at these steps
BAR = Section(area=1e-4, inertia_y=8e-10, inertia_z=1.2e-9, torsion=1.6e-9, youngs_modulus=7e10,
              poisson_ratio=0.3, density=2700.0)


def run(model, h, t_end, **options):
    """A run to some time, and its warnings."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", LimitWarning)
        simulation = Simulation(model, h, **options)
        result = simulation.run_to(t_end).result()
    return simulation, result, [str(one.message) for one in told]


def after(result, start):
    """Kinetic and strain energy from a time on."""
    return (result["energy.kinetic"] + result["energy.strain"])[result.t > start]


@pytest.mark.parametrize("struck, options", [
    (t_frame(), SOFT), (t_frame(), {"frame": "converged_mean"}), (cross(), SOFT),
    (u_frame(), SOFT)])
def test_frames_that_gained_energy_keep_it(struck, options):
    """Without the guard they gain multiples of the energy of vibrations, or stop before 0.2 s."""
    simulation, result, told = run(struck.model(**options), 1e-3, 0.2)
    energy = after(result, OVER - 5e-4)
    assert energy.max() - energy[0] < 0.1 * vibration(struck)
    guard, steps = simulation.state.guard, int(simulation.state.control.steps)
    assert guard.rejections > 0 and steps > 200
    assert result.t == pytest.approx(1e-3 * np.arange(201), abs=1e-12)      # the output grid stays
    message, = (text for text in told if text.startswith("energy grew by 2 % of the strain"))
    assert f"{int(guard.rejections)} steps from t = {guard.first:.6g} to" in message
    assert f"take a step of {1e-3 / 2**guard.most_halved:.2g}, divide the body" in message
    assert message in result.warnings and not any("Newton's iteration" in text for text in told)


def test_the_same_in_other_units_and_places():
    """In millimetres and grams, turned and far from the origin, the same step is rejected first.

    With a tight tolerance: what Newton's iteration leaves grows in such motions, too.
    """
    struck = u_frame()
    turn = Rotation.from_rotvec([0.4, 1.1, -0.3]).as_matrix()
    section = Section(area=struck.section.area * 1e6, torsion=struck.section.torsion * 1e12,
                      inertia_y=struck.section.inertia_y * 1e12,
                      inertia_z=struck.section.inertia_z * 1e12,
                      youngs_modulus=struck.section.youngs_modulus, poisson_ratio=0.3,
                      density=struck.section.density * 1e-6)
    other = struck._replace(
        points=1e3 * struck.points @ turn.T + np.array([4e3, -7e3, 2e3]), section=section,
        spin=tuple(turn @ struck.spin), forces=1e6 * struck.blows() @ turn.T)
    scheme = generalized_alpha(tolerance=1e-12)
    one, another = (run(frame.model(**SOFT), 1e-3, 0.06, scheme=scheme)[0].state.guard
                    for frame in (struck, other))
    assert one.rejections > 0
    assert another.first == one.first
    for energy in ("most_kinetic", "most_strain"):
        assert another[energy] == pytest.approx(1e9 * one[energy], rel=1e-4)


def test_a_run_that_goes_on_is_the_same():
    """In pieces as in one."""
    model = t_frame().model(**SOFT)
    whole, pieces = run(model, 1e-3, 0.05)[0], Simulation(model, 1e-3)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LimitWarning)
        for t in (0.017, 0.031, 0.05):
            pieces.run_to(t)
    assert np.array_equal(whole.state.now, pieces.state.now)
    assert np.array_equal(whole.state.guard, pieces.state.guard)


def test_variable_steps_are_halved_too():
    """A tolerance so loose that steps do not resolve what the blow has excited."""
    struck = t_frame()
    simulation, result, told = run(struck.model(**SOFT), 1e-3, 0.1, tolerance=Tolerance(0.1))
    rejections = simulation.state.guard.rejections
    assert rejections > 0
    # what has risen until a step is rejected stays, each time
    assert np.ptp(after(result, OVER - 5e-4)) < 0.06 * rejections * vibration(struck)
    assert any("take a smaller tolerance, divide the body" in text for text in told)


def bar(ends, modes=4):
    """A bar between two points as a body."""
    return craig_bampton(straight_beam(*ends, BAR, elements=8), [(0, "full"), (8, "full")], modes)


def tumbling():
    """A bar that hardly bends, in general spin."""
    model, ends = Model(), np.array([[0.3, -0.2, 0.5], [0.7, 0.1, 0.4]])
    model.superelement("bar", bar(ends), [model.node("a", ends[0]), model.node("b", ends[1])])
    model.rigid_velocity((3.0, 1.0, -2.0), (2.0, -3.0, 5.0), ends.mean(axis=0))
    return model, 0.02, 2.0


def bouncing():
    """A bar that falls on a stiff wall, a user's force that is on for few steps."""
    model, ends = Model(), np.array([[0.0, 0.1, 0.3], [0.3, 0.2, 0.2]])
    nodes = [model.node("a", ends[0]), model.node("b", ends[1])]
    model.superelement("bar", bar(ends), nodes)
    model.gravity((0.0, 0.0, -9.81))
    model.user_force("wall", nodes, wall)
    return model, 1e-3, 0.6


def wall(t, x, v, force):
    """Pushes back below zero height."""
    for k in range(2, x.size, 3):
        force[k] = 2e5 * max(-x[k], 0.0) ** 1.5


def switched():
    """A bar on a hinge, at rest until a torque is switched on and off."""
    model, ends = Model(), np.array([[0.1, 0.2, 0.3], [0.8, 0.6, -0.1]])
    nodes = [model.node("foot", ends[0]), model.node("tip", ends[1])]
    model.superelement("bar", bar(ends), nodes)
    model.revolute("foot", (1.0, 2.0, -1.0))
    model.torque("foot", (0.0, 0.3, 0.4), piecewise((0.0, 0.0), (0.1, 1.0), (0.3, 0.0)))
    return model, 2e-3, 0.8


def driven():
    """Kane's spin-up: a drive that starts from rest."""
    scene = spin_up.build("kane", bodies=1, modes=2, inertia="floating_field")
    return scene.model, scene.h, 3.0


def falling():
    """Links that whip round; some steps are too long for Newton's iteration."""
    scene = chain.build()
    return scene.model, scene.h, 2.0


def hinged():
    """The shipped beam."""
    return hinged_beam.build().model, 0.01, 20.0


@pytest.mark.parametrize("build", [tumbling, bouncing, switched, driven, falling, hinged])
def test_other_motions_are_left_alone(build):
    """Rigid rotation in long steps, contacts, jumps, drives, rest: no step is rejected for it."""
    model, h, t_end = build()
    guard = run(model, h, t_end)[0].state.guard
    assert guard.rejections == 0 and guard.in_vain == 0
    assert guard.off == 0 and guard.most_strain > 0.0


def test_models_without_bodies_are_not_looked_at():
    model = Model()
    model.rigid_body("top", model.node("top", (0, 0, 1)), 1.0, np.diag([0.1, 0.2, 0.25]))
    assert run(model, 0.01, 0.1)[0].state.guard.off == 1.0


def test_what_energy_may_grow_by_follows_the_largest_turn_of_a_frame():
    """Frames of bodies are turned by known angles from where a step left them."""
    run = Simulation(chain.build(links=3).model, 1e-3).run_to(0.02)
    state, found = run.state, []
    frames = state.frames.reshape(-1, 3, 3)
    for scale in (1.0, 2.0):
        angles = scale * np.array([0.01, 0.03, 0.02])
        axes = np.array([(0.6, 0.0, 0.8), (0.0, -0.8, 0.6), (2.0, 1.0, -2.0) / np.float64(3.0)])
        turns = Rotation.from_rotvec(angles[:, None] * axes).as_matrix()
        state.frames_old[:] = (turns @ frames).ravel()
        found.append(growth.look_at_energies(run.system, state)[2])
    more = growth.TURNED * (0.06**2 - 0.03**2) * state.guard.most_kinetic
    assert found[1] - found[0] == pytest.approx(more, rel=1e-3)     # sine and angle: a^2 / 12
