"""Guards of the reference model, each against runs whose difference is made on purpose."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from sebody import Model, harmonic, simulate
from sebody.explore.advice.guards import (
    EXPECTED,
    GROWTH,
    SMALL,
    Scales,
    amplified,
    disturbed,
    off_the_grid,
)
from sebody.explore.advice.loads import missed
from sebody.explore.advice.quantities import Values
from sebody.explore.advice.reference import Reference
from sebody.model.histories import time_function

H, GRID, T_END = 0.00927, 0.01, 1.0
UNREAD = None   # the worst place of a reference, which these guards do not need


def ball(load=None, velocity=(0.0, 0.0, 0.0)):
    model = Model()
    model.point_mass("ball", model.node("ball", (1.0, 2.0, 3.0), keeps="translation"), 2.0)
    model.initial_velocity("ball", velocity)
    if load is not None:
        model.force("ball", (0.3, 0.4, 0.0), load, name="push")
    return model


def guarded(load, change, step_error):
    """What the guard says of a run whose reference differs by (t) -> change, of size 1."""
    run = simulate(ball(load), H, T_END)
    values = Values([run["ball.position"]], [])
    times = GRID * np.arange(round(run.t[-1] // GRID) + 1)
    best = CubicSpline(run.t, values.histories[0])(times)
    best[:, 1] += change(times)
    reference = Reference(Values([best], []), [1.0], 0.0, step_error, True, UNREAD)
    return off_the_grid(run, values, H, reference, GRID)[1]


@pytest.mark.parametrize("times, told", [(0.9, False), (1.1, True)])
def test_another_step_may_make_a_multiple_of_the_error_by_the_step(times, told):
    error = times * EXPECTED * 1e-3
    doubt = guarded(harmonic(1.0, 3.0), lambda t: np.full(len(t), error), 1e-3)
    assert doubt.error == (pytest.approx(error, rel=1e-6) if told else 0.0)


@pytest.mark.parametrize("before, told", [(0.1, True), (4.0, False)])
def test_beside_a_jump_nothing_is_compared_beside_a_small_one_all(before, told):
    """Of 0.1 and of 4, before another one to 10."""
    rows = [(0.0, 0.0), (0.2, 0.0), (0.2, before), (0.5, before), (0.5, 10.0), (1.0, 10.0)]
    doubt = guarded(rows, lambda t: 0.01 * (np.abs(t - 0.2) < 0.02), 1e-4)
    assert bool(doubt.error) == told


def test_positions_and_rotations_are_disturbed_by_their_own_speeds():
    model = ball()
    model.rigid_body("wheel", model.node("wheel", (0.0, 0.0, 0.0)), 1.0, (1.0, 2.0, 2.5))
    found = disturbed(model, Scales(1.0, 10.0, 4e5, 0.0, 1.0))
    for node in found.nodes.values():
        assert 0.01 < np.abs(node.position.rate).max() / (10.0 * SMALL) < 10.0
    assert 0.01 < np.abs(found.nodes["wheel"].rotation.rate).max() / (4e5 * SMALL) < 10.0


@pytest.mark.parametrize("times, told", [(0.9, False), (1.1, True)])
def test_what_a_drift_makes_is_no_growth(times, told):
    """To and fro by 0.01 at a speed of 1 for 1 s: a change of speed is a hundredfold change."""
    scales = Scales(0.01, 1.0, 0.0, 0.0, T_END)
    factor = times * GROWTH * 101.0
    off = factor * SMALL * scales.travel
    still, run = (simulate(ball(velocity=(v, 0.0, 0.0)), H, T_END) for v in (0.0, 1.0))
    run.rows[:] = still.rows + off / T_END * (run.rows - still.rows)
    doubt = amplified(run, still, scales).doubt
    assert bool(doubt.error) == told


def test_a_jump_on_a_step_loses_half_a_step_of_the_load():
    """A triangle beside an area of a half; other lines of the spectrum are hardly larger."""
    rows = [(0.0, 1.0), (0.5, 1.0), (0.5, 0.0), (1.0, 0.0)]
    for h in (0.1, 0.02):
        found = missed(["push"], [time_function(rows)], h, 1.0)
        assert found.name == "push" and found.share == pytest.approx(h, rel=1e-3)
