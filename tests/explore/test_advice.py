"""Advice on how much of a model is needed: what it chooses is within the tolerance."""

import numpy as np
import pytest
from advised_crane import T_END, H, crane

from sebody import InputError, Model, simulate
from sebody.analysis import advise
from sebody.control import pid


def error(found: Model, step: float, quantity: str) -> float:
    """Against the whole model at a step half as long as the reference's."""
    one = simulate(found, step, T_END)
    whole = simulate(crane(), H / 8, T_END, output_every=round(8 * step / H))
    off, moved = one[quantity] - whole[quantity], whole[quantity] - whole[quantity][0]
    return np.linalg.norm(off, axis=1).max() / np.linalg.norm(moved, axis=1).max()


@pytest.mark.parametrize("tolerance", [0.05, 1e-2, 1e-3])
def test_what_is_chosen_is_within_the_tolerance(tolerance):
    model = crane()
    advice = advise(model, H, T_END, "tip.position", tolerance)
    assert list(model.bodies) == ["soft", "stout"]
    confirmed = error(advice.model, advice.step, "tip.position")
    assert confirmed <= tolerance
    assert abs(confirmed - advice.error) <= 0.1 * tolerance     # the two references' steps
    # a short arm of a thousand times the stiffness: it bends by 1e-5 of what the soft one does
    assert "stout" in advice.model.rigid_bodies
    last = advice.summary().splitlines()[-1]
    assert last == f"confirmed error {advice.error:.2g} <= {tolerance:g}"
    assert len(advice.table) <= 20
    # a longer step is not enough of any model that takes clearly less time: the times of two models
    # with nearly the same cost change places on a machine that does other work
    tried = [trial for trial in advice.table if trial.step > advice.step
             and trial.kind not in ("guard", "reference")]
    assert all(trial.error > tolerance for trial in tried
               if trial.cost < 0.7 * advice.table[-2].cost or trial.kind == "together")


def test_the_soft_body_stays_flexible_with_as_many_modes_as_needed():
    modes = [advise(crane(), H, T_END, "tip.position", tolerance).model.bodies["soft"].reduced.modes
             for tolerance in (0.05, 1e-3)]
    assert modes[0] < modes[1]


def test_a_search_ends_with_its_budget():
    advice = advise(crane(), H, T_END, "tip.position", 1e-2, budget=1.0)
    assert advice.untried == ("soft", "stout")      # two runs before the first body
    assert list(advice.model.bodies) == ["soft", "stout"]
    assert "not tried: soft, stout; raise the budget" in advice.summary().splitlines()


@pytest.mark.parametrize(("given", "message"), [
    ({"quantities": "top.position"}, "'top.position' is unknown: did you mean 'tip.position'"),
    ({"tolerance": 1e-9}, "tip.position is known to .* of its change only, worst at t = .*, even "
     "with the step .*: shorter steps that are tried, down to .*, are not enough; a "
     "tolerance of .* would pass"),
    ({"t_end": 0.405}, "t_end is 0.405, 40.5 steps of 0.01: give a whole number of steps"),
    ({"model": crane(still=True)}, "quantity 'tip.position' does not change: the model does not "
     "move; give it loads, a drive or initial velocities"),
    ({"quantities": "base.position"}, "'base.position' does not change: give one that the motion"),
    ({"quantities": "frequency 99"}, "'frequency 99' does not exist: the model has 14 freq"),
    ({"quantities": []}, "quantities: none is given"),
])
def test_what_cannot_be_advised_is_said(given, message):
    whole = {"model": crane(), "h": H, "t_end": T_END, "quantities": "tip.position"} | given
    with pytest.raises(InputError, match=message):
        advise(**whole)


@pytest.mark.parametrize("period", [None, 0.01])
def test_models_with_actuators_and_sampled_controllers_are_advised(period):
    model = crane(torque=0.0)
    model.actuator("motor", joint=model.joints[0], start=300.0)
    if period:
        model.sensor("angle", "base.rotation")
        model.controller("loop", pid(3000.0, 0.0, 10.0, reference=0.1), inputs=("angle",),
                         outputs=("motor",), period=period)
    advice = advise(model, H, T_END, "tip.position", 0.05)
    assert advice.error <= 0.05 and advice.seconds > 0.0
    if period:
        assert round(period / advice.step, 9) == round(period / advice.step)
