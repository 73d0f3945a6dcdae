"""Time integration: the recurrences of the scheme, resuming, cut steps, failing runs."""

from dataclasses import fields, replace

import numpy as np
import pytest

from sebody import InputError, Model, Simulation, SimulationError, generalized_alpha
from sebody.engine.scalars import numbers_of
from sebody.model.histories import time_function
from sebody.scenes.hinged_beam import build


def test_loop_follows_the_scheme():
    """Auxiliary and true accelerations of a run satisfy the recurrences of the scheme."""
    scene = build()
    run = Simulation(scene.model, 0.01, generalized_alpha(0.8, tolerance=1e-12)).run_to(1.0)
    am, af, beta, gamma = run.scheme[:4]
    s, h = run.state, 0.01
    assert np.allclose((1 - am) * s.aux + am * s.aux_old, (1 - af) * s.a + af * s.a_old,
                       rtol=1e-9, atol=1e-9)
    # rates and increments are corrected in step with accelerations: rounding of a few corrections
    rounding = 1e2 * np.finfo(float).eps
    assert np.allclose(s.v, s.v_old + h * ((1 - gamma) * s.aux_old + gamma * s.aux), rtol=0,
                       atol=rounding * h * np.abs(s.aux).max())
    assert np.allclose(s.dq[:3], h * s.v_old[:3] + h * h * (
        (0.5 - beta) * s.aux_old[:3] + beta * s.aux[:3]), rtol=0,
        atol=rounding * h * h * np.abs(s.aux).max())


def test_run_in_pieces_equals_one_run():
    whole = Simulation(build().model, 0.01).run_to(2.0).result()
    pieces = Simulation(build().model, 0.01)
    for t in (0.5, 0.51, 2.0):
        pieces.run_to(t)
    assert np.array_equal(whole["tip.position"], pieces.result()["tip.position"])
    assert np.array_equal(whole.t, pieces.result().t)


def test_state_restarts_a_run():
    """A copy of the state continues exactly as the original does."""
    first = Simulation(build().model, 0.01).run_to(1.0)
    other = Simulation(build().model, 0.01)
    for field in fields(first.state):
        value = getattr(first.state, field.name)
        if isinstance(value, np.record):
            numbers_of(getattr(other.state, field.name))[:] = numbers_of(value)
        else:
            getattr(other.state, field.name)[:] = value
    assert np.array_equal(first.run_to(2.0).result()["tip.position"][-1],
                          other.run_to(2.0).result()["tip.position"][-1])


def test_output_every():
    every = Simulation(build().model, 0.01).run_to(1.0).result()
    thin = Simulation(build().model, 0.01, output_every=10).run_to(1.0).result()
    assert np.array_equal(every["tip.position"][::10], thin["tip.position"])
    assert np.allclose(thin.t, np.arange(11) * 0.1)


def struck(height, h=0.01):
    """The hinged beam pushed at its tip so hard that long steps cannot converge."""
    scene = build()
    scene.model.force("tip", (0, 0, height), [(0.1, 0.0), (0.11, 1.0), (0.12, 0.0)])
    return Simulation(scene.model, h)


def test_cut_steps_rejoin_the_grid():
    run = struck(1e5).run_to(0.3)
    result = run.result()
    assert result.cuts > 0
    assert np.allclose(result.t, np.arange(31) * 0.01, rtol=0, atol=1e-12)      # products of h
    fine = struck(1e5, 0.000625).run_to(0.3).result()["tip.position"][::16]
    assert np.abs(result["tip.position"][:10] - fine[:10]).max() < 1e-3


def test_failed_run_keeps_what_it_has():
    run = struck(1e12)
    with pytest.raises(SimulationError, match="stopped at t = 0.1.*(half a revolution|converge)"
                       ) as caught:
        run.run_to(0.5)
    kept = caught.value.result
    assert 0.09 < kept.t[-1] < 0.12
    assert np.isfinite(kept["tip.position"]).all()
    assert "FAILED" in kept.summary()
    assert run.state.control.cuts >= 12


def test_cannot_run_backwards():
    with pytest.raises(InputError, match="later time"):
        Simulation(build().model, 0.01).run_to(0.5).run_to(0.2)


@pytest.mark.parametrize("h, t_end, steps", [
    (0.1, 0.3, 3),          # 0.3 / 0.1 is 2.9999999999999996 in floating point,
    (0.1, 0.7, 7),          # 0.7 / 0.1 is 6.999999999999999
    (0.1, 0.26, 3), (0.1, 0.24, 2)])
def test_a_run_ends_at_the_step_nearest_to_the_wanted_time(h, t_end, steps):
    model = Model(planar=True)
    model.point_mass("ball", model.node("ball", (0.0, 0.0), keeps="translation"), 1.0)
    model.initial_velocity("ball", (2.0, 0.0))
    run = Simulation(model, h).run_to(t_end)
    assert run.result().steps == steps
    assert run.time == pytest.approx(steps * h, rel=1e-14)      # a product and its rounding
    assert run.result()["ball.position"][-1] == pytest.approx([2.0 * steps * h, 0.0], rel=1e-9)


def stronger(model):
    model.loads[0].constants["d"][:] *= 2.0


def sooner(model):
    model.loads[0].time_function = time_function([(0.0, 0.0), (1.0, 1.2e4)])


def stiffer(model):
    body = model.element("beam")
    body.reduced = replace(body.reduced, stiffness=2.0 * body.reduced.stiffness)


def heavier(model):
    body = model.element("beam")
    own = body.reduced.invariants
    doubled = {name: 2.0 * getattr(own, name) for name in (
        "mass", "c0", "S1", "J0", "g", "h", "K", "J2", "Mbar")}
    body.reduced = replace(body.reduced, mass=2.0 * body.reduced.mass,
                           invariants=replace(own, **doubled))


def another_frame(model):
    model.element("beam").alpha[:] = 0.8, 0.2


def pulled(model):
    model.force("tip", (0, 0, 1.0), [(0.0, 0.0), (0.1, 100.0)])


def falling(model):
    model.gravity((0, 0, -9.81))


@pytest.mark.parametrize("change", [stronger, sooner, stiffer, heavier, another_frame, pulled,
                                    falling])
def test_a_model_changed_between_runs_runs_as_it_is(change):
    """Nothing that the set-up of one run leaves behind is taken for the changed model."""
    used, fresh = build().model, build().model
    before = Simulation(used, 0.01).run_to(0.2).result()
    change(used)
    change(fresh)
    after = Simulation(used, 0.01).run_to(0.2).result()
    assert np.array_equal(after.rows, Simulation(fresh, 0.01).run_to(0.2).result().rows)
    assert not np.array_equal(after["tip.position"], before["tip.position"])
