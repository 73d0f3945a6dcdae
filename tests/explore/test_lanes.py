"""Runs eight at a time: each equals a single run, in whatever company it is made."""

import gc
import weakref

import numpy as np
import pytest
from lane_models import linkage, single, turned_beam
from scipy.integrate import solve_ivp

from sebody import Model, generalized_alpha
from sebody.analysis import (
    Ensemble,
    at_time,
    final,
    integral,
    maximum,
    minimum,
    rms,
    soft_maximum,
)
from sebody.catalogue import builder
from sebody.compiler.choice import way
from sebody.explore.ensembles import ensemble
from sebody.explore.ensembles.work import alike

H, T_END = 2e-3, 0.06
RUNS = 11       # one group of eight, and one that is not full
OUTPUTS = {"end": final("tip.position"), "most": maximum("tip.velocity"), "course": "tip.position",
           "late": at_time("tip.velocity", 0.041)}

pytestmark = pytest.mark.skipif(
    way().__name__.endswith("plain"), reason="the plain way makes runs one by one")


@pytest.fixture
def small(monkeypatch):
    """Ensembles of few steps are made in lanes, too."""
    monkeypatch.setattr(ensemble, "WORTH_IT", 0)


@pytest.fixture(scope="module")
def beam() -> Ensemble:
    return Ensemble(turned_beam(), H)


def parameters(runs: int = RUNS, seed: int = 3) -> dict:
    rng = np.random.default_rng(seed)
    return {"beam.stiffness": rng.uniform(0.6, 1.6, runs), "weight.mass": rng.uniform(0.3, 3, runs),
            "motor.amplitude": rng.uniform(-1.0, 2.0, runs)}


def assert_same(found, other, runs=slice(None)):
    """Equal bit by bit."""
    for name, values in found.values.items():
        np.testing.assert_array_equal(values, other.values[name][runs])


def test_members_equal_single_runs(beam, small):
    """Unequal members of a turned model, with outputs that are folded and whole histories."""
    given = parameters()
    found = beam.run(given, T_END, OUTPUTS)
    assert found.in_lanes == RUNS and not found.failures
    assert np.all(found.reached == pytest.approx(T_END, rel=1e-12))
    for run in range(RUNS):
        result = single(turned_beam(), {name: v[run] for name, v in given.items()}, H, T_END)
        # both stop Newton's iteration at the same iterate: they differ by rounding, which a run
        # of 30 steps amplifies by less than 1e3
        scale = np.abs(result["tip.position"]).max()
        assert np.abs(found["course"][run] - result["tip.position"]).max() < 1e-12 * scale
        speed = np.abs(result["tip.velocity"]).max()
        assert np.abs(found["most"][run] - result["tip.velocity"].max(axis=0)).max() < 1e-10 * speed


def test_bits_do_not_depend_on_company_order_or_threads(beam, small):
    """Alone, among others, in another order, in two threads: the same bits."""
    given = parameters(2 * RUNS, seed=8)
    whole = beam.run(given, T_END, OUTPUTS, threads=1)
    assert whole.in_lanes == 2 * RUNS
    assert_same(beam.run(given, T_END, OUTPUTS, threads=2), whole)
    order = np.random.default_rng(0).permutation(2 * RUNS)
    for some in (order, order[:5], order[7:8]):
        part = beam.run({name: v[some] for name, v in given.items()}, T_END, OUTPUTS)
        assert part.in_lanes == len(some)
        assert_same(part, whole, some)


def test_groups_in_turns_give_what_groups_with_python_between_give(beam, small):
    """Nothing but numbers made on the way: groups follow each other in one compiled call.

    A run without accelerations, and one that stops in its steps, are among them. All kinds of
    outputs, against single runs, and with the bits of groups that Python sees for a history.
    """
    runs, end = 45, H * 30
    given = parameters(runs, seed=4)
    given["gravity"] = np.tile(turned_beam().gravity_field, (runs, 1))
    given["motor.amplitude"][5], given["gravity"][40] = 3e4, 1e160
    tip = "tip.velocity"
    kept = {"most": maximum(tip), "least": minimum(tip), "rms": rms(tip, norm=True),
            "mean": integral(tip), "end": final("tip.position"), "soft": soft_maximum(tip, 6),
            "between": at_time(tip, 0.0413), "turned": final("tip.rotation")}
    found = beam.run(given, end, kept, threads=1)
    assert found.in_lanes == runs - 2 and sorted(found.failures) == [5, 40]
    others = np.setdiff1d(np.arange(runs), [5, 40])
    assert found.reached[others] == pytest.approx(end, rel=1e-12) and found.reached[5] < end
    assert np.isnan(found.reached[40])
    assert_same(beam.run(given, end, kept, threads=2), found)
    watched = beam.run(given, end, kept | {"course": tip}, threads=1)
    assert watched.failures == found.failures
    np.testing.assert_array_equal(watched.reached, found.reached)
    for name, values in found.values.items():
        np.testing.assert_array_equal(values, watched.values[name])
    ensemble.WORTH_IT = np.inf      # the fixture puts it back
    alone = beam.run(given, end, kept)
    assert alone.failures == found.failures
    for name, values in found.values.items():
        size = np.abs(alone[name][others]).max()
        assert np.abs(values[others] - alone[name][others]).max() < 1e-10 * size


def test_bits_of_long_runs_do_not_depend_on_company(beam, small):
    """Over 500 steps members turn the fitted prediction on and off, each at other times."""
    given = parameters()
    whole = beam.run(given, 1.0, OUTPUTS)
    for run in range(RUNS):
        alone = beam.run({name: v[run:run + 1] for name, v in given.items()}, 1.0, OUTPUTS)
        assert_same(alone, whole, slice(run, run + 1))


def test_what_is_made_together_does_not_depend_on_the_parts_asked_for(beam, monkeypatch):
    """A part of a sweep is made as all of it is, an ensemble by its own steps."""
    monkeypatch.setattr(ensemble, "WORTH_IT", 100 * T_END / H)
    given = parameters()
    assert beam.run(given, T_END, OUTPUTS).in_lanes == 0
    assert beam.part(given, T_END, OUTPUTS, 99).in_lanes == 0
    assert beam.part(given, T_END, OUTPUTS, 101).in_lanes == RUNS


def test_a_member_that_fails_keeps_its_reason_and_harms_no_other(beam, small):
    """A torque that the step does not resolve: it stops where a run alone stops."""
    given = parameters()
    good = beam.run(given, T_END, OUTPUTS)
    given["motor.amplitude"][[2, 9]] = 3e4, -4e4
    found = beam.run(given, T_END, OUTPUTS)
    others = np.setdiff1d(np.arange(RUNS), [2, 9])
    assert found.in_lanes == len(others)
    assert_same(beam.run({name: v[others] for name, v in given.items()}, T_END, OUTPUTS), good,
                others)
    for name, values in found.values.items():
        np.testing.assert_array_equal(values[others], good.values[name][others])
    alone = Ensemble(turned_beam(), H)
    ensemble.WORTH_IT, kept = np.inf, ensemble.WORTH_IT
    try:
        expected = alone.run(given, T_END, OUTPUTS)
    finally:
        ensemble.WORTH_IT = kept
    assert found.failures == expected.failures
    for run in (2, 9):
        assert found.reached[run] == expected.reached[run]
        np.testing.assert_array_equal(found["course"][run], expected["course"][run])


def test_members_agree_with_an_independent_integration(small):
    """A planar pendulum of a rigid body, large angles, against the equation of its angle.

    The scheme is of second order: a third of the step leaves a ninth of the error.
    """
    mass, inertia, arm, foot = 2.0, 0.7, 0.9, np.array([0.4, -0.2])
    made = Model(planar=True)
    hinge = made.node("hinge", foot)
    made.fix(hinge, "position")
    made.rigid_body("body", hinge, mass, inertia, foot + (arm, 0.0))
    made.attach("tip", foot + (1.5 * arm, 0.0), hinge)      # a rigid link
    fields = np.outer(np.linspace(0.5, 1.5, 9), (0.3, -9.81))

    def turned(field):
        def rate(t, y):
            moment = mass * arm * (np.cos(y[0]) * field[1] - np.sin(y[0]) * field[0])
            return y[1], moment / (inertia + mass * arm * arm)
        angle = solve_ivp(rate, (0, 1.2), (0.0, 0.0), rtol=1e-11, atol=1e-12).y[0, -1]
        return foot + 1.5 * arm * np.array([np.cos(angle), np.sin(angle)])

    expected, errors = [turned(field) for field in fields], []
    for h in (6e-3, 2e-3):
        found = Ensemble(made, h).run({"gravity": fields}, 1.2, {"end": final("tip.position")})
        assert found.in_lanes == 9
        errors.append(np.abs(found["end"] - expected).max())
    assert errors[1] < 1e-3
    assert errors[0] / errors[1] == pytest.approx(9.0, rel=0.15)


def test_neighbours_are_alike():
    """Groups have every run once, and runs of a group differ less than runs by chance."""
    rng = np.random.default_rng(5)
    changes = rng.uniform(size=(403, 3)) * (1.0, 3.0, 0.1)
    order = alike(changes, 8)
    groups = [order[k:k + 8] for k in range(0, 403, 8)]
    assert sorted(run for group in groups for run in group) == list(range(403))
    assert {len(group) for group in groups} == {8, 3}
    within = np.mean([np.ptp(changes[group], axis=0)[:2] / (1.0, 3.0) for group in groups])
    assert within < 0.3         # by chance (8 - 1) / (8 + 1)


def test_straight_code_lives_as_long_as_the_arrays_that_use_it(small, monkeypatch):
    """Where none is kept for other ensembles."""
    from sebody.engine.lanes import loop
    from sebody.kernels.lanes import straight

    made, alive, rows_of = weakref.WeakSet(), [], loop.rows_of

    def code(entries):
        made.add(own := straight.Straight(entries))
        return own

    def count(*given):
        gc.collect()
        alive.append(len(made))
        rows_of(*given)
    four_bar, given = Ensemble(linkage(), 4e-3), {"spring.stiffness": np.linspace(5, 90, 9)}
    found = four_bar.run(given, 0.04, {"end": "tip.position"}, threads=1)
    monkeypatch.setattr(straight, "straight_code", code)
    monkeypatch.setattr(loop, "rows_of", count)
    assert_same(four_bar.run(given, 0.04, {"end": "tip.position"}, threads=1), found)
    gc.collect()
    assert found.in_lanes == 9 and min(alive) == max(alive) > 0 and not made


@pytest.mark.parametrize("scene, options, scheme, reason", [
    ("stick-slip", {}, None, "friction"),
    ("pole-on-cart", {}, generalized_alpha(index=2), "controllers with index 2")])
def test_the_ensemble_says_why_its_runs_are_made_one_by_one(scene, options, scheme, reason, small):
    """By facts of the model; its runs are those of the scalar loop."""
    built = builder(scene)(**options)
    found = Ensemble(built.model, built.h, scheme)
    assert "runs one by one" in repr(found) and reason in repr(found)
    outcome = found.run({"gravity": np.ones((2, 1)) * built.model.gravity_field}, 2 * built.h,
                        {"end": final(f"{built.tip}.position")})
    assert outcome.in_lanes == 0 and not outcome.failures


def test_a_member_without_a_start_and_steps_after_the_last_record(beam, small):
    """The last member that begins has no accelerations; 30 steps, every seventh is recorded."""
    given = parameters(5)
    given["gravity"] = np.tile(turned_beam().gravity_field, (5, 1))
    given["gravity"][4] = 1e160
    outputs = OUTPUTS | {"energy": "energy.strain", "strained": maximum("energy.strain")}
    seventh = Ensemble(turned_beam(), H, output_every=7)
    found = seventh.run(given, T_END, outputs)
    assert found.in_lanes == 4 and list(found.failures) == [4]
    assert "no accelerations" in found.failures[4]
    ensemble.WORTH_IT = np.inf      # the fixture puts it back
    expected = seventh.run(given, T_END, outputs)
    assert found.failures == expected.failures and expected["energy"].shape == (5, 5)
    for name, values in found.values.items():
        size = np.abs(expected[name][:4]).max()
        assert np.abs(values[:4] - expected[name][:4]).max() < 1e-10 * size


def test_long_groups_look_whether_they_are_to_stop(beam, small, monkeypatch):
    """Few records of many steps: interrupted between these, with the numbers of single runs."""
    monkeypatch.setattr("sebody.explore.ensembles.lanes.MOST_STEPS", 4)
    fifteenth, given = Ensemble(turned_beam(), H, output_every=15), parameters(3)
    outputs = {"course": "tip.position", "most": maximum("tip.velocity")}
    found = fifteenth.run(given, T_END, outputs, threads=1)
    monkeypatch.setattr("sebody.explore.ensembles.lanes.MOST_STEPS", 10**6)
    assert found.in_lanes == 3
    assert_same(found, fifteenth.run(given, T_END, outputs, threads=1))


def test_interrupted_members_keep_what_they_have(beam, small, monkeypatch):
    """Stopped after the first four of thirty steps."""
    from sebody.explore.ensembles.lanes import Lanes

    given = parameters(3)
    whole, run_lanes = beam.run(given, T_END, OUTPUTS, threads=1), Lanes.run
    monkeypatch.setattr("sebody.explore.ensembles.lanes.MOST_STEPS", 4)
    monkeypatch.setattr(Lanes, "run", lambda self, stop: run_lanes(self, lambda: True))
    found = beam.run(given, T_END, OUTPUTS, threads=1)
    assert found.failures == dict.fromkeys(range(3), "interrupted before its end")
    assert found.reached == pytest.approx(4 * H) and np.isnan(found["late"]).all()
    np.testing.assert_array_equal(found["course"][:, :5], whole["course"][:, :5])
    assert np.isnan(found["course"][:, 5:]).all()
