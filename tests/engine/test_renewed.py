"""Element matrices that are made in the state before a step: corrections, rejected steps, lanes."""

import numpy as np
import pytest
from small_mechanisms import arm, four_bar, links, skew, unequal

from sebody import Simulation, generalized_alpha, simulate
from sebody.analysis import Ensemble, final
from sebody.compiler.choice import why_no_lanes
from sebody.engine.state import EVALUATED
from sebody.explore.ensembles import ensemble

LANES = pytest.mark.skipif(bool(why_no_lanes()), reason=why_no_lanes())


def corrections(model, h: float, steps: int, accepted: bool) -> float:
    """Of a step, with a new matrix at the begin of each and a tight tolerance."""
    run = Simulation(model, h, generalized_alpha(tolerance=1e-11)).run_to(10 * h)
    before = run.state.control.iterations
    for k in range(steps):
        run.state.control.wanted = EVALUATED
        if not accepted:        # a step that is repeated: matrices are of the predicted state
            run.state.control.iteration = 0
        run.run_to((11 + k) * h)
    return (run.state.control.iterations - before) / steps


@pytest.mark.parametrize("build, h", [(lambda: links(2), 0.01), (lambda: skew(3), 0.01)])
def test_matrices_of_accepted_states_take_fewer_corrections(build, h):
    """The errors of a predicted state stretch stiff links: 6.8 corrections, and 4.9."""
    own, predicted = (corrections(build(), h, 40, accepted) for accepted in (True, False))
    assert own < predicted - 0.8, (own, predicted)


@pytest.mark.parametrize("build, h, steps", [
    (lambda: links(4), 0.01, 50), (unequal, 0.005, 100), (four_bar, 0.002, 150),
    (arm, 0.002, 100), (lambda: skew(5), 0.005, 100)])
def test_motions_of_few_bodies_are_those_of_a_tight_tolerance(build, h, steps):
    """The tolerance is 1e-8 of the increments; in such motions 1e-5 of coordinates is left."""
    model = build()
    own, exact = (Simulation(model, h, generalized_alpha(tolerance=tolerance)).run_to(steps * h)
                  for tolerance in (1e-8, 1e-12))
    assert own.state.control.cuts == exact.state.control.cuts == 0
    assert own.state.control.iterations < 4.5 * steps
    moving = own.system.is_multiplier[:own.state.q.size] == 0.0
    for name, most in (("q", 1e-5), ("v", 1e-4)):
        a, b = (one.rows.all()[:, one.state.recorded_parts[name]][:, moving]
                for one in (own, exact))
        assert np.abs(a - b).max() < most * np.abs(b).max(), name


@LANES
@pytest.mark.parametrize("build, end", [
    (lambda: skew(4), "end 3"), (unequal, "end 4"), (lambda: links(2), "tip")])
def test_members_renew_as_single_runs_do(build, end, monkeypatch):
    """Four equal links, which single runs evaluate eight at a time and members one by one."""
    monkeypatch.setattr(ensemble, "WORTH_IT", 0)
    values, quantity = np.array([-6.0, -9.81, -13.0]), f"{end}.position"
    outcome = Ensemble(build(), 0.005).run({"gravity.y": values}, 0.4, {"end": final(quantity)})
    assert not outcome.why_one_by_one
    for value, found in zip(values, outcome["end"], strict=True):
        model = build()
        model.gravity((0.0, value, *model.gravity_field[2:]))
        expected = simulate(model, 0.005, 0.4)[quantity][-1]
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
