"""The estimated error of a run against the true one, and the difference of two runs."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import Model, Simulation, SimulationError, simulate
from sebody.model.extent import extent
from sebody.runs import accuracy
from sebody.runs.accuracy import difference, estimated, simulate_within
from sebody.runs.tolerance import Tolerance
from sebody.scenes import stick_slip


@pytest.mark.parametrize("allowed", [1e-3, 1e-4])
def test_the_estimated_error_is_the_true_one(allowed):
    """A mass on a spring, ``x = 1 + u sin(w t)``; errors fall with the square of the steps.

    So the error of the finer of two runs is their difference over ``n^2 - 1``, but for terms of
    third order. Their share is about ``w h``, 0.05 in the coarser of the two runs of 1e-3.
    """
    omega, amplitude = 5.0, 0.5
    model = Model(planar=True)
    model.node("wall", (0.0, 0.0), keeps="translation")
    model.fix("wall", "position")
    model.point_mass("ball", model.node("ball", (1.0, 0.0), keeps="translation"), 1.0)
    model.spring("ball", "wall", omega**2)
    model.initial_velocity("ball", (amplitude * omega, 0.0))
    result = simulate_within(model, 0.05, 10.0, Tolerance(allowed))
    exact = 1.0 + amplitude * np.sin(omega * result.t)
    true = np.sqrt(np.mean((result["ball.position"][:, 0] - exact)**2)) / allowed
    assert result.error == pytest.approx(true, rel=0.05)


@pytest.mark.parametrize(("fast", "amplitude"), [(100.0, 0.01), (100.0, 0.03), (200.0, 0.01)])
def test_vibrations_that_coarse_runs_do_not_resolve(fast, amplitude):
    """Their phase is lost: errors fall more slowly than with the square of the steps at first.

    At that rate the second or third run would count as good enough, at four times the tolerance.
    """
    model = Model(planar=True)
    wall = model.node("wall", (0.0, 0.0), keeps="translation")
    model.fix(wall, "position")
    moves = [(5.0, 0.5), *((fast * (1 + 0.3 * k), amplitude) for k in range(3))]
    for k, (omega, size) in enumerate(moves):
        along = np.array([np.cos(k), np.sin(k)])
        ball = model.node(f"ball {k}", along, keeps="translation")
        model.point_mass(ball.name, ball, 1.0)
        model.spring(wall, ball, omega**2, name=f"spring {k}")
        model.initial_velocity(ball, size * omega * along)
    result = simulate_within(model, 0.01, 2.0, Tolerance(1e-3))
    true = max(
        np.sqrt((((1 + size * np.sin(omega * result.t))[:, None] * (np.cos(k), np.sin(k))
                  - result[f"ball {k}.position"])**2).mean(axis=0)).max()
        for k, (omega, size) in enumerate(moves)) / (1e-3 * extent(model))
    assert true < 1.0
    assert 0.5 * true < result.error <= 1.0


def test_difference_of_rotations_is_their_angle():
    """Two runs alike, but for matrices turned by a small angle against each other."""
    model = Model()
    model.rigid_body("body", model.node("centre", (0, 0, 0)), 1.0, (1.0, 2.0, 2.5))
    model.initial_velocity("centre", angular=(0.3, -0.2, 0.5))
    one = simulate(model, 0.01, 0.5)
    other = replace(one, rows=one.rows.copy())
    angle = 3e-4 * np.sin(7.0 * one.t)
    axis = np.array([2.0, -1.0, 2.0]) / 3
    turned = (Rotation.from_matrix(one["centre.rotation"])
              * Rotation.from_rotvec(np.outer(angle, axis))).as_matrix()
    other.recorded("R")[:] = turned.reshape(-1, 9)
    assert np.shares_memory(other.recorded("R"), other.rows)
    expected = np.sqrt(np.mean(angle**2)) / (1e-3 + 2e-3)
    allowed = Tolerance(1e-3, 1.0, 2e-3)
    assert difference(one, other, allowed) == pytest.approx(expected, rel=1e-6)
    assert difference(one, one, allowed) == 0.0


@pytest.mark.parametrize("order", [1.6, 2.0, 2.6])
def test_the_order_is_that_of_three_runs(order):
    """Errors ``c k^-p``: those of second order are told, others are not told too small."""
    divisors = np.array([1.0, 1.6, 3.2])
    errors = 5.0 * divisors**-order
    found = estimated(divisors, errors[:-1] - errors[1:])
    assert found.regular and found.second == (order == 2.0)
    assert found.most >= errors[-1]
    assert found.error == pytest.approx(errors[-1], rel=1e-6 if order == 2.0 else 2.0)


@pytest.mark.parametrize("differences", [(3.0, 2.9), (1.0, 2.0), (30.0, 0.1)])
def test_irregular_differences_are_no_order(differences):
    """The error then is no less than the last difference."""
    found = estimated((1.0, 1.6, 2.4), differences)
    assert not found.regular and found.error >= differences[-1]


def test_friction_is_never_told_by_an_order():
    """Where it breaks away the step decides, whatever three runs show."""
    smooth, dry = (estimated((1.0, 2.0, 4.0), (3.0, 0.75), smooth) for smooth in (True, False))
    assert smooth.error == pytest.approx(0.25) and dry.error == 0.75 and not dry.regular


def belt(grid, tolerance):
    """A block on a belt (`stick_slip`): its place and the closed form of it."""
    result = simulate_within(stick_slip.build().model, grid, 2.0, Tolerance(tolerance))
    t, x = result.t, np.empty(len(result.t))
    rides = t < 0.4
    x[rides] = 0.1 * t[rides]
    # break-away at 4 N, sliding at 3 N: 0.03 m of the spring, and 10 rad/s
    since = np.mod(t[~rides] - 0.4, 0.15 * np.pi + 0.2)
    slides = since < 0.15 * np.pi
    x[~rides] = np.where(slides, 0.03 + 0.01 * (np.cos(10 * since) + np.sin(10 * since)),
                         0.02 + 0.1 * (since - 0.15 * np.pi))
    return result, result["block.position"][:, 0], x


@pytest.mark.parametrize("grid", [0.02, 0.002])
def test_friction_converges_on_any_output_grid(grid):
    """What bristles give way by falls with the steps, so the difference of runs sees it."""
    for tolerance in (1e-3, 1e-4):
        result, x, exact = belt(grid, tolerance)
        allowed = tolerance * extent(result.model)
        assert np.sqrt(np.mean((x - exact)**2)) <= allowed


def test_errors_of_friction_that_do_not_fall_are_not_called_chaos(monkeypatch):
    monkeypatch.setattr(accuracy, "difference", lambda *_: 2.0)
    with pytest.raises(SimulationError, match="does not decrease with the step: it stays at 2 .*"
                                              "friction breaks away.* larger tolerance"):
        belt(0.02, 1e-2)


def test_bristles_stiffen_with_the_tolerance():
    """At 0.35 s the block still rides, 3.5 N bend its bristle; the grid is the same."""
    bent = []
    for tolerance in (1e-3, 1e-6, 1e-9):
        run = Simulation(stick_slip.build().model, 0.01, tolerance=Tolerance(tolerance))
        bent.append(0.035 - run.run_to(0.35).result()["block.position"][-1, 0])
    assert bent[0] == pytest.approx(3.5e-4, rel=0.1)        # m/h^2 with the grid of 0.01
    assert bent[1:] == pytest.approx([3.5e-6, 3.5e-8], rel=0.1)
