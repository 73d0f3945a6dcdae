"""Members in lanes that are evaluated, or make some steps, alone: each equals its single run."""

import numpy as np
import pytest
from lane_models import linkage

from sebody import Model, plane
from sebody.analysis import Ensemble, final
from sebody.compiler.choice import way
from sebody.explore.ensembles import ensemble

RUNS = 9        # one group of eight, and one run
SEED = 6

pytestmark = pytest.mark.skipif(
    way().__name__.endswith("plain"), reason="the plain way makes runs one by one")


def rolling(friction: float, speed: float) -> Model:
    """A ball that lies on a plane, with a beam beside it."""
    made = linkage()
    ball = made.node("ball", (0.0, -3.0))
    made.rigid_body("sphere", ball, 1.0, 0.004)
    made.initial_velocity(ball, (speed, 0.0))
    made.contact(ball, on=plane((0.0, 1.0), point=(0.0, -3.1)), radius=0.1001, stiffness=1e5,
                 friction=friction, name="floor")
    return made


def geared() -> Model:
    made = linkage()
    for k in (0, 1):
        wheel = made.node(f"wheel {k}", (4.0 + 3 * k, 1.0))
        made.rigid_body(f"gear {k}", wheel, 1.0, 0.1)
        made.revolute(wheel, name=f"axle {k}")
    made.gear("axle 0", "axle 1", ratio=-1.0, backlash=1e-3, name="teeth")
    return made


@pytest.mark.parametrize("build, reason", [
    (lambda: rolling(0.3, 0.0), "friction that holds"), (geared, "teeth"),
    (lambda: rolling(0.3, 1.0), "eight at a time")])
def test_the_ensemble_says_how_its_runs_are_made(build, reason):
    assert reason in repr(Ensemble(build(), 2e-3))


def test_the_outcome_says_how_its_runs_were_made(monkeypatch):
    """A damping that follows from a restitution, not in proportion, wants another model."""
    beam, ball = linkage(), Model(planar=True)
    ball.rigid_body("ball", ball.node("centre", (0.3, 0.2)), 1.0, 0.1)
    for made, node in ((beam, "tip"), (ball, "centre")):
        made.contact(node, plane((0.1, 1.0), point=(0.0, -3.0)), stiffness=1e5, name="floor")

    def told(model, name):
        outcome = Ensemble(model, 2e-3).run({name: np.linspace(0.3, 0.9, RUNS)}, 0.02,
                                            {"end": final("energy.kinetic")})
        title = repr(outcome).splitlines()[0]
        assert title.endswith(f"one by one: {outcome.why_one_by_one}" if outcome.why_one_by_one
                              else f"{outcome.in_lanes} of them eight at a time")
        return outcome.in_lanes, outcome.why_one_by_one
    assert told(beam, "floor.stiffness") == (0, f"fewer than {ensemble.WORTH_IT} steps in all")
    monkeypatch.setattr(ensemble, "WORTH_IT", 0)
    assert told(beam, "motor.amplitude") == (RUNS, "")
    assert told(beam, "floor.restitution") == (
        0, "with these parameters the model is built anew for each run")
    assert told(ball, "ball.mass") == (
        0, "elements that keep numbers, as contacts and friction, among rigid bodies alone")
